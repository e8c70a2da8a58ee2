//! G-4: the range of an axis of ours does not straddle ±180°.

use super::super::finding::{Finding, Place};
use super::super::report::Report;
use super::super::{Description, GroupKind, Joint, JointKind};
use std::f64::consts::{FRAC_PI_2, PI};

/// What rounding in a text may add to a bound, rad.
const ROUNDING: f64 = 1e-6;

/// Ranges of axes that are in a group or have a drive; plain URDF joints may turn as far as they like.
pub(super) fn check(d: &Description, report: &mut Report) {
    let rotary = |joint: &&Joint| matches!(joint.kind, JointKind::Revolute | JointKind::Continuous);
    for joint in d.joints.iter().filter(rotary) {
        let name = Some(joint.name.as_str());
        let grouped = |g: &&super::super::JointGroup| [&g.h, &g.p, &g.b].iter().any(|axis| axis.as_deref() == name);
        match d.groups.iter().find(grouped) {
            Some(g) if g.kind == GroupKind::ThreeDof && g.p.as_deref() == name => {
                let reason = format!("it is the pitch axis of the 3dof group '{}', which is limited to ±90°", g.name);
                refuse_beyond(FRAC_PI_2, joint, &reason, report);
            }
            Some(g) => refuse_beyond(PI, joint, &format!("it is an axis of the group '{}'", g.name), report),
            None if joint.drive.is_some() => refuse_beyond(PI, joint, "it has a <drive>", report),
            None => {}
        }
    }
}

fn refuse_beyond(bound: f64, joint: &Joint, reason: &str, report: &mut Report) {
    let degrees = bound.to_degrees();
    let limit = joint.limit.as_ref().filter(|_| joint.kind == JointKind::Revolute);
    let Some(limit) = limit else {
        if bound < PI {
            let place = super::place_of_joint(joint);
            let message = format!("joint '{}' has no range: {reason}", joint.name);
            let mend = format!("make it revolute, with a <limit> that stays within ±{bound:.8}");
            report.add(Finding::error("range-too-wide", place, message, mend));
        }
        return;
    };
    if limit.lower >= -bound - ROUNDING && limit.upper <= bound + ROUNDING {
        return;
    }
    let place = Place { element: format!("joint '{}' <limit>", joint.name), at: limit.at };
    let message = format!(
        "the range {} to {} rad ({:.1}° to {:.1}°) goes beyond ±{degrees:.0}°: {reason}",
        limit.lower,
        limit.upper,
        limit.lower.to_degrees(),
        limit.upper.to_degrees()
    );
    let turn = if bound < PI { "" } else { ", or move the zero of the joint (its <origin>), or make it continuous" };
    let mend = format!("keep it within ±{bound:.8}{turn}");
    report.add(Finding::error("range-too-wide", place, message, mend));
}
