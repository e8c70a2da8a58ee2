//! Whether the settings of a joint are valid, and why not (J-5).

use crate::dynamics::singular_axes;
use crate::model::{AxisSlot, Model};
use crate::world::Mode;
use std::f64::consts::FRAC_PI_2;

/// What rounding in a text may add to a bound, rad.
const ROUNDING: f64 = 1e-6;

/// Per axis, in the order of the model: what keeps it from working as it is set; valid if there is nothing.
pub fn axis_faults(m: &Model) -> Vec<Vec<String>> {
    let singular = singular_axes(m);
    (0..m.axes.len()).map(|axis| faults(m, axis, &singular)).collect()
}

fn faults(m: &Model, axis: usize, singular: &[usize]) -> Vec<String> {
    let a = &m.axes[axis];
    let mut told = vec![];
    if a.lower >= a.upper {
        told.push(format!("the range is {} to {}: the axis cannot move", a.lower, a.upper));
    }
    if matches!(a.slot, AxisSlot::Euler { angle: 1, .. }) && a.lower.abs().max(a.upper.abs()) > FRAC_PI_2 + ROUNDING {
        told.push(format!("the pitch of a 3dof group goes from {} to {}, beyond ±90°", a.lower, a.upper));
    }
    if a.drive.max_torque <= 0.0 && a.mode != Mode::Idle {
        told.push("the drive has a mode but no torque: its maximum torque is 0".into());
    } else if a.mode != Mode::Idle && a.drive.static_resistance >= a.drive.max_torque {
        let (resistance, torque) = (a.drive.static_resistance, a.drive.max_torque);
        told.push(format!("the drive never starts: static resistance {resistance}, maximum torque {torque}"));
    }
    if m.carrier(axis).is_some_and(|body| singular.contains(&body)) {
        told.push("what moves here has no inertia: the mass matrix is singular".into());
    }
    if matches!(a.slot, AxisSlot::Apart { .. }) {
        told.push("the joint has come apart".into());
    }
    told
}
