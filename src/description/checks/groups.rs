//! `<joint_group>`: what it names exists, and its joints form what its type says.

use super::super::element::Element;
use super::super::finding::Finding;
use super::super::report::Report;
use super::super::tags::robot::RobotTags;
use super::super::{Description, GroupKind, Joint, JointGroup, JointKind, Link, suggest};
use crate::math::{Quat, Vec3};
use std::collections::HashMap;

/// Metres, and cosine of the angle between axes: what rounding in a text may leave.
const TOLERANCE: f64 = 1e-6;

/// One axis of a group: its letter and its joint.
type Axis<'d> = (&'static str, &'d Joint);

/// All groups.
pub(super) fn check(d: &Description, tags: &RobotTags, report: &mut Report) {
    let mut names: HashMap<&str, u32> = HashMap::new();
    let mut owners: HashMap<&str, &str> = HashMap::new();
    for (group, element) in &tags.groups {
        if let Some(line) = names.insert(&group.name, group.at.line) {
            let message = format!("a second group named '{}'; the first one is in line {line}", group.name);
            report.add(Finding::error("duplicate-name", element.place_of("name", report), message, "rename one group"));
        }
        check_group(d, group, element, &mut owners, report);
    }
}

pub(super) fn must_exist<'n>(
    what: &str,
    name: &str,
    known: impl Iterator<Item = &'n str> + Clone,
    (attribute, element): (&str, &Element),
    report: &mut Report,
) -> bool {
    let exists = known.clone().any(|k| k == name);
    if !exists {
        let message = format!("there is no {what} '{name}'");
        let mend = match suggest::nearest(name, known) {
            Some(near) => format!("did you mean '{near}'?"),
            None => format!("name an existing {what}"),
        };
        report.add(Finding::error("unknown-name", element.place_of(attribute, report), message, mend));
    }
    exists
}

fn check_group<'d>(
    d: &'d Description,
    group: &'d JointGroup,
    element: &Element,
    owners: &mut HashMap<&'d str, &'d str>,
    report: &mut Report,
) {
    let before = report.len();
    let mut axes: Vec<Axis<'d>> = vec![];
    for (letter, name) in group.axes() {
        let joints = d.joints.iter().map(|j| j.name.as_str());
        if !must_exist("joint", name, joints, (letter, element), report) {
            continue;
        }
        refuse_second_owner(letter, name, &group.name, element, owners, report);
        axes.extend(d.joint(name).map(|joint| (letter, joint)));
    }
    refuse_wrong_types(&axes, element, report);
    if report.len() > before {
        return;
    }
    refuse_broken_path(&axes, element, report);
    if report.len() == before {
        check_shape(d, group.kind, &axes, element, report);
        check_extension(&axes, element, report);
    }
    tell_missing_axes(group, element, report);
}

fn refuse_second_owner<'d>(
    letter: &str,
    joint: &'d str,
    group: &'d str,
    element: &Element,
    owners: &mut HashMap<&'d str, &'d str>,
    report: &mut Report,
) {
    if let Some(owner) = owners.insert(joint, group) {
        let message = format!("joint '{joint}' is already an axis of the group '{owner}'");
        let mend = "a joint can be one axis of one group";
        report.add(Finding::error("joint-in-two-groups", element.place_of(letter, report), message, mend));
    }
}

fn refuse_wrong_types(axes: &[Axis], element: &Element, report: &mut Report) {
    for (letter, joint) in axes {
        let linear = *letter == "e";
        let right = match joint.kind {
            JointKind::Revolute | JointKind::Continuous => !linear,
            JointKind::Prismatic => linear,
            JointKind::Fixed => true,
            _ => false,
        };
        if !right {
            let needed = if linear { "prismatic or fixed" } else { "revolute, continuous or fixed" };
            let message = format!("joint '{}' (line {}) cannot be the axis {letter}", joint.name, joint.at.line);
            let mend = format!("the axis {letter} takes a {needed} joint");
            report.add(Finding::error("group-axis-type", element.place_of(letter, report), message, mend));
        }
    }
}

/// J-6: an axis without a joint is physically fixed. Where the type would share it, that is worth a word.
fn tell_missing_axes(group: &JointGroup, element: &Element, report: &mut Report) {
    let shared: &[&str] = match group.kind {
        GroupKind::ThreeDof => &["h", "p", "b"],
        GroupKind::Cardan => &["h", "p"],
        GroupKind::CombinedHinge => &[],
    };
    let missing: Vec<_> = shared.iter().filter(|letter| group.axes().all(|(l, _)| l != **letter)).copied().collect();
    if group.axes().next().is_none() {
        let message = "a group needs at least one of h, p, b, e".to_string();
        let mend = "name a joint, or take the group out";
        report.add(Finding::error("group-axis-missing", element.place(report), message, mend));
    } else if !missing.is_empty() {
        let message = format!("no joint is given for {}: physically fixed", missing.join(", "));
        let mend = "name the joint if that axis turns";
        report.add(Finding::note("group-axis-fixed", element.place(report), message, mend));
    }
}

fn refuse_broken_path(axes: &[Axis], element: &Element, report: &mut Report) {
    for pair in axes.windows(2) {
        let [(upper, above), (lower, below)] = pair else { continue };
        if above.child != below.parent {
            let message = format!(
                "{lower} does not follow {upper}: '{}' moves link '{}', but the parent of '{}' is '{}'",
                above.name, above.child, below.name, below.parent
            );
            let mend = format!("make '{}' the parent link of '{}' (line {})", above.child, below.name, below.at.line);
            report.add(Finding::error("group-path", element.place_of(lower, report), message, mend));
        }
    }
}

/// The rules of the type: which joints share their origin, which links are massless, which axes are perpendicular.
fn check_shape(d: &Description, kind: GroupKind, axes: &[Axis], element: &Element, report: &mut Report) {
    let shared = match kind {
        GroupKind::CombinedHinge => return,
        GroupKind::Cardan => 2,
        GroupKind::ThreeDof => 3,
    };
    let letters = &["h", "p", "b"][..shared];
    let stack: Vec<Axis> = axes.iter().filter(|(letter, _)| letters.contains(letter)).copied().collect();
    for pair in stack.windows(2) {
        let [(upper, above), (lower, below)] = pair else { continue };
        refuse_own_origin((upper, lower), below, element, report);
        if let Some(link) = d.links.iter().find(|link| link.name == above.child) {
            refuse_massive_between((upper, lower), link, element, report);
        }
        for branch in d.joints.iter().filter(|j| j.parent == above.child && j.name != below.name) {
            let message =
                format!("joint '{}' (line {}) branches off between {upper} and {lower}", branch.name, branch.at.line);
            let mend = format!("hang it on '{}' or on '{}'", above.parent, below.child);
            report.add(Finding::error("group-branch", element.place_of(lower, report), message, mend));
        }
    }
    refuse_skew_axes(&stack, element, report);
}

fn refuse_own_origin((upper, lower): (&str, &str), below: &Joint, element: &Element, report: &mut Report) {
    let offset = Vec3::from(below.origin.xyz).norm();
    if offset > TOLERANCE {
        let [x, y, z] = below.origin.xyz;
        let message = format!(
            "{upper} and {lower} must share their origin, but '{}' (line {}) has xyz=\"{x} {y} {z}\", {offset:.6} m away",
            below.name, below.at.line
        );
        let mend = "set the xyz of that <origin> to 0 0 0, or use type=\"combined_hinge\"";
        report.add(Finding::error("group-origin", element.place_of(lower, report), message, mend));
    }
}

fn refuse_massive_between((upper, lower): (&str, &str), link: &Link, element: &Element, report: &mut Report) {
    let reason = match (&link.inertial, &link.body) {
        (_, Some(_)) => "a <body>",
        (Some(_), _) => "an <inertial>",
        _ => return,
    };
    let message = format!(
        "link '{}' (line {}) between {upper} and {lower} has {reason}: it must be massless",
        link.name, link.at.line
    );
    let mend = "take that out, or use type=\"combined_hinge\"";
    report.add(Finding::error("group-mass", element.place_of(lower, report), message, mend));
}

/// At zero angles every axis of the stack is perpendicular to every other one; only the first and the last may be skew,
/// where the one between them does not move: it may be frozen at any angle (G-5).
fn refuse_skew_axes(stack: &[Axis], element: &Element, report: &mut Report) {
    let moves = |joint: &Joint| joint.kind != JointKind::Fixed;
    let pitch_moves = stack.iter().any(|(letter, joint)| *letter == "p" && moves(joint));
    let mut frame = Quat::identity();
    let mut directions: Vec<(&str, Vec3)> = vec![];
    for (i, (letter, joint)) in stack.iter().enumerate() {
        if i > 0 {
            frame *= joint.origin.rotation();
        }
        if !moves(joint) {
            continue;
        }
        let direction = frame * Vec3::from(joint.axis);
        for (other, earlier) in directions.iter().filter(|(other, _)| pitch_moves || (*other, *letter) != ("h", "b")) {
            let cosine = earlier.dot(&direction);
            if cosine.abs() > TOLERANCE {
                let angle = cosine.clamp(-1.0, 1.0).acos().to_degrees();
                let message =
                    format!("the axes {other} and {letter} are {angle:.4}° apart at zero: they must be perpendicular");
                let mend = format!("mend the <axis> or the rpy of '{}' (line {})", joint.name, joint.at.line);
                report.add(Finding::error("group-axes", element.place_of(letter, report), message, mend));
            }
        }
        directions.push((letter, direction));
    }
}

/// J-2, J-14: e slides along the line about which b turns, and between limits.
fn check_extension(axes: &[Axis], element: &Element, report: &mut Report) {
    let Some(("e", slide)) = axes.last().filter(|(_, joint)| joint.kind == JointKind::Prismatic) else { return };
    let limited = slide.limit.as_ref().is_some_and(|l| l.lower.is_finite() && l.upper.is_finite());
    if !limited {
        let message =
            format!("e is fixed or limited, but joint '{}' (line {}) has no range", slide.name, slide.at.line);
        let mend = "give it <limit lower=\"…\" upper=\"…\" effort=\"…\" velocity=\"…\"/>";
        report.add(Finding::error("group-extension-range", element.place_of("e", report), message, mend));
    }
    let Some((_, bank)) = axes.iter().find(|(letter, joint)| *letter == "b" && joint.kind != JointKind::Fixed) else {
        return;
    };
    let (along, about) = (slide.origin.rotation() * Vec3::from(slide.axis), Vec3::from(bank.axis));
    if along.cross(&about).norm() > TOLERANCE {
        let angle = along.dot(&about).abs().clamp(0.0, 1.0).acos().to_degrees();
        let message = format!("e is {angle:.4}° off the axis of b: it must lie on its extension");
        let mend = format!("mend the <axis> or the rpy of '{}' (line {})", slide.name, slide.at.line);
        report.add(Finding::error("group-extension", element.place_of("e", report), message, mend));
    }
}
