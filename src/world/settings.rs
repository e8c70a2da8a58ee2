//! Settings of a world (W-3 … W-6), with their ranges.

pub use crate::engine::{EngineKind, Integrator};

/// Settings of a world.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Control interval in ns, before the time scale; 1 µs … 1 s.
    pub control_interval_ns: i64,
    /// W-5: 1 … 1000.
    pub steps_per_interval: u32,
    /// W-6: passes of the axis set at most, 1 … 10000.
    pub solver_iterations: u32,
    /// W-3: 0 … 100; 0 stops time.
    pub time_scale: f64,
    /// m/s², world frame (Z up).
    pub gravity: [f64; 3],
    /// Integrator.
    pub integrator: Integrator,
    /// Dynamics engine.
    pub engine: EngineKind,
    /// What [`Integrator::Extrapolation`] may be wrong by after a second of its own errors alone: relative to 1 rad, m, rad/s, m/s and
    /// the coordinate; 1e-14 … 1e-2. Recordings from before it was there do not have it.
    #[serde(default = "usual_accuracy")]
    pub accuracy: f64,
}

/// Of [`Settings::accuracy`].
fn usual_accuracy() -> f64 {
    1e-9
}

/// Range of [`Settings::accuracy`].
pub const ACCURACY: (f64, f64) = (1e-14, 1e-2);
/// Shorter steps drown in rounding, s.
const SHORTEST_STEP: f64 = 1e-12;

impl Default for Settings {
    fn default() -> Self {
        Self {
            control_interval_ns: 1_000_000,
            steps_per_interval: 5,
            solver_iterations: 10,
            time_scale: 1.0,
            gravity: [0.0, 0.0, -9.80665],
            integrator: Integrator::default(),
            engine: EngineKind::default(),
            accuracy: usual_accuracy(),
        }
    }
}

impl Settings {
    /// # Errors
    /// Names the setting that is out of range, its value and the range.
    pub fn check(&self) -> Result<(), String> {
        self.engine.available()?;
        let ranged = |name: &str, value: f64, low: f64, high: f64, unit: &str| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(format!("{name} is {value}{unit}; it must be from {low} to {high}{unit}"))
            }
        };
        ranged("control_interval", self.control_interval_ns as f64 * 1e-9, 1e-6, 1.0, " s")?;
        ranged("steps_per_interval", f64::from(self.steps_per_interval), 1.0, 1000.0, "")?;
        ranged("solver_iterations", f64::from(self.solver_iterations), 1.0, 10_000.0, "")?;
        ranged("time_scale", self.time_scale, 0.0, 100.0, "")?;
        let (finest, coarsest) = ACCURACY;
        if !(finest..=coarsest).contains(&self.accuracy) {
            return Err(format!("accuracy is {:e}; it must be from {finest:e} to {coarsest:e}", self.accuracy));
        }
        let step = self.control_interval_ns as f64 * 1e-9 * self.time_scale / f64::from(self.steps_per_interval);
        if step > 0.0 && step < SHORTEST_STEP {
            return Err(format!(
                "time_scale {} makes a step of {step} s; it must be 0 or give at least {SHORTEST_STEP} s",
                self.time_scale
            ));
        }
        for (axis, g) in ["x", "y", "z"].iter().zip(self.gravity) {
            ranged(&format!("gravity {axis}"), g, -1000.0, 1000.0, " m/s²")?;
        }
        Ok(())
    }
}
