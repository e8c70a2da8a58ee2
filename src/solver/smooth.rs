//! Explicit steps: while every axis slides on its flat or stands still, the laws are smooth functions of the state and a
//! method of high order may take the step. A standing axis (at rest in its friction, on its stop, at its target) is locked
//! with no acceleration by the hybrid dynamics; whether its reaction fits is checked at every stage.

use super::axis_set::{AxisSet, Input, StateRef, clear_balls};
use super::law::{LOWER, Law, UPPER};
use crate::dynamics::Workspace;
use crate::math::V3;
use crate::model::{AxisSlot, Model};

/// Slower than this is still, rad/s or m/s.
const STILL: f64 = 1e-12;
/// Viscous terms must be slower than this share of 1/h. The classical method of order 4 is stable to 2.8; the rate is
/// taken with the base of the axis held, which underestimates it.
const STIFF: f64 = 0.5;

impl AxisSet {
    /// True if every axis slides on a flat or stands still at the beginning of the step.
    pub fn is_smooth(&self) -> bool {
        (0..self.laws.len()).all(|i| self.place[i].is_multiple_of(2) || self.is_still(i))
    }

    fn is_still(&self, i: usize) -> bool {
        self.laws[i].risers[self.place[i] / 2].speed.abs() <= STILL && self.speed[i].abs() <= STILL
    }

    /// Writes the laws at a state into the inputs of the hybrid dynamics, explicitly.
    pub fn write_smooth(&mut self, m: &Model, ws: &mut Workspace<f64>, s: StateRef) {
        self.update_rates(m, s);
        clear_balls(ws);
        for (i, axis) in m.axes.iter().enumerate() {
            let input = match (self.place[i] % 2 == 1, axis.slot) {
                (false, _) => {
                    let (_, v) = self.axis_state(m, axis, s);
                    let torque = self.laws[i].flat(self.place[i] / 2) - self.laws[i].slope * v;
                    Input::Sliding { torque, diagonal: 0.0 }
                }
                (true, AxisSlot::Scalar { .. } | AxisSlot::Apart { .. }) => Input::Locked(0.0),
                (true, AxisSlot::Euler { group, angle }) => {
                    Input::Locked(self.rates[group].gradient[angle].dot(self.turning(m, s, group)))
                }
            };
            self.write(m, ws, i, input);
        }
    }

    /// The part of ω̇ of a group that the turning of its own axes makes: an angle at constant rate has `g·ω̇ = g·turning`.
    fn turning(&self, m: &Model, s: StateRef, group: usize) -> V3<f64> {
        let e = &m.eulers[group];
        let w = V3::new(s.v[e.v], s.v[e.v + 1], s.v[e.v + 2]);
        e.direction_rates(s.angles[group], self.rates[group].gradient.map(|g| g.dot(w)))
    }

    /// After a stage: do the reactions of the standing axes fit, and is no viscous term too stiff for a step of `h`?
    pub fn stage_fits(&self, m: &Model, ws: &Workspace<f64>, h: f64) -> bool {
        (0..self.laws.len()).all(|i| {
            if self.place[i] % 2 == 1 {
                return self.laws[i].step(self.place[i], 0.0, self.reaction(m, ws, i)) == 0;
            }
            let slope = self.laws[i].slope;
            slope == 0.0 || slope * h * ws.mobility(m, i) < STIFF
        })
    }

    /// True if after the step every sliding axis is still on its flat, and inside its stops.
    pub fn stayed_smooth(&mut self, m: &Model, s: StateRef) -> bool {
        self.update_rates(m, s);
        (0..self.laws.len()).filter(|i| self.place[*i].is_multiple_of(2)).all(|i| {
            let (q, v) = self.axis_state(m, &m.axes[i], s);
            let (law, axis) = (&self.laws[i], &m.axes[i]);
            let inside = law.stopless() || (q > axis.lower && q < axis.upper);
            inside && law.stays_beside_stops(self.place[i], v)
        })
    }

    /// Ends an explicit step: remembers who stands, writes the efforts. `ws` is that of the last stage.
    pub fn finish_smooth(&mut self, m: &Model, ws: &Workspace<f64>, s: StateRef) {
        for (i, axis) in m.axes.iter().enumerate() {
            let (_, v) = self.axis_state(m, axis, s);
            let k = self.place[i] / 2;
            let standing = self.place[i] % 2 == 1;
            self.memory[i] = if standing { self.laws[i].risers[k].kinds } else { 0 };
            let riser = standing.then(|| (k, self.reaction(m, ws, i)));
            self.effort[i] = self.laws[i].drive_torque(v, riser);
        }
    }
}

impl Law {
    /// True if speed `v` is still on this flat; stops are checked by position instead.
    fn stays_beside_stops(&self, place: usize, v: f64) -> bool {
        let k = place / 2;
        let counts = |r: usize| self.risers[r].kinds & (LOWER | UPPER) == 0;
        let below = k > 0 && counts(k - 1) && v <= self.risers[k - 1].speed;
        let above = k < self.count && counts(k) && v >= self.risers[k].speed;
        !below && !above
    }
}
