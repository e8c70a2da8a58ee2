//! What a drive does (J-13, J-14): the torque–speed line, the short brake, the servo.
//!
//! A motor under a current limit gives at most the torque c. Its back-EMF takes from that in proportion to the speed, and
//! nothing is left at the no-load speed d: `c (1 − v/d)`, cut off at ±c, where the current limit holds it. That is one
//! falling curve through all four quadrants; above d the motor brakes.

use super::Mode;
use super::law::{AxisInput, Knot, SERVO, Segment, WALL_LEFT, WALL_RIGHT, bounded};
use crate::model::{Part, Parts};

/// A servo that wants less than this has arrived, rad/s or m/s.
const STILL: f64 = 1e-11;
/// No-load speed that stands for less, rad/s or m/s.
const SLOWEST: f64 = 1e-9;

/// How well a servo can slow its load down, seen in the last step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Brakes {
    /// Acceleration per torque of the axis, 1/(kg·m²) or 1/kg; 0 where nothing is known yet.
    pub mobility: f64,
    /// Acceleration of the axis without its drive, rad/s² or m/s².
    pub drift: f64,
}

/// Torque of the drive over the speed of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum DriveLaw {
    /// No torque.
    #[default]
    Idle,
    /// Applied torque, signed, and applied speed > 0, maybe infinite.
    Line { torque: f64, speed: f64 },
    /// Short-circuited: torque per speed.
    ShortBrake { slope: f64 },
    /// Wants a speed; torque bound and no-load speed.
    Servo { wanted: f64, torque: f64, speed: f64 },
}

impl DriveLaw {
    /// The law that the command of an axis asks for, in a step of `h` seconds, without the parts that are `off`.
    #[inline]
    pub fn of(input: &AxisInput, h: f64, off: Parts) -> Self {
        let (limits, c) = (input.limits, &input.command);
        let given = |command: f64, own: f64| if command.is_nan() { own } else { command.abs().min(own) };
        let speed = || match off.has(Part::TorqueSpeedLine) {
            true => f64::INFINITY,
            // A line that ends where it begins has no slope that a number can hold.
            false => given(c.speed, limits.no_load_speed).max(SLOWEST),
        };
        match c.mode {
            Mode::Idle => Self::Idle,
            Mode::Torque if c.torque == 0.0 || c.torque.is_nan() => Self::unpowered(input, off),
            Mode::Torque => Self::Line { torque: bounded(c.torque, limits.max_torque), speed: speed() },
            Mode::Servo => {
                let torque = given(c.torque, limits.max_torque);
                if torque == 0.0 || off.has(Part::Servo) {
                    return Self::unpowered(input, off);
                }
                let bound = given(c.speed, limits.max_speed);
                let wanted = bounded(approach(input, torque, h), bound);
                let wanted = if wanted.abs() < STILL { 0.0 } else { wanted };
                Self::Servo { wanted, torque, speed: speed() }
            }
        }
    }

    /// J-13 (g). The shorted motor's slope K²/R is that of its line at maximum voltage: (a)/(b).
    fn unpowered(input: &AxisInput, off: Parts) -> Self {
        if input.limits.short_brake { Self::shorted(input, off) } else { Self::Idle }
    }

    /// Of a drive that has one. By itself, so that one that has none does not ask whether it is switched off.
    #[inline(never)]
    fn shorted(input: &AxisInput, off: Parts) -> Self {
        let (torque, speed) = (input.limits.max_torque, input.limits.no_load_speed);
        if !off.has(Part::ShortBrake) && torque.is_finite() && speed.is_finite() && speed > 0.0 {
            Self::ShortBrake { slope: torque / speed }
        } else {
            Self::Idle
        }
    }

    /// The curve as its first segment and its knots.
    #[inline]
    pub fn staircase(&self) -> (Segment, [Option<Knot>; 2]) {
        let kink = |speed: f64, steeper: f64| Some(Knot { speed, drop: 0.0, steeper, kinds: 0 });
        match *self {
            Self::Idle => (Segment::default(), [None, None]),
            Self::ShortBrake { slope } => (Segment { intercept: 0.0, slope }, [None, None]),
            Self::Line { torque, speed: f64::INFINITY } => (Segment { intercept: torque, slope: 0.0 }, [None, None]),
            Self::Line { torque, speed } => {
                let (slope, end) = (torque.abs() / speed, 2.0 * speed * torque.signum());
                let start = Segment { intercept: torque.abs(), slope: 0.0 };
                (start, [kink(end.min(0.0), slope), kink(end.max(0.0), -slope)])
            }
            Self::Servo { torque: f64::INFINITY, wanted, .. } => {
                let riser = Knot { speed: wanted, drop: 0.0, steeper: 0.0, kinds: SERVO | WALL_LEFT | WALL_RIGHT };
                (Segment::default(), [Some(riser), None])
            }
            Self::Servo { wanted, torque, speed } => {
                let (low, high) = self.range(wanted);
                let slope = torque / speed;
                let side = if wanted < 0.0 { 1.0 } else { -1.0 };
                let riser = Knot { speed: wanted, drop: high - low, steeper: side * slope, kinds: SERVO };
                (Segment { intercept: torque, slope: 0.0 }, [Some(riser), kink(0.0, -side * slope)])
            }
        }
    }

    /// Torque at a speed that is not a servo's wanted one.
    pub fn torque(&self, v: f64) -> f64 {
        match *self {
            Self::Idle => 0.0,
            Self::ShortBrake { slope } => -slope * v,
            Self::Line { torque, speed } => bounded(torque - torque.abs() * v / speed, torque.abs()),
            Self::Servo { wanted, .. } => {
                let (low, high) = self.range(v);
                if v < wanted { high } else { low }
            }
        }
    }

    /// What the drive can give at a speed, backwards and forwards.
    pub fn range(&self, v: f64) -> (f64, f64) {
        match *self {
            Self::Servo { torque: f64::INFINITY, .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Self::Servo { torque, speed, .. } => {
                let lost = torque * v / speed;
                (bounded(-torque - lost, torque), bounded(torque - lost, torque))
            }
            _ => (self.torque(v), self.torque(v)),
        }
    }
}

/// Speed towards the target: as fast as the error e decays with the servo's time constant, and as a brake a can still stop it:
/// after a step at the speed v there is `e − hv` left, and `v² = 2a (e − hv)` is the fastest that comes to rest there.
fn approach(input: &AxisInput, torque: f64, h: f64) -> f64 {
    let error = input.command.target - input.q;
    let linear = error / input.limits.servo_time.max(h);
    let Brakes { mobility, drift } = input.brakes;
    let brake = mobility * torque - drift * error.signum();
    if mobility == 0.0 || brake <= 0.0 || !brake.is_finite() {
        return linear;
    }
    let step = brake * h;
    bounded(linear, (step * step + 2.0 * brake * error.abs()).sqrt() - step)
}
