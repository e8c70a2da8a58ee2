//! How far the axes are from leaving the parts of their laws, while a method of high order takes the step: the event functions
//! whose roots it looks for.

use super::axis_set::{AxisSet, StateRef};
use super::law::{LOWER, Law, UPPER};
use crate::dynamics::Workspace;
use crate::model::{Axis, Model};

/// Per axis, each ≥ 0 while its part of the law holds and ∞ where there is nothing to leave. A sliding axis: speed above the knot
/// below, below the knot above (rad/s or m/s), position above the lower stop, below the upper one (rad or m). A standing one:
/// torque down to the lower end of its riser, and up to the upper one (N·m or N).
pub type Margins = [f64; 4];

/// No end in sight.
const WIDE: Margins = [f64::INFINITY; 4];
/// A start this far behind a stop is rounding, relative to 1 rad or m and the position.
const ROUNDING: f64 = 1e-13;
/// Relative tolerance of a riser's ends.
const FIT: f64 = 1e-11;

/// What the laws of a step ask of a method of high order.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shape {
    /// Some law has a knot: there may be events.
    pub bends: bool,
    /// Some axis gives a torque.
    pub acts: bool,
    /// Some axis stands.
    pub stands: bool,
}

impl Law {
    fn speed_room(&self, j: usize, v: f64) -> [f64; 2] {
        let counts = |k: usize| self.knots[k].kinds & (LOWER | UPPER) == 0;
        let below = if j > 0 && counts(j - 1) { v - self.knots[j - 1].speed } else { f64::INFINITY };
        let above = if j < self.count && counts(j) { self.knots[j].speed - v } else { f64::INFINITY };
        [below, above]
    }

    fn torque_room(&self, k: usize, torque: f64) -> [f64; 2] {
        let (left, right) = self.held(k);
        let slack = FIT * (1.0 + torque.abs());
        [torque - right + slack, left - torque + slack]
    }

    fn sliding(&self, axis: &Axis, j: usize, (q, v): (f64, f64)) -> Margins {
        let [below, above] = self.speed_room(j, v);
        let stops = if self.has_stop() { [q - axis.lower, axis.upper - q] } else { [f64::INFINITY; 2] };
        [below, above, stops[0], stops[1]]
    }

    /// No torque at any speed.
    fn is_nothing(&self) -> bool {
        self.count == 0 && self.segments[0].intercept == 0.0 && self.segments[0].slope == 0.0
    }
}

impl AxisSet {
    /// What the prepared laws are made of.
    pub fn shape(&self) -> Shape {
        let mut shape = Shape::default();
        for (i, law) in self.laws.iter().enumerate().filter(|(i, _)| !self.rests(*i)) {
            shape.bends |= !law.smooth();
            shape.acts |= !law.is_nothing();
            shape.stands |= self.place[i] % 2 == 1;
        }
        shape
    }

    /// Does an axis stand in a soft stop?
    pub fn in_soft_stop(&self) -> bool {
        self.laws.iter().any(|law| law.in_soft_stop)
    }

    /// Writes the margins of all axes at a state; `ws` and `qdd` (nv) are those of this state where some axis stands.
    pub fn write_margins(&mut self, m: &Model, (ws, qdd): (&Workspace<f64>, &[f64]), s: StateRef, out: &mut [Margins]) {
        self.update_rates(m, s.angles);
        for (i, (axis, out)) in m.axes.iter().zip(out).enumerate() {
            let (law, place) = (&self.laws[i], self.place[i]);
            *out = match place % 2 {
                _ if law.smooth() || self.rests(i) => WIDE,
                0 => law.sliding(axis, place / 2, self.axis_state(m, axis, s)),
                _ => {
                    let [low, high] = law.torque_room(place / 2, self.riser_torque(m, ws, i, qdd));
                    [low, high, f64::INFINITY, f64::INFINITY]
                }
            };
        }
    }

    /// Do these margins of a start show that some axis has left its part already?
    pub fn has_left(&self, m: &Model, margins: &[Margins]) -> bool {
        let stops = |axis: &Axis| [ROUNDING * (1.0 + axis.lower.abs()), ROUNDING * (1.0 + axis.upper.abs())];
        m.axes.iter().zip(margins).any(|(axis, room)| {
            let [lower, upper] = stops(axis);
            room[0] < 0.0 || room[1] < 0.0 || room[2] < -lower || room[3] < -upper
        })
    }

    /// Has a sliding axis left its segment or its range in this state?
    pub fn strays(&mut self, m: &Model, s: StateRef) -> bool {
        self.update_rates(m, s.angles);
        (0..self.laws.len()).filter(|i| self.place[*i].is_multiple_of(2) && !self.laws[*i].smooth()).any(|i| {
            let (axis, law) = (&m.axes[i], &self.laws[i]);
            law.sliding(axis, self.place[i] / 2, self.axis_state(m, axis, s)).iter().any(|room| *room < 0.0)
        })
    }

    /// Power of the drives, and what the rest of the laws takes, W, in the state of the last [`AxisSet::write_smooth`].
    pub fn smooth_powers(&self, m: &Model, s: StateRef) -> [f64; 2] {
        let (mut drives, mut losses) = (0.0, 0.0);
        for (i, law) in
            self.laws.iter().enumerate().filter(|(i, law)| self.place[*i].is_multiple_of(2) && !law.is_nothing())
        {
            let (_, v) = self.axis_state(m, &m.axes[i], s);
            let (drive, total) = (law.drive_torque(v, None), law.on_segment(self.place[i] / 2, v));
            drives += drive * v;
            losses -= (total - drive) * v;
        }
        [drives, losses]
    }

    /// Ends an explicit piece at the state `s`: remembers who stands, writes efforts. `ws` and `qdd` are those of this state where
    /// some axis stands.
    pub fn end_smooth(&mut self, m: &Model, ws: &Workspace<f64>, s: StateRef, qdd: &[f64]) {
        for (i, axis) in m.axes.iter().enumerate() {
            let (_, v) = self.axis_state(m, axis, s);
            let (k, law) = (self.place[i] / 2, &self.laws[i]);
            let standing = self.place[i] % 2 == 1;
            self.memory[i] = if standing { law.knots[k].kinds } else { 0 };
            let riser = standing.then(|| (k, self.riser_torque(m, ws, i, qdd)));
            self.books.effort[i] = law.drive_torque(v, riser);
        }
    }

    /// Looks for what may touch within `ahead` seconds from a state (q, v). How many times as far as they are thick bodies that are
    /// near may move in that time; 0 if nothing is near.
    pub fn look_ahead(&mut self, m: &Model, state: (&[f64], &[f64]), ahead: f64) -> f64 {
        let Some(contacts) = self.contacts_mut() else { return 0.0 };
        contacts.begin(m, state, ahead);
        contacts.fastest()
    }
}

/// When the first of the margins reaches 0, of those that are below 0 at the end: share of the way, the axis, and which of its margins.
pub fn first_to_leave(start: &[Margins], end: &[Margins]) -> Option<(f64, usize, usize)> {
    let all = end.iter().enumerate().flat_map(|(i, room)| (0..room.len()).map(move |k| (i, k)));
    all.filter(|(i, k)| end[*i][*k] < 0.0)
        .map(|(i, k)| (share(start[i][k], end[i][k]), i, k))
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Where a straight line from one value to another, below 0, crosses 0.
pub fn share(from: f64, to: f64) -> f64 {
    let from = from.max(0.0);
    if from.is_finite() { from / (from - to) } else { 0.5 }
}
