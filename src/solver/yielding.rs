//! What gives way where a follower and its leader are both locked to speeds that do not agree.

use super::axis_set::AxisSet;
use super::couplings::Pair;
use super::law::{LOWER, UPPER, WALL_LEFT, WALL_RIGHT};
use crate::dynamics::Workspace;
use crate::model::Model;

impl AxisSet {
    /// Follower and leader are both locked, to speeds that do not agree. The force between them grows until the first of
    /// them leaves its riser: that force is returned. A drive that nothing bounds yields to the other by its speed instead,
    /// the follower's before the leader's; stops do not yield.
    pub(super) fn break_loose(&mut self, m: &Model, ws: &Workspace<f64>, pair: &Pair, qdd: &[f64]) -> f64 {
        let c = pair.coupling;
        let sense = -pair.bias.signum();
        let forces =
            [(c.follower, 1.0), (c.leader, -c.ratio)].map(|(axis, factor)| self.room(m, ws, axis, factor * sense, qdd));
        let force = forces[0].min(forces[1]);
        if force.is_finite() {
            return sense * force;
        }
        let by = self.yield_by(c.follower, -pair.bias);
        let left = pair.bias + by;
        if left.abs() > pair.slack && c.ratio != 0.0 {
            self.yield_by(c.leader, left / c.ratio);
        }
        0.0
    }

    /// The force between a locked axis and its partner at which the axis leaves its riser; `factor` is the torque on it per
    /// force. Infinite if nothing bounds it, or if it is not locked.
    fn room(&self, m: &Model, ws: &Workspace<f64>, axis: usize, factor: f64, qdd: &[f64]) -> f64 {
        let (law, place) = (&self.laws[axis], self.place[axis]);
        if place.is_multiple_of(2) || factor == 0.0 {
            return f64::INFINITY;
        }
        let torque = self.riser_torque(m, ws, axis, qdd);
        let left = law.room(place / 2, torque, factor > 0.0);
        // A little beyond, so that the law sees it.
        (left.max(0.0) + 1e-6 * (1.0 + torque.abs())) / factor.abs()
    }

    /// Changes the speed of the riser that an axis stands on, if a drive without bound holds it there, as far as its stops
    /// allow; returns by how much.
    fn yield_by(&mut self, axis: usize, by: f64) -> f64 {
        let (law, place) = (&mut self.laws[axis], self.place[axis]);
        if place.is_multiple_of(2) || law.knots[place / 2].kinds & (LOWER | UPPER) != 0 {
            return 0.0;
        }
        let stops = law.knots[..law.count].iter();
        let (low, high) = stops.fold((f64::NEG_INFINITY, f64::INFINITY), |(low, high), k| match k.kinds {
            kinds if kinds & LOWER != 0 && kinds & WALL_LEFT != 0 => (k.speed.max(low), high),
            kinds if kinds & UPPER != 0 && kinds & WALL_RIGHT != 0 => (low, k.speed.min(high)),
            _ => (low, high),
        });
        let speed = &mut law.knots[place / 2].speed;
        let before = *speed;
        *speed = (before + by).max(low).min(high);
        *speed - before
    }
}
