//! Explicit steps: while every axis slides on its segment or stands still, the laws are smooth functions of the state and a
//! method of high order may take the step. A standing axis (at rest in its friction, on its stop, at its target) is locked
//! with no acceleration by the hybrid dynamics; whether its reaction fits is checked at every stage.

use super::axis_set::{AxisSet, StateRef};
use super::inputs::{Input, clear_balls};
use crate::dynamics::Workspace;
use crate::model::{AxisSlot, Model};

/// Slower than this is still, rad/s or m/s.
const STILL: f64 = 1e-12;
/// Viscous terms must be slower than this share of 1/h. The classical method of order 4 is stable to 2.8.
const STIFF: f64 = 0.5;

impl AxisSet {
    /// True if every axis slides on a segment or stands still at the beginning of the step, and no joint is soft.
    pub fn is_smooth(&self, m: &Model) -> bool {
        m.softs.is_empty() && (0..self.laws.len()).all(|i| self.place[i].is_multiple_of(2) || self.is_still(i))
    }

    fn is_still(&self, i: usize) -> bool {
        self.laws[i].knots[self.place[i] / 2].speed.abs() <= STILL && self.speed[i].abs() <= STILL
    }

    /// Writes the laws at a state into the inputs of the hybrid dynamics, explicitly.
    pub fn write_smooth(&mut self, m: &Model, ws: &mut Workspace<f64>, s: StateRef) {
        self.update_rates(m, s.angles);
        clear_balls(ws);
        for (i, axis) in m.axes.iter().enumerate() {
            self.turning[i] = match axis.slot {
                AxisSlot::Euler { group, angle } if self.place[i] % 2 == 1 || self.rotor[i] > 0.0 => {
                    self.rates[group].gradient[angle].dot(self.turning(m, s, group))
                }
                _ => 0.0,
            };
            let input = if self.place[i] % 2 == 1 {
                Input::Locked(self.turning[i])
            } else {
                let (_, v) = self.axis_state(m, axis, s);
                let torque = self.laws[i].on_segment(self.place[i] / 2, v);
                Input::Sliding { torque: torque + self.rotor[i] * self.turning[i], diagonal: self.rotor[i] }
            };
            self.write(m, ws, i, input);
        }
    }

    /// After a stage: do the reactions of the standing axes fit?
    pub fn stage_fits(&self, m: &Model, ws: &Workspace<f64>, qdd: &[f64]) -> bool {
        (0..self.laws.len())
            .filter(|i| self.place[*i] % 2 == 1)
            .all(|i| self.laws[i].leaves_riser(self.place[i] / 2, self.riser_torque(m, ws, i, qdd)) == 0)
    }

    /// After the first stage, whose state is `q` (nq): is no viscous term too stiff for a step of `h`?
    pub fn is_soft_enough(&mut self, m: &Model, ws: &Workspace<f64>, q: &[f64], h: f64) -> bool {
        if let Some(answers) = &mut self.answers {
            answers.forget();
        }
        (0..self.laws.len()).all(|i| {
            let slope = self.laws[i].segments[self.place[i] / 2].slope;
            let sliding = self.place[i].is_multiple_of(2) && slope > 0.0;
            !sliding || slope * h * self.whole_mobility(m, ws, q, i) < STIFF
        })
    }

    /// True if after the step every sliding axis is still on its segment, and inside its stops.
    pub fn stayed_smooth(&mut self, m: &Model, s: StateRef) -> bool {
        self.update_rates(m, s.angles);
        (0..self.laws.len()).filter(|i| self.place[*i].is_multiple_of(2)).all(|i| {
            let (q, v) = self.axis_state(m, &m.axes[i], s);
            let (law, axis) = (&self.laws[i], &m.axes[i]);
            let inside = !law.has_stop() || (q > axis.lower && q < axis.upper);
            inside && law.stays_between_knots(self.place[i] / 2, v)
        })
    }

    /// Ends an explicit step of `h` seconds at the state `s`: remembers who stands, writes efforts and work. `ws` and `qdd` are
    /// those of the last stage.
    pub fn finish_smooth(&mut self, m: &Model, ws: &Workspace<f64>, (s, h): (StateRef, f64), qdd: &[f64]) {
        self.end_smooth(m, ws, s, qdd);
        for (i, axis) in m.axes.iter().enumerate().filter(|(i, _)| self.place[*i].is_multiple_of(2)) {
            let (law, mean) = (&self.laws[i], 0.5 * (self.speed[i] + self.axis_state(m, axis, s).1));
            let total = law.on_segment(self.place[i] / 2, mean);
            self.books.work.book(law.drive_torque(mean, None), total, h * mean);
        }
    }
}
