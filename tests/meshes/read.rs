//! The three formats, in the ways in which exporters write them.

use super::support::{Collada, Folder, ascii_stl, binary_stl, collada, cuboid, obj, read, volume};
use realnoid::shape::{MeshFault, TriMesh, closed_solid};

const SIZE: [f64; 3] = [0.5, 0.25, 0.125];

fn is_the_box(mesh: &TriMesh) {
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (8, 12), "welded");
    let (solid, repairs) = closed_solid(mesh.clone()).unwrap();
    assert_eq!(repairs, Vec::<String>::new());
    assert_eq!(volume(&solid), SIZE.iter().product::<f64>());
}

#[test]
fn every_format_gives_the_same_box() {
    let mesh = cuboid(SIZE);
    is_the_box(&read("a.stl", binary_stl(b"", &mesh)).unwrap());
    is_the_box(&read("a.stl", ascii_stl(&mesh)).unwrap());
    is_the_box(&read("a.obj", obj(&mesh)).unwrap());
    is_the_box(&read("a.dae", collada(&mesh, &Collada::default())).unwrap());
}

#[test]
fn extensions_in_capitals_and_missing_ones() {
    let mesh = cuboid(SIZE);
    is_the_box(&read("A.STL", binary_stl(b"", &mesh)).unwrap());
    is_the_box(&read("A.DAE", collada(&mesh, &Collada::default())).unwrap());
    is_the_box(&read("A.Obj", obj(&mesh)).unwrap());
    is_the_box(&read("obj", obj(&mesh)).unwrap());
    is_the_box(&read("binary", binary_stl(b"", &mesh)).unwrap());
}

#[test]
fn bytes_win_over_a_wrong_extension() {
    is_the_box(&read("a.obj", binary_stl(b"", &cuboid(SIZE))).unwrap());
    is_the_box(&read("a.stl", collada(&cuboid(SIZE), &Collada::default())).unwrap());
}

#[test]
fn a_binary_stl_may_begin_with_solid() {
    is_the_box(&read("a.stl", binary_stl(b"solid made by an exporter", &cuboid(SIZE))).unwrap());
    is_the_box(&read("a.stl", binary_stl(b"solid facet normal 0 0 0\n", &cuboid(SIZE))).unwrap());
}

#[test]
fn a_tail_shorter_than_a_triangle_is_left_aside() {
    let mut bytes = binary_stl(b"", &cuboid(SIZE));
    bytes.extend(b"exported");
    is_the_box(&read("a.stl", bytes).unwrap());
}

#[test]
fn ends_of_line_and_letters_do_not_matter() {
    let text = ascii_stl(&cuboid(SIZE));
    is_the_box(&read("a.stl", text.replace('\n', "\r\n")).unwrap());
    is_the_box(&read("a.stl", text.replace('\n', "\r")).unwrap());
    is_the_box(&read("a.stl", text.to_uppercase()).unwrap());
    is_the_box(&read("a.obj", obj(&cuboid(SIZE)).replace('\n', "\r\n")).unwrap());
}

#[test]
fn several_solids_in_one_file_are_one_mesh() {
    let text = ascii_stl(&cuboid(SIZE));
    let twice = text.clone() + &text;
    assert_eq!(read("a.stl", twice).unwrap().triangles.len(), 24);
}

#[test]
fn ascii_keeps_all_digits() {
    let text = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0.1234567890123456 0 0\nvertex 0 1e-3 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid";
    assert_eq!(read("a.stl", text).unwrap().vertices[0].x, 0.123_456_789_012_345_6);
}

#[test]
fn faces_of_obj_in_all_spellings() {
    let corners: String = cuboid(SIZE).vertices.iter().map(|v| format!("v {} {} {} 1.0\n", v.x, v.y, v.z)).collect();
    let quads = "f 1/1/1 5//1 7/2 3\nf -7 -5 -1 -3\nf 1 2 6 5\nf 3 7 8 \\\n4\nf 1 3 4 2 # the bottom\nf 5 6 8 7\n";
    let text = format!(
        "# a box\nmtllib none.mtl\no box\n{corners}vt 0 0\nvn 0 0 1\ng all\ns off\nusemtl grey\n{quads}l 1 2\n"
    );
    is_the_box(&read("a.obj", &text).unwrap());
    is_the_box(&read("a.obj", format!("{quads}{corners}").replace("-7 -5 -1 -3", "2 4 8 6")).unwrap());
}

/// An L of seven corners (one on a straight side), raised by 1: its area is 3.
#[test]
fn a_face_that_is_not_convex_keeps_its_area_and_all_its_corners() {
    let outline = [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)];
    let corner = |z: i32| outline.iter().map(move |(x, y)| format!("v {x} {y} {z}\n"));
    let side = |i: usize| format!("f {} {} {} {}\n", i + 1, (i + 1) % 7 + 1, (i + 1) % 7 + 8, i + 8);
    let text: String = corner(0).chain(corner(1)).chain((0..7).map(side)).collect();
    let mesh = read("l.obj", text + "f 7 6 5 4 3 2 1\nf 8 9 10 11 12 13 14\n").unwrap();
    let (solid, repairs) = closed_solid((*mesh).clone()).unwrap();
    assert_eq!(repairs, Vec::<String>::new());
    assert!((volume(&solid) - 3.0).abs() < 1e-14);
    let area: f64 =
        mesh.triangles.iter().map(|t| mesh.corners(*t)).map(|[a, b, c]| (b - a).cross(&(c - a)).norm() / 2.0).sum();
    assert!((area - (3.0 + 3.0 + 8.0)).abs() < 1e-14, "{area}");
}

#[test]
fn a_file_is_read_once() {
    let folder = Folder::with("a.obj", obj(&cuboid(SIZE)));
    let meshes = folder.meshes();
    let first = meshes.mesh("a.obj").unwrap();
    std::fs::remove_file(folder.path().join("a.obj")).unwrap();
    assert!(matches!(meshes.mesh("a.obj"), Err(MeshFault::NotFound(_))), "a lost file is not hidden");
    folder.write("a.obj", "v 0 0 0");
    assert!(std::sync::Arc::ptr_eq(&first, &meshes.mesh("a.obj").unwrap()));
}

#[test]
fn threads_share_one_reading() {
    let folder = Folder::with("a.obj", obj(&cuboid(SIZE)));
    let meshes = folder.meshes();
    let read: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(|| meshes.mesh("a.obj").unwrap())).collect();
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    });
    assert!(read.iter().all(|mesh| std::sync::Arc::ptr_eq(mesh, &read[0])));
}

/// A corner that no face uses moves neither the middle about which the mesh is integrated, nor its bounds.
#[test]
fn stray_corners_are_left_out() {
    let text = obj(&cuboid(SIZE));
    is_the_box(&read("a.obj", format!("{text}\nv 1e6 1e6 1e6\n")).unwrap());
}

#[test]
fn a_backslash_in_a_comment_joins_no_lines_and_one_at_the_end_loses_none() {
    let text = obj(&cuboid(SIZE));
    is_the_box(&read("a.obj", format!("# C:\\meshes\\\n{text}")).unwrap());
    is_the_box(&read("a.obj", format!("{}\\", text.trim_end())).unwrap());
}

/// 80 000 corners on one line: linear in their number, or the test would never end.
#[test]
fn a_long_flat_face_is_read() {
    let corners: String = (0..80_000).map(|i| format!("v {i} 0 0\n")).collect();
    let face: String = (1..=80_000).map(|i| format!(" {i}")).collect();
    assert_eq!(read("a.obj", format!("{corners}f{face}\n")).unwrap().triangles.len(), 79_998);
}
