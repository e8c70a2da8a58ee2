//! The standard part, read a second time by urdf-rs from a text without what it cannot take; both readings
//! must agree.

use super::element::Element;
use super::finding::Finding;
use super::origin::QUATERNION;
use super::report::Report;
use super::{Description, Inertial, Joint, JointKind, Origin};
use std::fmt::Write;

/// Elements and attributes of the standard part that the dynamics use; each element at most once per parent.
const INERTIAL: [(&str, &[&str]); 3] =
    [("origin", &["xyz", "rpy"]), ("mass", &["value"]), ("inertia", &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"])];
const JOINT: [(&str, &[&str]); 3] = [("origin", &["xyz", "rpy"]), ("parent", &["link"]), ("child", &["link"])];
const DYNAMICS: (&str, &[&str]) = ("dynamics", &["damping", "friction"]);
const AXIS: (&str, &[&str]) = ("axis", &["xyz"]);
const RANGE: (&str, &[&str]) = ("limit", &["lower", "upper", "effort", "velocity"]);
const BOUNDS: (&str, &[&str]) = ("limit", &["effort", "velocity"]);
const MIMIC: (&str, &[&str]) = ("mimic", &["joint"]);

/// Reports an error if urdf-rs cannot read the standard part of a text that we found sound, or reads it
/// otherwise. Call it only when there is no error yet.
pub(super) fn cross_check(robot: &Element, description: &Description, report: &mut Report) {
    let differences = match urdf_rs::read_from_string(&plain_text(robot, description)) {
        Ok(second) => differences(robot, description, &second),
        Err(error) => vec![format!("urdf-rs cannot read it: {error}")],
    };
    if let Some(first) = differences.first() {
        let message = format!("two readers disagree about this file, in {} places: {first}", differences.len());
        let mend = "this is a fault of realnoid: please report it together with the file";
        report.add(Finding::error("readers-disagree", robot.place(report), message, mend));
    }
}

/// The standard part with the values as the text has them.
fn plain_text(robot: &Element, description: &Description) -> String {
    let mut text = String::from("<robot name=\"plain\">");
    for link in robot.all("link") {
        open("link", &link, &["name"], &mut text);
        if let Some(inertial) = link.all("inertial").next() {
            text.push_str("<inertial>");
            children(&inertial, &INERTIAL, &mut text);
            text.push_str("</inertial>");
        }
        text.push_str("</link>");
    }
    for (element, joint) in robot.all("joint").zip(&description.joints) {
        open("joint", &element, &["name", "type"], &mut text);
        children(&element, &JOINT, &mut text);
        children(&element, motion(joint), &mut text);
        children(&element, if joint.mimic.is_some() { &[MIMIC] } else { &[] }, &mut text);
        text.push_str("</joint>");
    }
    text.push_str("</robot>");
    text
}

/// What counts for this type of joint: the rest may hold anything.
fn motion(joint: &Joint) -> &'static [(&'static str, &'static [&'static str])] {
    match joint.kind {
        JointKind::Revolute | JointKind::Prismatic => &[AXIS, RANGE, DYNAMICS],
        JointKind::Continuous => &[AXIS, BOUNDS, DYNAMICS],
        _ => &[],
    }
}

fn children(parent: &Element, allowed: &[(&'static str, &[&str])], text: &mut String) {
    for (tag, attributes) in allowed {
        let Some(child) = parent.all(tag).next() else { continue };
        open(tag, &child, attributes, text);
        let _ = write!(text, "</{tag}>");
    }
}

/// A start tag; a `<limit>` without velocity gets the placeholder that urdf-rs insists on.
fn open(tag: &str, element: &Element, attributes: &[&str], text: &mut String) {
    let _ = write!(text, "<{tag}");
    for name in attributes {
        match element.value(name) {
            Some(value) => {
                let _ = write!(text, " {name}=\"{}\"", escape(value.trim()));
            }
            None if (tag, *name) == ("limit", "velocity") => text.push_str(" velocity=\"0\""),
            None => {}
        }
    }
    text.push('>');
}

fn escape(value: &str) -> String {
    value.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// One sentence for each item that the two readings see differently.
fn differences(robot: &Element, ours: &Description, theirs: &urdf_rs::Robot) -> Vec<String> {
    if (ours.links.len(), ours.joints.len()) != (theirs.links.len(), theirs.joints.len()) {
        return vec!["the number of links or joints".into()];
    }
    let links = ours.links.iter().zip(&theirs.links).filter_map(|(a, b)| {
        let equal = a.name.trim() == b.name.trim() && a.inertial.as_ref().is_none_or(|i| equal_inertial(i, b));
        (!equal).then(|| format!("link '{}'", a.name))
    });
    let joints = robot.all("joint").zip(&ours.joints).zip(&theirs.joints).filter_map(|((element, a), b)| {
        let quaternion = element.all("origin").any(|o| o.value(QUATERNION).is_some());
        (!equal_joint(a, b, quaternion)).then(|| format!("joint '{}'", a.name))
    });
    links.chain(joints).collect()
}

fn equal_inertial(a: &Inertial, b: &urdf_rs::Link) -> bool {
    let b = &b.inertial;
    let inertia = [b.inertia.ixx, b.inertia.ixy, b.inertia.ixz, b.inertia.iyy, b.inertia.iyz, b.inertia.izz];
    a.mass == b.mass.value && a.inertia == inertia && equal_origin(&a.origin, &b.origin, true)
}

fn equal_origin(a: &Origin, b: &urdf_rs::Pose, with_rpy: bool) -> bool {
    a.xyz == *b.xyz && (!with_rpy || a.rpy == *b.rpy)
}

fn equal_joint(a: &Joint, b: &urdf_rs::Joint, quaternion: bool) -> bool {
    let (damping, friction) = b.dynamics.as_ref().map_or((0.0, 0.0), |d| (d.damping, d.friction));
    let mimic = (a.mimic.as_ref().map(|m| m.joint.trim()), b.mimic.as_ref().map(|m| m.joint.trim()));
    (a.name.trim(), a.parent.trim(), a.child.trim()) == (b.name.trim(), b.parent.link.trim(), b.child.link.trim())
        && equal_origin(&a.origin, &b.origin, !quaternion)
        && (a.damping, a.friction) == (damping, friction)
        && mimic.0 == mimic.1
        && equal_motion(a, b)
}

fn equal_motion(a: &Joint, b: &urdf_rs::Joint) -> bool {
    let length = b.axis.xyz.iter().map(|x| x * x).sum::<f64>().sqrt();
    let axis = b.axis.xyz.map(|x| x / length);
    let given = |ours: f64, theirs: f64| ours == theirs || ours.is_infinite();
    let bound = |ours: Option<f64>, theirs: f64| ours.unwrap_or(0.0) == theirs;
    let limit = |l: &super::Limit| {
        given(l.lower, b.limit.lower)
            && given(l.upper, b.limit.upper)
            && bound(l.effort, b.limit.effort)
            && bound(l.velocity, b.limit.velocity)
    };
    match a.kind {
        JointKind::Revolute | JointKind::Prismatic | JointKind::Continuous => {
            a.axis == axis && a.limit.as_ref().is_none_or(limit)
        }
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{read, read_robot};
    use super::*;

    const TEXT: &str = r#"<robot name="r"><link name="a"/><link name="b"><inertial><mass value="2"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
        <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 3 4"/>
        <limit lower="-1" upper="2" effort="3" velocity="4"/></joint></robot>"#;

    /// What the cross-check finds after `change` has falsified our reading.
    fn disagreements(change: impl Fn(&mut Description)) -> usize {
        let document = roxmltree::Document::parse(TEXT).unwrap();
        let robot = Element::root(document.root_element());
        let mut report = Report::new(TEXT);
        let mut description = read_robot(&robot, TEXT, "r", &mut report).unwrap();
        change(&mut description);
        cross_check(&robot, &description, &mut report);
        report.finish().iter().filter(|f| f.code == "readers-disagree").count()
    }

    #[test]
    fn a_number_misread_is_found() {
        assert!(read(TEXT, "r").findings.is_empty());
        assert_eq!(disagreements(|_| {}), 0);
        assert_eq!(disagreements(|d| d.links[1].inertial.as_mut().unwrap().mass = 2.5), 1);
        assert_eq!(disagreements(|d| d.links[1].inertial.as_mut().unwrap().inertia[3] = 1.5), 1);
        assert_eq!(disagreements(|d| d.joints[0].axis = [0.0, 1.0, 0.0]), 1);
        assert_eq!(disagreements(|d| d.joints[0].limit.as_mut().unwrap().upper = 2.5), 1);
        assert_eq!(disagreements(|d| d.joints[0].limit.as_mut().unwrap().velocity = None), 1);
        assert_eq!(disagreements(|d| d.joints[0].origin.rpy[1] = 0.5), 1);
        assert_eq!(disagreements(|d| d.joints[0].damping = 0.5), 1);
        assert_eq!(disagreements(|d| d.links[0].name = "c".into()), 1);
        assert_eq!(disagreements(|d| d.links.truncate(1)), 1);
    }
}
