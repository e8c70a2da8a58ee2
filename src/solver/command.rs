//! What a controller tells the axes.

pub use crate::description::DriveMode as Mode;
use crate::model::{Axis, DriveLimits};

/// Inputs of one axis' drive. Units: N·m, rad/s, rad; for a linear axis N, m/s, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisCommand {
    /// Mode.
    pub mode: Mode,
    /// Applied torque: signed in torque mode; in servo mode its magnitude bounds the drive torque. NaN = not given
    /// (torque mode: 0; servo mode: the axis' maximum).
    pub torque: f64,
    /// Applied speed (no-load speed at the applied voltage); NaN = not given (the axis' maximum).
    pub speed: f64,
    /// Servo target.
    pub target: f64,
}

impl AxisCommand {
    /// The drive gives no torque.
    pub const IDLE: Self = Self { mode: Mode::Idle, torque: f64::NAN, speed: f64::NAN, target: 0.0 };
    /// Applied torque.
    pub fn torque(torque: f64) -> Self {
        Self { mode: Mode::Torque, torque, ..Self::IDLE }
    }
    /// Servo target.
    pub fn servo(target: f64) -> Self {
        Self { mode: Mode::Servo, target, ..Self::IDLE }
    }

    /// True if every number that the mode uses is finite, or NaN where that means "not given", and if applied torque and
    /// speed do not contradict each other.
    pub fn is_sound(&self) -> bool {
        let finite = !self.torque.is_infinite() && !self.speed.is_infinite();
        match self.mode {
            Mode::Idle => finite,
            Mode::Torque => finite && !self.contradicts(),
            Mode::Servo => finite && self.target.is_finite(),
        }
    }

    /// What of it the axis cannot do, and what it does instead; `None` if it can do all of it.
    pub fn beyond(&self, axis: &Axis, drive: &DriveLimits) -> Option<String> {
        let name = &axis.name;
        let beyond = |what: &str, value: f64, bound: f64| {
            (value.abs() > bound)
                .then(|| format!("axis '{name}': applied {what} {value} is beyond its maximum: {bound} is applied"))
        };
        if self.mode == Mode::Idle {
            return None;
        }
        if self.mode == Mode::Servo && !(axis.lower..=axis.upper).contains(&self.target) {
            let (low, high) = (axis.lower, axis.upper);
            return Some(format!(
                "axis '{name}': servo target {} is outside its range {low} to {high}: it will push against its stop",
                self.target
            ));
        }
        if self.mode == Mode::Servo && drive.max_torque == f64::INFINITY && !self.torque.is_finite() {
            return Some(format!("axis '{name}': nothing bounds the torque of its servo; give its drive a max_torque"));
        }
        let speed = if self.mode == Mode::Servo { drive.max_speed } else { drive.no_load_speed };
        beyond("torque", self.torque, drive.max_torque).or_else(|| beyond("speed", self.speed, speed))
    }

    /// applied torque and applied speed, in torque mode, that have no meaning together: of opposite sign, or torque
    /// at speed 0. False where one of the two is not given, since a comparison with NaN is false.
    pub fn contradicts(&self) -> bool {
        let opposed = self.torque * self.speed < 0.0 || (self.speed == 0.0 && self.torque.abs() > 0.0);
        self.mode == Mode::Torque && opposed
    }
}
