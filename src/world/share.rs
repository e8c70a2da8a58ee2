//! Worlds of one model.

use super::World;
use crate::model::Bodies;
use std::sync::Arc;

impl World {
    /// Takes over these bodies, if its own are the same: who computes many worlds in common passes
    /// ([`take_turns`](crate::dynamics::take_turns)) sees then at once that they are.
    pub fn share(&mut self, bodies: &Bodies) {
        if self.model.bodies != *bodies || self.model.bodies.is_shared_with(bodies) {
            return;
        }
        let whole = Arc::ptr_eq(&self.breaking.intact, &self.model);
        Arc::make_mut(&mut self.model).bodies = bodies.clone();
        if whole {
            self.breaking.intact = self.model.clone();
        }
    }
}
