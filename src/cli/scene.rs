//! Scene files: world settings in YAML. Unknown keys are refused, with their line.

use crate::world::{Integrator, Settings};
use serde::Deserialize;
use std::path::Path;

/// A scene file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Version of the format: 1.
    pub version: u32,
    /// World settings.
    #[serde(default)]
    pub world: WorldSettings,
    /// The robot.
    #[serde(default)]
    pub robot: Robot,
    /// Ground planes and terrain: read, not simulated yet.
    pub ground: Option<serde_json::Value>,
    /// Free bodies: read, not simulated yet.
    pub bodies: Option<serde_json::Value>,
}

/// `world:`; what is absent keeps its default.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorldSettings {
    /// s.
    pub control_interval: Option<f64>,
    /// 1 … 1000.
    pub steps_per_interval: Option<u32>,
    /// 1 … 10000.
    pub solver_iterations: Option<u32>,
    /// 0 … 100.
    pub time_scale: Option<f64>,
    /// m/s².
    pub gravity: Option<[f64; 3]>,
    /// semi_implicit_euler or rk4.
    pub integrator: Option<String>,
    /// Effects to switch.
    #[serde(default)]
    pub effects: std::collections::BTreeMap<String, bool>,
}

/// `robot:`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// fixed or free.
    pub base: Option<String>,
    /// Root link in the world: x, y, z, qx, qy, qz, qw.
    pub pose: Option<[f64; 7]>,
}

impl Scene {
    /// Reads a file; `None` is an empty scene.
    ///
    /// # Errors
    /// Names the file, the line and the key.
    pub fn read(path: Option<&Path>) -> Result<Self, String> {
        let Some(path) = path else { return Ok(Self { version: 1, ..Self::default() }) };
        let text = super::check::read_text(path)?;
        let scene: Self = serde_saphyr::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        if scene.version != 1 {
            return Err(format!("{}: version is {}; it must be 1", path.display(), scene.version));
        }
        Ok(scene)
    }

    /// The settings, over the defaults.
    ///
    /// # Errors
    /// Names a value that makes no sense.
    pub fn settings(&self) -> Result<Settings, String> {
        let (w, mut s) = (&self.world, Settings::default());
        if let Some(t) = w.control_interval {
            s.control_interval_ns = interval_ns(t)?;
        }
        s.steps_per_interval = w.steps_per_interval.unwrap_or(s.steps_per_interval);
        s.solver_iterations = w.solver_iterations.unwrap_or(s.solver_iterations);
        s.time_scale = w.time_scale.unwrap_or(s.time_scale);
        s.gravity = w.gravity.unwrap_or(s.gravity);
        if let Some(name) = &w.integrator {
            s.integrator = integrator(name)?;
        }
        Ok(s)
    }

    /// What is read but has no effect yet.
    pub fn pending(&self) -> Vec<String> {
        let named = [("ground", self.ground.is_some()), ("bodies", self.bodies.is_some())];
        let said = |(name, _): (&str, bool)| format!("scene: {name} is read but not simulated yet");
        named.into_iter().filter(|(_, present)| *present).map(said).collect()
    }
}

/// A control interval in whole nanoseconds.
///
/// # Errors
/// If it is not a positive number.
pub fn interval_ns(seconds: f64) -> Result<i64, String> {
    if seconds.is_finite() && seconds > 0.0 {
        Ok((seconds * 1e9).round() as i64)
    } else {
        Err(format!("control_interval is {seconds} s; it must be from 0.000001 to 1 s"))
    }
}

/// An integrator by name.
///
/// # Errors
/// Names those that exist.
pub fn integrator(name: &str) -> Result<Integrator, String> {
    Integrator::by_name(name).ok_or_else(|| {
        let known: Vec<&str> = Integrator::NAMES.iter().map(|(n, _)| *n).collect();
        format!("integrator '{name}' does not exist; choose one of: {}", known.join(", "))
    })
}
