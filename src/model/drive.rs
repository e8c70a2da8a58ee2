//! What bounds a drive (J-13, J-14).

use crate::description::Joint;
use std::f64::consts::TAU;

/// Time constant of a servo of no stated bandwidth, s.
pub const SERVO_TIME: f64 = 0.05;

/// The drive of one axis as a machine: everything but its command. Units: N·m, rad/s, kg·m²; of a linear axis N, m/s, kg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// J-13 (a): torque at maximum current; +∞ where nothing bounds it.
    pub max_torque: f64,
    /// J-13 (b): no-load speed at maximum voltage; +∞ where no drive tag gives it.
    pub no_load_speed: f64,
    /// Bound of a servo's speed: the no-load speed or the URDF's velocity limit, whichever is less, else +∞.
    pub max_speed: f64,
    /// J-13 (e): least torque that starts the axis. At least the dynamic resistance counts.
    pub static_resistance: f64,
    /// J-13 (f): torque lost to friction when turning.
    pub dynamic_resistance: f64,
    /// J-13 (g): the motor's terminals are short-circuited while the applied torque is 0.
    pub short_brake: bool,
    /// A servo closes on its target with this time constant, s; 1 / (2π bandwidth).
    pub servo_time: f64,
    /// Inertia of the rotor as the axis feels it: rotor inertia × gear ratio².
    pub rotor_inertia: f64,
}

impl Default for DriveLimits {
    /// A drive that nothing bounds, without losses.
    fn default() -> Self {
        Self {
            max_torque: f64::INFINITY,
            no_load_speed: f64::INFINITY,
            max_speed: f64::INFINITY,
            static_resistance: 0.0,
            dynamic_resistance: 0.0,
            short_brake: false,
            servo_time: SERVO_TIME,
            rotor_inertia: 0.0,
        }
    }
}

impl DriveLimits {
    /// # Errors
    /// Names the value that is out of range, and the range.
    pub fn check(&self) -> Result<(), String> {
        let ranged = |name: &str, value: f64, ok: bool, range: &str| {
            if ok { Ok(()) } else { Err(format!("{name} is {value}; it must be {range}")) }
        };
        let (a, b, c) = (self.max_torque, self.no_load_speed, self.max_speed);
        ranged("max_torque", a, a >= 0.0, "0 or more")?;
        ranged("no_load_speed", b, b > 0.0, "greater than 0")?;
        ranged("max_speed", c, c > 0.0, "greater than 0")?;
        let (e, f) = (self.static_resistance, self.dynamic_resistance);
        ranged("dynamic_resistance", f, (0.0..f64::INFINITY).contains(&f), "0 or more, and finite")?;
        ranged("static_resistance", e, e >= f && e.is_finite(), "at least the dynamic resistance, and finite")?;
        let (t, j) = (self.servo_time, self.rotor_inertia);
        ranged("servo_time", t, t > 0.0 && t.is_finite(), "greater than 0, and finite")?;
        ranged("rotor_inertia", j, (0.0..f64::INFINITY).contains(&j), "0 or more, and finite")
    }

    /// From the tag, else from the URDF's limits.
    pub(super) fn of(joint: &Joint) -> Self {
        let (drive, limit) = (joint.drive.as_ref(), joint.limit.as_ref());
        let tag = |value: fn(&crate::description::Drive) -> Option<f64>| drive.and_then(value);
        let no_load_speed = tag(|d| d.no_load_speed).unwrap_or(f64::INFINITY);
        let dynamic_resistance = tag(|d| d.dynamic_resistance).unwrap_or(0.0);
        let gear_ratio = tag(|d| d.gear_ratio).unwrap_or(1.0);
        Self {
            max_torque: tag(|d| d.max_torque).or(limit.and_then(|l| l.effort)).unwrap_or(f64::INFINITY),
            no_load_speed,
            max_speed: no_load_speed.min(limit.and_then(|l| l.velocity).unwrap_or(f64::INFINITY)),
            static_resistance: tag(|d| d.static_resistance).unwrap_or(0.0).max(dynamic_resistance),
            dynamic_resistance,
            short_brake: drive.is_some_and(|d| d.short_brake),
            servo_time: tag(|d| d.bandwidth).map_or(SERVO_TIME, |f| 1.0 / (TAU * f)),
            rotor_inertia: tag(|d| d.rotor_inertia).unwrap_or(0.0) * gear_ratio * gear_ratio,
        }
    }
}
