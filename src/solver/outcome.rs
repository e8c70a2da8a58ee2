//! What an implicit step has come to on the axes: where they stand, what drives gave, who paid.

use super::axis_set::AxisSet;
use crate::dynamics::Workspace;
use crate::model::{Axis, Model};

impl AxisSet {
    /// Ends an implicit step of `h` seconds with these accelerations: remembers the places, writes efforts and work. `q` (nq) is
    /// the state of the last pass.
    pub fn finish(&mut self, m: &Model, ws: &Workspace<f64>, q: &[f64], (h, qdd): (f64, &[f64])) {
        self.paid.fill((0.0, 0.0));
        self.settle_contests();
        self.damped = (0.0, 0.0);
        for (i, axis) in m.axes.iter().enumerate() {
            if self.between[i].on {
                self.finish_between(i, (h, qdd));
            } else if !self.rests(i) {
                self.finish_axis(m, ws, (i, axis), q, (h, qdd));
            }
        }
    }

    fn finish_axis(
        &mut self,
        m: &Model,
        ws: &Workspace<f64>,
        (i, axis): (usize, &Axis),
        q: &[f64],
        (h, qdd): (f64, &[f64]),
    ) {
        let (law, place) = (&self.laws[i], self.place[i]);
        let acceleration = self.axis_rate(m, axis, qdd);
        let end = self.speed[i] + h * acceleration;
        let moved = if self.at_end[i] { end } else { 0.5 * (self.speed[i] + end) };
        let k = place / 2;
        let (effort, total) = if place % 2 == 1 {
            let (total, speed) = (self.riser_torque(m, ws, i, qdd), law.knots[k].speed);
            self.memory[i] = law.knots[k].kinds;
            (law.drive_torque(speed, Some((k, total))), total)
        } else {
            let torques = (law.drive_torque(moved, None), law.on_segment(k, moved));
            self.memory[i] = 0;
            if law.is_servo() {
                self.brakes[i].mobility = self.whole_mobility(m, ws, q, i);
            }
            torques
        };
        self.brakes[i].drift = acceleration - self.brakes[i].mobility * effort;
        self.books.effort[i] = effort;
        let pays = total - if self.is_stopped(i) { self.unpaid(i, end, total) } else { 0.0 };
        self.paid[i] = (0.5 * h * pays * self.speed[i], 0.5 * h * pays * end);
        self.books.work.book(effort, total, 0.5 * h * (self.speed[i] + end));
    }

    /// The torque of a hard stop that would do work. None does: the axis came back from it, and again to it, in one step.
    fn unpaid(&self, i: usize, end: f64, total: f64) -> f64 {
        let wall = self.laws[i].at_walls(self.place[i] / 2, total);
        if wall * (self.speed[i] + end) > 0.0 { wall } else { 0.0 }
    }

    /// Did an axis stand on a hard stop in the step that was finished last?
    pub fn is_stopped(&self, axis: usize) -> bool {
        let place = self.place[axis];
        place % 2 == 1 && !self.rests(axis) && self.laws[axis].is_hard_stop(place / 2)
    }

    /// Work of the laws in the step that was finished last, J: with the speeds at its start, and at its end.
    pub fn paid(&self) -> (f64, f64) {
        self.paid.iter().fold(self.damped, |sum, p| (sum.0 + p.0, sum.1 + p.1))
    }

    /// The same per axis, then per direction in which a joint yields.
    pub fn paid_by(&self) -> &[(f64, f64)] {
        &self.paid
    }
}
