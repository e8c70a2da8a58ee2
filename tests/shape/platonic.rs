//! The regular polyhedra against the textbook: edge and volume from the radius of the sphere through the corners.

use super::family::{SUBDIVISION, mesh_of};
use super::topology::volume;
use approx::assert_relative_eq;
use realnoid::description::Geometry;
use realnoid::math::Vec3;
use realnoid::shape::{Shape, TriMesh};

const RADIUS: f64 = 0.37;

fn polyhedron(faces: u32) -> TriMesh {
    mesh_of(&Shape::new(Geometry::Polyhedron { faces, radius: RADIUS }).unwrap(), SUBDIVISION)
}

/// Lengths of the edges between triangles that are not in one plane.
fn edges(mesh: &TriMesh) -> Vec<f64> {
    let normal = |t: [u32; 3]| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(&(c - a)).normalize()
    };
    let sides = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)];
    let mut lengths = vec![];
    for t in &mesh.triangles {
        for (a, b) in sides(*t) {
            let other = mesh.triangles.iter().find(|u| sides(**u).contains(&(b, a))).unwrap();
            if a < b && normal(*t).dot(&normal(*other)) < 0.999 {
                lengths.push((mesh.vertices[a as usize] - mesh.vertices[b as usize]).norm());
            }
        }
    }
    lengths
}

#[test]
fn they_are_regular() {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let root = f64::sqrt;
    // Faces, corners, edges, edge length per radius, volume per edge length cubed.
    let textbook = [
        (4, 4, 6, root(8.0 / 3.0), root(2.0) / 12.0),
        (6, 8, 12, 2.0 / root(3.0), 1.0),
        (8, 6, 12, root(2.0), root(2.0) / 3.0),
        (12, 20, 30, 2.0 / (root(3.0) * golden), (15.0 + 7.0 * root(5.0)) / 4.0),
        (20, 12, 30, 2.0 / root(golden * golden + 1.0), 5.0 * (3.0 + root(5.0)) / 12.0),
    ];
    for (faces, corners, edge_count, edge, volume_of_edge) in textbook {
        let mesh = polyhedron(faces);
        assert_eq!(mesh.vertices.len(), corners);
        let lengths = edges(&mesh);
        assert_eq!(lengths.len(), edge_count, "{faces} faces");
        for length in lengths {
            assert_relative_eq!(length, edge * RADIUS, max_relative = 1e-14);
        }
        assert_relative_eq!(volume(&mesh), volume_of_edge * (edge * RADIUS).powi(3), max_relative = 1e-14);
    }
}

/// The orientation that `tessellate` documents.
#[test]
fn they_stand_as_documented() {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let one_corner = [
        (4, Vec3::new(1.0, 1.0, 1.0)),
        (6, Vec3::new(1.0, 1.0, -1.0)),
        (8, Vec3::new(0.0, 0.0, 1.0)),
        (12, Vec3::new(0.0, golden, 1.0 / golden)),
        (20, Vec3::new(0.0, 1.0, golden)),
    ];
    for (faces, corner) in one_corner {
        let wanted = corner.normalize() * RADIUS;
        assert!(polyhedron(faces).vertices.iter().any(|v| (v - wanted).norm() < 1e-15), "{faces} faces");
    }
}
