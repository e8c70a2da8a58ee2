//! Masses and inertias: possible ones, and enough of them for every moving link.

use super::super::finding::{Finding, Place};
use super::super::report::Report;
use super::super::{Description, Inertial, JointKind, Link};
use super::tree::Tree;
use super::{place_of_joint, place_of_link};
use crate::math::Mat3;

/// Relative to the greatest principal moment: what rounding in a text may take from an inertia.
const ROUNDING: f64 = 1e-3;
/// A principal moment below −this × the greatest one makes the inertia no inertia.
const NEGATIVE: f64 = 1e-6;
/// The greatest principal moment can be no more than the sum of the others; beyond this factor it is an error.
const TRIANGLE_FACTOR: f64 = 2.0;

/// All checks of mass; those over subtrees only if there is a tree.
pub(super) fn check(d: &Description, tree: Option<&Tree>, report: &mut Report) {
    for link in &d.links {
        if let Some(inertial) = &link.inertial {
            check_inertial(link, inertial, report);
        }
        check_body(link, report);
    }
    if let Some(tree) = tree {
        refuse_massless_leaves(d, tree, report);
        refuse_static_moving(d, tree, report);
    }
}

fn check_inertial(link: &Link, inertial: &Inertial, report: &mut Report) {
    let place = Place { element: format!("link '{}' <inertial>", link.name), at: inertial.at };
    if inertial.mass < 0.0 {
        let message = format!("the mass is negative: {} kg", inertial.mass);
        report.add(Finding::error("negative-mass", place.clone(), message, "a mass is 0 or greater"));
    }
    let zero = inertial.inertia.iter().all(|i| *i == 0.0);
    if zero && inertial.mass > 0.0 {
        let message = format!("{} kg with no inertia: simulated as a point mass", inertial.mass);
        let mend = "give the inertia about the centre of mass";
        report.add_once("", Finding::warning("zero-inertia", place, message, mend));
    } else if !zero && inertial.mass == 0.0 {
        let message = "an inertia without a mass".to_string();
        report.add_once("", Finding::warning("inertia-without-mass", place, message, "give the mass, or make both 0"));
    } else if !zero {
        report_impossible_inertia(inertial.inertia, place, report);
    }
}

fn report_impossible_inertia(inertia: [f64; 6], place: Place, report: &mut Report) {
    let [a, b, c] = principal_moments(inertia);
    let shown = format!("the principal moments are {a:.4e}, {b:.4e}, {c:.4e} kg·m²");
    let mend = "compute it anew about the centre of mass; check the signs of ixy, ixz, iyz, and the units (kg·m²)";
    if a < -NEGATIVE * c.abs() {
        let message = format!("this is no inertia: {shown}, none may be negative");
        report.add(Finding::error("no-inertia", place, message, mend));
    } else if c > TRIANGLE_FACTOR * (a + b) {
        let message = format!("this is no inertia: {shown}, none may exceed the sum of the other two");
        report.add(Finding::error("no-inertia", place, message, mend));
    } else if c > (a + b) * (1.0 + ROUNDING) {
        let message = format!("no real body has this inertia: {shown}, none may exceed the sum of the other two");
        report.add_once("", Finding::warning("odd-inertia", place, message, mend));
    }
}

/// Ascending.
fn principal_moments([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [f64; 3] {
    let tensor = Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    // Scaled, so that neither squares nor their sums overflow.
    let scale = tensor.amax();
    let moments = (tensor / scale).symmetric_eigenvalues() * scale;
    let mut sorted = [moments.x, moments.y, moments.z];
    sorted.sort_by(f64::total_cmp);
    sorted
}

fn check_body(link: &Link, report: &mut Report) {
    let Some(body) = &link.body else { return };
    let place = Place { element: format!("link '{}' <body>", link.name), at: body.at };
    if body.shapes.is_empty() && link.visuals.is_empty() {
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
        (Some(body), _) => body.specific_gravity > 0.0,
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
    for (joint, (_, child)) in d.joints.iter().zip(&tree.ends) {
        if joint.kind != JointKind::Fixed && !carries[*child] {
            let message = format!(
                "joint '{}' moves link '{}', but neither it nor what hangs on it has mass",
                joint.name, joint.child
            );
            let mend = "give the link an <inertial> or a <body>, or make the joint fixed";
            report.add(Finding::error("massless-leaf", place_of_joint(joint), message, mend));
        }
    }
}

/// Specific gravity 0 means static (B-2): that is for links that are fixed to the root.
fn refuse_static_moving(d: &Description, tree: &Tree, report: &mut Report) {
    for (start, link) in d.links.iter().enumerate() {
        if link.body.as_ref().is_none_or(|body| body.specific_gravity > 0.0) {
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
