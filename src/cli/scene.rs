//! Scene files: world settings in YAML. Unknown keys are refused, with their line.

use crate::math::{Pose, Quat};
use crate::model::{Base, EFFECT_NAMES};
use crate::world::{Integrator, Settings};
use nalgebra::{Quaternion, Translation3};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A checked scene.
#[derive(Debug)]
pub struct Scene {
    /// Over the defaults.
    pub settings: Settings,
    /// How the root is held, if the scene says so.
    pub base: Option<Base>,
    /// Root link in the world.
    pub pose: Pose,
    /// Effects to switch, by name; every name exists.
    pub effects: BTreeMap<String, bool>,
    /// What is read but has no effect yet.
    pub pending: Vec<String>,
}

/// What a file says.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    /// Version of the format: 1.
    version: u32,
    /// World settings.
    #[serde(default)]
    world: WorldSettings,
    /// The robot.
    #[serde(default)]
    robot: Robot,
    /// Ground planes and terrain: read, not simulated yet.
    ground: Option<serde_json::Value>,
    /// Free bodies: read, not simulated yet.
    bodies: Option<serde_json::Value>,
}

/// `world:`; what is absent keeps its default.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct WorldSettings {
    /// s.
    control_interval: Option<f64>,
    /// 1 … 1000.
    steps_per_interval: Option<u32>,
    /// 1 … 10000.
    solver_iterations: Option<u32>,
    /// 0 … 100.
    time_scale: Option<f64>,
    /// m/s².
    gravity: Option<[f64; 3]>,
    /// implicit_midpoint, semi_implicit_euler or rk4.
    integrator: Option<String>,
    /// Effects to switch.
    #[serde(default)]
    effects: BTreeMap<String, bool>,
}

/// `robot:`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Robot {
    /// fixed or free.
    base: Option<String>,
    /// Root link in the world: x, y, z, qx, qy, qz, qw.
    pose: Option<[f64; 7]>,
}

impl Scene {
    /// Reads a file; without one, the scene is the defaults.
    ///
    /// # Errors
    /// Names the file, and the line and key, or the value that makes no sense.
    pub fn read(path: Option<&Path>) -> Result<Self, String> {
        let Some(path) = path else { return Self::checked(SceneFile { version: 1, ..SceneFile::default() }) };
        let text = super::check::read_text(path)?;
        let told = |reason: String| format!("{}: {reason}", path.display());
        let file = serde_saphyr::from_str(&text).map_err(|e| told(e.to_string()))?;
        Self::checked(file).map_err(told)
    }

    fn checked(file: SceneFile) -> Result<Self, String> {
        if file.version != 1 {
            return Err(format!("version is {}; it must be 1", file.version));
        }
        let settings = settings(&file.world)?;
        let base = file.robot.base.as_deref().map(base).transpose()?;
        let told = |reason: String| format!("robot: pose: {reason}");
        let pose = file.robot.pose.map_or(Ok(Pose::identity()), pose).map_err(told)?;
        if let Some(name) = file.world.effects.keys().find(|name| !EFFECT_NAMES.contains(&name.as_str())) {
            return Err(format!("effect '{name}' does not exist; choose from: {}", EFFECT_NAMES.join(", ")));
        }
        let named = [("ground", file.ground.is_some()), ("bodies", file.bodies.is_some())];
        let said = |(name, _): (&str, bool)| format!("scene: {name} is read but not simulated yet");
        let pending = named.into_iter().filter(|(_, present)| *present).map(said).collect();
        Ok(Self { settings, base, pose, effects: file.world.effects, pending })
    }
}

fn settings(w: &WorldSettings) -> Result<Settings, String> {
    let mut s = Settings::default();
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
    s.check()?;
    Ok(s)
}

fn base(name: &str) -> Result<Base, String> {
    match name {
        "fixed" => Ok(Base::Fixed),
        "free" => Ok(Base::Free),
        other => Err(format!("base '{other}' does not exist; choose one of: fixed, free")),
    }
}

/// A pose from x, y, z, qx, qy, qz, qw.
///
/// # Errors
/// If a number is not finite, or the quaternion's length is not 1 within 0.001.
pub fn pose(p: [f64; 7]) -> Result<Pose, String> {
    if let Some(x) = p.iter().find(|x| !x.is_finite()) {
        return Err(format!("{x} is not a finite number"));
    }
    let q = Quaternion::new(p[6], p[3], p[4], p[5]);
    if (q.norm() - 1.0).abs() > 1e-3 {
        return Err(format!("the quaternion's length is {}; it must be 1", q.norm()));
    }
    Ok(Pose::from_parts(Translation3::new(p[0], p[1], p[2]), Quat::from_quaternion(q)))
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
