//! What a scene file may say, word by word. Unknown keys are refused, with their line.

use serde::Deserialize;
use serde_json::{Map, Value};
use serde_saphyr::Spanned;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::cli) struct SceneFile {
    /// Version of the format: 1.
    pub version: u32,
    /// World settings.
    pub world: Option<Spanned<WorldSettings>>,
    /// The first robot, the one of the command line.
    pub robot: Option<Spanned<Robot>>,
    /// Further robots.
    #[serde(default)]
    pub robots: Vec<Spanned<Robot>>,
    /// Free and static bodies.
    #[serde(default)]
    pub bodies: Vec<Spanned<Body>>,
    /// An infinite half-space.
    pub ground: Option<Spanned<Value>>,
    /// Surfaces where nothing says otherwise.
    pub defaults: Option<Spanned<Defaults>>,
}

/// `world:`; what is absent keeps its default.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::cli) struct WorldSettings {
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
    /// implicit_midpoint, semi_implicit_euler, rk4 or extrapolation.
    pub integrator: Option<String>,
    /// 1e-14 … 1e-2, of the integrator extrapolation.
    pub accuracy: Option<f64>,
    /// rbx, rapier or bullet.
    pub engine: Option<String>,
    /// Effects to switch.
    #[serde(default)]
    pub effects: BTreeMap<String, bool>,
}

/// `robot:` and an entry of `robots:`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::cli) struct Robot {
    /// Name, of a further robot.
    pub name: Option<String>,
    /// URDF file; a relative path starts at the scene file.
    pub urdf: Option<PathBuf>,
    /// fixed or free.
    pub base: Option<String>,
    /// Root link in the world: x, y, z, qx, qy, qz, qw.
    pub pose: Option<[f64; 7]>,
    /// Of a free base, in the base frame: wx, wy, wz, vx, vy, vz.
    pub twist: Option<[f64; 6]>,
    /// Positions of axes at start, rad or m.
    #[serde(default)]
    pub set: BTreeMap<String, f64>,
}

/// An entry of `bodies:`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::cli) struct Body {
    /// Name.
    pub name: String,
    /// In the world: x, y, z, qx, qy, qz, qw.
    pub pose: Option<[f64; 7]>,
    /// Of the centre of mass, m/s.
    pub velocity: Option<[f64; 3]>,
    /// rad/s.
    pub angular_velocity: Option<[f64; 3]>,
    /// Of both velocities: world or body.
    pub frame: Option<String>,
    /// It never moves.
    #[serde(rename = "static", default)]
    pub fixed: bool,
    /// One shape, in the words of the tags.
    pub shape: Map<String, Value>,
    /// kg, instead of a specific gravity.
    pub mass: Option<f64>,
    /// 1 = 1000 kg/m³; 0: static.
    pub specific_gravity: Option<f64>,
    /// ixx, ixy, ixz, iyy, iyz, izz about the centre of mass, kg·m²; with mass.
    pub inertia: Option<[f64; 6]>,
    /// Centre of mass in the body's frame, m; with inertia.
    pub center: Option<[f64; 3]>,
    /// Attributes of `<surface>`.
    #[serde(default)]
    pub surface: Map<String, Value>,
    /// Attributes of `<damping>`.
    #[serde(default)]
    pub damping: Map<String, Value>,
    /// Attributes of `<deactivate>`.
    #[serde(default)]
    pub deactivate: Map<String, Value>,
    /// What collides instead of the shape, in the same words.
    pub proxy: Option<Map<String, Value>>,
    /// world or body.
    pub monitor: Option<String>,
}

/// `ground:` with attributes.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::cli) struct Ground {
    /// As in `<surface>`.
    pub friction: Option<f64>,
    /// m.
    pub rolling_friction: Option<f64>,
    /// m.
    pub spinning_friction: Option<f64>,
    /// 0 … 1.
    pub restitution: Option<f64>,
    /// m.
    pub margin: Option<f64>,
    /// Where it meets the Z axis, m.
    pub height: Option<f64>,
    /// Out of the ground.
    pub normal: Option<[f64; 3]>,
}

/// `defaults:`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::cli) struct Defaults {
    /// Of all surfaces.
    #[serde(default)]
    pub surface: SurfaceValues,
}

/// `defaults: surface:`.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::cli) struct SurfaceValues {
    /// As in `<surface>`.
    pub friction: Option<f64>,
    /// m.
    pub rolling_friction: Option<f64>,
    /// m.
    pub spinning_friction: Option<f64>,
    /// 0 … 1.
    pub restitution: Option<f64>,
    /// m.
    pub margin: Option<f64>,
}
