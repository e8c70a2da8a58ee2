//! The axis set after a joint has come apart.

use super::AxisSet;
use crate::model::{AxisSlot, Model};

impl AxisSet {
    /// Goes on with a model of the same axes, some of which have come apart: those forget what they did. Allocates nothing.
    pub fn refit(&mut self, m: &Model) {
        self.rates.truncate(m.eulers.len());
        for (i, axis) in m.axes.iter().enumerate() {
            if matches!(axis.slot, AxisSlot::Apart { .. }) {
                (self.memory[i], self.effort[i], self.speed[i]) = (0, 0.0, 0.0);
            }
        }
    }
}
