//! Robots, bodies and the ground → one model and one state.

use super::body::BodyEntry;
use super::start::Start;
use super::{RobotEntry, Scene};
use crate::cli::check::read_text;
use crate::cli::load::{Examined, Loaded, Source, examine_text, loaded};
use crate::description::{Finding, Severity};
use crate::engine::State;
use crate::math::{Mat3, Pose, Vec3};
use crate::model::{Base, EFFECT_NAMES, Model};
use std::path::{Path, PathBuf};

/// Least radius of gyration of a body, m.
const THINNEST: f64 = 1e-7;

/// A scene without a robot still has something that robots and bodies can join.
const NOBODY: &str = r#"<robot name="scene"><link name="stand"/></robot>"#;

/// A scene as it starts.
pub struct Assembly {
    /// The first robot, by itself.
    pub first: Loaded,
    /// Everything.
    pub model: Model,
    /// Where everything is, and how it moves.
    pub initial: State,
    /// About what joined the first robot.
    pub warnings: Vec<String>,
}

/// Switches effects.
pub type Switch<'a> = &'a dyn Fn(&mut Model) -> Result<(), String>;

/// Why there is nothing to simulate.
pub enum Fault {
    /// The first robot cannot be loaded: a report for people.
    Robot(String),
    /// The scene makes no sense.
    Scene(String),
}

/// The robot where neither the command line nor the scene names one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spare {
    /// The embedded humanoid.
    Humanoid,
    /// None, and it is a mistake if the scene is empty.
    Nobody,
}

/// Loads the first robot, on the base and at the pose given, and all that the scene puts beside it. Without a source the robot
/// is that of the scene. `switch` switches effects, of every model before it starts.
///
/// # Errors
/// [`Fault`].
pub fn assemble(
    scene: &Scene,
    source: Source,
    (base, pose): (Base, Pose),
    spare: Spare,
    switch: Switch,
) -> Result<Assembly, Fault> {
    let shown = |reason: String| Fault::Scene(scene.told(reason));
    let setup = scene.setup(base, pose);
    let urdf = source.urdf.or(scene.robot.urdf.as_deref());
    let examined = match urdf {
        None if spare == Spare::Nobody && scene.has_company() => {
            Ok(examine_text(("scene", NOBODY), source.packages, setup))
        }
        None if spare == Spare::Nobody => {
            let reason = "nothing to simulate: name a URDF file, or a scene with a robot (robot: urdf:) or with bodies";
            return Err(shown(reason.into()));
        }
        _ => crate::cli::load::examine_with(Source { urdf, ..source }, setup),
    };
    let examined = examined.map_err(|reason| match source.urdf {
        None if scene.robot.urdf.is_some() => Fault::Robot(scene.told(format!("{}: {reason}", scene.robot.place))),
        _ => Fault::Robot(reason),
    })?;
    let first = loaded(examined).map_err(Fault::Robot)?;
    let mut model = Model::clone(&first.model);
    switch(&mut model).map_err(Fault::Scene)?;
    let initial = start(&scene.robot, &model, pose).map_err(|r| shown(format!("{}: {r}", scene.robot.place)))?;
    let mut all = Union { initial, model, warnings: vec![], switch };
    for robot in &scene.robots {
        all.robot(scene, robot, source).map_err(shown)?;
    }
    for body in &scene.bodies {
        all.body(scene, body, source).map_err(shown)?;
    }
    if let Some(ground) = &scene.ground {
        let mut colliders = std::mem::take(&mut all.model.colliders);
        colliders.push(ground.clone());
        all.model.set_colliders(colliders);
    }
    let Union { mut model, initial, warnings, .. } = all;
    switch(&mut model).map_err(Fault::Scene)?;
    Ok(Assembly { first, model, initial, warnings })
}

/// What has been put together so far.
struct Union<'a> {
    model: Model,
    initial: State,
    warnings: Vec<String>,
    switch: Switch<'a>,
}

impl Union<'_> {
    fn robot(&mut self, scene: &Scene, robot: &RobotEntry, source: Source) -> Result<(), String> {
        let told = |reason: String| format!("{}: {reason}", robot.place);
        let urdf: PathBuf = robot.urdf.clone().unwrap_or_default();
        let text = read_text(&urdf).map_err(told)?;
        let setup = scene.setup(robot.base, robot.pose);
        let file = urdf.display().to_string();
        let examined = examine_text((&file, &text), source.packages, setup);
        let report = examined.report(Severity::Warning, false);
        let Some((_, _, mut model)) = examined.robot else { return Err(told(format!("cannot be loaded:\n{report}"))) };
        (self.switch)(&mut model)?;
        self.warn(&robot.place, &examined.findings);
        let state = start(robot, &model, robot.pose).map_err(told)?;
        self.join(model, &state, &robot.name).map_err(told)
    }

    fn body(&mut self, scene: &Scene, body: &BodyEntry, source: Source) -> Result<(), String> {
        let told = |reason: String| format!("{}: {reason}", body.place);
        let base = if body.fixed { Base::Fixed } else { Base::Free };
        let setup = scene.setup(base, body.pose);
        // Mesh files are looked for beside the scene file.
        let file = scene.path.display().to_string();
        let read = |scale: f64| -> Result<(Model, Examined), String> {
            let mut examined = examine_text((&file, &body.urdf(scale)), source.packages, setup);
            match examined.robot.take() {
                Some((_, _, model)) => Ok((model, examined)),
                None => Err(told(said(&examined.findings, Severity::Error).join("; "))),
            }
        };
        let (mut model, mut examined) = read(1.0)?;
        if let Some(mass) = body.mass {
            (model, examined) = read(mass / model.mass())?;
        }
        if let Some(hollow) = examined.findings.iter().find(|f| f.code == "does-not-collide") {
            return Err(told(format!("{} ({})", hollow.message, "a body needs a shape that can be read")));
        }
        spread(&model).map_err(told)?;
        self.warn(&body.place, &examined.findings);
        let state = thrown(body, &model);
        self.join(model, &state, &body.name).map_err(told)
    }

    fn warn(&mut self, place: &str, findings: &[Finding]) {
        self.warnings.extend(said(findings, Severity::Warning).iter().map(|w| format!("scene, {place}: {w}")));
    }

    fn join(&mut self, model: Model, state: &State, name: &str) -> Result<(), String> {
        if self.model.links.iter().any(|l| l.name == name) {
            return Err(format!("the name '{name}' is that of a link of the first robot; choose another one"));
        }
        self.model.join(model, name);
        self.initial.join(state);
        Ok(())
    }
}

/// Findings as they concern a body, whose text nobody has seen.
fn said(findings: &[Finding], least: Severity) -> Vec<String> {
    let told = |f: &Finding| match f.mend.is_empty() {
        true => f.message.clone(),
        false => format!("{} ({})", f.message, f.mend),
    };
    findings.iter().filter(|f| f.severity >= least).map(told).collect()
}

fn start(robot: &RobotEntry, m: &Model, pose: Pose) -> Result<State, String> {
    let set: Vec<(&str, f64)> = robot.set.iter().map(|(name, x)| (name.as_str(), *x)).collect();
    Start { pose, twist: robot.twist, set: &set }.state(m)
}

/// A body whose mass lies on a line or in a point is as good as free to turn: contacts cannot be solved beside its mass.
fn spread(m: &Model) -> Result<(), String> {
    let Some(b) = m.bodies.get(1).filter(|b| b.mass > 0.0) else { return Ok(()) };
    let (c, i) = (Vec3::from(b.mc) / b.mass, b.inertia);
    let at_origin = Mat3::new(i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz);
    let at_center = at_origin - (Mat3::identity() * c.norm_squared() - c * c.transpose()) * b.mass;
    let least = at_center.symmetric_eigenvalues().min();
    if least >= THINNEST * THINNEST * b.mass {
        return Ok(());
    }
    Err(format!(
        "its inertia about an axis is {least:e} kg·m², for {:e} kg: a radius of gyration below {THINNEST} m; give it more",
        b.mass
    ))
}

/// A body with its velocities (B-8 B … D).
fn thrown(body: &BodyEntry, m: &Model) -> State {
    let mut s = State::initial(m);
    if body.fixed {
        return s;
    }
    let (p, q) = (body.pose.translation, body.pose.rotation.coords);
    s.set_base_pose(m, [p.x, p.y, p.z], [q.x, q.y, q.z, q.w]);
    let (mut v, mut w) = body.velocity;
    if !body.own_axes {
        (v, w) = (body.pose.rotation.inverse() * v, body.pose.rotation.inverse() * w);
    }
    let center = m.bodies.get(1).map_or(Vec3::zeros(), |b| Vec3::from(b.mc) / b.mass);
    s.set_base_twist(m, w, v - w.cross(&center));
    s
}

impl Scene {
    /// Switches the effects that the scene names.
    ///
    /// # Errors
    /// Names an effect that does not exist.
    pub fn switch_effects(&self, m: &mut Model) -> Result<(), String> {
        self.effects.iter().try_for_each(|(name, on)| switch_effect(m, name, *on))
    }

    fn told(&self, reason: String) -> String {
        if self.path == Path::new("") { reason } else { format!("{}: {reason}", self.path.display()) }
    }
}

/// Switches one effect.
///
/// # Errors
/// Names those that exist.
pub fn switch_effect(m: &mut Model, name: &str, on: bool) -> Result<(), String> {
    let known = || format!("effect '{name}' does not exist; choose one of: {}", EFFECT_NAMES.join(", "));
    if m.effects.switch(name, on) { Ok(()) } else { Err(known()) }
}
