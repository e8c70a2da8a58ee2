//! What is recorded of one instant.

use crate::dynamics::Momentum;
use crate::world::{Snapshot, World};

/// One instant of a world; made once, then filled again and again.
pub struct Sample {
    /// State of axes and links, energies (J), stamp.
    pub snapshot: Snapshot,
    /// In the world frame, angular about the common centre of mass.
    pub momentum: Momentum,
}

impl Sample {
    /// The present state.
    pub fn new(world: &World) -> Self {
        Self { snapshot: world.new_snapshot(), momentum: world.momentum() }
    }

    /// Takes the present state; allocates nothing.
    pub fn take(&mut self, world: &World) {
        world.write_snapshot(&mut self.snapshot);
        self.momentum = world.momentum();
    }

    /// True if every value is a finite number.
    pub fn is_finite(&self) -> bool {
        let s = &self.snapshot;
        let axes = s.position.iter().chain(&s.velocity).chain(&s.effort);
        let poses = s.link_pose.iter().flat_map(|p| p.translation.vector.iter().chain(p.rotation.coords.iter()));
        let twists = s.link_twist.iter().flat_map(|t| t.angular.iter().chain(t.linear.iter()));
        let sums = [s.kinetic_energy, s.potential_energy];
        let momenta = self.momentum.angular.iter().chain(self.momentum.linear.iter());
        s.finite && axes.chain(poses).chain(twists).chain(&sums).chain(momenta).all(|x| x.is_finite())
    }
}
