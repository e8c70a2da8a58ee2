//! Files that give no mesh: each is refused with the place of its fault.

use super::support::{Collada, Folder, ascii_stl, binary_stl, collada, cuboid, obj, read};
use realnoid::shape::{LONGEST_FILE, MeshFault, SolidFault, TriMesh, closed_solid};

fn refusal(name: &str, content: impl AsRef<[u8]>) -> String {
    read(name, content).unwrap_err().to_string()
}

fn says(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "\"{part}\" is not in: {text}");
    }
}

#[test]
fn a_missing_file_tells_where_it_was_looked_for() {
    let folder = Folder::new();
    let fault = folder.mesh("meshes/gone.stl").unwrap_err();
    assert!(matches!(fault, MeshFault::NotFound(_)));
    says(&fault.to_string(), &["meshes/gone.stl", &folder.path().join("meshes/gone.stl").display().to_string()]);
}

#[test]
fn a_folder_is_no_file() {
    assert!(matches!(Folder::new().mesh("."), Err(MeshFault::NotFound(_))));
}

#[test]
fn unknown_formats() {
    says(&refusal("a.gltf", "{}"), &["a.gltf", ".gltf", "STL, OBJ or DAE"]);
    says(&refusal("nothing", "what is this"), &["no extension"]);
}

#[test]
fn nothing_in_it() {
    for (name, content) in [("a.obj", ""), ("a.obj", "v 0 0 0\n"), ("a.stl", "solid x\nendsolid x\n")] {
        assert!(matches!(read(name, content), Err(MeshFault::NoTriangles { .. })), "{name}: {content}");
    }
    assert!(matches!(read("a.stl", binary_stl(b"", &TriMesh::default())), Err(MeshFault::NoTriangles { .. })));
    let lines = "<lines count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1</p></lines>";
    let text = collada(&cuboid([1.0; 3]), &Collada { faces: lines, ..Collada::default() });
    assert!(matches!(read("a.dae", text), Err(MeshFault::NoTriangles { .. })));
}

#[test]
fn nan_and_infinity_are_named() {
    let mut mesh = cuboid([1.0; 3]);
    mesh.vertices[2].y = f64::NAN;
    says(&refusal("a.obj", obj(&mesh)), &["vertex 3", "NaN"]);
    says(&refusal("a.stl", ascii_stl(&mesh)), &["vertex 6", "NaN"]);
    says(&refusal("a.stl", binary_stl(b"", &mesh)), &["vertex 6", "NaN"]);
    says(&refusal("a.dae", collada(&mesh, &Collada::default())), &["vertex 3", "NaN", "line "]);
    mesh.vertices[2].y = f64::INFINITY;
    says(&refusal("a.obj", obj(&mesh)), &["vertex 3", "inf"]);
    mesh.vertices[2].y = 1e200;
    says(&refusal("a.obj", obj(&mesh)), &["vertex 3", "1e15 m"]);
}

#[test]
fn lying_counts_of_binary_stl() {
    let honest = binary_stl(b"", &cuboid([1.0; 3]));
    for count in [11_u32, 13, u32::MAX, 0] {
        let mut bytes = honest.clone();
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        says(&refusal("a.stl", bytes), &["byte 80", &format!("{count} triangles are promised"), "bytes for 12"]);
    }
    says(&refusal("a.stl", &honest[..50]), &["byte 50", "header"]);
    says(&refusal("a.stl", &honest[..400]), &["bytes for 6"]);
}

#[test]
fn faults_in_ascii_stl_name_their_line() {
    let text = ascii_stl(&cuboid([1.0; 3]));
    says(&refusal("a.stl", text.replacen("vertex 0 0 0", "vertex 0 0", 1)), &["line 4", "missing"]);
    says(&refusal("a.stl", text.replacen("vertex 0 0 0", "vertex 0 0,5 0", 1)), &["line 4", "\"0,5\" is not a number"]);
    says(&refusal("a.stl", text.replacen(" endloop\n", "vertex 1 1 1\n", 1)), &["line 7", "more than three"]);
    says(&refusal("a.stl", text.replacen("  vertex 0 0 0\n", "", 1)), &["line 7", "fewer than three"]);
    says(&refusal("a.stl", text.replace("endsolid a box\n", "")), &["cut off"]);
    says(&refusal("a.stl", text.replacen("facet normal", "fascet", 1)), &["line 2", "\"fascet\""]);
}

#[test]
fn faults_in_obj_name_their_line() {
    says(&refusal("a.obj", "v 0 0 0\nv 1 0\n"), &["line 2", "missing"]);
    says(&refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), &["line 4", "vertex 4", "there are 3"]);
    for word in ["0", "-4", "x", "/1", "99999999999999999999", "1.5", "-9223372036854775808"] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 {word}\n");
        says(&refusal("a.obj", text), &["line 5", &format!("\"{word}\" names no vertex")]);
    }
}

#[test]
fn faults_in_collada_name_their_line() {
    let whole = collada(&cuboid([1.0; 3]), &Collada::default());
    says(&refusal("a.dae", &whole[..whole.len() - 20]), &["line ", "well-formed"]);
    says(&refusal("a.dae", whole.replace("<p>0", "<p>8")), &["line 15", "corner 8 of 8"]);
    says(&refusal("a.dae", whole.replace("<p>0", "<p>x")), &["line 15", "\"x\""]);
    says(&refusal("a.dae", whole.replace("url=\"#g\"", "url=\"#h\"")), &["line 18", "leads nowhere"]);
    says(&refusal("a.dae", whole.replace("source=\"#v\"", "source=\"#w\"")), &["line 15", "leads nowhere"]);
    says(&refusal("a.dae", whole.replace("stride=\"3\"", "stride=\"2\"")), &["stride is 2"]);
    says(&refusal("a.dae", whole.replace("stride=\"3\"", "stride=\"-1\"")), &["no count"]);
    says(&refusal("a.dae", "<html/>"), &["<html> is no COLLADA"]);
}

#[test]
fn a_file_beyond_the_limit_is_not_opened() {
    let folder = Folder::with("a.stl", "");
    let file = std::fs::File::options().write(true).open(folder.path().join("a.stl")).unwrap();
    file.set_len(LONGEST_FILE + 1).unwrap();
    let fault = folder.mesh("a.stl").unwrap_err();
    assert!(matches!(fault, MeshFault::TooLarge { .. }));
    says(&fault.to_string(), &["a.stl", "536870913 bytes", "512 MiB"]);
}

/// A bumpy sheet of 1 000 000 triangles, 50 MB, is read, judged and found open.
#[test]
fn fifty_megabytes_are_read() {
    const N: usize = 1_000_000;
    let side = 707;
    let place = |i: usize, j: usize| [i as f64, j as f64, ((i * j) % 7) as f64];
    let cell = |k: usize| (k / 2 / side, k / 2 % side);
    let mut bytes = vec![b' '; 80];
    bytes.extend((N as u32).to_le_bytes());
    for k in 0..N {
        let (i, j) = cell(k % (2 * side * side));
        let corners = if k % 2 == 0 { [(0, 0), (1, 0), (1, 1)] } else { [(0, 0), (1, 1), (0, 1)] };
        bytes.extend([0; 12]);
        for x in corners.iter().flat_map(|(di, dj)| place(i + di, j + dj)) {
            bytes.extend((x as f32).to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    assert!(bytes.len() >= 50_000_000, "the issue's 50 MB");
    let mesh = read("a.stl", bytes).unwrap();
    assert_eq!(
        (mesh.triangles.len(), mesh.vertices.len()),
        (N, (side + 1) * (side + 1)),
        "{} corners",
        mesh.vertices.len()
    );
    assert!(matches!(closed_solid((*mesh).clone()), Err(SolidFault::NotClosed { .. })));
}

/// A node that instantiates itself, and small files that unfold into any number of triangles.
#[test]
fn bombs_are_refused() {
    let mesh = cuboid([1.0; 3]);
    let ring = "<node id=\"n\"><instance_node url=\"#n\"/></node>";
    let fault = refusal("a.dae", collada(&mesh, &Collada { scene: ring, ..Collada::default() }));
    says(&fault, &["instantiate itself"]);
    let ten = |next: &str| format!("<instance_node url=\"#{next}\"/>").repeat(10);
    let level = |i: usize| format!("<node id=\"n{i}\">{}</node>", ten(&format!("n{}", i + 1)));
    let levels: String = (0..20).map(level).collect();
    let scene = format!("{levels}<node id=\"n20\"><instance_geometry url=\"#g\"/></node>");
    let fault = read("a.dae", collada(&mesh, &Collada { scene: &scene, ..Collada::default() })).unwrap_err();
    assert!(matches!(fault, MeshFault::TooLarge { .. } | MeshFault::Unreadable { .. }), "{fault}");
}

#[test]
fn deeply_nested_xml_is_survived() {
    let depth = 200_000;
    let text = format!("<COLLADA>{}{}</COLLADA>", "<node>".repeat(depth), "</node>".repeat(depth));
    assert!(read("a.dae", text).is_err());
}
