//! Every shape, with its variants, by name.

use realnoid::description::{Finish, Geometry, Heights, Scaling, Subdivision};
use realnoid::shape::{Meshes, Shape, TriMesh, tessellate};

pub const SUBDIVISION: Subdivision = Subdivision { around: 24, flat: 2 };

pub fn mesh_of(shape: &Shape, subdivision: Subdivision) -> TriMesh {
    tessellate(shape, subdivision, &Meshes::default()).unwrap()
}

fn with(geometry: Geometry, finish: Finish) -> Shape {
    Shape::finished(geometry, finish, Scaling::default()).unwrap()
}

pub fn cylinder() -> Geometry {
    Geometry::Cylinder { radius: 0.3, length: 0.8 }
}

pub fn tube() -> Geometry {
    Geometry::Tube { outer_radius: 0.4, inner_radius: 0.25, length: 0.7 }
}

pub fn torus() -> Geometry {
    Geometry::Torus { ring_radius: 0.5, pipe_radius: 0.2 }
}

pub fn cone() -> Geometry {
    Geometry::Cone { radius_x: 0.4, radius_y: 0.25, length: 0.9 }
}

pub fn frustum() -> Geometry {
    Geometry::Frustum { radius_x: 0.4, radius_y: 0.3, top_scale: 0.5, length: 0.6 }
}

pub fn capsule() -> Geometry {
    Geometry::Capsule { radius_top: 0.2, radius_bottom: 0.35, length: 0.6 }
}

pub fn hills(columns: usize, rows: usize) -> Heights {
    let value = |i: usize| (0.7 * i as f64).sin() * 0.5 + 0.5;
    Heights::Written { columns, values: (0..rows * columns).map(value).collect() }
}

/// Shapes with an inside, whole and sharp.
pub fn solids() -> Vec<(&'static str, Shape)> {
    let polyhedra = [("4", 4), ("6", 6), ("8", 8), ("12", 12), ("20", 20)];
    let mut all = vec![
        ("box", Geometry::Box { size: [0.4, 0.6, 0.9] }),
        ("sphere", Geometry::Sphere { radius: 0.5 }),
        ("ellipsoid", Geometry::Ellipsoid { radii: [0.3, 0.5, 0.2] }),
        ("cylinder", cylinder()),
        ("elliptic cylinder", Geometry::EllipticCylinder { radius_x: 0.4, radius_y: 0.2, length: 0.5 }),
        ("capsule", capsule()),
        ("capsule, top wider", Geometry::Capsule { radius_top: 0.35, radius_bottom: 0.2, length: 0.6 }),
        ("capsule with a point", Geometry::Capsule { radius_top: 0.0, radius_bottom: 0.35, length: 0.6 }),
        ("tube", tube()),
        ("cone", cone()),
        ("frustum", frustum()),
        ("frustum, top wider", Geometry::Frustum { radius_x: 0.3, radius_y: 0.3, top_scale: 1.7, length: 0.6 }),
        ("torus", torus()),
        ("oil tank", Geometry::OilTank { radius: 0.3, length: 0.7, cap_height: 0.1 }),
        ("pyramid", Geometry::Pyramid { size: [0.4, 0.6, 0.5] }),
        ("globe", Geometry::SphericalTerrain { radius: 0.4, height: 0.1, heights: hills(12, 7) }),
    ];
    all.extend(polyhedra.map(|(name, faces)| (name, Geometry::Polyhedron { faces, radius: 0.5 })));
    all.into_iter().map(|(name, geometry)| (name, Shape::new(geometry).unwrap())).collect()
}

/// Shapes with an inside, with fillets, slices or stretched beyond their primitive.
pub fn finished() -> Vec<(&'static str, Shape)> {
    let fillet = Finish { fillet: 0.05, ..Finish::default() };
    let slice = Finish { slice: Some([-0.4, 1.9]), ..Finish::default() };
    let wide = Finish { slice: Some([0.5, 6.0]), fillet: 0.04, ..Finish::default() };
    let rims = Finish { fillet: 0.08, top_fillet: Some(0.02), ..Finish::default() };
    let mirrored = Scaling { factors: [1.5, -0.5, 2.0], ..Scaling::default() };
    let stretched = |geometry, finish| Shape::finished(geometry, finish, mirrored).unwrap();
    vec![
        ("box with fillet", with(Geometry::Box { size: [0.4, 0.6, 0.9] }, fillet)),
        ("box, all fillet", with(Geometry::Box { size: [0.1, 0.6, 0.9] }, fillet)),
        ("cylinder with fillet", with(cylinder(), fillet)),
        ("cylinder, all fillet", with(Geometry::Cylinder { radius: 0.05, length: 0.1 }, fillet)),
        ("cylinder, sliced", with(cylinder(), slice)),
        ("cylinder, sliced, with fillet", with(cylinder(), wide)),
        ("tube with fillet", with(tube(), fillet)),
        ("tube, sliced", with(tube(), slice)),
        ("tube, sliced, with fillet", with(tube(), wide)),
        ("cone with fillet", with(cone(), fillet)),
        ("cone, sliced", with(cone(), slice)),
        ("frustum with two fillets", with(frustum(), rims)),
        ("frustum, sliced, with two fillets", with(frustum(), Finish { slice: slice.slice, ..rims })),
        ("capsule, sliced", with(capsule(), slice)),
        ("torus, stretched and mirrored", stretched(torus(), Finish::default())),
        ("box with fillet, stretched and mirrored", stretched(Geometry::Box { size: [0.4, 0.6, 0.9] }, fillet)),
        ("tube, sliced, stretched and mirrored", stretched(tube(), slice)),
        (
            "polyhedron, stretched and mirrored",
            stretched(Geometry::Polyhedron { faces: 20, radius: 0.3 }, Finish::default()),
        ),
        ("capsule, stretched and mirrored", stretched(capsule(), Finish::default())),
    ]
}

/// Surfaces without an inside, with their number of holes' rims.
pub fn surfaces() -> Vec<(&'static str, Shape, usize)> {
    let open = Finish { open: true, ..Finish::default() };
    let half = Finish { slice: Some([0.0, 3.0]), ..Finish::default() };
    let new = |geometry| Shape::new(geometry).unwrap();
    let corners = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.1], [0.6, 0.4, 0.0], [0.0, 0.3, 0.1]];
    vec![
        ("hemisphere", new(Geometry::Hemisphere { radius: 0.4 }), 1),
        ("open cylinder", with(cylinder(), open), 2),
        ("open cylinder, sliced", with(cylinder(), Finish { slice: half.slice, ..open }), 1),
        ("open cone", with(cone(), open), 1),
        ("open frustum", with(frustum(), open), 2),
        ("disc", new(Geometry::Disc { outer_radius: 0.4, inner_radius: 0.0 }), 1),
        ("disc with a hole", new(Geometry::Disc { outer_radius: 0.4, inner_radius: 0.1 }), 2),
        ("disc, sliced", with(Geometry::Disc { outer_radius: 0.4, inner_radius: 0.0 }, half), 1),
        ("plane", new(Geometry::Plane { size: [0.4, 0.7] }), 1),
        ("triangle", new(Geometry::Triangle { corners: [corners[0], corners[1], corners[2]] }), 1),
        ("quad", new(Geometry::Quad { corners }), 1),
        ("terrain", new(Geometry::Terrain { size: [1.0, 2.0, 0.3], heights: hills(5, 4) }), 1),
    ]
}
