//! `realnoid simulate`: no ROS, as fast as it goes.

use super::args::{RunArgs, SimulateArgs, assignment, numbers};
use super::commands::{self, axis};
use super::load::Loaded;
use super::outcome::{Outcome, Peak, Progress, counted};
use super::scene::{
    Assembly, Fault, Scene, Spare, assemble, couple, engine, inside, integrator, interval_ns, outside, pose,
    switch_effect,
};
use super::script::Script;
use crate::description::Severity;
use crate::engine::{State, unused_integrator};
use crate::math::{Pose, Vec3};
use crate::model::{Base, Model};
use crate::record::{ContactWriter, Format, Recorder, Sample};
use crate::world::{ContactPoint, Settings, World};
use serde_json::json;
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by SIGINT and SIGTERM: the run ends early, its file is completed.
static STOP: AtomicBool = AtomicBool::new(false);

/// From here on, SIGINT and SIGTERM only set what [`stopped`] tells.
pub(super) fn catch_signals() {
    // Without the handler the run only loses its neat end.
    let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
}

/// Has a signal come?
pub(super) fn stopped() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Runs; prints the summary to standard output. Exit codes: 0 all finite; 1 not finite, stopped by a signal, robot not
/// loaded, output not written; 2 wrong arguments or scene.
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
            // A reader that has gone away (`| head`) is no failure of the run.
            let _ = writeln!(std::io::stdout(), "{summary:#}");
            let complete = summary["finite"] == true && summary["stopped"] == false;
            if complete { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

/// The files of a run.
struct Records {
    recorder: Option<Recorder>,
    contacts: Option<ContactWriter<File>>,
}

impl Records {
    /// True if a row was written.
    fn write(&mut self, sample: &Sample, contacts: &[ContactPoint]) -> Result<bool, String> {
        if let Some(writer) = &mut self.contacts {
            writer.rows(&sample.snapshot, contacts).map_err(|cause| format!("--contacts: cannot write: {cause}"))?;
        }
        let Some(recorder) = &mut self.recorder else { return Ok(false) };
        recorder.write(sample).map_err(|e| e.to_string())?;
        Ok(true)
    }
}

/// Checked arguments.
struct Plan<'a> {
    args: &'a SimulateArgs,
    world: World,
    script: Script,
    intervals: u64,
    every: u64,
    warnings: Vec<String>,
}

/// A run before its first step, as arguments and scene want it.
pub(super) struct Start {
    pub world: World,
    pub script: Script,
    /// Control intervals to make.
    pub intervals: u64,
    /// Control intervals between two rows.
    pub every: u64,
    pub warnings: Vec<String>,
}

impl Start {
    /// With this engine, or that of the scene. `Err`: exit code (1 not loaded, 2 wrong arguments) and reason.
    pub fn new(args: &RunArgs, engine: Option<&str>, every: Option<f64>) -> Result<Self, (u8, String)> {
        let usage = |reason| (2, reason);
        let mut scene = Scene::read(args.scene.as_deref()).map_err(usage)?;
        if args.ground {
            scene.lay_ground();
        }
        let settings = settings(args, engine, &scene).map_err(usage)?;
        scene.settings.engine = settings.engine;
        let stand = (base(args, &scene), base_pose(args, &scene).map_err(usage)?);
        let (source, switch) =
            (args.packages.source(args.urdf.as_deref()), |m: &mut Model| switch_effects(args, &scene, m));
        let assembly = assemble(&scene, source, stand, Spare::Nobody, &switch).map_err(code)?;
        let Assembly { first: loaded, model, mut initial, warnings: about_others } = assembly;
        override_start(args, &model, &mut initial).map_err(usage)?;
        let mut world = World::new(Arc::new(model), settings).map_err(usage)?;
        world.set_initial_state(initial);
        commands::turn(args, &mut world).map_err(usage)?;
        commands::command(args, &mut world).map_err(usage)?;
        let (intervals, every) = schedule(args.duration, every, &settings).map_err(usage)?;
        let read = |path| Script::read(path, &world, &loaded.description, (interval(&settings), intervals));
        let script = args.script.as_deref().map(read).transpose().map_err(usage)?.unwrap_or_default();
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
        Ok(Self { world, script, intervals, every, warnings })
    }
}

impl<'a> Plan<'a> {
    /// `Err`: exit code (1 not loaded, 2 wrong arguments) and reason.
    fn new(args: &'a SimulateArgs) -> Result<Self, (u8, String)> {
        args.out.as_deref().map(Format::of).transpose().map_err(|e| (2, format!("--out {e}")))?;
        let Start { world, script, intervals, every, warnings } =
            Start::new(&args.run, args.engine.as_deref(), args.every)?;
        Ok(Self { args, world, script, intervals, every, warnings })
    }

    fn run(&mut self) -> Result<serde_json::Value, String> {
        let open = |path: &PathBuf| Recorder::create(path, self.world.model());
        let recorder = self.args.out.as_ref().map(open).transpose().map_err(|e| e.to_string())?;
        let touches = |path| ContactWriter::new(File::create(path)?, self.world.model());
        let told = |cause: io::Error| format!("--contacts: cannot write the file: {cause}");
        let contacts = self.args.contacts.as_ref().map(touches).transpose().map_err(told)?;
        let mut records = Records { recorder, contacts };
        catch_signals();
        let mut progress = Progress::new();
        let outcome = self.simulate(&mut records, &mut progress);
        progress.clear();
        let mut outcome = outcome?;
        if let Some(recorder) = records.recorder {
            outcome.files = recorder.finish().map_err(|e| e.to_string())?;
        }
        if let Some(contacts) = records.contacts {
            contacts.finish().map_err(told)?;
            outcome.files.extend(self.args.contacts.clone());
        }
        Ok(self.summary(&outcome))
    }

    fn simulate(&mut self, records: &mut Records, progress: &mut Progress) -> Result<Outcome, String> {
        let peaks = vec![Peak::default(); self.world.model().axes.len()];
        let e = self.world.energy();
        let mut outcome = Outcome { finite: true, energy: e.kinetic + e.potential, peaks, ..Outcome::default() };
        let mut sample = Sample::new(&self.world);
        for interval in 0..=self.intervals {
            let complete = interval == self.intervals;
            outcome.stopped = !complete && stopped();
            let (last, row) = (complete || outcome.stopped, interval % self.every == 0);
            if row || last {
                sample.take(&self.world);
                outcome.finite &= sample.is_finite();
            }
            if row {
                outcome.rows += u64::from(records.write(&sample, self.world.contacts())?);
            }
            if last {
                break;
            }
            progress.show(interval, self.intervals);
            self.script.apply(interval, &mut self.world);
            let start = super::bench::cpu_seconds();
            self.world.advance();
            outcome.cpu += super::bench::cpu_seconds() - start;
            outcome.note_peaks(&self.world);
        }
        Ok(outcome)
    }

    /// Where the energy (J) went; what is unaccounted for is the error of the integrator.
    fn ledger(&self, start: f64) -> serde_json::Value {
        let (e, work, stats) = (self.world.energy(), self.world.work(), self.world.stats());
        let end = e.kinetic + e.potential;
        let taken = work.losses + work.contacts + stats.trimmed_energy + stats.guarded_energy;
        json!({
            "start": start,
            "end": end,
            "work_of_drives": work.drives,
            "losses": work.losses,
            "losses_at_contacts": work.contacts,
            "trimmed": stats.trimmed_energy,
            "unaccounted": end - start - work.drives + taken,
        })
    }

    fn summary(&self, outcome: &Outcome) -> serde_json::Value {
        let (s, cpu) = (self.world.stats(), outcome.cpu);
        let broken = self.world.broken().iter();
        let broken: Vec<_> = broken.map(|b| json!({"joint": *b.joint, "time": b.time, "force": b.force})).collect();
        json!({
            "engine": self.world.settings().engine.name(),
            "steps": s.steps,
            "rows": outcome.rows,
            "output": outcome.files,
            "simulated_seconds": self.simulated(),
            "cpu_seconds": cpu,
            "us_per_step": if s.steps > 0 { cpu * 1e6 / s.steps as f64 } else { 0.0 },
            "worst_penetration": s.worst_penetration,
            "contacts": self.world.contacts().len(),
            "worst_stop_violation": s.worst_stop_violation,
            "joint_drift": self.world.joint_drift(),
            "peaks": outcome.peaks(self.world.model()),
            "finite": outcome.finite,
            "stopped": outcome.stopped,
            "fallback_steps": s.fallback_steps,
            "unsettled_steps": s.unsettled_steps,
            "halvings": s.halvings,
            "divided_steps": s.divided_steps,
            "fast_pieces": s.fast_pieces,
            "guarded_pieces": s.guarded_pieces,
            "guarded_energy": s.guarded_energy,
            "trimmed_energy": s.trimmed_energy,
            "tempered_steps": s.tempered_steps,
            "worst_residual": s.worst_residual,
            "energy": self.ledger(outcome.energy),
            "pole_steps": s.pole_steps,
            "broken_joints": broken,
            "warnings": self.all_warnings(outcome),
        })
    }

    /// Simulated time, s; of a world that stands still, up to there.
    fn simulated(&self) -> f64 {
        let s = self.world.settings();
        let step = interval(s) / f64::from(s.steps_per_interval);
        if self.world.stats().diverged_steps > 0 {
            self.world.stats().steps.saturating_sub(1) as f64 * step
        } else {
            self.world.time()
        }
    }

    /// Those from before the run, and what the run had to tell.
    fn all_warnings(&self, outcome: &Outcome) -> Vec<String> {
        let s = self.world.stats();
        let mut warnings = self.warnings.clone();
        if outcome.stopped {
            warnings.push("stopped by a signal before the end of the duration".into());
        }
        if !outcome.finite && s.diverged_steps == 0 {
            warnings.push("a value is not finite: the state can be represented, its energy or momentum cannot".into());
        }
        let broken = self.world.broken().iter();
        warnings.extend(broken.map(|b| format!("joint '{}' {b}, more than its break_threshold", b.joint)));
        let counted = counted(&s).into_iter().filter(|(n, _)| *n > 0);
        warnings.extend(counted.map(|(n, text)| format!("{n} {text}")));
        warnings
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
    if let Some(name) = &args.integrator {
        s.integrator = integrator(name)?;
    }
    if let Some(name) = engine_name {
        s.engine = engine(name)?;
    }
    s.check()?;
    Ok(s)
}

fn base(args: &RunArgs, scene: &Scene) -> Base {
    args.base.as_deref().map(super::base_by_name).or(scene.base).unwrap_or(Base::Fixed)
}

fn base_pose(args: &RunArgs, scene: &Scene) -> Result<Pose, String> {
    let Some(text) = &args.base_pose else { return Ok(scene.robot.pose) };
    let form = "X,Y,Z,QX,QY,QZ,QW";
    pose(numbers("--base-pose", form, text)?).map_err(|reason| format!("--base-pose {text}: {reason}"))
}

fn switch_effects(args: &RunArgs, scene: &Scene, model: &mut Model) -> Result<(), String> {
    scene.switch_effects(model)?;
    if let Some(both) = args.off.iter().find(|name| args.on.contains(name)) {
        return Err(format!("--off {both} and --on {both} contradict each other; leave one of them out"));
    }
    for (flag, names, on) in [("--off", &args.off, false), ("--on", &args.on, true)] {
        for name in names {
            switch_effect(model, name, on).map_err(|reason| format!("{flag} {name}: {reason}"))?;
        }
    }
    Ok(())
}

/// What the flags say of the start, over what the scene says.
fn override_start(args: &RunArgs, m: &Model, s: &mut State) -> Result<(), String> {
    if let Some(text) = &args.base_twist {
        if m.base == Base::Fixed {
            return Err("--base-twist needs --base free".into());
        }
        let t: [f64; 6] = numbers("--base-twist", "WX,WY,WZ,VX,VY,VZ", text)?;
        s.set_base_twist(m, Vec3::new(t[0], t[1], t[2]), Vec3::new(t[3], t[4], t[5]));
    }
    let mut given = vec![];
    for text in &args.set {
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
