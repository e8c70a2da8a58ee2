//! Which links get which mass, and what is said about them.

use nalgebra::{Matrix3, Vector3};
use realnoid::description::*;
use realnoid::mass::{link_masses, with_inertials};
use realnoid::shape;
use std::sync::Arc;

fn at(line: u32) -> Position {
    Position { line, column: 5, ..Position::default() }
}

fn placed(geometry: Geometry, xyz: [f64; 3], rpy: [f64; 3]) -> PlacedShape {
    PlacedShape { at: at(7), origin: Origin { xyz, rpy }, geometry }
}

fn body(specific_gravity: f64, shapes: Vec<PlacedShape>) -> Body {
    Body { at: at(9), specific_gravity, dimension: Dimension::Solid, l_scale: 1.0, shapes }
}

fn link(name: &str) -> Link {
    Link {
        name: name.into(),
        at: at(3),
        inertial: None,
        visuals: vec![],
        collisions: vec![],
        body: None,
        proxies: vec![],
        surface: None,
        damping: None,
        deactivate: None,
        monitor: None,
    }
}

fn joint(kind: JointKind, parent: &str, child: &str) -> Joint {
    Joint {
        name: format!("{parent}_{child}"),
        at: at(1),
        kind,
        parent: parent.into(),
        parent_at: at(1),
        child: child.into(),
        child_at: at(1),
        origin: Origin::default(),
        axis: [1.0, 0.0, 0.0],
        limit: None,
        damping: 0.0,
        friction: 0.0,
        mimic: None,
        drive: None,
        constraint: None,
    }
}

fn robot(links: Vec<Link>, joints: Vec<Joint>) -> Description {
    Description {
        name: "robot".into(),
        file: Arc::from("robot.urdf"),
        text: Arc::from(""),
        links,
        joints,
        groups: vec![],
        chains: vec![],
    }
}

const CUBE: Geometry = Geometry::Box { size: [0.1; 3] };

#[test]
fn a_link_without_inertial_and_tag_has_no_mass() {
    let mut only = link("only");
    only.visuals.push(placed(CUBE, [0.0; 3], [0.0; 3]));
    let (masses, findings) = link_masses(&robot(vec![only], vec![]));
    assert_eq!((masses[0].mass, masses[0].inertia.norm()), (0.0, 0.0));
    assert!(findings.is_empty());
}

#[test]
fn inertial_is_turned_to_the_axes_of_the_link() {
    let mut only = link("only");
    let origin = Origin { xyz: [0.1, 0.2, 0.3], rpy: [0.0, 0.0, std::f64::consts::FRAC_PI_2] };
    only.inertial = Some(Inertial { at: at(4), origin, mass: 2.0, inertia: [1.0, 0.1, 0.0, 2.0, 0.0, 2.5] });
    let (masses, _) = link_masses(&robot(vec![only], vec![]));
    assert_eq!(masses[0].center, Vector3::new(0.1, 0.2, 0.3));
    let turned = Matrix3::new(2.0, -0.1, 0.0, -0.1, 1.0, 0.0, 0.0, 0.0, 2.5);
    assert!((masses[0].inertia - turned).norm() < 1e-15);
}

#[test]
fn shapes_of_the_tag_replace_the_visuals() {
    let mut only = link("only");
    only.visuals.push(placed(Geometry::Sphere { radius: 1.0 }, [0.0; 3], [0.0; 3]));
    only.body =
        Some(body(2.0, vec![placed(CUBE, [0.1, 0.0, 0.0], [0.0; 3]), placed(CUBE, [-0.1, 0.0, 0.2], [0.3; 3])]));
    let (masses, findings) = link_masses(&robot(vec![only.clone()], vec![]));
    assert!(findings.is_empty());
    assert!((masses[0].mass - 4.0).abs() < 1e-14);
    assert!((masses[0].center - Vector3::new(0.0, 0.0, 0.1)).norm() < 1e-15);
    only.body = Some(body(2.0, vec![]));
    let (masses, _) = link_masses(&robot(vec![only], vec![]));
    assert!((masses[0].mass - 2000.0 * 4.0 / 3.0 * std::f64::consts::PI).abs() < 1e-9);
}

#[test]
fn l_scale_multiplies_distances_in_the_inertia_and_nothing_else() {
    let mut only = link("only");
    only.body =
        Some(body(1.0, vec![placed(CUBE, [0.1, 0.0, 0.0], [0.0; 3]), placed(CUBE, [-0.3, 0.2, 0.0], [0.0; 3])]));
    let (plain, _) = link_masses(&robot(vec![only.clone()], vec![]));
    only.body.as_mut().unwrap().l_scale = 3.0;
    let (scaled, _) = link_masses(&robot(vec![only], vec![]));
    assert_eq!((scaled[0].mass, scaled[0].center), (plain[0].mass, plain[0].center));
    assert!((scaled[0].inertia - plain[0].inertia * 9.0).norm() < 1e-15);
}

#[test]
fn tag_beats_inertial_and_the_note_says_by_how_much() {
    let mut only = link("shin");
    only.body = Some(body(1.5, vec![placed(CUBE, [0.0; 3], [0.0; 3])]));
    let own = 1.0 / 600.0;
    let origin = Origin { xyz: [0.003, 0.0, 0.004], ..Origin::default() };
    only.inertial = Some(Inertial { at: at(4), origin, mass: 1.0, inertia: [own, 0.0, 0.0, own, 0.0, own] });
    let (masses, findings) = link_masses(&robot(vec![only], vec![]));
    assert!((masses[0].mass - 1.5).abs() < 1e-15);
    assert_eq!((findings.len(), findings[0].severity, findings[0].at.line), (1, Severity::Note, 9));
    let said = &findings[0].message;
    assert!(said.contains("mass is 1.500000 kg instead of 1.000000 kg (+50.0 %)"), "{said}");
    assert!(said.contains("5.00 mm away"), "{said}");
    assert!(said.contains("(+50.0 % of the largest)"), "{said}");
}

#[test]
fn static_is_allowed_where_nothing_moves_it() {
    let mut links = vec![link("stand"), link("plate"), link("arm"), link("hand")];
    for l in &mut links {
        l.body = Some(body(0.0, vec![placed(CUBE, [0.0; 3], [0.0; 3])]));
    }
    let joints = vec![
        joint(JointKind::Fixed, "stand", "plate"),
        joint(JointKind::Revolute, "plate", "arm"),
        joint(JointKind::Fixed, "arm", "hand"),
    ];
    let (masses, findings) = link_masses(&robot(links, joints));
    assert!(masses.iter().all(|m| m.mass == 0.0));
    let blamed: Vec<_> = findings.iter().map(|f| (f.severity, f.code, f.element.as_str())).collect();
    let code = "static-link-in-chain";
    assert_eq!(blamed, [(Severity::Error, code, "link 'arm' <body>"), (Severity::Error, code, "link 'hand' <body>")]);
}

#[test]
fn a_cycle_does_not_hang() {
    let joints = vec![joint(JointKind::Fixed, "a", "b"), joint(JointKind::Fixed, "b", "a")];
    assert_eq!(link_masses(&robot(vec![link("a"), link("b")], joints)).0.len(), 2);
}

#[test]
fn a_mesh_that_must_carry_mass_is_an_error_at_its_line() {
    let mesh = Geometry::Mesh { filename: "package://robot/torso.stl".into(), scale: [1.0; 3] };
    let mut only = link("torso");
    only.visuals.push(placed(mesh, [0.0; 3], [0.0; 3]));
    assert!(link_masses(&robot(vec![only.clone()], vec![])).1.is_empty(), "no tag, no question");
    only.body = Some(body(1.0, vec![]));
    let (masses, findings) = link_masses(&robot(vec![only.clone()], vec![]));
    assert_eq!(masses[0].mass, 0.0);
    assert_eq!((findings[0].severity, findings[0].code), (Severity::Error, "mass-from-shape-later"));
    assert_eq!((findings[0].element.as_str(), findings[0].at.line), ("link 'torso' <mesh>", 7));
    only.visuals.clear();
    assert_eq!(link_masses(&robot(vec![only], vec![])).1[0].code, "no-shape-for-mass");
}

const TEXT: &str = r#"<?xml version="1.0"?>
<!-- a robot --> <robot name="robot">
  <link name="root"/>
  <link name="tagged"><!-- first --><realnoid><body specific_gravity="1"/></realnoid></link>
  <link name="both"><realnoid><body specific_gravity="1"/></realnoid>
    <inertial><mass value="7"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
  <link name="written">
    <inertial><mass value="7"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
</robot>"#;

#[test]
fn inertials_are_put_in_to_the_last_bit_and_nothing_else_changes() {
    let names = ["root", "tagged", "both", "written"];
    let mut links: Vec<_> = names.iter().map(|n| link(n)).collect();
    let odd = Geometry::Ellipsoid { radii: [0.1, 0.07, 0.033] };
    links[1].body = Some(body(1.07, vec![placed(odd.clone(), [0.3, 0.1, 1e-9], [0.1, 0.2, 0.3])]));
    links[2].body = Some(body(1.3, vec![placed(odd, [0.0; 3], [1.0, 0.0, 0.3])]));
    let description = robot(links, vec![]);
    let (masses, _) = link_masses(&description);
    let text = with_inertials(TEXT, &masses, &description);

    let read = urdf_rs::read_from_string(&text.replace("<realnoid>", "<!--").replace("</realnoid>", "-->")).unwrap();
    for i in [1, 2] {
        let inertial = &read.links[i].inertial;
        assert_eq!(inertial.mass.value, masses[i].mass);
        assert_eq!(inertial.origin.xyz.0, <[f64; 3]>::from(masses[i].center));
        let n = &inertial.inertia;
        let tensor = Matrix3::new(n.ixx, n.ixy, n.ixz, n.ixy, n.iyy, n.iyz, n.ixz, n.iyz, n.izz);
        assert_eq!(tensor, masses[i].inertia);
    }
    assert_eq!((read.links[0].inertial.mass.value, read.links[3].inertial.mass.value), (0.0, 7.0));
    let kept = text.lines().zip(TEXT.lines()).filter(|(new, old)| new == old).count();
    assert_eq!(kept, 3, "the lines before the first insertion");
    assert!(text.ends_with(&TEXT[TEXT.find("<link name=\"written\">").unwrap()..]));
    assert_eq!(text.matches("<inertial>").count(), 3);
}

#[test]
fn urdf_origins_turn_about_fixed_axes_roll_first() {
    let x = shape::pose(&Origin {
        xyz: [1.0, 0.0, 0.0],
        rpy: [std::f64::consts::FRAC_PI_2, 0.0, std::f64::consts::FRAC_PI_2],
    });
    let y = x * nalgebra::Point3::new(0.0, 1.0, 0.0);
    assert!((y.coords - Vector3::new(1.0, 0.0, 1.0)).norm() < 1e-15);
}
