//! Files that were cut, changed or made up: never a panic, and what is accepted holds together.

use super::support::{Collada, ascii_stl, binary_stl, collada, cuboid, obj, read};
use proptest::prelude::*;
use realnoid::shape::{TriMesh, closed_solid};

fn originals() -> [(&'static str, Vec<u8>); 4] {
    let mesh = cuboid([1.0, 2.0, 3.0]);
    let scene = "<node><matrix>1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1</matrix><rotate>0 1 0 90</rotate><scale>1 1 2</scale>\
                 <instance_geometry url=\"#g\"/></node>";
    let faces = "<polylist count=\"2\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><vcount>4 8</vcount>\
                 <p>0 4 6 2 0 1 2 3 4 5 6 7</p></polylist><polygons><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\
                 <p>0 1 2</p></polygons>";
    let dae = collada(&mesh, &Collada { scene, faces, asset: "<unit meter=\"0.5\"/>", ..Collada::default() });
    let obj = obj(&mesh) + "f 1 2 3 4 5 6 7 8\nf -1 -2 -3 -4\n";
    [
        ("a.stl", binary_stl(b"", &mesh)),
        ("a.stl", ascii_stl(&mesh).into()),
        ("a.obj", obj.into()),
        ("a.dae", dae.into()),
    ]
}

/// Reads, and if there is a mesh, judges it.
fn survive(name: &str, bytes: &[u8]) {
    let Ok(mesh) = read(name, bytes) else { return };
    assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < mesh.vertices.len()));
    assert!(mesh.vertices.iter().all(|v| v.iter().all(|x| x.is_finite())));
    judge((*mesh).clone());
}

fn judge(mesh: TriMesh) {
    let Ok((solid, _)) = closed_solid(mesh) else { return };
    assert_eq!(closed_solid(solid.clone()).unwrap().0, solid, "a repaired mesh needs no repair");
}

proptest! {
    #[test]
    fn cut_files(which in 0..4_usize, end in 0.0..1.0) {
        let (name, bytes) = &originals()[which];
        survive(name, &bytes[..(end * bytes.len() as f64) as usize]);
    }

    #[test]
    fn changed_files(which in 0..4_usize, changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let (name, mut bytes) = originals()[which].clone();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        survive(name, &bytes);
    }

    #[test]
    fn words_swapped_for_others(which in 1..4_usize, at in any::<prop::sample::Index>(),
        word in prop::sample::select(vec!["-1", "99999999999999999999", "1e308", "NaN", "", "0", "<", "vertex", "f", "v 1 1 1"])) {
        let (name, bytes) = &originals()[which];
        let text = String::from_utf8(bytes.clone()).unwrap();
        let words: Vec<&str> = text.split(' ').collect();
        let at = at.index(words.len());
        let changed: Vec<&str> = words.iter().enumerate().map(|(i, w)| if i == at { word } else { *w }).collect();
        survive(name, changed.join(" ").as_bytes());
    }

    #[test]
    fn noise(name in prop::sample::select(vec!["a.stl", "a.obj", "a.dae", "a"]), bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        survive(name, &bytes);
    }

    #[test]
    fn any_triangles_over_few_corners(triangles in prop::collection::vec(prop::array::uniform3(0..6_u32), 0..24)) {
        let vertices = cuboid([1.0, 2.0, 3.0]).vertices[..6].to_vec();
        judge(TriMesh { vertices, triangles });
    }
}
