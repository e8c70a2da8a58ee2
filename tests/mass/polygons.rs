//! Polygon meshes: closed forms, invariance, cuts, size.

use super::random::pose;
use super::weigh::{WALL, deviation, weigh, weigh_mesh};
use proptest::prelude::*;
use realnoid::description::{Dimension, Geometry, Subdivision};
use realnoid::mass::{MassProperties, Method, Refusal};
use realnoid::math::Vec3;
use realnoid::shape::{Meshes, Shape, TriMesh, tessellate};
use std::f64::consts::TAU;

fn mesh(geometry: Geometry, around: u32) -> TriMesh {
    tessellate(&Shape::new(geometry).unwrap(), Subdivision { around, flat: 1 }, &Meshes::default()).unwrap()
}

/// Not convex, with a hole.
fn ring() -> TriMesh {
    mesh(Geometry::Torus { ring_radius: 0.4, pipe_radius: 0.15 }, 12)
}

/// The part of a convex mesh on the side of the plane n·p = d where n points, closed by a fan.
fn half(mesh: &TriMesh, n: Vec3, d: f64) -> TriMesh {
    let mut part = TriMesh::default();
    let mut rim: Vec<[Vec3; 2]> = Vec::new();
    let mut push = |a: Vec3, b: Vec3, c: Vec3| {
        let first = part.vertices.len() as u32;
        part.vertices.extend([a, b, c]);
        part.triangles.push([first, first + 1, first + 2]);
    };
    for &t in &mesh.triangles {
        let corners = mesh.corners(t);
        let mut kept = Vec::new();
        for i in 0..3 {
            let (p, q) = (corners[i], corners[(i + 1) % 3]);
            let (s, t) = (n.dot(&p) - d, n.dot(&q) - d);
            if s > 0.0 {
                kept.push((p, false));
            }
            if (s > 0.0) != (t > 0.0) {
                // The same bits from either side of the edge.
                let (p, q, s, t) = if s > 0.0 { (p, q, s, t) } else { (q, p, t, s) };
                kept.push((p + (q - p) * (s / (s - t)), true));
            }
        }
        (2..kept.len()).for_each(|i| push(kept[0].0, kept[i - 1].0, kept[i].0));
        let cut: Vec<usize> = (0..kept.len()).filter(|i| kept[*i].1).collect();
        if let [i, j] = cut[..] {
            let (i, j) = if (i + 1) % kept.len() == j { (i, j) } else { (j, i) };
            rim.push([kept[j].0, kept[i].0]);
        }
    }
    let center = rim.iter().map(|e| e[0]).sum::<Vec3>() / rim.len() as f64;
    rim.iter().for_each(|e| push(center, e[0], e[1]));
    part
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_moved_mesh_is_the_moved_body(x in pose()) {
        for dimension in [Dimension::Solid, WALL] {
            let here = weigh_mesh(&ring(), dimension).unwrap().properties.placed(&x);
            let there = weigh_mesh(&ring().placed(&x), dimension).unwrap().properties;
            prop_assert!(deviation(&there, &here, 1.0) < 1e-12);
            let (a, b) = (here.principal().moments, there.principal().moments);
            prop_assert!((a - b).norm() <= 1e-12 * a.norm());
        }
    }

    #[test]
    fn a_mesh_cut_in_two_weighs_as_before(n in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0], d in -0.1..0.1f64) {
        let n = Vec3::from(n);
        prop_assume!(n.norm() > 0.1);
        let n = n.normalize();
        let whole = mesh(Geometry::Ellipsoid { radii: [0.4, 0.3, 0.2] }, 14);
        let parts = [half(&whole, n, d), half(&whole, -n, -d)].map(|p| weigh_mesh(&p, Dimension::Solid).unwrap().properties);
        let whole = weigh_mesh(&whole, Dimension::Solid).unwrap().properties;
        let off = deviation(&MassProperties::sum(&parts), &whole, 0.4);
        prop_assert!(off < 1e-12, "{off:e}");
    }

    #[test]
    fn order_and_start_of_triangles_do_not_matter(seed in any::<u64>()) {
        let whole = ring();
        let mut shuffled = whole.clone();
        let mut state = seed | 1;
        for i in (1..shuffled.triangles.len()).rev() {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            shuffled.triangles.swap(i, (state >> 33) as usize % (i + 1));
            shuffled.triangles[i].rotate_left((state >> 40) as usize % 3);
        }
        for dimension in [Dimension::Solid, WALL] {
            let (a, b) = (weigh_mesh(&whole, dimension).unwrap(), weigh_mesh(&shuffled, dimension).unwrap());
            prop_assert!(deviation(&a.properties, &b.properties, 1.0) < 1e-14);
        }
    }
}

/// Volume and moment of inertia of the Platonic solids of edge 1, from tables, and edge per circumradius.
fn platonic() -> [(u32, f64, f64, f64); 5] {
    let root = f64::sqrt;
    let phi = (1.0 + root(5.0)) / 2.0;
    [
        (4, root(2.0) / 12.0, 1.0 / 20.0, root(8.0 / 3.0)),
        (6, 1.0, 1.0 / 6.0, 2.0 / root(3.0)),
        (8, root(2.0) / 3.0, 1.0 / 10.0, root(2.0)),
        (12, (15.0 + 7.0 * root(5.0)) / 4.0, (39.0 * phi + 28.0) / 150.0, 2.0 / (root(3.0) * phi)),
        (20, 5.0 * (3.0 + root(5.0)) / 12.0, phi * phi / 10.0, 1.0 / (TAU / 5.0).sin()),
    ]
}

#[test]
fn platonic_solids_have_their_textbook_values() {
    for (faces, volume, inertia, edge) in platonic() {
        let radius = 0.37;
        let edge = edge * radius;
        let shape = Shape::new(Geometry::Polyhedron { faces, radius }).unwrap();
        let body = weigh(&shape, Dimension::Solid);
        assert!((body.mass / (1000.0 * volume * edge.powi(3)) - 1.0).abs() < 1e-14, "{faces}");
        let expected = nalgebra::Matrix3::from_diagonal_element(inertia * body.mass * edge * edge);
        assert!((body.inertia - expected).norm() < 1e-14 * expected.norm(), "{faces}");
        // All faces are at one distance from the centre: the wall has 5/3 of the solid's inertia per mass.
        let wall = weigh(&shape, WALL);
        let expected = expected * (5.0 / 3.0 * wall.mass / body.mass);
        assert!((wall.inertia - expected).norm() < 1e-14 * expected.norm(), "{faces}");
    }
}

#[test]
fn a_million_triangles_lose_no_digits_and_little_time() {
    // 1000 · 2 · 500 triangles, against the closed formula of the lathe polygon: the torus of inscribed polygons.
    let n = 1000;
    let (ring, pipe) = (0.5, 0.1);
    let start = std::time::Instant::now();
    let shape = Shape::new(Geometry::Torus { ring_radius: ring, pipe_radius: pipe }).unwrap();
    let body = super::weigh::polygonised(&shape, Dimension::Solid, n);
    let spent = start.elapsed();
    let angle = TAU / f64::from(n);
    // Each of n wedges is swept linearly between two sections: volume = ½ sin(α) Σ over the section of ρ² dz,
    // times n; the section is a regular polygon, whose ∬ρ = ring · area.
    let section = f64::from(n) / 2.0 * angle.sin() * pipe * pipe;
    let expected = 1000.0 * f64::from(n) * angle.sin() * ring * section;
    assert!((body.mass / expected - 1.0).abs() < 1e-13, "{:e}", body.mass / expected - 1.0);
    assert!(body.center.norm() < 1e-15);
    assert!(spent.as_secs_f64() < 20.0, "{spent:?}");
}

#[test]
fn meshes_without_inside_or_area_are_refused() {
    let refusal = |vertices: &[[f64; 3]], triangles: &[[u32; 3]], dimension| {
        let vertices = vertices.iter().map(|v| Vec3::from(*v)).collect();
        weigh_mesh(&TriMesh { vertices, triangles: triangles.to_vec() }, dimension).unwrap_err()
    };
    let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let said = refusal(&line, &[[0, 1, 2]], WALL).to_string();
    assert_eq!(said, "this <mesh> has no area: the corners of each of its triangles lie on one line");
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert!(matches!(refusal(&flat, &[[0, 1, 2]], Dimension::Solid), Refusal::NotSolid(_)));
    let sheet = weigh_mesh(&TriMesh { vertices: flat.map(Vec3::from).to_vec(), triangles: vec![[0, 1, 2]] }, WALL);
    assert_eq!(sheet.unwrap().method, Method::Polygons(1));
}

#[test]
fn a_mesh_that_is_inside_out_is_turned_and_told() {
    let mut inside_out = ring();
    inside_out.flip();
    let body = weigh_mesh(&inside_out, Dimension::Solid).unwrap();
    assert!(!body.repairs.is_empty());
    let right = weigh_mesh(&ring(), Dimension::Solid).unwrap();
    assert!(right.repairs.is_empty());
    assert!(deviation(&body.properties, &right.properties, 0.4) < 1e-14);
}
