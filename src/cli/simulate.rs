//! `realnoid simulate`: no ROS, as fast as it goes.

use super::args::{SimulateArgs, assignment, numbers};
use super::load::{Loaded, load_at};
use super::scene::{Scene, integrator, interval_ns};
use crate::description::Severity;
use crate::engine::{ENGINE_NAMES, State};
use crate::math::{Pose, Quat, Vec3};
use crate::model::{Base, EFFECT_NAMES, Model};
use crate::record::CsvWriter;
use crate::world::{AxisCommand, Settings, World};
use nalgebra::{Quaternion, Translation3};
use serde_json::json;
use std::fs::File;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Runs; prints the summary to standard output. Exit codes: 0 all finite, 1 not finite or not loaded, 2 wrong arguments.
pub fn run(args: &SimulateArgs) -> ExitCode {
    let mut plan = match Plan::new(args) {
        Ok(plan) => plan,
        Err((code, reason)) => {
            eprintln!("error: {}", reason.trim_end());
            return ExitCode::from(code);
        }
    };
    match plan.run() {
        Ok(summary) => {
            println!("{summary:#}");
            if summary["finite"] == true { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

/// Checked arguments.
struct Plan<'a> {
    args: &'a SimulateArgs,
    world: World,
    intervals: u64,
    every: u64,
    warnings: Vec<String>,
}

impl<'a> Plan<'a> {
    /// `Err`: exit code (1 not loaded, 2 wrong arguments) and reason.
    fn new(args: &'a SimulateArgs) -> Result<Self, (u8, String)> {
        let usage = |reason| (2, reason);
        let scene = Scene::read(args.scene.as_deref()).map_err(usage)?;
        let settings = settings(args, &scene).map_err(usage)?;
        let base = base(args, &scene).map_err(usage)?;
        let pose = base_pose(args, &scene).map_err(usage)?;
        let loaded = load_at(Some(&args.urdf), base, pose).map_err(|reason| (1, reason))?;
        let mut model = Model::clone(&loaded.model);
        switch_effects(args, &scene, &mut model).map_err(usage)?;
        let initial = initial_state(args, &model, pose).map_err(usage)?;
        let mut world = World::new(Arc::new(model), settings).map_err(usage)?;
        world.set_initial_state(initial);
        set_commands(args, &mut world).map_err(usage)?;
        let (intervals, every) = schedule(args, &settings).map_err(usage)?;
        let mut warnings = warnings(&loaded);
        warnings.extend(scene.pending());
        Ok(Self { args, world, intervals, every, warnings })
    }

    fn run(&mut self) -> Result<serde_json::Value, String> {
        let mut writer = match &self.args.out {
            Some(path) => Some(open(path, &self.world)?),
            None => None,
        };
        let mut cpu = 0.0;
        let mut rows = 0;
        for interval in 0..=self.intervals {
            if let Some(w) = writer.as_mut().filter(|_| interval % self.every == 0) {
                w.row(&self.world).map_err(|e| self.cannot_write(&e))?;
                rows += 1;
            }
            if interval < self.intervals {
                let start = super::bench::cpu_seconds();
                self.world.advance();
                cpu += super::bench::cpu_seconds() - start;
            }
        }
        if let Some(w) = writer {
            w.finish().map_err(|e| self.cannot_write(&e))?;
        }
        Ok(self.summary(cpu, rows))
    }

    fn cannot_write(&self, error: &std::io::Error) -> String {
        let path = self.args.out.as_deref().unwrap_or(Path::new(""));
        format!("cannot write '{}': {error}", path.display())
    }

    fn summary(&self, cpu: f64, rows: u64) -> serde_json::Value {
        let s = self.world.stats();
        let mut warnings = self.warnings.clone();
        let counted = [
            (
                s.fallback_steps,
                "steps were made by semi_implicit_euler, because a stop, dry friction at rest, a servo or a \
                                stiff viscous term acted",
            ),
            (s.unsettled_steps, "steps ended before the axis laws had settled: allow more --iterations"),
            (s.pole_steps, "steps had a 3dof group at its pole: torques about its angles were bounded there"),
            (s.diverged_steps, "step would have given values that are not finite: the world stood still from there on"),
        ];
        warnings.extend(counted.iter().filter(|(n, _)| *n > 0).map(|(n, text)| format!("{n} {text}")));
        json!({
            "steps": s.steps,
            "rows": rows,
            "simulated_seconds": self.world.time(),
            "cpu_seconds": cpu,
            "us_per_step": if s.steps > 0 { cpu * 1e6 / s.steps as f64 } else { 0.0 },
            "worst_penetration": 0.0,
            "finite": s.diverged_steps == 0,
            "fallback_steps": s.fallback_steps,
            "unsettled_steps": s.unsettled_steps,
            "pole_steps": s.pole_steps,
            "warnings": warnings,
        })
    }
}

fn settings(args: &SimulateArgs, scene: &Scene) -> Result<Settings, String> {
    let mut s = scene.settings()?;
    if let Some(t) = args.control_interval {
        s.control_interval_ns = interval_ns(t)?;
    }
    s.steps_per_interval = args.steps.unwrap_or(s.steps_per_interval);
    s.solver_iterations = args.iterations.unwrap_or(s.solver_iterations);
    s.time_scale = args.time_scale.unwrap_or(s.time_scale);
    if let Some(g) = &args.gravity {
        s.gravity = numbers("--gravity", "X,Y,Z in m/s²", g)?;
    }
    if let Some(name) = &args.integrator {
        s.integrator = integrator(name)?;
    }
    if let Some(name) = args.engine.as_deref().filter(|n| !ENGINE_NAMES.contains(n)) {
        return Err(format!("engine '{name}' does not exist; choose one of: {}", ENGINE_NAMES.join(", ")));
    }
    s.check()?;
    Ok(s)
}

fn base(args: &SimulateArgs, scene: &Scene) -> Result<Base, String> {
    match args.base.as_deref().or(scene.robot.base.as_deref()) {
        None | Some("fixed") => Ok(Base::Fixed),
        Some("free") => Ok(Base::Free),
        Some(other) => Err(format!("base '{other}' does not exist; choose one of: fixed, free")),
    }
}

fn base_pose(args: &SimulateArgs, scene: &Scene) -> Result<Pose, String> {
    let flag = args.base_pose.as_ref().map(|text| numbers("--base-pose", "X,Y,Z,QX,QY,QZ,QW", text)).transpose()?;
    let Some(p) = flag.or(scene.robot.pose) else { return Ok(Pose::identity()) };
    let q = Quaternion::new(p[6], p[3], p[4], p[5]);
    if (q.norm() - 1.0).abs() > 1e-3 {
        return Err(format!("base pose: the quaternion's length is {}; it must be 1", q.norm()));
    }
    Ok(Pose::from_parts(Translation3::new(p[0], p[1], p[2]), Quat::from_quaternion(q)))
}

fn switch_effects(args: &SimulateArgs, scene: &Scene, model: &mut Model) -> Result<(), String> {
    let from_scene = scene.world.effects.iter().map(|(name, on)| (name, *on));
    let flags = args.off.iter().map(|n| (n, false)).chain(args.on.iter().map(|n| (n, true)));
    for (name, on) in from_scene.chain(flags) {
        if !model.effects.switch(name, on) {
            return Err(format!("effect '{name}' does not exist; choose one of: {}", EFFECT_NAMES.join(", ")));
        }
    }
    Ok(())
}

fn initial_state(args: &SimulateArgs, m: &Model, pose: Pose) -> Result<State, String> {
    let mut s = State::initial(m);
    let (p, q) = (pose.translation, pose.rotation.coords);
    s.set_base_pose(m, [p.x, p.y, p.z], [q.x, q.y, q.z, q.w]);
    if let Some(text) = &args.base_twist {
        if m.base == Base::Fixed {
            return Err("--base-twist needs --base free".into());
        }
        let t: [f64; 6] = numbers("--base-twist", "WX,WY,WZ,VX,VY,VZ", text)?;
        s.set_base_twist(m, Vec3::new(t[0], t[1], t[2]), Vec3::new(t[3], t[4], t[5]));
    }
    for text in &args.set {
        let form = "AXIS=POSITION[,VELOCITY]";
        let (name, values) = assignment("--set", form, text)?;
        let axis = axis(m, "--set", name)?;
        match values[..] {
            [position] => s.set_axis(m, axis, position, 0.0),
            [position, speed] => s.set_axis(m, axis, position, speed),
            _ => return Err(format!("--set {text}: must be {form}")),
        }
    }
    Ok(s)
}

fn set_commands(args: &SimulateArgs, world: &mut World) -> Result<(), String> {
    let model = world.model().clone();
    let mut commands = world.commands().to_vec();
    let torque = AxisCommand::torque as fn(f64) -> AxisCommand;
    let given = args.effort.iter().map(|t| ("--effort", "AXIS=TORQUE", t, torque));
    let given =
        given.chain(args.servo.iter().map(|t| ("--servo", "AXIS=POSITION", t, AxisCommand::servo as fn(f64) -> _)));
    for (flag, form, text, command) in given {
        let (name, values) = assignment(flag, form, text)?;
        let [value] = values[..] else { return Err(format!("{flag} {text}: must be {form}")) };
        commands[axis(&model, flag, name)?] = command(value);
    }
    world.set_commands(&commands).map_err(|axis| format!("the command of axis {axis} is not sound"))
}

fn axis(m: &Model, flag: &str, name: &str) -> Result<usize, String> {
    m.axis(name).ok_or_else(|| {
        let names: Vec<&str> = m.axes.iter().map(|a| a.name.as_str()).collect();
        format!("{flag}: there is no axis '{name}'; the axes are: {}", names.join(", "))
    })
}

/// Number of intervals, and of intervals between two rows.
fn schedule(args: &SimulateArgs, s: &Settings) -> Result<(u64, u64), String> {
    let interval = s.control_interval_ns as f64 * 1e-9 * s.time_scale;
    if interval <= 0.0 {
        return Err("--time-scale 0 stops time: the duration would never be reached".into());
    }
    if !args.duration.is_finite() || args.duration < 0.0 {
        return Err(format!("--duration {}: must be a finite number of seconds, 0 or more", args.duration));
    }
    let every = args.every.unwrap_or(interval);
    if !every.is_finite() || every < interval * 0.999 {
        return Err(format!("--every {every}: must be at least one control interval, {interval} s"));
    }
    Ok(((args.duration / interval).round() as u64, (every / interval).round() as u64))
}

fn warnings(loaded: &Loaded) -> Vec<String> {
    let told = loaded.findings.iter().filter(|f| f.severity == Severity::Warning);
    told.map(|f| format!("{}:{}: {}: {}", loaded.description.file, f.at.line, f.element, f.message)).collect()
}

fn open(path: &Path, world: &World) -> Result<CsvWriter<File>, String> {
    let wrong = |e: std::io::Error| format!("cannot write '{}': {e}", path.display());
    match path.extension().and_then(|e| e.to_str()) {
        Some("csv") => CsvWriter::new(File::create(path).map_err(wrong)?, world).map_err(wrong),
        _ => Err(format!("--out {}: must end in .csv or .mcap", path.display())),
    }
}
