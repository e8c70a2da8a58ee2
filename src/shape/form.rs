//! A shape as it is after scaling (S-5, B-19): what mass properties, collision and drawings see.

use super::check::{ShapeFault, check};
use crate::description::{Finish, Geometry, PlacedShape, Scaling};
use crate::math::Vec3;

/// A checked shape in its own frame: a primitive with its finish, stretched along its axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The primitive.
    pub geometry: Geometry,
    /// Fillets, slice, caps; applied before the stretch.
    pub finish: Finish,
    /// Factors along X, Y, Z that could not be taken up by the primitive; a negative one mirrors. Mostly 1.
    pub stretch: [f64; 3],
}

impl Shape {
    /// A primitive as it is.
    ///
    /// # Errors
    /// Sizes that make no shape.
    pub fn new(geometry: Geometry) -> Result<Self, ShapeFault> {
        Self::finished(geometry, Finish::default(), Scaling::default())
    }

    /// The shape that the text describes.
    ///
    /// # Errors
    /// Sizes, fillets or scales that make no shape.
    pub fn of(placed: &PlacedShape) -> Result<Self, ShapeFault> {
        Self::finished(placed.geometry.clone(), placed.finish, placed.scaling)
    }

    /// A primitive with its finish, scaled.
    ///
    /// # Errors
    /// Sizes, fillets or scales that make no shape.
    pub fn finished(geometry: Geometry, finish: Finish, scaling: Scaling) -> Result<Self, ShapeFault> {
        if let Some(&bad) = scaling.factors.iter().find(|f| **f == 0.0 || !f.is_finite()) {
            return Err(ShapeFault::Scale(bad));
        }
        let geometry = with_ends(geometry, scaling.top, scaling.bottom);
        let geometry = split_inside(geometry)?;
        check(&geometry, &finish)?;
        let plain = Finish { open: finish.open, ..Finish::default() } == finish;
        let taken = plain.then(|| scaled(&geometry, scaling.factors)).flatten();
        Ok(match taken {
            Some(geometry) => Self { geometry, finish, stretch: [1.0; 3] },
            None => Self { geometry, finish, stretch: scaling.factors },
        })
    }

    /// A surface with no inside: forced 2D (B-11). A mesh file may turn out to be open as well.
    pub fn is_open(&self) -> bool {
        self.finish.open
            || matches!(
                self.geometry,
                Geometry::Hemisphere { .. }
                    | Geometry::Disc { .. }
                    | Geometry::Plane { .. }
                    | Geometry::Triangle { .. }
                    | Geometry::Quad { .. }
                    | Geometry::Terrain { .. }
            )
    }
}

/// S-4: factors on the end radii of a capsule.
fn with_ends(geometry: Geometry, top: f64, bottom: f64) -> Geometry {
    match geometry {
        Geometry::Capsule { radius_top, radius_bottom, length } => {
            Geometry::Capsule { radius_top: radius_top * top, radius_bottom: radius_bottom * bottom, length }
        }
        other => other,
    }
}

/// A quad that its first diagonal does not split into two triangles of the same side starts at its second corner: the
/// corner between them is bent inwards.
fn split_inside(geometry: Geometry) -> Result<Geometry, ShapeFault> {
    let Geometry::Quad { corners } = geometry else { return Ok(geometry) };
    let along_first = |[a, b, c, d]: [[f64; 3]; 4]| {
        let [a, b, c, d] = [a, b, c, d].map(Vec3::from);
        (b - a).cross(&(c - a)).dot(&(c - a).cross(&(d - a))) >= 0.0
    };
    let [a, b, c, d] = corners;
    let splits = [corners, [b, c, d, a]].into_iter().find(|corners| along_first(*corners));
    splits.map(|corners| Geometry::Quad { corners }).ok_or(ShapeFault::Crossing)
}

/// The primitive that `geometry` becomes under positive factors, if there is one: sphere → ellipsoid, cylinder →
/// elliptic cylinder, and so on.
fn scaled(geometry: &Geometry, factors: [f64; 3]) -> Option<Geometry> {
    let [x, y, z] = factors;
    if factors.iter().any(|f| *f < 0.0) {
        return None;
    }
    let round = x == y;
    let equal = round && x == z;
    Some(match *geometry {
        Geometry::Box { size: [a, b, c] } => Geometry::Box { size: [a * x, b * y, c * z] },
        Geometry::Sphere { radius } if equal => Geometry::Sphere { radius: radius * x },
        Geometry::Sphere { radius } => Geometry::Ellipsoid { radii: [radius * x, radius * y, radius * z] },
        Geometry::Ellipsoid { radii: [a, b, c] } => Geometry::Ellipsoid { radii: [a * x, b * y, c * z] },
        Geometry::Cylinder { radius, length } if round => Geometry::Cylinder { radius: radius * x, length: length * z },
        Geometry::Cylinder { radius, length } => {
            Geometry::EllipticCylinder { radius_x: radius * x, radius_y: radius * y, length: length * z }
        }
        Geometry::EllipticCylinder { radius_x, radius_y, length } => {
            Geometry::EllipticCylinder { radius_x: radius_x * x, radius_y: radius_y * y, length: length * z }
        }
        Geometry::Cone { radius_x, radius_y, length } => {
            Geometry::Cone { radius_x: radius_x * x, radius_y: radius_y * y, length: length * z }
        }
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => {
            Geometry::Frustum { radius_x: radius_x * x, radius_y: radius_y * y, top_scale, length: length * z }
        }
        Geometry::Tube { outer_radius, inner_radius, length } if round => {
            Geometry::Tube { outer_radius: outer_radius * x, inner_radius: inner_radius * x, length: length * z }
        }
        Geometry::Capsule { radius_top, radius_bottom, length } if equal => {
            Geometry::Capsule { radius_top: radius_top * x, radius_bottom: radius_bottom * x, length: length * x }
        }
        Geometry::Hemisphere { radius } if equal => Geometry::Hemisphere { radius: radius * x },
        Geometry::Torus { ring_radius, pipe_radius } if equal => {
            Geometry::Torus { ring_radius: ring_radius * x, pipe_radius: pipe_radius * x }
        }
        Geometry::OilTank { radius, length, cap_height } if equal => {
            Geometry::OilTank { radius: radius * x, length: length * x, cap_height: cap_height * x }
        }
        Geometry::Pyramid { size: [a, b, c] } => Geometry::Pyramid { size: [a * x, b * y, c * z] },
        Geometry::Polyhedron { faces, radius } if equal => Geometry::Polyhedron { faces, radius: radius * x },
        Geometry::Disc { outer_radius, inner_radius } if round => {
            Geometry::Disc { outer_radius: outer_radius * x, inner_radius: inner_radius * x }
        }
        _ => return (factors == [1.0; 3]).then(|| geometry.clone()),
    })
}
