//! Axes whose place in their law depends on contacts: what a standing leg's friction holds depends on what the ground gives, and the
//! ground on the friction. Moving one after the other from place to place need not end, where contacts share a load in
//! many ways. So beside contacts an axis that does not fit its law twice becomes a row for the rest of the step: its riser is
//! an impulse between the torques at the riser's ends, found together with those of the contacts.

use super::axis_set::AxisSet;
use super::inputs::Input;
use super::rows::{Kind, Rows};
use super::seat::Seat;
use crate::dynamics::{Push, Response, Workspace};
use crate::model::Model;

/// An axis that is a row.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contest {
    /// Is it?
    pub on: bool,
    block: usize,
    push: Push,
    /// N·m·s or N·s, beside `base`.
    impulse: f64,
    /// Torque that acts in any case.
    base: f64,
    lower: f64,
    upper: f64,
}

impl AxisSet {
    /// Is an axis a row?
    #[inline(always)]
    pub(super) fn is_contested(&self, axis: usize) -> bool {
        self.contests.get(axis).is_some_and(|c| c.on)
    }

    /// Puts an axis, that leaves its place to this side, on the riser there, as a row. False if there is no riser.
    pub(super) fn contest(&mut self, axis: usize, side: isize) -> bool {
        let place = self.place[axis];
        let next = self.laws[axis].neighbour(place, side);
        let riser = if place % 2 == 1 && !self.is_contested(axis) { place } else { next };
        if riser % 2 == 0 {
            return false;
        }
        self.laws[axis].hold(riser);
        self.place[axis] = riser;
        self.at_end[axis] = true;
        self.contests[axis] = Contest { on: true, ..Contest::default() };
        true
    }

    /// What the hybrid dynamics get of an axis that is a row, in a step of `h`.
    pub(super) fn contested_input(&mut self, axis: usize, h: f64) -> Input {
        let (law, k) = (&self.laws[axis], self.place[axis] / 2);
        let (left, right) = law.held(k);
        // No torque, if that is between the ends: rows that are given up leave the axis alone.
        let base = 0.0_f64.max(right).min(left);
        let c = &mut self.contests[axis];
        (c.base, c.lower, c.upper) = (base, (right - base) * h, (left - base) * h);
        let slope = law.segments[k].slope;
        let torque = base - slope * (self.speed[axis] - law.knots[k].speed) + self.rotor[axis] * self.turning[axis];
        Input::Sliding { torque, diagonal: slope * h + self.rotor[axis] }
    }

    /// Adds the rows of these axes, for velocities `v₀ + h qdd` without them.
    pub(super) fn write_contests(
        &mut self,
        m: &Model,
        ws: &Workspace<f64>,
        (response, rows): (&mut Response, &mut Rows),
        (q, h, qdd): (&[f64], f64, &[f64]),
    ) {
        for axis in 0..m.axes.len() {
            if !self.is_contested(axis) {
                continue;
            }
            let Some(seat) = Seat::of(m, axis) else { continue };
            let push = self.push_of(m, axis, seat, 1.0);
            let c = &mut self.contests[axis];
            c.push = push;
            c.block = rows.add(Kind::Bounds { lower: c.lower, upper: c.upper }, 1, response.layout.chunks(push.body));
            response.row(m, ws, q, &[push, Push::default()], rows.response(c.block, 0));
            let (block, impulse) = (c.block, c.impulse);
            let end = self.speed[axis] + h * self.axis_rate(m, &m.axes[axis], qdd);
            let row = rows.row(block, 0);
            row.bias = end - self.laws[axis].knots[self.place[axis] / 2].speed;
            row.impulse = impulse;
            rows.seal(block);
        }
    }

    /// Takes their impulses over and pushes with them.
    pub(super) fn take_contests(&mut self, response: &mut Response, rows: &Rows, h: f64) {
        for c in self.contests.iter_mut().filter(|c| c.on) {
            c.impulse = rows.impulse(c.block, 0);
            response.push(&c.push, c.impulse / h);
        }
    }

    /// To which side an axis that is a row has left the segments beside its riser.
    pub(super) fn leaves_contest(&self, axis: usize, end: f64) -> isize {
        let (law, k) = (&self.laws[axis], self.place[axis] / 2);
        let segment = if end < law.knots[k].speed { k } else { k + 1 };
        law.leaves_segment(segment, end)
    }

    /// Torque of an axis that is a row and stands.
    pub(super) fn contested_torque(&self, axis: usize, h: f64) -> f64 {
        self.contests[axis].base + self.contests[axis].impulse / h
    }

    /// At the end of a step: a row at its bound slides.
    pub(super) fn settle_contests(&mut self) {
        for (axis, c) in self.contests.iter().enumerate().filter(|(_, c)| c.on) {
            let k = self.place[axis] / 2;
            if c.impulse >= c.upper {
                self.place[axis] = 2 * k;
            } else if c.impulse <= c.lower {
                self.place[axis] = 2 * k + 2;
            }
        }
    }
}
