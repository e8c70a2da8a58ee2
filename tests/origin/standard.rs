//! Other tools load it: urdf-rs, and the rules by which Jazzy's urdfdom refuses a model.

use super::reader::{TEXT, all, child, read};
use realnoid::mass::{link_masses, with_inertials};
use roxmltree::{Document, Node};
use std::collections::HashSet;

fn shapes<'a, 'i>(robot: Node<'a, 'i>) -> Vec<Node<'a, 'i>> {
    let holders = all(robot, "link").flat_map(|l| all(l, "visual").chain(all(l, "collision")).collect::<Vec<_>>());
    holders.map(|h| child(h, "geometry").unwrap().first_element_child().unwrap()).collect()
}

fn obeys_urdfdom(text: &str) {
    let document = Document::parse(text).unwrap();
    let robot = document.root_element();
    assert!(matches!(robot.attribute("version"), None | Some("1.0")));
    let defined: HashSet<_> = all(robot, "material").map(|m| m.attribute("name").unwrap()).collect();
    for visual in all(robot, "link").flat_map(|l| all(l, "visual").collect::<Vec<_>>()) {
        let name = child(visual, "material").unwrap().attribute("name").unwrap();
        assert!(defined.contains(name), "material {name}");
    }
    for shape in shapes(robot) {
        assert!(["box", "cylinder", "sphere"].contains(&shape.tag_name().name()), "{shape:?}");
    }
    for joint in all(robot, "joint") {
        match joint.attribute("type").unwrap() {
            "fixed" => {}
            "revolute" => {
                let limit = child(joint, "limit").unwrap();
                for name in ["lower", "upper", "effort", "velocity"] {
                    limit.attribute(name).unwrap().parse::<f64>().unwrap();
                }
            }
            other => panic!("joint type {other}"),
        }
    }
}

#[test]
fn jazzy_takes_it_with_and_without_inertials() {
    let description = read();
    obeys_urdfdom(TEXT);
    obeys_urdfdom(&with_inertials(TEXT, &link_masses(&description).0, &description));
}

#[test]
fn no_link_states_its_inertia() {
    let document = Document::parse(TEXT).unwrap();
    let count = |tag| document.descendants().filter(|n| n.has_tag_name(tag)).count();
    assert_eq!(count("inertial"), 0);
    assert!(count("body") >= 20);
}

#[test]
fn urdf_rs_reads_the_same_tree() {
    let description = read();
    let robot = urdf_rs::read_from_string(TEXT).unwrap();
    assert_eq!(robot.links.len(), description.links.len());
    assert_eq!(robot.joints.len(), description.joints.len());
    for (theirs, ours) in robot.joints.iter().zip(&description.joints) {
        assert_eq!((&theirs.name, &theirs.parent.link, &theirs.child.link), (&ours.name, &ours.parent, &ours.child));
        assert_eq!((theirs.origin.xyz.0, theirs.origin.rpy.0), (ours.origin.xyz, ours.origin.rpy));
    }
    let names: HashSet<_> = robot.links.iter().map(|l| &l.name).collect();
    let children: HashSet<_> = robot.joints.iter().map(|j| &j.child.link).collect();
    assert_eq!((names.len(), children.len()), (robot.links.len(), robot.links.len() - 1), "one root, one parent each");
}

#[test]
fn frames_of_rep_120_are_there_and_carry_no_mass() {
    let description = read();
    let link = |name: &str| description.links.iter().find(|l| l.name == name).unwrap_or_else(|| panic!("{name}"));
    for name in ["base_link", "l_sole", "r_sole", "l_gripper", "r_gripper", "gaze"] {
        assert!(link(name).body.is_none() && link(name).visuals.is_empty(), "{name}");
    }
    assert!(link("torso").body.is_some());
}

#[test]
fn written_inertials_are_the_computed_ones() {
    let description = read();
    let (masses, _) = link_masses(&description);
    let robot = urdf_rs::read_from_string(&with_inertials(TEXT, &masses, &description)).unwrap();
    for (link, mass) in robot.links.iter().zip(&masses) {
        assert_eq!(link.inertial.mass.value, mass.mass, "{}", link.name);
        assert_eq!(link.inertial.inertia.iyz, mass.inertia[(1, 2)], "{}", link.name);
        assert_eq!(link.inertial.origin.xyz.0, <[f64; 3]>::from(mass.center), "{}", link.name);
    }
}

#[test]
fn the_text_with_inertials_is_the_same_robot_and_raises_no_question() {
    let description = read();
    let (masses, _) = link_masses(&description);
    let text = with_inertials(TEXT, &masses, &description);
    let again = realnoid::description::read(&text, "origin.urdf").description.unwrap();
    let (same, findings) = link_masses(&again);
    assert_eq!(same, masses);
    assert!(findings.is_empty(), "{findings:?}");
    assert_eq!(with_inertials(&text, &same, &again), text, "writing twice changes nothing");
}
