//! The law of one axis: torque over the velocity at the end of the step.
//!
//! Dry friction is a riser at speed 0, a servo a riser at its target speed, a stop a riser at the speed that just reaches
//! the stop; viscous terms are a slope. So the sum is a monotone staircase:
//!
//! ```text
//! torque  ──┐ flat 0
//!           │ riser 0 (servo, here below 0)
//!           └───┐ flat 1
//!               │ riser 1 (friction, speed 0)
//!               └────┐ flat 2
//!                    │ riser 2 (stop)
//!                    ▼ −∞                      → speed
//! ```

use super::{AxisCommand, Mode};
use crate::model::{Axis, Effects};

/// Share of a stop's penetration that one step takes back (ODE's default error reduction).
pub const STOP_ERP: f64 = 0.2;
/// A servo closes this on its target: the error decays with this time constant, s, as far as torque and speed allow.
pub const SERVO_TIME: f64 = 0.05;
/// Speeds nearer than this are one riser, rad/s or m/s.
const SAME: f64 = 1e-12;

/// An axis this near to its stop touches it: rounding of the step that brought it there; rad or m, relative.
const AT_STOP: f64 = 1e-14;

/// What a riser is made of, as bits.
pub(super) const FRICTION: u8 = 1;
pub(super) const SERVO: u8 = 2;
pub(super) const LOWER: u8 = 4;
pub(super) const UPPER: u8 = 8;

/// A vertical part of the staircase.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Riser {
    /// Speed at which it stands.
    pub speed: f64,
    /// Torque at its left (upper) and right (lower) end; +∞ and −∞ at stops.
    pub left: f64,
    pub right: f64,
    /// What it is made of.
    pub kinds: u8,
}

/// The law of one axis in one step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Law {
    pub(super) risers: [Riser; 4],
    pub(super) count: usize,
    /// Torque of the first flat; the others follow from the risers.
    first: f64,
    /// Viscous slope ≥ 0: torque per speed, damping and drive together.
    pub(super) slope: f64,
    /// The drive's part of the slope.
    drive_slope: f64,
    /// Torque that does not depend on speed: the drive in torque mode.
    constant: f64,
    servo: f64,
    servo_speed: f64,
    friction: f64,
}

/// What the law of an axis depends on.
#[derive(Clone, Copy, Debug)]
pub struct AxisInput<'a> {
    /// The axis.
    pub axis: &'a Axis,
    /// Its command.
    pub command: AxisCommand,
    /// Position, rad or m.
    pub q: f64,
    /// Speed, rad/s or m/s.
    pub v: f64,
}

/// The law of an axis for a step of `h` seconds.
pub fn law(input: &AxisInput, effects: Effects, h: f64) -> Law {
    let mut l = Law::default();
    let axis = input.axis;
    if effects.damping {
        l.slope = axis.damping;
    }
    if effects.drives {
        l.drive(input, h);
    }
    if effects.friction && axis.friction > 0.0 {
        l.friction = axis.friction;
        l.insert(0.0, axis.friction, FRICTION);
    }
    if effects.limits {
        l.stops(input, h);
    }
    l.finish();
    l
}

impl Law {
    fn drive(&mut self, input: &AxisInput, h: f64) {
        let (axis, c) = (input.axis, &input.command);
        match c.mode {
            Mode::Idle => {}
            Mode::Torque => {
                let torque = if c.torque.is_nan() { 0.0 } else { c.torque };
                self.constant = bounded(torque, axis.drive.max_torque);
                let speed = given(c.speed, axis.drive.no_load_speed).min(axis.drive.no_load_speed);
                if speed.is_finite() && speed > 0.0 && self.constant * input.v > 0.0 {
                    self.drive_slope = self.constant.abs() / speed;
                    self.slope += self.drive_slope;
                }
            }
            Mode::Servo => {
                let error = c.target - input.q;
                let bound = given(c.speed, axis.drive.max_speed).min(axis.drive.max_speed);
                self.servo_speed = bounded(error / SERVO_TIME.max(h), bound);
                self.servo = given(c.torque, axis.drive.max_torque).min(axis.drive.max_torque);
                self.insert(self.servo_speed, self.servo, SERVO);
            }
        }
    }

    /// A stop is reached exactly at the end of the step; a penetrated one is left by [`STOP_ERP`].
    fn stops(&mut self, input: &AxisInput, h: f64) {
        let axis = input.axis;
        let touching = AT_STOP * (1.0 + input.q.abs());
        let room = |gap: f64| match gap {
            _ if gap.abs() <= touching => 0.0,
            _ if gap > 0.0 => gap / h,
            _ => STOP_ERP * gap / h,
        };
        if axis.lower.is_finite() {
            self.insert(-room(input.q - axis.lower), 0.0, LOWER);
        }
        if axis.upper.is_finite() {
            self.insert(room(axis.upper - input.q), 0.0, UPPER);
        }
    }

    /// `right` holds the half height until [`Law::finish`].
    fn insert(&mut self, speed: f64, half: f64, kinds: u8) {
        if let Some(r) = self.risers[..self.count].iter_mut().find(|r| (r.speed - speed).abs() <= SAME) {
            r.right += half;
            r.kinds |= kinds;
            return;
        }
        let at = self.risers[..self.count].iter().take_while(|r| r.speed < speed).count();
        self.risers.copy_within(at..self.count, at + 1);
        self.risers[at] = Riser { speed, left: 0.0, right: half, kinds };
        self.count += 1;
    }

    /// Drops what lies beyond a stop and turns heights into torques.
    fn finish(&mut self) {
        if self.servo == f64::INFINITY {
            return self.finish_unbounded();
        }
        let risers = &mut self.risers;
        let start = risers[..self.count].iter().position(|r| r.kinds & LOWER != 0).unwrap_or(0);
        let beyond: f64 = risers[..start].iter().map(|r| r.right).sum();
        risers.copy_within(start..self.count, 0);
        self.count -= start;
        if let Some(end) = risers[..self.count].iter().position(|r| r.kinds & UPPER != 0) {
            self.count = end + 1;
        }
        let all = self.servo + self.friction;
        self.first = self.constant + all - 2.0 * beyond;
        let mut torque = self.first;
        for r in &mut risers[..self.count] {
            let half = r.right;
            r.left = if r.kinds & LOWER != 0 { f64::INFINITY } else { torque };
            torque -= 2.0 * half;
            r.right = if r.kinds & UPPER != 0 { f64::NEG_INFINITY } else { torque };
        }
    }

    /// A servo that nothing bounds is one riser from +∞ to −∞; only a stop moves it.
    fn finish_unbounded(&mut self) {
        let stop = |kind| self.risers[..self.count].iter().find(|r| r.kinds & kind != 0).map(|r| r.speed);
        let speed =
            self.servo_speed.max(stop(LOWER).unwrap_or(f64::NEG_INFINITY)).min(stop(UPPER).unwrap_or(f64::INFINITY));
        self.risers[0] = Riser { speed, left: f64::INFINITY, right: f64::NEG_INFINITY, kinds: SERVO | FRICTION };
        self.count = 1;
    }

    /// Torque of flat `j`, without the slope.
    pub(super) fn flat(&self, j: usize) -> f64 {
        if j == 0 { self.first } else { self.risers[j - 1].right }
    }

    /// True if only viscous and constant torques act.
    pub(super) fn smooth(&self) -> bool {
        self.count == 0
    }

    /// True if no stop is part of the law.
    pub(super) fn stopless(&self) -> bool {
        self.risers[..self.count].iter().all(|r| r.kinds & (LOWER | UPPER) == 0)
    }

    /// Torque of the drive at the end of the step: at speed `v`, on flat or riser, where `total` is the law's torque
    /// without slope. On a riser friction takes its part first, then the drive; what is left is the stop's.
    pub(super) fn drive_torque(&self, v: f64, riser: Option<(usize, f64)>) -> f64 {
        let steady = self.constant - self.drive_slope * v;
        let beside = |speed: f64, height: f64| if v < speed { height } else { -height };
        let Some((k, total)) = riser else {
            return steady + if self.servo > 0.0 { beside(self.servo_speed, self.servo) } else { 0.0 };
        };
        let kinds = self.risers[k].kinds;
        let mut rest = total - self.constant;
        if self.servo > 0.0 && kinds & SERVO == 0 {
            return steady + beside(self.servo_speed, self.servo);
        }
        if self.friction > 0.0 {
            rest -= if kinds & FRICTION != 0 { bounded(rest, self.friction) } else { beside(0.0, self.friction) };
        }
        steady + if kinds & SERVO != 0 { bounded(rest, self.servo) } else { 0.0 }
    }
}

/// A magnitude from a command, or the axis' own where it is not given.
fn given(command: f64, own: f64) -> f64 {
    if command.is_nan() { own } else { command.abs() }
}

/// `x` within ±`bound`; unlike `clamp` it cannot panic.
fn bounded(x: f64, bound: f64) -> f64 {
    x.min(bound).max(-bound)
}
