//! COLLADA: kinds of faces, units, nodes.

use super::support::{Collada, collada, cuboid, read, volume};
use realnoid::math::Vec3;
use realnoid::shape::{TriMesh, closed_solid};

const SIZE: [f64; 3] = [1.0, 2.0, 3.0];

fn mesh(parts: &Collada) -> TriMesh {
    let mesh = read("a.dae", collada(&cuboid(SIZE), parts)).unwrap();
    let (solid, repairs) = closed_solid((*mesh).clone()).unwrap();
    assert_eq!(repairs, Vec::<String>::new(), "closed, and facing outwards");
    solid
}

fn scene(scene: &str) -> TriMesh {
    mesh(&Collada { scene, ..Collada::default() })
}

fn box_of(mesh: &TriMesh) -> [Vec3; 2] {
    let all = || mesh.vertices.iter();
    [
        all().fold(all().next().copied().unwrap(), |a, b| a.inf(b)),
        all().fold(all().next().copied().unwrap(), |a, b| a.sup(b)),
    ]
}

fn lies(mesh: &TriMesh, from: [f64; 3], to: [f64; 3]) {
    let [min, max] = box_of(mesh);
    let off = (min - Vec3::from(from)).norm() + (max - Vec3::from(to)).norm();
    assert!(off < 1e-14 * 100.0, "{min} {max}");
}

const INPUTS: &str = "<input semantic=\"NORMAL\" source=\"#none\" offset=\"0\"/><input semantic=\"VERTEX\" source=\"#v\" offset=\"1\"/>\
                      <input semantic=\"TEXCOORD\" source=\"#none\" offset=\"2\" set=\"0\"/>";

/// Indices of corners with a normal before and a texture after each.
fn woven(corners: &str) -> String {
    corners.split_whitespace().map(|c| format!("7 {c} 9 ")).collect()
}

const QUADS: [&str; 6] = ["0 4 6 2", "1 3 7 5", "0 1 5 4", "2 6 7 3", "0 2 3 1", "4 5 7 6"];

#[test]
fn every_kind_of_face() {
    let polylist = format!(
        "<polylist count=\"6\">{INPUTS}<vcount>4 4 4 4 4 4</vcount><p>{}</p></polylist>",
        woven(&QUADS.join(" "))
    );
    let each: String = QUADS.iter().map(|q| format!("<p>{}</p>", woven(q))).collect();
    let polygons = format!("<polygons count=\"6\">{INPUTS}{each}</polygons>");
    let fans = format!("<trifans count=\"6\">{INPUTS}{each}</trifans>");
    let as_strip = |q: &str| {
        let c: Vec<&str> = q.split_whitespace().collect();
        format!("<p>{}</p>", woven(&format!("{} {} {} {}", c[0], c[1], c[3], c[2])))
    };
    let strips =
        format!("<tristrips count=\"6\">{INPUTS}{}</tristrips>", QUADS.iter().map(|q| as_strip(q)).collect::<String>());
    for faces in [&polylist, &polygons, &fans, &strips] {
        let found = mesh(&Collada { faces, ..Collada::default() });
        assert_eq!((volume(&found), found.triangles.len()), (6.0, 12), "{faces}");
    }
}

#[test]
fn the_unit_scales_corners_and_translations_of_nodes() {
    let asset = "<unit name=\"centimeter\" meter=\"0.01\"/>";
    let scene =
        "<node><translate>100 0 0</translate><node><scale>2 1 1</scale><instance_geometry url=\"#g\"/></node></node>";
    let found = mesh(&Collada { asset, scene, ..Collada::default() });
    lies(&found, [1.0, 0.0, 0.0], [1.02, 0.02, 0.03]);
}

#[test]
fn the_up_axis_turns_nothing() {
    for axis in ["X_UP", "Y_UP", "Z_UP"] {
        let asset = format!("<up_axis>{axis}</up_axis>");
        lies(&mesh(&Collada { asset: &asset, ..Collada::default() }), [0.0; 3], SIZE);
    }
}

#[test]
fn transforms_act_in_the_order_in_which_they_are_written() {
    let turned = "<rotate>0 0 1 90</rotate>";
    let moved = "<translate>10 0 0</translate>";
    let geometry = "<instance_geometry url=\"#g\"/>";
    lies(&scene(&format!("<node>{moved}{turned}{geometry}</node>")), [8.0, 0.0, 0.0], [10.0, 1.0, 3.0]);
    lies(&scene(&format!("<node>{turned}{moved}{geometry}</node>")), [-2.0, 10.0, 0.0], [0.0, 11.0, 3.0]);
}

#[test]
fn a_matrix_is_written_row_after_row() {
    let matrix = "<matrix>0 -1 0 10  1 0 0 20  0 0 1 30  0 0 0 1</matrix>";
    let found = scene(&format!("<node>{matrix}<instance_geometry url=\"#g\"/></node>"));
    lies(&found, [8.0, 20.0, 30.0], [10.0, 21.0, 33.0]);
}

#[test]
fn a_mirrored_node_still_faces_outwards() {
    let found = scene("<node><scale>-1 1 1</scale><instance_geometry url=\"#g\"/></node>");
    lies(&found, [-1.0, 0.0, 0.0], [0.0, 2.0, 3.0]);
    assert_eq!(volume(&found), 6.0);
}

#[test]
fn nodes_and_skins_are_instantiated() {
    let libraries = "<library_nodes><node id=\"n\"><translate>0 0 5</translate><instance_geometry url=\"#g\"/></node></library_nodes>
        <library_controllers><controller id=\"c\"><skin source=\"#m\"/></controller>
        <controller id=\"m\"><morph source=\"#g\"/></controller></library_controllers>";
    let scene = "<node><translate>5 0 0</translate><instance_node url=\"#n\"/></node><node><instance_controller url=\"#c\"/></node>";
    let found = mesh(&Collada { libraries, scene, ..Collada::default() });
    lies(&found, [0.0; 3], [6.0, 2.0, 8.0]);
    assert_eq!(found.triangles.len(), 24);
}

#[test]
fn what_is_not_instantiated_is_not_there() {
    let text = collada(&cuboid(SIZE), &Collada { scene: "<node/>", ..Collada::default() });
    assert!(read("a.dae", text).unwrap_err().to_string().contains("no triangles"));
}

#[test]
fn transforms_that_are_not_read_are_refused() {
    for (part, why) in [
        ("<lookat>0 0 0 1 0 0 0 0 1</lookat>", "not read"),
        ("<translate>1 2</translate>", "3 numbers are needed, there are 2"),
        ("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1</matrix>", "last row"),
    ] {
        let scene = format!("<node>{part}<instance_geometry url=\"#g\"/></node>");
        let fault =
            read("a.dae", collada(&cuboid(SIZE), &Collada { scene: &scene, ..Collada::default() })).unwrap_err();
        assert!(fault.to_string().contains(why) && fault.to_string().contains("line "), "{fault}");
    }
    for unit in ["0", "-1", "NaN", "inf", "one"] {
        let asset = format!("<unit meter=\"{unit}\"/>");
        let fault =
            read("a.dae", collada(&cuboid(SIZE), &Collada { asset: &asset, ..Collada::default() })).unwrap_err();
        assert!(fault.to_string().contains("no length above 0"), "{fault}");
    }
}
