//! Scene files: world settings, robots, bodies and the ground in YAML. Unknown keys are refused, with their line.

mod assemble;
mod body;
mod file;
mod ground;
mod limits;
mod start;

use super::load::Setup;
use crate::contact::Defaults;
use crate::math::{Pose, Quat};
use crate::model::{Base, Collider, EFFECT_NAMES};
use crate::world::{EngineKind, Integrator, Settings};
pub use assemble::{Assembly, Fault, Spare, Switch, assemble, switch_effect};
use body::BodyEntry;
pub(super) use file::SceneFile;
use file::{Robot, WorldSettings};
use ground::ground;
pub(super) use limits::plain;
use limits::{shown, within};
use nalgebra::{Quaternion, Translation3};
use serde_saphyr::{Location, Spanned};
pub use start::{Start, couple, inside, outside};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A checked scene.
#[derive(Debug)]
pub struct Scene {
    /// Over the defaults.
    pub settings: Settings,
    /// Which settings the file gives, by the names of the parameters.
    pub given: Vec<&'static str>,
    /// The first robot.
    pub robot: RobotEntry,
    /// The file speaks of it.
    has_robot: bool,
    /// How its root is held, if the scene says so.
    pub base: Option<Base>,
    /// Effects to switch, by name; every name exists.
    pub effects: BTreeMap<String, bool>,
    /// An infinite half-space.
    pub ground: Option<Collider>,
    robots: Vec<RobotEntry>,
    bodies: Vec<BodyEntry>,
    defaults: Defaults,
    /// The file; empty without one.
    path: PathBuf,
}

/// A robot in a scene.
#[derive(Clone, Debug)]
pub struct RobotEntry {
    /// Where it is said, for messages.
    place: String,
    /// Name; that of the first robot has no effect.
    name: String,
    /// As seen from the working directory.
    pub urdf: Option<PathBuf>,
    base: Base,
    /// Root link in the world.
    pub pose: Pose,
    /// Of a free base, in the base frame: angular (rad/s), then linear (m/s).
    twist: Option<[f64; 6]>,
    set: BTreeMap<String, f64>,
}

impl Scene {
    /// Reads a file; without one, the scene is the defaults.
    ///
    /// # Errors
    /// Names the file, and the line and key, or the value that makes no sense.
    pub fn read(path: Option<&Path>) -> Result<Self, String> {
        let Some(path) = path else {
            return Self::checked(SceneFile { version: 1, ..SceneFile::default() }, Path::new(""));
        };
        let text = super::check::read_text(path)?;
        let told = |reason: String| format!("{}: {reason}", path.display());
        if text.trim().is_empty() {
            return Err(told("the file is empty; a scene begins with version: 1".into()));
        }
        let file = serde_saphyr::from_str(&text).map_err(|e| told(plain(&e.to_string())))?;
        Self::checked(file, path).map_err(told)
    }

    /// A scene that stands in another file, at `path`.
    pub(super) fn of_words(words: SceneFile, path: &Path) -> Result<Self, String> {
        Self::checked(words, path)
    }

    fn checked(file: SceneFile, path: &Path) -> Result<Self, String> {
        if file.version != 1 {
            return Err(format!("version is {}; it must be 1", file.version));
        }
        let world = or_nothing(file.world);
        let settings = at_line(&world, "world", settings(&world.value))?;
        let has_robot = file.robot.is_some();
        let (base, robot) = first(or_nothing(file.robot), path)?;
        let defaults = or_nothing(file.defaults);
        let defaults = at_line(&defaults, "defaults: surface", ground::defaults(&defaults.value.surface))?;
        let ground = file.ground.map(|g| at_line(&g, "ground", ground(&g.value, defaults))).transpose()?.flatten();
        let robots: Result<Vec<_>, String> =
            (file.robots.into_iter().enumerate()).map(|(i, r)| further(i, r, path)).collect();
        let bodies: Result<Vec<_>, String> = (file.bodies.into_iter().enumerate()).map(|(i, b)| entry(i, b)).collect();
        let (given, effects) = (given(&world.value), world.value.effects);
        let (robots, bodies, path) = (robots?, bodies?, path.to_owned());
        unique(robots.iter().map(|r| (&r.place, &r.name)).chain(bodies.iter().map(|b| (&b.place, &b.name))))?;
        Ok(Self { settings, given, robot, has_robot, base, effects, ground, robots, bodies, defaults, path })
    }

    fn setup(&self, base: Base, base_pose: Pose) -> Setup {
        Setup { base, base_pose, surface: self.defaults, engine: self.settings.engine }
    }

    /// The flat ground z = 0, if the scene has none of its own.
    pub fn lay_ground(&mut self) {
        let defaults = self.defaults;
        self.ground.get_or_insert_with(|| ground::flat(defaults));
    }

    /// Who stands in for a robot that neither the command line nor the scene names: nobody, where the scene does not speak of
    /// one, but of something else.
    pub fn spare(&self) -> Spare {
        if self.has_company() && !self.has_robot { Spare::Nobody } else { Spare::Humanoid }
    }

    /// True if there is more in the scene than the first robot.
    pub fn has_company(&self) -> bool {
        !(self.robots.is_empty() && self.bodies.is_empty())
    }
}

/// Which of the settings are there.
fn given(w: &WorldSettings) -> Vec<&'static str> {
    let all = [
        ("control_interval", w.control_interval.is_some()),
        ("steps_per_interval", w.steps_per_interval.is_some()),
        ("solver_iterations", w.solver_iterations.is_some()),
        ("time_scale", w.time_scale.is_some()),
        ("gravity", w.gravity.is_some()),
        ("integrator", w.integrator.is_some()),
        ("accuracy", w.accuracy.is_some()),
        ("engine", w.engine.is_some()),
    ];
    all.into_iter().filter(|(_, given)| *given).map(|(name, _)| name).collect()
}

/// Names are those of frames and topics: they must be there, alone, and free of what parts names.
fn unique<'a>(names: impl Iterator<Item = (&'a String, &'a String)>) -> Result<(), String> {
    let mut known: Vec<&str> = vec![];
    for (place, name) in names {
        if name.is_empty() || name.contains(|c: char| c == '/' || c.is_whitespace() || c.is_control()) {
            return Err(format!("{place}: name '{name}': must be a word without blanks and slashes"));
        }
        if known.contains(&name.as_str()) {
            return Err(format!("{place}: the name '{name}' is already taken"));
        }
        if ["world", "base"].contains(&name.as_str()) {
            return Err(format!("{place}: the name '{name}' stands for something else; choose another one"));
        }
        known.push(name);
    }
    Ok(())
}

/// What is absent says nothing, nowhere.
fn or_nothing<T: Default>(entry: Option<Spanned<T>>) -> Spanned<T> {
    entry.unwrap_or_else(|| Spanned::new(T::default(), Location::UNKNOWN, Location::UNKNOWN))
}

/// Where an entry of a list stands.
fn stands<T>(list: &str, index: usize, entry: &Spanned<T>, name: &str) -> String {
    format!("line {}: {list}[{index}] '{name}'", entry.defined.line())
}

fn at_line<T, R>(entry: &Spanned<T>, key: &str, result: Result<R, String>) -> Result<R, String> {
    result.map_err(|reason| format!("line {}: {key}: {reason}", entry.defined.line()))
}

/// The first robot, and how its root is held if the scene says so.
fn first(entry: Spanned<Robot>, path: &Path) -> Result<(Option<Base>, RobotEntry), String> {
    let place = match entry.defined {
        Location::UNKNOWN => "robot".into(),
        defined => format!("line {}: robot", defined.line()),
    };
    if entry.value.name.is_some() {
        return Err(format!("{place}: name: the first robot keeps its own names; names are for the entries of robots"));
    }
    let told = |reason: String| format!("{place}: {reason}");
    let base = entry.value.base.as_deref().map(base).transpose().map_err(told)?;
    Ok((base, robot(entry.value, path, place)?))
}

fn further(index: usize, entry: Spanned<Robot>, path: &Path) -> Result<RobotEntry, String> {
    let name = entry.value.name.clone().unwrap_or_default();
    let place = stands("robots", index, &entry, &name);
    if entry.value.urdf.is_none() {
        return Err(format!("{place}: urdf is missing: which robot is it?"));
    }
    robot(entry.value, path, place)
}

fn entry(index: usize, entry: Spanned<file::Body>) -> Result<BodyEntry, String> {
    let place = stands("bodies", index, &entry, &entry.value.name);
    BodyEntry::new(entry.value, place)
}

fn robot(r: Robot, path: &Path, place: String) -> Result<RobotEntry, String> {
    let told = |reason: String| format!("{place}: {reason}");
    let base = r.base.as_deref().map(base).transpose().map_err(told)?.unwrap_or(Base::Fixed);
    let pose = r.pose.map_or(Ok(Pose::identity()), pose).map_err(|reason| told(format!("pose: {reason}")))?;
    within("twist", "m/s or rad/s", r.twist.as_ref().map_or(&[], |t| t)).map_err(told)?;
    r.set.iter().try_for_each(|(axis, x)| within(&format!("set: {axis}"), "", &[*x])).map_err(told)?;
    let beside = |urdf: PathBuf| path.parent().unwrap_or(Path::new("")).join(urdf);
    let (name, urdf) = (r.name.unwrap_or_default(), r.urdf.map(beside));
    Ok(RobotEntry { place, name, urdf, base, pose, twist: r.twist, set: r.set })
}

fn settings(w: &WorldSettings) -> Result<Settings, String> {
    if let Some(name) = w.effects.keys().find(|name| !EFFECT_NAMES.contains(&name.as_str())) {
        return Err(format!("effect '{name}' does not exist; choose from: {}", EFFECT_NAMES.join(", ")));
    }
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
    if let Some(name) = &w.engine {
        s.engine = engine(name)?;
    }
    s.accuracy = w.accuracy.unwrap_or(s.accuracy);
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
/// If a number is not finite, a place too far away, or the quaternion's length is not 1 within 0.001.
pub fn pose(p: [f64; 7]) -> Result<Pose, String> {
    within("the place", "m", &p[..3])?;
    if let Some(x) = p.iter().find(|x| !x.is_finite()) {
        return Err(format!("{x} is not a finite number"));
    }
    let q = Quaternion::new(p[6], p[3], p[4], p[5]);
    if (q.norm() - 1.0).abs() > 1e-3 {
        return Err(format!("the quaternion's length is {}; it must be 1", shown(q.norm())));
    }
    Ok(Pose::from_parts(Translation3::new(p[0], p[1], p[2]), Quat::from_quaternion(q)))
}

/// A control interval in whole nanoseconds.
///
/// # Errors
/// If it is out of range.
pub fn interval_ns(seconds: f64) -> Result<i64, String> {
    if (1e-6..=1.0).contains(&seconds) {
        Ok((seconds * 1e9).round() as i64)
    } else {
        Err(format!("control_interval is {} s; it must be from 0.000001 to 1 s", shown(seconds)))
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

/// An engine by name.
///
/// # Errors
/// Names those that exist.
pub fn engine(name: &str) -> Result<EngineKind, String> {
    EngineKind::by_name(name).ok_or_else(|| {
        let known: Vec<&str> = EngineKind::NAMES.iter().map(|(n, _)| *n).collect();
        format!("engine '{name}' does not exist; choose one of: {}", known.join(", "))
    })
}
