//! Masses at specific gravity 1, meshes by file.

use realnoid::description::{Dimension, Geometry, Subdivision, Substance};
use realnoid::mass::{MassProperties, Method, Refusal, ShapeMass, of_shape};
use realnoid::shape::{Meshes, Shape, TriMesh};
use std::fmt::Write;

pub const WALL: Dimension = Dimension::Hollow { thickness: 0.001 };

pub fn substance(dimension: Dimension) -> Substance {
    Substance { specific_gravity: 1.0, dimension, polygonise: None }
}

pub fn weighed(shape: &Shape, dimension: Dimension) -> Result<ShapeMass, Refusal> {
    of_shape(shape, &substance(dimension), &Meshes::default())
}

pub fn weigh(shape: &Shape, dimension: Dimension) -> MassProperties {
    weighed(shape, dimension).unwrap().properties
}

pub fn solid(geometry: &Geometry) -> MassProperties {
    weigh(&Shape::new(geometry.clone()).unwrap(), Dimension::Solid)
}

/// As polygon mesh of `around` segments.
pub fn polygonised(shape: &Shape, dimension: Dimension, around: u32) -> MassProperties {
    let polygonise = Some(Subdivision { around, flat: 1 });
    let body = of_shape(shape, &Substance { polygonise, ..substance(dimension) }, &Meshes::default()).unwrap();
    assert!(matches!(body.method, Method::Polygons(_)));
    body.properties
}

/// Of a mesh that goes through a file, as every mesh does.
pub fn weigh_mesh(mesh: &TriMesh, dimension: Dimension) -> Result<ShapeMass, Refusal> {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::new();
    for v in &mesh.vertices {
        writeln!(text, "v {:e} {:e} {:e}", v.x, v.y, v.z).unwrap();
    }
    for t in &mesh.triangles {
        writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1).unwrap();
    }
    std::fs::write(folder.path().join("mesh.obj"), text).unwrap();
    let meshes = Meshes::beside(&folder.path().join("robot.urdf"), &[]);
    let shape = Shape::new(Geometry::Mesh { filename: "mesh.obj".into(), scale: [1.0; 3] }).unwrap();
    of_shape(&shape, &substance(dimension), &meshes)
}

/// Greatest deviation, each value against its own scale; `reach` is the scale of lengths.
pub fn deviation(a: &MassProperties, b: &MassProperties, reach: f64) -> f64 {
    let mass = (a.mass - b.mass).abs() / b.mass;
    let center = (a.center - b.center).norm() / reach;
    let inertia = (a.inertia - b.inertia).abs().max() / b.inertia.abs().max();
    mass.max(center).max(inertia)
}
