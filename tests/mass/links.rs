//! Which links get which mass, and what is said about them.

use nalgebra::{Matrix3, Vector3};
use realnoid::description::{self, Description, Origin, Severity};
use realnoid::mass::{link_masses, with_inertials};

/// A robot of these links and joints, which must read without errors.
fn robot(elements: &str) -> Description {
    let text = format!("<robot name=\"robot\">\n{elements}\n</robot>");
    let reading = description::read(&text, "robot.urdf");
    reading.description.unwrap_or_else(|| panic!("{:?}", reading.findings))
}

/// A link with these tags of ours and this plain content.
fn link(name: &str, tags: &str, plain: &str) -> String {
    format!("<link name=\"{name}\">\n<realnoid>\n{tags}\n</realnoid>\n{plain}\n</link>")
}

fn joint(kind: &str, parent: &str, child: &str) -> String {
    format!(
        "<joint name=\"{parent}_{child}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
         <axis xyz=\"1 0 0\"/></joint>"
    )
}

const CUBE: &str = "<box size=\"0.1 0.1 0.1\"/>";

fn visual(geometry: &str) -> String {
    format!("<visual><geometry>{geometry}</geometry></visual>")
}

fn body(specific_gravity: f64, shapes: &str) -> String {
    format!("<body specific_gravity=\"{specific_gravity}\">{shapes}</body>")
}

#[test]
fn a_link_without_inertial_and_tag_has_no_mass() {
    let (masses, findings) = link_masses(&robot(&link("only", "", &visual(CUBE))));
    assert_eq!((masses[0].mass, masses[0].inertia.norm()), (0.0, 0.0));
    assert!(findings.is_empty());
}

#[test]
fn inertial_is_turned_to_the_axes_of_the_link() {
    let inertial = "<inertial><origin xyz=\"0.1 0.2 0.3\" rpy=\"0 0 1.5707963267948966\"/><mass value=\"2\"/>\
                    <inertia ixx=\"1\" ixy=\"0.1\" ixz=\"0\" iyy=\"2\" iyz=\"0\" izz=\"2.5\"/></inertial>";
    let (masses, _) = link_masses(&robot(&link("only", "", inertial)));
    assert_eq!(masses[0].center, Vector3::new(0.1, 0.2, 0.3));
    let turned = Matrix3::new(2.0, -0.1, 0.0, -0.1, 1.0, 0.0, 0.0, 0.0, 2.5);
    assert!((masses[0].inertia - turned).norm() < 1e-15);
}

#[test]
fn shapes_of_the_tag_replace_the_visuals() {
    let ball = visual("<sphere radius=\"1\"/>");
    let shapes = format!(
        "<shape><origin xyz=\"0.1 0 0\"/>{CUBE}</shape><shape><origin xyz=\"-0.1 0 0.2\" rpy=\"0.3 0.3 0.3\"/>{CUBE}</shape>"
    );
    let (masses, findings) = link_masses(&robot(&link("only", &body(2.0, &shapes), &ball)));
    assert!(findings.is_empty());
    assert!((masses[0].mass - 4.0).abs() < 1e-14);
    assert!((masses[0].center - Vector3::new(0.0, 0.0, 0.1)).norm() < 1e-15);
    let (masses, _) = link_masses(&robot(&link("only", &body(2.0, ""), &ball)));
    assert!((masses[0].mass - 2000.0 * 4.0 / 3.0 * std::f64::consts::PI).abs() < 1e-9);
}

#[test]
fn l_scale_multiplies_distances_in_the_inertia_and_nothing_else() {
    let shapes =
        format!("<shape><origin xyz=\"0.1 0 0\"/>{CUBE}</shape><shape><origin xyz=\"-0.3 0.2 0\"/>{CUBE}</shape>");
    let mut description = robot(&link("only", &body(1.0, &shapes), ""));
    let (plain, _) = link_masses(&description);
    description.links[0].body.as_mut().unwrap().l_scale = 3.0;
    let (scaled, _) = link_masses(&description);
    assert_eq!((scaled[0].mass, scaled[0].center), (plain[0].mass, plain[0].center));
    assert!((scaled[0].inertia - plain[0].inertia * 9.0).norm() < 1e-15);
}

#[test]
fn tag_beats_inertial_and_the_note_says_by_how_much() {
    let i = 1.0 / 600.0;
    let inertial = format!(
        "<inertial><origin xyz=\"0.003 0 0.004\"/><mass value=\"1\"/>\
         <inertia ixx=\"{i}\" ixy=\"0\" ixz=\"0\" iyy=\"{i}\" iyz=\"0\" izz=\"{i}\"/></inertial>"
    );
    let shapes = format!("<shape>{CUBE}</shape>");
    let (masses, findings) = link_masses(&robot(&link("shin", &body(1.5, &shapes), &inertial)));
    assert!((masses[0].mass - 1.5).abs() < 1e-15);
    assert_eq!((findings.len(), findings[0].severity, findings[0].at.line), (1, Severity::Note, 4));
    let said = &findings[0].message;
    assert!(said.contains("mass is 1.500000 kg instead of 1.000000 kg (+50.0 %)"), "{said}");
    assert!(said.contains("5.00 mm away"), "{said}");
    assert!(said.contains("(50.0 % of the largest)"), "{said}");
}

/// A stand of two links that carries an arm of two; all of the specific gravity of the cube that each is.
fn arm_on_a_stand() -> Description {
    let shapes = format!("<shape>{CUBE}</shape>");
    let links = ["stand", "plate", "arm", "hand"].map(|name| link(name, &body(1.0, &shapes), ""));
    let joints = [joint("fixed", "stand", "plate"), joint("continuous", "plate", "arm"), joint("fixed", "arm", "hand")];
    robot(&[links.join("\n"), joints.join("\n")].join("\n"))
}

#[test]
fn static_is_allowed_where_nothing_moves_it() {
    let mut description = arm_on_a_stand();
    for link in &mut description.links {
        link.body.as_mut().unwrap().substance.specific_gravity = 0.0;
    }
    let (masses, findings) = link_masses(&description);
    assert!(masses.iter().all(|m| m.mass == 0.0));
    let blamed: Vec<_> = findings.iter().map(|f| (f.severity, f.code, f.element.as_str())).collect();
    let code = "static-link-in-chain";
    assert_eq!(blamed, [(Severity::Error, code, "link 'arm' <body>"), (Severity::Error, code, "link 'hand' <body>")]);
}

#[test]
fn a_density_that_is_none_gives_no_mass_and_an_error() {
    for gravity in [-1.0, f64::NAN, f64::INFINITY] {
        let mut description = arm_on_a_stand();
        description.links[2].body.as_mut().unwrap().substance.specific_gravity = gravity;
        let (masses, findings) = link_masses(&description);
        assert_eq!((masses[2].mass, findings.len(), findings[0].code), (0.0, 1, "specific-gravity"));
    }
}

#[test]
fn a_cycle_does_not_hang() {
    let mut description = arm_on_a_stand();
    let mut back = description.joints[0].clone();
    (back.parent, back.child) = ("plate".into(), "stand".into());
    description.joints.push(back);
    assert_eq!(link_masses(&description).0.len(), 4);
}

#[test]
fn a_mesh_that_must_carry_mass_is_an_error_at_its_line() {
    let mesh = visual("<mesh filename=\"package://robot/torso.stl\"/>");
    assert!(link_masses(&robot(&link("torso", "", &mesh))).1.is_empty(), "no tag, no question");
    let mut description = robot(&link("torso", &body(1.0, ""), &mesh));
    let (masses, findings) = link_masses(&description);
    assert_eq!(masses[0].mass, 0.0);
    assert_eq!((findings[0].severity, findings[0].code), (Severity::Error, "unknown-package"));
    assert_eq!((findings[0].element.as_str(), findings[0].at.line), ("link 'torso' <mesh>", 6));
    description.links[0].visuals.clear();
    assert_eq!(link_masses(&description).1[0].code, "no-shape-for-mass");
}

const ODD: &str = r#"<realnoid><body specific_gravity="1.07"><shape><origin xyz="0.3 0.1 1e-9" rpy="0.1 0.2 0.3"/>
    <ellipsoid radii="0.1 0.07 0.033"/></shape></body></realnoid>"#;
const INERTIAL: &str =
    r#"<inertial><mass value="7"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>"#;

#[test]
fn inertials_are_put_in_to_the_last_bit_and_nothing_else_changes() {
    let before = r#"<?xml version="1.0"?><!-- a robot --><robot name="robot"><link name="root"/><link name="tagged">"#;
    let after = format!(
        "<link name=\"written\">{INERTIAL}</link>{}{}{}</robot>",
        joint("fixed", "root", "tagged"),
        joint("fixed", "root", "both"),
        joint("fixed", "root", "written")
    );
    let old = format!("{before}<!-- first -->{ODD}</link><link name=\"both\">{ODD}\n {INERTIAL} </link>{after}");
    let description = description::read(&old, "robot.urdf").description.unwrap();
    let (masses, _) = link_masses(&description);
    let new = with_inertials(&old, &masses, &description);

    let links = urdf_rs::read_from_string(&new).unwrap().links;
    for i in [1, 2] {
        assert_eq!(links[i].inertial.mass.value, masses[i].mass);
        assert_eq!(links[i].inertial.origin.xyz.0, <[f64; 3]>::from(masses[i].center));
        let n = &links[i].inertial.inertia;
        let tensor = Matrix3::new(n.ixx, n.ixy, n.ixz, n.ixy, n.iyy, n.iyz, n.ixz, n.iyz, n.izz);
        assert_eq!(tensor, masses[i].inertia);
    }
    assert_eq!((links[0].inertial.mass.value, links[3].inertial.mass.value), (0.0, 7.0));
    let (first, rest) = new.strip_prefix(before).unwrap().split_once("<!-- first -->").unwrap();
    let second = rest.strip_prefix(&format!("{ODD}</link><link name=\"both\">{ODD}\n ")).unwrap();
    let second = second.strip_suffix(&format!(" </link>{after}")).unwrap();
    for written in [first.trim(), second] {
        assert!(written.starts_with("<inertial>") && written.ends_with("</inertial>"), "{written}");
        assert_eq!(written.matches("<inertial>").count(), 1, "{written}");
    }
}

#[test]
fn urdf_origins_turn_about_fixed_axes_roll_first() {
    let x =
        Origin { xyz: [1.0, 0.0, 0.0], rpy: [std::f64::consts::FRAC_PI_2, 0.0, std::f64::consts::FRAC_PI_2] }.pose();
    let y = x * nalgebra::Point3::new(0.0, 1.0, 0.0);
    assert!((y.coords - Vector3::new(1.0, 0.0, 1.0)).norm() < 1e-15);
}

#[test]
fn what_overflows_or_does_not_fit_is_told() {
    let told = |tags: &str| link_masses(&robot(&link("only", tags, ""))).1;
    let far = r#"<shape><origin xyz="1e200 0 0"/><box size="1 1 1"/></shape><shape><box size="1 1 1"/></shape>"#;
    assert_eq!(told(&body(1.0, far))[0].code, "mass-out-of-range");
    let scaled = body(1.0, &format!("<shape>{CUBE}</shape>")).replace("<body", "<body l_scale=\"1e200\"");
    assert_eq!(told(&scaled)[0].code, "mass-out-of-range");
    let wall = body(1.0, "<shape><sphere radius=\"0.1\"/></shape>")
        .replace("<body", "<body dimension=\"2d\" thickness=\"0.2\"");
    assert_eq!((told(&wall)[0].code, told(&wall)[0].severity), ("wall-thicker-than-shape", Severity::Warning));
    let proxy = r#"<proxy><torus ring_radius="0.1" pipe_radius="0.2"/></proxy>"#;
    assert_eq!(told(proxy)[0].code, "shape-without-volume");
    let needle = r#"<shape><origin rpy="0.3 0.4 0.5"/><cylinder radius="1e-4" length="1e6"/></shape>"#;
    assert!(told(&body(1.0, needle)).is_empty(), "a needle's least moment may drown in rounding");
}
