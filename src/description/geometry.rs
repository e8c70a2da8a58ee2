//! What the text says about shapes, and about the bodies made from them.

use super::{Origin, Position};

/// A shape with its place in the link.
#[derive(Clone, Debug)]
pub struct PlacedShape {
    /// Where the element starts.
    pub at: Position,
    /// Frame of the shape in the link frame.
    pub origin: Origin,
    /// What it is.
    pub geometry: Geometry,
    /// Fillets, slice, caps.
    pub finish: Finish,
    /// `scale`, `scale_top`, `scale_bottom`: what deforms it, in its own frame.
    pub scaling: Scaling,
    /// What it is made of, where a `<shape>` inside `<body>` says so; `None`: as the body.
    pub substance: Option<Substance>,
}

impl PlacedShape {
    /// B-4 (table 6-2): may it be taken as its polygon mesh? A hollow body never is (table 7-35).
    pub fn may_be_polygonised(&self, dimension: Dimension) -> bool {
        let sharp = self.finish.fillet == 0.0 && self.finish.top_fillet.is_none_or(|fillet| fillet == 0.0);
        let whole = self.finish.slice.is_none();
        let kind = match self.geometry {
            Geometry::Box { .. } => sharp,
            Geometry::Sphere { .. } | Geometry::Ellipsoid { .. } => true,
            Geometry::Capsule { .. } => whole,
            Geometry::Cylinder { .. }
            | Geometry::EllipticCylinder { .. }
            | Geometry::Tube { .. }
            | Geometry::Cone { .. }
            | Geometry::Frustum { .. } => sharp && whole,
            _ => false,
        };
        kind && dimension == Dimension::Solid
    }
}

/// Shapes; lengths in metres. Axes of round shapes are Z, as in URDF, and the origin is the middle.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the sentence at each variant tells its fields")]
pub enum Geometry {
    /// Full edge lengths.
    Box { size: [f64; 3] },
    /// Full height `length` along Z, without caps.
    Cylinder { radius: f64, length: f64 },
    /// A sphere.
    Sphere { radius: f64 },
    /// `length` is the cylindrical part, along Z; `radius_top`, `radius_bottom` differ for a tapered one.
    Capsule { radius_top: f64, radius_bottom: f64, length: f64 },
    /// Semi-axes.
    Ellipsoid { radii: [f64; 3] },
    /// Semi-axes of the cross section along X and Y, full height along Z.
    EllipticCylinder { radius_x: f64, radius_y: f64, length: f64 },
    /// Outer and inner radius, full height along Z.
    Tube { outer_radius: f64, inner_radius: f64, length: f64 },
    /// Base semi-axes, full height; base at −length/2, tip at +length/2.
    Cone { radius_x: f64, radius_y: f64, length: f64 },
    /// Base semi-axes (at −length/2), scale of the top section (at +length/2).
    Frustum { radius_x: f64, radius_y: f64, top_scale: f64, length: f64 },
    /// A bowl: the curved half of a sphere on z ≥ 0, open at z = 0.
    Hemisphere { radius: f64 },
    /// Around Z: radius of the ring through the middle of the pipe, radius of the pipe.
    Torus { ring_radius: f64, pipe_radius: f64 },
    /// A cylinder whose ends are caps of a sphere; `length` is the part between the caps, along Z.
    OilTank { radius: f64, length: f64, cap_height: f64 },
    /// Rectangular base at −z/2, tip at +z/2.
    Pyramid { size: [f64; 3] },
    /// Platonic: number of faces, radius of the sphere through the corners.
    Polyhedron { faces: u32, radius: f64 },
    /// Flat, in the XY plane; the inner radius may be 0.
    Disc { outer_radius: f64, inner_radius: f64 },
    /// A rectangle in the XY plane.
    Plane { size: [f64; 2] },
    /// Its corners, anticlockwise seen from the outside.
    Triangle { corners: [[f64; 3]; 3] },
    /// Its corners in order around, anticlockwise seen from the outside; two triangles, split along a diagonal inside.
    Quad { corners: [[f64; 3]; 4] },
    /// A height field over the XY plane: full extents along X and Y, height of a value of 1.
    Terrain { size: [f64; 3], heights: Heights },
    /// A sphere with heights: distance of the surface from the centre = radius + height × value.
    SphericalTerrain { radius: f64, height: f64, heights: Heights },
    /// A file, scaled per axis.
    Mesh { filename: String, scale: [f64; 3] },
}

impl Geometry {
    /// The element name.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::Cylinder { .. } => "cylinder",
            Self::Sphere { .. } => "sphere",
            Self::Capsule { .. } => "capsule",
            Self::Ellipsoid { .. } => "ellipsoid",
            Self::EllipticCylinder { .. } => "elliptic_cylinder",
            Self::Tube { .. } => "tube",
            Self::Cone { .. } => "cone",
            Self::Frustum { .. } => "frustum",
            Self::Hemisphere { .. } => "hemisphere",
            Self::Torus { .. } => "torus",
            Self::OilTank { .. } => "oil_tank",
            Self::Pyramid { .. } => "pyramid",
            Self::Polyhedron { .. } => "polyhedron",
            Self::Disc { .. } => "disc",
            Self::Plane { .. } => "plane",
            Self::Triangle { .. } => "triangle",
            Self::Quad { .. } => "quad",
            Self::Terrain { .. } | Self::SphericalTerrain { .. } => "terrain",
            Self::Mesh { .. } => "mesh",
        }
    }
}

/// Where the values of a terrain come from: rows from +Y to −Y (spherical: from the pole +Z to −Z), columns from −X to
/// +X (spherical: eastwards around, from +X over +Y; the last column meets the first).
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the sentence at each variant tells its fields")]
pub enum Heights {
    /// Row after row, `columns` values in each.
    Written { columns: usize, values: Vec<f64> },
    /// A picture in shades of grey (PNG): black 0, white 1; or numbers in lines (.txt, .csv).
    File { filename: String },
}

/// Fillets, slice and caps: what tables 6-2 and 6-5 of the source name beside the sizes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Finish {
    /// Radius by which the edges are rounded, m; 0: sharp.
    pub fillet: f64,
    /// The same at the top rim of a frustum, where it differs from the bottom rim.
    pub top_fillet: Option<f64>,
    /// Only the part between these two angles about Z, rad, from X towards Y: `to` > `from`, less than a turn.
    pub slice: Option<[f64; 2]>,
    /// Without caps: a mantle that is open at its ends.
    pub open: bool,
}

/// What deforms a shape (S-3, S-4), in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling {
    /// Factors along X, Y, Z; none is 0, a negative one mirrors.
    pub factors: [f64; 3],
    /// Factor on a capsule's top radius, ≥ 0.
    pub top: f64,
    /// Factor on a capsule's bottom radius, ≥ 0.
    pub bottom: f64,
}

impl Default for Scaling {
    fn default() -> Self {
        Self { factors: [1.0; 3], top: 1.0, bottom: 1.0 }
    }
}

/// Solid or hollow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dimension {
    /// Filled.
    Solid,
    /// A shell.
    Hollow {
        /// Of the wall, metres.
        thickness: f64,
    },
}

/// Most segments of a turn: a sphere of them has four million triangles.
pub const MOST_SEGMENTS: u32 = 2000;
/// Most segments of a length: a box of them has three million triangles.
pub const MOST_FLAT_SEGMENTS: u32 = 500;

/// Into how many segments a primitive is divided where it becomes a polygon mesh (B-4, B-5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Subdivision {
    /// Of a full turn; a half circle of an outline takes half as many. 3 to [`MOST_SEGMENTS`].
    pub around: u32,
    /// Of a straight length, where more of them do not change the shape; 1 if the
    /// subdivision is limited (B-5). 1 to [`MOST_FLAT_SEGMENTS`].
    pub flat: u32,
}

/// What a body is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substance {
    /// 1 = 1000 kg/m³; 0 = static.
    pub specific_gravity: f64,
    /// Solid or hollow.
    pub dimension: Dimension,
    /// B-4: the primitive is taken as its polygon mesh.
    pub polygonise: Option<Subdivision>,
}

/// `<body>`.
#[derive(Clone, Debug)]
pub struct Body {
    /// Where.
    pub at: Position,
    /// What it is made of, where a shape says nothing else.
    pub substance: Substance,
    /// Factor on the distance used in the moment of inertia (B-18); 1 by default.
    pub l_scale: f64,
    /// B-10: elements of the inertia tensor below 10 to this power (kg·m²) become 0.
    pub zero_exponent: Option<i32>,
    /// `<shape>` children: what the mass is computed from; empty = the link's visuals.
    pub shapes: Vec<PlacedShape>,
    /// How many `<shape>` children could not be read; each is reported.
    pub misread: usize,
}

impl Body {
    /// What one of its shapes is made of; polygonised only if it may be (B-4).
    pub fn substance_of(&self, shape: &PlacedShape) -> Substance {
        let own = shape.substance.unwrap_or(self.substance);
        Substance { polygonise: own.polygonise.filter(|_| shape.may_be_polygonised(own.dimension)), ..own }
    }
}
