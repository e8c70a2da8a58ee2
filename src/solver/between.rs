//! Axes that are between their hard stops, or have none, and on which nothing acts but damping: most axes in most steps.
//!
//! The law of such an axis is that of the step before but for the speeds that reach its stops, and no pass has more to ask than whether
//! its speed stays between these. All this is what [`Law::set`] and the passes would come to, bit by bit; as soon as anything else
//! comes in (a command, a stop, stiff damping), they are asked.

use super::axis_set::{AxisSet, StepStart};
use super::drive::DriveLaw;
use super::law::{AT_STOP, LOWER, Law, SAME, UPPER, WALL_LEFT, WALL_RIGHT};
use super::{AxisCommand, Mode};
use crate::dynamics::{DofIn, Workspace};
use crate::model::{Axis, AxisSlot, DriveLimits, Effects, Model};

/// An axis as such a step sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Between {
    /// Place in `q` and in `v`.
    at: (usize, usize),
    lower: f64,
    upper: f64,
    /// May it ever be one of these?
    may: bool,
    /// Is it in this step, as far as the passes have found?
    pub on: bool,
    /// Speeds that reach its stops, rad/s or m/s.
    low: f64,
    high: f64,
    /// N·m·s/rad or N·s/m.
    damping: f64,
}

impl Between {
    /// Of each axis of a model.
    pub fn all(m: &Model) -> Vec<Self> {
        m.axes.iter().map(Self::of).collect()
    }

    fn of(axis: &Axis) -> Self {
        let hard = axis.lower.is_finite() == axis.upper.is_finite() && axis.stop.cfm == 0.0 && axis.friction == 0.0;
        let (at, may) = match axis.slot {
            AxisSlot::Scalar { q, v } => ((q, v), hard),
            _ => ((0, 0), false),
        };
        let (lower, upper) = (axis.lower, axis.upper);
        Self { at, lower, upper, may, on: false, low: 0.0, high: 0.0, damping: 0.0 }
    }
}

/// Neither torque nor friction.
fn is_idle(command: &AxisCommand, limits: &DriveLimits) -> bool {
    command.mode == Mode::Idle && limits.static_resistance == 0.0 && limits.dynamic_resistance == 0.0
}

impl AxisSet {
    /// Sets up an axis for a step, if it is one of these; `effects` are those of its law.
    #[inline(always)]
    pub(super) fn prepare_between(&mut self, i: usize, start: &StepStart, effects: Effects) -> bool {
        let b = &mut self.between[i];
        if !b.may {
            return false;
        }
        b.on = false;
        let law = &mut self.laws[i];
        if !law.plain || self.memory[i] != 0 || !is_idle(&start.commands[i], &self.books.drives[i]) {
            return false;
        }
        let (q, v) = (start.state.q[b.at.0], start.state.v[b.at.1]);
        let (lower, upper) = if effects.limits { (b.lower, b.upper) } else { (f64::NEG_INFINITY, f64::INFINITY) };
        let Some((low, high)) = law.pass_between((q - lower, upper - q), q, start.h) else { return false };
        if !(low < v && v < high) {
            return false;
        }
        (b.low, b.high, b.damping, b.on) = (low, high, law.segments[0].slope, true);
        self.speed[i] = v;
        self.rotor[i] = self.books.rotor(i, effects);
        self.place[i] = law.count;
        self.at_end[i] = !start.mean || self.stiff[i];
        true
    }

    /// What the hybrid dynamics get of it in a pass.
    #[inline(always)]
    pub(super) fn write_between(&self, ws: &mut Workspace<f64>, i: usize, h: f64) {
        let (b, rotor) = (&self.between[i], self.rotor[i]);
        let share = if self.at_end[i] { 1.0 } else { 0.5 };
        let (torque, diagonal) = (0.0 - b.damping * self.speed[i], share * b.damping * h + rotor);
        ws.dofs[b.at.1] = if diagonal > 0.0 { DofIn::implicit(torque, diagonal) } else { DofIn::free(torque) };
    }

    /// After a pass: is it still one?
    #[inline(always)]
    pub(super) fn stays_between(&mut self, ws: &Workspace<f64>, i: usize, (h, qdd): (f64, &[f64])) -> bool {
        let b = &mut self.between[i];
        if !b.on {
            return false;
        }
        let v = b.at.1;
        let (end, damping) = (self.speed[i] + h * qdd[v], b.damping);
        let stiff = damping > 0.0 && damping * h * ws.mobility(v) > 1.0;
        b.on = b.low < end && end < b.high && (self.at_end[i] || !stiff);
        (self.stiff[i], self.moves[i]) = (stiff, 0);
        b.on
    }

    /// Ends its step.
    #[inline(always)]
    pub(super) fn finish_between(&mut self, i: usize, (h, qdd): (f64, &[f64])) {
        let (b, start) = (&self.between[i], self.speed[i]);
        let acceleration = qdd[b.at.1];
        self.memory[i] = 0;
        self.books.effort[i] = 0.0;
        self.brakes[i].drift = acceleration;
        if b.damping == 0.0 {
            return;
        }
        let end = start + h * acceleration;
        let moved = if self.at_end[i] { end } else { 0.5 * (start + end) };
        let total = 0.0 - b.damping * moved;
        self.paid[i] = (0.5 * h * total * start, 0.5 * h * total * end);
        self.books.work.book(0.0, total, 0.5 * h * (start + end));
    }

    /// Is this speed of its coordinate between those that reach its stops? Then it is exact.
    #[inline(always)]
    pub(super) fn is_between(&self, i: usize, v: &[f64]) -> bool {
        let b = &self.between[i];
        b.on && b.low < v[b.at.1] && v[b.at.1] < b.high
    }
}

impl Law {
    /// What touches a stop is nearer to it than this, rad or m.
    #[inline(always)]
    pub(super) fn touching(q: f64) -> f64 {
        AT_STOP * (1.0 + q.abs())
    }

    /// Are these speeds knots of their own?
    #[inline(always)]
    pub(super) fn are_apart(low: f64, high: f64) -> bool {
        high - low > SAME
    }

    /// Two hard stops or none, and nothing but damping.
    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        let stops = match &self.knots[..self.count] {
            [] => true,
            [low, high] => low.kinds == LOWER | WALL_LEFT && high.kinds == UPPER | WALL_RIGHT,
            _ => false,
        };
        let idle = matches!(self.drive, DriveLaw::Idle);
        stops && idle && self.friction == 0.0 && self.stood == 0.0 && self.push == 0.0
    }

    /// Takes over the gaps to hard stops of a law that is plain; the speeds that reach them. `None` where it touches one or is beyond.
    #[inline(always)]
    fn pass_between(&mut self, (below, above): (f64, f64), q: f64, h: f64) -> Option<(f64, f64)> {
        let touching = Self::touching(q);
        let (low, high) = (-(below / h), above / h);
        if !(below > touching && above > touching && Self::are_apart(low, high)) {
            return None;
        }
        if self.count > 0 {
            (self.knots[0].speed, self.knots[1].speed) = (low, high);
            (self.soft.1, self.soft.2) = (low, high);
        }
        Some((low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{AxisKind, Softness};
    use crate::solver::{AxisInput, Brakes};

    const EFFECTS: Effects = Effects { damping: true, friction: true, drives: true, limits: true, ..Effects::NONE };

    fn axis(damping: f64, stops: bool) -> Axis {
        let range = if stops { (-0.7, 1.1) } else { (f64::NEG_INFINITY, f64::INFINITY) };
        Axis {
            name: "a".into(),
            kind: AxisKind::Rotary,
            slot: AxisSlot::Scalar { q: 0, v: 0 },
            direction: crate::math::Vec3::z(),
            lower: range.0,
            upper: range.1,
            stop: Softness::HELD,
            drive: DriveLimits::default(),
            damping,
            friction: 0.0,
            mode: Mode::Idle,
            switchable: true,
        }
    }

    fn law(axis: &Axis, q: f64) -> Law {
        let mut law = Law::default();
        let brakes = Brakes::default();
        let input = AxisInput { axis, limits: &axis.drive, command: AxisCommand::IDLE, q, stuck: true, brakes };
        law.set(&input, EFFECTS, (1e-3, 1e-3));
        law
    }

    fn bits(law: &Law) -> Vec<u64> {
        let knots = law.knots[..law.count].iter().flat_map(|k| [k.speed, k.drop, k.steeper, f64::from(k.kinds)]);
        let segments = law.segments[..=law.count].iter().flat_map(|s| [s.intercept, s.slope]);
        let rest = [law.stiction, law.push, f64::from(u8::from(law.in_soft_stop))];
        knots.chain(segments).chain(rest).map(f64::to_bits).collect()
    }

    /// A law that is taken over for another position is the one that is made there, and the place is the one that it guesses.
    #[test]
    fn a_law_taken_over_is_the_one_made_anew() {
        for axis in [axis(0.0, true), axis(0.3, true), axis(0.0, false), axis(2.0, false)] {
            for from in [-0.7, -0.3, 0.0, 1.1] {
                for step in 0..=180 {
                    let (mut taken, q) = (law(&axis, from), -0.7 + 0.01 * f64::from(step));
                    assert!(taken.plain);
                    let made = law(&axis, q);
                    let Some((low, high)) = taken.pass_between((q - axis.lower, axis.upper - q), q, 1e-3) else {
                        assert!((q - axis.lower).min(axis.upper - q) < 1e-12, "{q}");
                        continue;
                    };
                    assert_eq!(bits(&taken), bits(&made), "from {from} to {q}");
                    for v in [-3.0, -1e-9, 0.0, 1e-9, 3.0_f64] {
                        if low < v && v < high {
                            assert_eq!(made.guess(v, 0), taken.count);
                            assert_eq!(made.on_segment(taken.count / 2, v), 0.0 - axis.damping * v);
                        }
                    }
                }
            }
        }
    }

    /// Whatever else there is, the law is made anew.
    #[test]
    fn what_has_more_is_not_plain() {
        let made = |change: &dyn Fn(&mut Axis)| {
            let mut axis = axis(0.1, true);
            change(&mut axis);
            law(&axis, 0.2).plain
        };
        assert!(made(&|_| {}));
        assert!(!made(&|a| a.friction = 0.1));
        assert!(!made(&|a| a.stop = Softness { erp: 0.2, cfm: 1e-3 }));
        assert!(!made(&|a| a.drive.static_resistance = 0.1));
        assert!(!made(&|a| a.drive.dynamic_resistance = 0.1));
        assert!(!made(&|a| (a.lower, a.stop) = (0.3, Softness { erp: 0.2, cfm: 0.0 })));
    }
}
