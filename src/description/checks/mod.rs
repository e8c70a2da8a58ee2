//! Checks over the whole description, after all items have been read.

mod chains;
mod groups;
mod inertias;
mod masses;
mod mimic;
mod names;
mod ranges;
mod rigid;
mod rigs;
mod sides;
mod softness;
mod tree;

use super::Description;
use super::control;
use super::element::Element;
use super::finding::Place;
use super::report::Report;
use super::tags::robot::RobotTags;
use super::{Joint, JointKind, Link};

/// Runs all checks. `all_joints_read` is false if joints are missing from the description because of faults
/// already reported.
pub(super) fn run(d: &Description, robot: &Element, tags: &RobotTags, all_joints_read: bool, report: &mut Report) {
    names::check(d, report);
    let tree = tree::check(d, robot, all_joints_read, report);
    inertias::check(d, robot, tree.as_ref(), report);
    masses::check(d, tree.as_ref(), report);
    groups::check(d, tags, report);
    chains::check(d, tags, tree.is_some(), report);
    rigs::check(d, tags, report);
    mimic::check(d, report);
    ranges::check(d, report);
    sides::check(d, report);
    softness::check(d, report);
    let moves = |name: &str| d.joint(name).is_some_and(|joint| joint.kind != JointKind::Fixed);
    control::check(&d.controls, moves, report);
}

fn place_of_link(link: &Link) -> Place {
    Place { element: format!("link '{}'", link.name), at: link.at }
}

fn place_of_joint(joint: &Joint) -> Place {
    Place { element: format!("joint '{}'", joint.name), at: joint.at }
}
