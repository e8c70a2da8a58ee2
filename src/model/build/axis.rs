//! An axis as its joint is written.

use super::super::{Axis, AxisKind, AxisSlot, DriveLimits, Softness};
use crate::description::{Drive, DriveMode, Joint, JointKind};
use crate::math::Vec3;

pub(super) fn axis(j: &Joint, slot: AxisSlot) -> Axis {
    let limited = matches!(j.kind, JointKind::Revolute | JointKind::Prismatic);
    let limit = j.limit.as_ref();
    let range = limit.filter(|_| limited);
    let drive = j.drive.as_ref();
    Axis {
        name: j.name.clone(),
        kind: if j.kind == JointKind::Prismatic { AxisKind::Linear } else { AxisKind::Rotary },
        slot,
        direction: Vec3::from(j.axis),
        lower: range.map_or(f64::NEG_INFINITY, |l| l.lower),
        upper: range.map_or(f64::INFINITY, |l| l.upper),
        stop: stop(j),
        drive: DriveLimits::of(j),
        damping: j.damping,
        friction: j.friction,
        mode: drive.map_or(DriveMode::Idle, |d: &Drive| d.mode),
        switchable: drive.is_none_or(|d| d.switchable),
    }
}

/// Share of a stop's penetration that one step takes back where no tag says it (ODE's default error reduction).
const STOP_ERP: f64 = 0.2;

fn stop(j: &Joint) -> Softness {
    let c = j.constraint.as_ref();
    Softness { erp: c.and_then(|c| c.stop_erp).unwrap_or(STOP_ERP), cfm: c.and_then(|c| c.stop_cfm).unwrap_or(0.0) }
}
