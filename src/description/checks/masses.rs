//! Mass: where it comes from, and that there is some for every moving link.

use super::super::finding::{Finding, Place};
use super::super::report::Report;
use super::super::{Description, JointKind, Link, PlacedShape, shapes};
use super::tree::Tree;
use super::{place_of_joint, place_of_link};

/// All checks of mass; those over subtrees only if there is a tree.
pub(super) fn check(d: &Description, tree: Option<&Tree>, report: &mut Report) {
    for link in &d.links {
        check_body(link, report);
    }
    if let Some(tree) = tree {
        refuse_massless_leaves(d, tree, report);
        refuse_static_moving(d, tree, report);
    }
}

fn check_body(link: &Link, report: &mut Report) {
    let Some(body) = &link.body else { return };
    let exact = |v: &&PlacedShape| !v.may_be_polygonised(body.substance.dimension);
    if body.substance.polygonise.is_some()
        && body.shapes.is_empty()
        && let Some(visual) = link.visuals.iter().find(exact)
    {
        let place = Place { element: format!("link '{}' <visual>", link.name), at: visual.at };
        report.add(shapes::not_polygonised(place, visual.geometry.kind()));
    }
    let place = Place { element: format!("link '{}' <body>", link.name), at: body.at };
    if body.shapes.is_empty() && body.misread == 0 && link.visuals.is_empty() {
        let message = "there is no shape to compute the mass from".to_string();
        let mend = "add a <visual>, or a <shape> inside <body>";
        report.add(Finding::error("body-without-shape", place, message, mend));
    } else if link.inertial.is_some() {
        let message = "the link has <inertial> as well: <body> wins".to_string();
        report.add_once("", Finding::note("body-over-inertial", place, message, "take out the one that is not meant"));
    }
}

fn has_mass(link: &Link) -> bool {
    match (&link.body, &link.inertial) {
        (Some(body), _) => body.substance.specific_gravity > 0.0,
        (None, Some(inertial)) => inertial.mass != 0.0 || inertial.inertia.iter().any(|i| *i != 0.0),
        (None, None) => false,
    }
}

/// A moving link must carry mass, itself or further out: else nothing resists its axis.
fn refuse_massless_leaves(d: &Description, tree: &Tree, report: &mut Report) {
    let mut carries = d.links.iter().map(has_mass).collect::<Vec<_>>();
    for start in 0..d.links.len() {
        let mut link = start;
        while carries[link] {
            let Some(joint) = tree.joint_above[link] else { break };
            link = tree.ends[joint].0;
            if carries[link] {
                break;
            }
            carries[link] = true;
        }
    }
    for (joint, (parent, child)) in d.joints.iter().zip(&tree.ends) {
        // Further out in a branch without mass it is the same fault again.
        let outermost = carries[*parent] || tree.joint_above[*parent].is_none();
        if joint.kind != JointKind::Fixed && !carries[*child] && outermost {
            let message = format!(
                "joint '{}' moves link '{}', but neither it nor what hangs on it has mass",
                joint.name, joint.child
            );
            let mend = "give the link an <inertial> or a <body>, or make the joint fixed";
            report.add_once("", Finding::error("massless-leaf", place_of_joint(joint), message, mend));
        }
    }
}

/// Specific gravity 0 means static (B-2): that is for links that are fixed to the root.
fn refuse_static_moving(d: &Description, tree: &Tree, report: &mut Report) {
    for (start, link) in d.links.iter().enumerate() {
        if link.body.as_ref().is_none_or(|body| body.substance.specific_gravity > 0.0) {
            continue;
        }
        let mut above = start;
        while let Some(joint) = tree.joint_above[above] {
            if d.joints[joint].kind != JointKind::Fixed {
                let message = format!(
                    "specific_gravity = 0 makes the body static, but joint '{}' moves it",
                    d.joints[joint].name
                );
                let mend = "give its specific gravity; for a link without mass take <body> out";
                report.add(Finding::error("static-body-moves", place_of_link(link), message, mend));
                break;
            }
            above = tree.ends[joint].0;
        }
    }
}
