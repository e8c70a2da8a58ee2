//! Text → [`Description`]: every item of the URDF and every tag of ours with its place, checked; findings.
//!
//! A positioned XML pass reads and checks everything; `standard` then lets urdf-rs read the standard part
//! as well, and the two must agree.

mod checks;
mod control;
mod element;
mod finding;
mod geometry;
mod joints;
mod links;
mod origin;
mod report;
mod rules;
mod shapes;
mod standard;
mod suggest;
mod tags;
mod types;
mod unknown;
mod xml;

pub use control::{ControlBlock, ControlJoint, INTERFACES};
pub use finding::{Finding, Severity, render};
pub use geometry::*;
pub use types::*;

use element::Element;
use report::Report;
use std::sync::Arc;

/// The mend for whatever xacro has left behind.
const RUN_XACRO: &str = "run xacro first: xacro robot.urdf.xacro > robot.urdf";

/// Elements of `<robot>` that mean something here.
const KNOWN: &[&str] = &["link", "joint", "material", "realnoid", "ros2_control"];

/// What reading a text gives.
#[derive(Clone, Debug)]
pub struct Reading {
    /// What the text says; `None` if one of the findings is an error.
    pub description: Option<Description>,
    /// Errors, then warnings, then notes, each in the order of the text.
    pub findings: Vec<Finding>,
}

/// Reads and checks a URDF text with our tags. `file` is its name for messages. Never fails as such: what is
/// wrong is in the findings.
pub fn read(text: &str, file: &str) -> Reading {
    let mut report = Report::new(text);
    let declared = xml::declare_prefixes(text, &mut report);
    let description = xml::parse(&declared, text, &mut report).and_then(|document| {
        let robot = Element::root(document.root_element());
        let description = read_robot(&robot, text, file, &mut report)?;
        if !report.has_errors() {
            standard::cross_check(&robot, &description, &mut report);
        }
        Some(description)
    });
    let sound = !report.has_errors();
    Reading { description: description.filter(|_| sound), findings: report.finish() }
}

fn read_robot(robot: &Element, text: &str, file: &str, report: &mut Report) -> Option<Description> {
    if robot.tag() != "robot" {
        report.add(not_urdf(robot, report));
        return None;
    }
    unknown::children(robot, KNOWN, report);
    let links: Vec<_> = robot.all("link").map(|e| links::read(&e, report)).collect();
    let joint_elements: Vec<_> = robot.all("joint").collect();
    let joints: Vec<_> = joint_elements.iter().filter_map(|e| joints::read(e, report)).collect();
    let all_joints_read = joints.len() == joint_elements.len();
    let tags = tags::robot::read(robot, report);
    let description = Description {
        name: read_name(robot, report),
        file: Arc::from(file),
        text: Arc::from(text),
        links,
        joints,
        groups: tags.groups.iter().map(|(group, _)| group.clone()).collect(),
        chains: tags.chains.iter().map(|(chain, _)| chain.clone()).collect(),
        rigs: tags.rigs.iter().map(|(rig, _)| rig.clone()).collect(),
        controls: robot.all("ros2_control").map(|e| control::read(&e, report)).collect(),
    };
    checks::run(&description, robot, &tags, all_joints_read, report);
    Some(description)
}

fn read_name(robot: &Element, report: &mut Report) -> String {
    report.lenient(|report| robot.required("name", report)).unwrap_or("unnamed").to_string()
}

fn not_urdf(root: &Element, report: &Report) -> Finding {
    let (format, mend) = match root.tag() {
        "sdf" => ("SDF", "convert it to URDF first"),
        "mujoco" => ("MJCF (MuJoCo)", "convert it to URDF first"),
        _ => ("not URDF", "a URDF starts with <robot name=\"…\">"),
    };
    let message = format!("the outermost element is <{}>: this is {format}", root.tag());
    Finding::error("not-urdf", root.place(report), message, mend)
}
