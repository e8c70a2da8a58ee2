//! What is a solid, what is repaired, what is refused.

use super::support::{cuboid, inside_out, moved, together, volume};
use realnoid::math::Vec3;
use realnoid::shape::{COUNTS_TWICE, SolidFault, TriMesh, closed_solid};

fn unit() -> TriMesh {
    cuboid([1.0; 3])
}

/// The volume and what was told.
fn solid(mesh: TriMesh) -> (f64, Vec<String>) {
    let (mesh, told) = closed_solid(mesh).unwrap();
    (volume(&mesh), told)
}

#[track_caller]
fn tells(mesh: TriMesh, expected_volume: f64, parts: &[&str]) {
    let (volume, told) = solid(mesh);
    assert!((volume - expected_volume).abs() < 1e-12, "{volume}");
    assert_eq!(told.len(), parts.len(), "{told:?}");
    told.iter().zip(parts).for_each(|(sentence, part)| assert!(sentence.contains(part), "{sentence}"));
}

#[test]
fn a_sound_mesh_is_left_as_it_is() {
    let (mesh, told) = closed_solid(unit()).unwrap();
    assert_eq!((mesh, told), (unit(), vec![]));
}

#[test]
fn inside_out_is_turned() {
    tells(inside_out(unit()), 1.0, &["inside out: all its 12 triangles"]);
    let two = together(&[unit(), moved(inside_out(unit()), [2.0, 0.0, 0.0])]);
    tells(two, 2.0, &["inside out were turned: 1 of 2, 12 triangles"]);
}

#[test]
fn some_triangles_the_wrong_way_are_turned() {
    let mut mesh = unit();
    [0, 5, 7].into_iter().for_each(|t: usize| mesh.triangles[t].swap(0, 1));
    tells(mesh, 1.0, &["faced the other way than their neighbours were turned: 3 of 12"]);
    let mut mesh = inside_out(unit());
    mesh.triangles[3].swap(0, 1);
    tells(mesh, 1.0, &["were turned: 1 of 12", "inside out: all its 12"]);
}

#[test]
fn useless_triangles_are_left_out() {
    let mut mesh = unit();
    mesh.triangles.push([1, 1, 2]);
    let twice = mesh.triangles[4];
    mesh.triangles.extend([twice, [twice[1], twice[2], twice[0]]]);
    tells(mesh, 1.0, &["two equal corners were left out: 1 of 15", "more than once were left out: 2 of 14"]);
}

#[test]
fn cracks_narrower_than_a_millionth_are_welded() {
    let apart = |by: f64| {
        let mut mesh = unit();
        mesh.vertices.push(mesh.vertices[7] + Vec3::new(by, 0.0, 0.0));
        mesh.triangles[2..4].iter_mut().flatten().filter(|i| **i == 7).for_each(|i| *i = 8);
        mesh
    };
    let (volume, told) = solid(apart(1e-6));
    assert!((volume - 1.0).abs() < 1e-6 && told.len() == 1 && told[0].contains("1 vertex welded"), "{told:?}");
    assert!(matches!(closed_solid(apart(2e-6)), Err(SolidFault::NotClosed { .. })), "the diagonal is √3 m");
}

#[test]
fn a_cavity_stays_and_an_island_in_it_too() {
    let core = |size: f64| moved(cuboid([size; 3]), [(1.0 - size) / 2.0; 3]);
    let hollow = together(&[unit(), inside_out(core(0.5))]);
    tells(hollow.clone(), 1.0 - 0.125, &[]);
    tells(inside_out(hollow.clone()), 1.0 - 0.125, &["inside out: all its 24 triangles"]);
    let island = core(0.25);
    tells(together(&[hollow.clone(), island.clone()]), 1.0 - 0.125 + 1.0 / 64.0, &[]);
    tells(together(&[hollow, inside_out(island)]), 1.0 - 0.125 + 1.0 / 64.0, &["were turned: 1 of 3"]);
    tells(together(&[unit(), core(0.5)]), 1.125, &["inside others, and no cavities: 1 part"]);
}

/// A cavity whose corner touches the wall from inside is still a cavity.
#[test]
fn a_cavity_may_touch_the_wall() {
    tells(together(&[unit(), inside_out(cuboid([0.5; 3]))]), 1.0 - 0.125, &[]);
}

#[test]
fn parts_that_cut_into_each_other_are_told() {
    let post = moved(cuboid([0.5, 0.5, 3.0]), [0.75, 0.25, -1.0]);
    let plate = cuboid([3.0, 1.0, 1.0]);
    let cross = together(&[moved(cuboid([3.0, 1.0, 1.0]), [-1.0, 0.0, 0.0]), post.clone()]);
    let (volume, told) = solid(cross);
    assert!(
        (volume - 3.75).abs() < 1e-12 && told.is_empty(),
        "what crosses with its edges alone is not found: {told:?}"
    );
    let tooth = moved(cuboid([1.0, 0.5, 0.6]), [0.2, 0.2, 0.2]);
    let mut wedge = plate;
    wedge.vertices.iter_mut().filter(|v| v.x > 0.0 && v.z > 0.0).for_each(|v| v.z = 0.4);
    tells(together(&[wedge, tooth]), 3.0 * 0.7 + 0.3, &["cutting into others: 1 part"]);
}

#[test]
fn boxes_that_share_an_edge_or_a_corner_are_two_parts() {
    let mut mesh = together(&[unit(), moved(inside_out(unit()), [1.0, 1.0, 0.0])]);
    for corner in mesh.triangles.iter_mut().flatten() {
        *corner = match *corner {
            8 => 3,
            12 => 7,
            other => other,
        };
    }
    tells(mesh, 2.0, &["were turned: 1 of 2"]);
}

#[test]
fn open_meshes_are_refused_with_the_place() {
    let mut mesh = unit();
    mesh.triangles.remove(0);
    let fault = closed_solid(mesh.clone()).unwrap_err();
    assert!(matches!(fault, SolidFault::NotClosed { edges: 3, .. }), "{fault}");
    assert!(
        fault.to_string().contains("3 edges") && fault.to_string().contains("(0.000000, 0.000000, 0.000000)"),
        "{fault}"
    );
    let mut fin = unit();
    fin.vertices.push(Vec3::new(2.0, 2.0, 2.0));
    fin.triangles.push([0, 1, 8]);
    assert!(matches!(closed_solid(fin), Err(SolidFault::NotClosed { edges: 3, .. })));
}

/// A band of an odd number of half turns, doubled at its rim into a Klein bottle: each edge has two triangles.
#[test]
fn a_klein_bottle_has_no_inside() {
    const N: u32 = 8;
    let vertex = |i: u32, j: u32| (i % N) * N + if i < N { j % N } else { (N - j % N) % N };
    let cell = |i: u32, j: u32| {
        let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let place = |k: u32| {
        let (u, v) = (std::f64::consts::TAU * f64::from(k / N) / 8.0, std::f64::consts::TAU * f64::from(k % N) / 8.0);
        let r = 3.0 + (u / 2.0).cos() * v.sin() - (u / 2.0).sin() * (2.0 * v).sin();
        Vec3::new(r * u.cos(), r * u.sin(), (u / 2.0).sin() * v.sin() + (u / 2.0).cos() * (2.0 * v).sin())
    };
    let triangles = (0..N).flat_map(|i| (0..N).flat_map(move |j| cell(i, j))).collect();
    let mesh = TriMesh { vertices: (0..N * N).map(place).collect(), triangles };
    assert!(matches!(closed_solid(mesh), Err(SolidFault::NotOrientable { .. })));
}

/// Two boxes in a row with two walls between them that both face the same way, and cut their square differently.
#[test]
fn contradictions_where_walls_meet_are_refused() {
    let mut mesh = together(&[unit(), moved(unit(), [1.0, 0.0, 0.0])]);
    let same = [(8, 1), (10, 3), (12, 5), (14, 7)];
    for corner in mesh.triangles.iter_mut().flatten() {
        *corner = same.iter().find(|(from, _)| from == corner).map_or(*corner, |(_, to)| *to);
    }
    mesh.triangles.retain(|t| !t.iter().all(|i| [1, 3, 5, 7].contains(i)));
    assert_eq!(solid(mesh.clone()), (2.0, vec![]), "without walls between");
    let wall = [[1, 3, 7], [1, 7, 5]];
    mesh.triangles.extend(wall);
    assert!(matches!(closed_solid(mesh.clone()), Err(SolidFault::NotClosed { edges: 4, .. })));
    mesh.triangles.extend([[1, 3, 5], [3, 7, 5]]);
    let fault = closed_solid(mesh).unwrap_err();
    assert!(matches!(fault, SolidFault::Contradiction { edges: 4, .. }), "{fault}");
}

#[test]
fn nothing_with_an_inside() {
    let flat =
        TriMesh { vertices: vec![Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0], triangles: vec![[0, 1, 2], [0, 0, 1]] };
    assert!(matches!(closed_solid(flat), Err(SolidFault::Degenerate { triangles: 2 })));
    let sheet = TriMesh { vertices: vec![Vec3::zeros(), Vec3::x(), Vec3::y()], triangles: vec![[0, 1, 2], [2, 1, 0]] };
    assert!(matches!(closed_solid(sheet), Err(SolidFault::NoVolume { .. })));
    assert!(matches!(closed_solid(TriMesh::default()), Err(SolidFault::Degenerate { triangles: 0 })));
}

#[test]
fn a_mesh_that_is_none_is_refused() {
    let mut mesh = unit();
    mesh.triangles[2][1] = 99;
    assert!(matches!(closed_solid(mesh), Err(SolidFault::Malformed { triangle: 2 })));
    let mut mesh = unit();
    mesh.vertices[0].x = f64::NAN;
    assert!(matches!(closed_solid(mesh), Err(SolidFault::Malformed { triangle: 0 })));
}

/// A plate of 1 m × 1 m is a solid however thin a plate can be.
#[test]
fn thin_plates_and_far_places_are_solids() {
    assert_eq!(solid(cuboid([1.0, 1.0, 1e-9])), (1e-9, vec![]));
    let (mesh, told) = closed_solid(moved(cuboid([1.0; 3]), [1e6, -1e6, 1e6])).unwrap();
    assert!(told.is_empty() && mesh.triangles.len() == 12);
}

#[test]
fn parts_that_overlap_side_by_side_are_told_and_touching_ones_are_not() {
    let pair = |by: [f64; 3]| solid(together(&[unit(), moved(unit(), by)]));
    let (volume, told) = pair([0.5, 0.5, 0.5]);
    assert!((volume - 2.0).abs() < 1e-12 && told.len() == 1 && told[0].contains(COUNTS_TWICE), "{told:?}");
    for apart in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [1.5, 0.0, 0.0]] {
        assert_eq!(pair(apart), (2.0, vec![]), "{apart:?}");
    }
}
