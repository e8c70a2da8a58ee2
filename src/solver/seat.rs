//! The joint of an axis, and forces along it.

use super::axis_set::AxisSet;
use crate::dynamics::Push;
use crate::model::{AxisSlot, EulerRates, Model};

/// The joint of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seat {
    body: usize,
    /// Which of the joint's velocities; an angle of a group uses all.
    index: usize,
}

impl Seat {
    /// `None` if the joint has come apart.
    pub fn of(m: &Model, axis: usize) -> Option<Self> {
        let body = m.carrier(axis)?;
        let index = if let AxisSlot::Scalar { v, .. } = m.axes[axis].slot { v - m.bodies[body].v } else { 0 };
        Some(Self { body, index })
    }

    pub fn body(&self) -> usize {
        self.body
    }

    /// The force that is `factor` along this joint's axis in a slot.
    pub fn push(&self, slot: &AxisSlot, rates: &[EulerRates], factor: f64) -> Push {
        let mut push = Push { body: self.body, ..Push::default() };
        if let AxisSlot::Euler { group, angle } = slot {
            let g = rates[*group].gradient[*angle] * factor;
            push.own[..3].copy_from_slice(&[g.x, g.y, g.z]);
        } else {
            push.own[self.index] = factor;
        }
        push
    }
}

impl AxisSet {
    /// The force that is `factor` along an axis.
    pub(super) fn push_of(&self, m: &Model, axis: usize, seat: Seat, factor: f64) -> Push {
        seat.push(&m.axes[axis].slot, &self.rates, factor)
    }
}
