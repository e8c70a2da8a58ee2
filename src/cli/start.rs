//! What a run of `simulate`, `compare` or `sweep` starts with: world, script and schedule, as arguments and scene want them.

use super::args::{RunArgs, assignment, numbers};
use super::commands::{self, axis};
use super::load::Loaded;
use super::scene::{
    Assembly, Fault, Scene, Spare, assemble, couple, engine, inside, integrator, interval_ns, outside, pose,
    switch_effect,
};
use super::script::{Script, ScriptText};
use crate::description::Severity;
use crate::engine::{State, unused_integrator};
use crate::math::{Pose, Vec3};
use crate::model::{Base, Model};
use crate::world::{Integrator, Settings, World};
use std::sync::Arc;

/// A run before its first step, as arguments and scene want it.
pub(super) struct Start {
    pub world: World,
    pub script: Script,
    /// Control intervals to make.
    pub intervals: u64,
    /// Control intervals between two rows.
    pub every: u64,
    pub warnings: Vec<String>,
    /// Is the error of the run estimated?
    pub estimates: bool,
}

impl Start {
    /// With this engine, or that of the scene. `Err`: exit code (1 not loaded, 2 wrong arguments) and reason.
    pub fn new(args: &RunArgs, engine: Option<&str>, every: Option<f64>) -> Result<Self, (u8, String)> {
        let usage = |reason| (2, reason);
        let scene = Scene::read(args.start.scene.as_deref()).map_err(usage)?;
        let script = args.script.as_deref().map(ScriptText::read).transpose().map_err(usage)?;
        Self::of_scene(args, (scene, script), engine, every)
    }

    /// The same, of a scene and a script that have been read; those that `args` name do not count.
    ///
    /// # Errors
    /// As [`Start::new`].
    pub fn of_scene(
        args: &RunArgs,
        (mut scene, script): (Scene, Option<ScriptText>),
        engine: Option<&str>,
        every: Option<f64>,
    ) -> Result<Self, (u8, String)> {
        let usage = |reason| (2, reason);
        if args.start.ground {
            scene.lay_ground();
        }
        let settings = settings(args, engine, &scene).map_err(usage)?;
        scene.settings.engine = settings.engine;
        let stand = (base(args, &scene), base_pose(args, &scene).map_err(usage)?);
        let (source, switch) =
            (args.start.packages.source(args.start.urdf.as_deref()), |m: &mut Model| switch_effects(args, &scene, m));
        let assembly = assemble(&scene, source, stand, Spare::Nobody, &switch).map_err(code)?;
        let Assembly { first: loaded, model, mut initial, warnings: about_others } = assembly;
        override_start(args, &model, &mut initial).map_err(usage)?;
        let mut world = World::new(Arc::new(model), settings).map_err(usage)?;
        world.set_initial_state(initial);
        commands::turn(args, &mut world).map_err(usage)?;
        commands::command(args, &mut world).map_err(usage)?;
        let (intervals, every) = schedule(args.duration, every, &settings).map_err(usage)?;
        let read = |text: ScriptText| text.compile(&world, &loaded.description, (interval(&settings), intervals));
        let script = script.map(read).transpose().map_err(usage)?.unwrap_or_default();
        let mut warnings = warnings(&loaded);
        warnings.extend(about_others);
        warnings.extend(outside(world.model(), world.state()).map(|(_, said)| said + ": its stop pushes it back"));
        warnings.extend(inside(world.model(), world.state()));
        warnings.extend(beyond(&world));
        warnings.extend(unused_integrator(settings.engine, settings.integrator).map(|s| s.of(settings.engine)));
        if intervals == 0 && args.duration > 0.0 {
            warnings.push("the duration is less than half a control interval: no step is made".into());
        }
        warnings.extend(script.warnings.iter().cloned());
        Ok(Self { world, script, intervals, every, warnings, estimates: false })
    }
}

fn settings(args: &RunArgs, engine_name: Option<&str>, scene: &Scene) -> Result<Settings, String> {
    let mut s = scene.settings;
    if let Some(t) = args.control_interval {
        s.control_interval_ns = interval_ns(t)?;
    }
    s.steps_per_interval = args.steps.unwrap_or(s.steps_per_interval);
    s.solver_iterations = args.iterations.unwrap_or(s.solver_iterations);
    s.time_scale = args.time_scale.unwrap_or(s.time_scale);
    if let Some(g) = &args.gravity {
        s.gravity = numbers("--gravity", "X,Y,Z in m/s²", g)?;
    }
    if let Some(name) = &args.start.integrator {
        s.integrator = integrator(name)?;
    }
    if let Some(name) = engine_name {
        s.engine = engine(name)?;
    }
    if let Some(accuracy) = args.accuracy {
        set_accuracy(&mut s, accuracy, args)?;
    }
    s.check()?;
    Ok(s)
}

/// `--accuracy`: the method that takes one, with steps of its own.
fn set_accuracy(s: &mut Settings, accuracy: f64, args: &RunArgs) -> Result<(), String> {
    if args.start.integrator.is_some() && s.integrator != Integrator::Extrapolation {
        let given = s.integrator.name();
        return Err(format!(
            "--accuracy {accuracy} is for --integrator extrapolation, not {given}: leave one of them out"
        ));
    }
    s.integrator = Integrator::Extrapolation;
    s.accuracy = accuracy;
    s.steps_per_interval = args.steps.unwrap_or(1);
    Ok(())
}

fn base(args: &RunArgs, scene: &Scene) -> Base {
    args.start.base.as_deref().map(super::base_by_name).or(scene.base).unwrap_or(Base::Fixed)
}

fn base_pose(args: &RunArgs, scene: &Scene) -> Result<Pose, String> {
    let Some(text) = &args.start.base_pose else { return Ok(scene.robot.pose) };
    let form = "X,Y,Z,QX,QY,QZ,QW";
    pose(numbers("--base-pose", form, text)?).map_err(|reason| format!("--base-pose {text}: {reason}"))
}

fn switch_effects(args: &RunArgs, scene: &Scene, model: &mut Model) -> Result<(), String> {
    scene.switch_effects(model)?;
    if let Some(both) = args.start.off.iter().find(|name| args.on.contains(name)) {
        return Err(format!("--off {both} and --on {both} contradict each other; leave one of them out"));
    }
    for (flag, names, on) in [("--off", &args.start.off, false), ("--on", &args.on, true)] {
        for name in names {
            switch_effect(model, name, on).map_err(|reason| format!("{flag} {name}: {reason}"))?;
        }
    }
    Ok(())
}

/// What the flags say of the start, over what the scene says.
fn override_start(args: &RunArgs, m: &Model, s: &mut State) -> Result<(), String> {
    if let Some(text) = &args.start.base_twist {
        if m.base == Base::Fixed {
            return Err("--base-twist needs --base free".into());
        }
        let t: [f64; 6] = numbers("--base-twist", "WX,WY,WZ,VX,VY,VZ", text)?;
        s.set_base_twist(m, Vec3::new(t[0], t[1], t[2]), Vec3::new(t[3], t[4], t[5]));
    }
    let mut given = vec![];
    for text in &args.start.set {
        let form = "AXIS=POSITION[,VELOCITY]";
        let (name, values) = assignment("--set", form, text)?;
        let axis = axis(m, "--set", name)?;
        match values[..] {
            [position] => s.set_axis(m, axis, position, 0.0),
            [position, speed] => s.set_axis(m, axis, position, speed),
            _ => return Err(format!("--set {text}: must be {form}")),
        }
        if given.contains(&axis) {
            return Err(format!("--set {text}: axis '{name}' is already set"));
        }
        given.push(axis);
    }
    couple(m, s, &given).map_err(|reason| format!("--set: {reason}"))
}

/// Exit code and reason.
fn code(fault: Fault) -> (u8, String) {
    match fault {
        Fault::Robot(report) => (1, report),
        Fault::Scene(reason) => (2, reason),
    }
}

/// Simulated time of a control interval, s.
pub(super) fn interval(s: &Settings) -> f64 {
    s.control_interval_ns as f64 * 1e-9 * s.time_scale
}

/// Number of intervals, and of intervals between two rows.
fn schedule(duration: f64, every: Option<f64>, s: &Settings) -> Result<(u64, u64), String> {
    let interval = interval(s);
    if interval <= 0.0 {
        return Err("time_scale 0 stops time: the duration would never be reached".into());
    }
    if !duration.is_finite() || duration < 0.0 {
        return Err(format!("--duration {duration}: must be a finite number of seconds, 0 or more"));
    }
    let every = every.unwrap_or(interval);
    let ratio = every / interval;
    // Far more than rounding, far less than a mistake.
    let whole = ratio.is_finite() && ratio >= 0.5 && (ratio - ratio.round()).abs() <= 1e-6;
    if !whole {
        let scaled = if s.time_scale == 1.0 { "" } else { " times the time scale" };
        return Err(format!("--every {every}: must be a whole multiple of the control interval{scaled}, {interval} s"));
    }
    Ok(((duration / interval).round() as u64, ratio.round() as u64))
}

/// What the axes cannot do of their commands.
fn beyond(world: &World) -> Vec<String> {
    if !world.model().effects.drives {
        let commanded = world.commands().iter().any(|c| c.mode != crate::world::Mode::Idle);
        return if commanded { vec!["the effect drives is off: commands have no effect".into()] } else { vec![] };
    }
    let axes = world.model().axes.iter().enumerate().zip(world.commands());
    axes.filter_map(|((i, axis), command)| command.beyond(axis, world.drive(i)?)).collect()
}

fn warnings(loaded: &Loaded) -> Vec<String> {
    let told = loaded.findings.iter().filter(|f| f.severity == Severity::Warning);
    told.map(|f| format!("{}:{}: {}: {}", loaded.description.file, f.at.line, f.element, f.message)).collect()
}
