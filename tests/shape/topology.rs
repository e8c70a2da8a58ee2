//! Meshes are closed by index, or open exactly at their rims; they face outwards.

use super::family::{SUBDIVISION, finished, mesh_of, solids, surfaces};
use realnoid::description::Subdivision;
use realnoid::shape::TriMesh;
use std::collections::{BTreeMap, BTreeSet};

/// Directed edges without an opposite. Panics on an edge used twice.
fn rims(mesh: &TriMesh) -> Vec<(u32, u32)> {
    let mut edges = BTreeSet::new();
    for [a, b, c] in &mesh.triangles {
        for edge in [(*a, *b), (*b, *c), (*c, *a)] {
            assert!(edge.0 != edge.1 && edges.insert(edge), "edge {edge:?} twice");
        }
    }
    edges.iter().copied().filter(|(a, b)| !edges.contains(&(*b, *a))).collect()
}

/// V − E + F, of the vertices in use.
fn euler_characteristic(mesh: &TriMesh) -> i64 {
    let vertices: BTreeSet<u32> = mesh.triangles.iter().flatten().copied().collect();
    assert_eq!(vertices.len(), mesh.vertices.len(), "every vertex is in use");
    let sorted = |a: u32, b: u32| (a.min(b), a.max(b));
    let edges: BTreeSet<_> =
        mesh.triangles.iter().flat_map(|&[a, b, c]| [sorted(a, b), sorted(b, c), sorted(c, a)]).collect();
    vertices.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64
}

pub fn volume(mesh: &TriMesh) -> f64 {
    mesh.triangles.iter().map(|t| mesh.corners(*t)).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
}

const SUBDIVISIONS: [Subdivision; 4] = [
    SUBDIVISION,
    Subdivision { around: 3, flat: 1 },
    Subdivision { around: 7, flat: 3 },
    Subdivision { around: 50, flat: 1 },
];

#[test]
fn solids_are_closed_and_face_outwards() {
    for (name, shape) in solids().into_iter().chain(finished()) {
        for subdivision in SUBDIVISIONS {
            let mesh = mesh_of(&shape, subdivision);
            assert_eq!(rims(&mesh), [], "{name} {subdivision:?}");
            assert!(volume(&mesh) > 0.0, "{name} {subdivision:?} is inside out");
            let ring = ["torus", "tube", "tube with fillet", "torus, stretched and mirrored"].contains(&name);
            assert_eq!(euler_characteristic(&mesh), if ring { 0 } else { 2 }, "{name} {subdivision:?}");
        }
    }
}

#[test]
fn surfaces_are_open_exactly_at_their_rims() {
    for (name, shape, count) in surfaces() {
        assert!(shape.is_open(), "{name}");
        for subdivision in SUBDIVISIONS {
            let edges = rims(&mesh_of(&shape, subdivision));
            let mut next: BTreeMap<u32, u32> = edges.iter().copied().collect();
            assert_eq!(next.len(), edges.len(), "{name}: two rims touch");
            let mut loops = 0;
            while let Some((start, mut at)) = next.pop_first() {
                while at != start {
                    at = next.remove(&at).unwrap();
                }
                loops += 1;
            }
            assert_eq!(loops, count, "{name} {subdivision:?}");
        }
    }
}
