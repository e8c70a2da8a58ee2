//! `<mimic>`: what is followed exists and moves, nothing follows itself, and ranges and drives go together.

use super::super::finding::{Finding, Place};
use super::super::report::Report;
use super::super::{Description, Joint, JointKind, Mimic};
use std::f64::consts::PI;

/// What rounding in a text may take from a range, rad or m.
const ROUNDING: f64 = 1e-6;

pub(super) fn check(d: &Description, report: &mut Report) {
    for joint in &d.joints {
        let Some(mimic) = &joint.mimic else { continue };
        let place = Place { element: format!("joint '{}' <mimic>", joint.name), at: mimic.at };
        if joint.kind == JointKind::Fixed {
            let message = "a fixed joint follows nothing: its <mimic> is ignored".to_string();
            report.add_once("", Finding::note("ignored-element", place, message, ""));
        } else if let Some(leader) = followed(d, joint, mimic, &place, report) {
            about_drive(joint, &place, report);
            about_range(joint, mimic, leader, place, report);
        }
    }
}

/// The joint that this one follows, if it can.
fn followed<'d>(
    d: &'d Description,
    joint: &Joint,
    mimic: &Mimic,
    place: &Place,
    report: &mut Report,
) -> Option<&'d Joint> {
    let find = |name: &str| d.joints.iter().find(|other| other.name == name);
    let Some(leader) = find(&mimic.joint) else {
        let message = format!("there is no joint '{}' to follow: the joint moves by itself", mimic.joint);
        report.add(Finding::warning("unknown-joint", place.clone(), message, "name an existing joint"));
        return None;
    };
    let next = |j: &&'d Joint| j.mimic.as_ref().and_then(|m| find(&m.joint));
    if std::iter::successors(Some(leader), next).take(d.joints.len()).any(|j| j.name == joint.name) {
        let message = if leader.name == joint.name {
            format!("joint '{}' follows itself", joint.name)
        } else {
            format!("joint '{}' follows '{}', which follows it in turn", joint.name, leader.name)
        };
        let mend = "let one of them move by itself: take its <mimic> out";
        report.add(Finding::error("mimic-cycle", place.clone(), message, mend));
        return None;
    }
    let manifold = |j: &&&Joint| matches!(j.kind, JointKind::Floating | JointKind::Planar | JointKind::Spherical);
    if let Some(which) = [joint, leader].iter().find(manifold) {
        let message = format!("'{}' has more than one axis: joint '{}' moves by itself", which.name, joint.name);
        let mend = "only revolute, continuous and prismatic joints can follow and be followed";
        report.add(Finding::warning("mimic-without-axis", place.clone(), message, mend));
        return None;
    }
    if leader.kind == JointKind::Fixed {
        let message = format!("'{}' is fixed: joint '{}' is held at {}", leader.name, joint.name, mimic.offset);
        report.add_once("", Finding::note("mimic-of-fixed", place.clone(), message, ""));
    }
    Some(leader)
}

/// Two drives on one degree of freedom.
fn about_drive(joint: &Joint, place: &Place, report: &mut Report) {
    if joint.drive.is_some() {
        let message =
            format!("joint '{}' has a drive of its own, which works beside the one that it follows", joint.name);
        let mend = "take the <drive> out, unless there are two motors";
        report.add(Finding::warning("mimic-drive", place.clone(), message, mend));
    }
}

/// A follower's stop stops its leader as well.
fn about_range(joint: &Joint, mimic: &Mimic, leader: &Joint, place: Place, report: &mut Report) {
    let (own, of_leader) = (range(joint), range(leader));
    let ends = [mimic.multiplier * of_leader.0 + mimic.offset, mimic.multiplier * of_leader.1 + mimic.offset];
    let needed = match leader.kind {
        JointKind::Fixed => (mimic.offset, mimic.offset),
        _ if mimic.multiplier == 0.0 => (mimic.offset, mimic.offset),
        _ => (ends[0].min(ends[1]), ends[0].max(ends[1])),
    };
    let unlimited = needed.0 == f64::NEG_INFINITY && needed.1 == f64::INFINITY;
    if unlimited || (own.0 <= needed.0 + ROUNDING && own.1 >= needed.1 - ROUNDING) {
        return;
    }
    let met = (own.0.max(needed.0), own.1.min(needed.1));
    let is = format!("joint '{}' has the range {} but follows through", joint.name, shown(own));
    if met.0 > met.1 + ROUNDING {
        let message = format!("{is} {}: the two never meet", shown(needed));
        let mend = "mend the range, the multiplier or the offset";
        report.add(Finding::error("mimic-range", place, message, mend));
    } else {
        let ends = [met.0, met.1].map(|end| (end - mimic.offset) / mimic.multiplier);
        let left = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let message = format!("{is} {}: it leaves '{}' only {}", shown(needed), leader.name, shown(left));
        let mend = "widen its <limit>, or mend the sign of the multiplier, if that is not meant";
        report.add(Finding::warning("mimic-range", place, message, mend));
    }
}

fn range(joint: &Joint) -> (f64, f64) {
    let limited = matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic);
    let limit = joint.limit.as_ref().filter(|_| limited);
    limit.map_or((f64::NEG_INFINITY, f64::INFINITY), |l| (l.lower, l.upper))
}

fn shown((low, high): (f64, f64)) -> String {
    let number =
        |x: f64| if x.abs() < 1e3 * PI { format!("{}", (x * 1e6).round() / 1e6 + 0.0) } else { format!("{x:e}") };
    format!("{} to {}", number(low), number(high))
}
