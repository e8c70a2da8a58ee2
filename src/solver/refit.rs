//! The axis set after joints have come apart, or have been made whole again.

use super::AxisSet;
use super::between::Between;
use super::couplings::Couplings;
use super::mobility::Answers;
use crate::model::{AxisSlot, Model};

impl AxisSet {
    /// Goes on with a model of the same axes. Those that have come apart forget what they did. Allocates where the model has more
    /// coordinates than the one before.
    pub fn refit(&mut self, m: &Model) {
        self.rates.resize(m.eulers.len(), Default::default());
        self.weight.resize(m.nv, 1.0);
        self.paid.resize(m.axes.len() + m.softs.len(), (0.0, 0.0));
        self.couplings = Couplings::new(m);
        self.between = Between::all(m);
        self.laws.iter_mut().for_each(|law| law.plain = false);
        self.answers = Some(Box::new(Answers::new(m)));
        for (i, axis) in m.axes.iter().enumerate() {
            if matches!(axis.slot, AxisSlot::Apart { .. }) {
                (self.memory[i], self.books.effort[i], self.speed[i]) = (0, 0.0, 0.0);
            }
        }
    }
}
