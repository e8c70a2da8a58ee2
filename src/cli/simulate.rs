//! `realnoid simulate`: no ROS, as fast as it goes.

use super::args::{SimulateArgs, assignment, numbers};
use super::commands::{self, axis};
use super::load::{Loaded, load_at};
use super::scene::{Scene, integrator, interval_ns, pose};
use super::script::Script;
use crate::description::Severity;
use crate::engine::{ENGINE_NAMES, State};
use crate::math::{Pose, Vec3};
use crate::model::{Base, EFFECT_NAMES, Model};
use crate::record::{Format, RecordError, Recorder, Sample};
use crate::world::{Settings, Stats, World};
use serde_json::json;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Set by SIGINT and SIGTERM: the run ends early, its file is completed.
static STOP: AtomicBool = AtomicBool::new(false);

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

/// What became of a run.
#[derive(Default)]
struct Outcome {
    /// CPU time of the steps, s.
    cpu: f64,
    /// Energy at the start, J.
    energy: f64,
    rows: u64,
    /// Every value looked at was finite.
    finite: bool,
    /// By a signal.
    stopped: bool,
    files: Vec<PathBuf>,
    /// Per axis.
    peaks: Vec<Peak>,
}

/// Greatest magnitudes at the ends of the control intervals (J-15, J-16).
#[derive(Clone, Copy, Default)]
struct Peak {
    /// N·m or N, really applied.
    torque: f64,
    /// rad/s or m/s.
    speed: f64,
}

impl Outcome {
    fn note_peaks(&mut self, world: &World) {
        for (axis, peak) in self.peaks.iter_mut().enumerate() {
            peak.torque = peak.torque.max(world.efforts()[axis].abs());
            peak.speed = peak.speed.max(world.state().axis(world.model(), axis).1.abs());
        }
    }

    fn peaks(&self, m: &Model) -> serde_json::Map<String, serde_json::Value> {
        let told = |(axis, peak): (&crate::model::Axis, &Peak)| {
            (axis.name.clone(), json!({"torque": peak.torque, "speed": peak.speed}))
        };
        m.axes.iter().zip(&self.peaks).map(told).collect()
    }
}

/// A line on standard error that tells how far a long run is, if people see it.
struct Progress {
    /// When it is written next; never if nobody sees it.
    next: Option<Instant>,
    shown: bool,
}

impl Progress {
    const PAUSE: Duration = Duration::from_millis(500);

    fn new() -> Self {
        Self { next: std::io::stderr().is_terminal().then(|| Instant::now() + Self::PAUSE), shown: false }
    }

    fn show(&mut self, done: u64, all: u64) {
        if self.next.is_some_and(|next| Instant::now() >= next) {
            let _ = write!(std::io::stderr(), "\r{:3.0} % of the duration", 100.0 * done as f64 / all as f64);
            (self.next, self.shown) = (Some(Instant::now() + Self::PAUSE), true);
        }
    }

    fn clear(&self) {
        if self.shown {
            let _ = write!(std::io::stderr(), "\r{:30}\r", "");
        }
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

impl<'a> Plan<'a> {
    /// `Err`: exit code (1 not loaded, 2 wrong arguments) and reason.
    fn new(args: &'a SimulateArgs) -> Result<Self, (u8, String)> {
        let usage = |reason| (2, reason);
        args.out.as_deref().map(Format::of).transpose().map_err(|e| usage(format!("--out {e}")))?;
        let scene = Scene::read(args.scene.as_deref()).map_err(usage)?;
        let settings = settings(args, &scene).map_err(usage)?;
        let base = base(args, &scene);
        let pose = base_pose(args, &scene).map_err(usage)?;
        let loaded = load_at(args.packages.source(Some(&args.urdf)), base, pose).map_err(|reason| (1, reason))?;
        let mut model = Model::clone(&loaded.model);
        switch_effects(args, &scene, &mut model).map_err(usage)?;
        let initial = initial_state(args, &model, pose).map_err(usage)?;
        let mut world = World::new(Arc::new(model), settings).map_err(usage)?;
        world.set_initial_state(initial);
        commands::turn(args, &mut world).map_err(usage)?;
        commands::command(args, &mut world).map_err(usage)?;
        let (intervals, every) = schedule(args, &settings).map_err(usage)?;
        let read = |path| Script::read(path, &world, &loaded.description, (interval(&settings), intervals));
        let script = args.script.as_deref().map(read).transpose().map_err(usage)?.unwrap_or_default();
        let mut warnings = warnings(&loaded);
        warnings.extend(scene.pending);
        warnings.extend(outside(world.model(), world.state()).map(|(_, said)| said + ": its stop pushes it back"));
        warnings.extend(beyond(&world));
        if intervals == 0 && args.duration > 0.0 {
            warnings.push("the duration is less than half a control interval: no step is made".into());
        }
        warnings.extend(script.warnings.iter().cloned());
        Ok(Self { args, world, script, intervals, every, warnings })
    }

    fn run(&mut self) -> Result<serde_json::Value, String> {
        let open = |path: &PathBuf| Recorder::create(path, self.world.model());
        let mut recorder = self.args.out.as_ref().map(open).transpose().map_err(|e| e.to_string())?;
        // Without the handler the run only loses its neat end.
        let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
        let mut progress = Progress::new();
        let outcome = self.simulate(recorder.as_mut(), &mut progress);
        progress.clear();
        let mut outcome = outcome.map_err(|e| e.to_string())?;
        if let Some(recorder) = recorder {
            outcome.files = recorder.finish().map_err(|e| e.to_string())?;
        }
        Ok(self.summary(&outcome))
    }

    fn simulate(
        &mut self,
        mut recorder: Option<&mut Recorder>,
        progress: &mut Progress,
    ) -> Result<Outcome, RecordError> {
        let peaks = vec![Peak::default(); self.world.model().axes.len()];
        let e = self.world.energy();
        let mut outcome = Outcome { finite: true, energy: e.kinetic + e.potential, peaks, ..Outcome::default() };
        let mut sample = Sample::new(&self.world);
        for interval in 0..=self.intervals {
            let complete = interval == self.intervals;
            outcome.stopped = !complete && STOP.load(Ordering::Relaxed);
            let (last, row) = (complete || outcome.stopped, interval % self.every == 0);
            if row || last {
                sample.take(&self.world);
                outcome.finite &= sample.is_finite();
            }
            if let Some(recorder) = recorder.as_mut().filter(|_| row) {
                recorder.write(&sample)?;
                outcome.rows += 1;
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
        let (e, work, guarded) = (self.world.energy(), self.world.work(), self.world.stats().guarded_energy);
        let end = e.kinetic + e.potential;
        json!({
            "start": start,
            "end": end,
            "work_of_drives": work.drives,
            "losses": work.losses,
            "unaccounted": end - start - work.drives + work.losses + guarded,
        })
    }

    fn summary(&self, outcome: &Outcome) -> serde_json::Value {
        let (s, cpu) = (self.world.stats(), outcome.cpu);
        let broken = self.world.broken().iter();
        let broken: Vec<_> = broken.map(|b| json!({"joint": *b.joint, "time": b.time, "force": b.force})).collect();
        json!({
            "steps": s.steps,
            "rows": outcome.rows,
            "output": outcome.files,
            "simulated_seconds": self.simulated(),
            "cpu_seconds": cpu,
            "us_per_step": if s.steps > 0 { cpu * 1e6 / s.steps as f64 } else { 0.0 },
            "worst_penetration": 0.0,
            "worst_stop_violation": s.worst_stop_violation,
            "peaks": outcome.peaks(self.world.model()),
            "finite": outcome.finite,
            "stopped": outcome.stopped,
            "fallback_steps": s.fallback_steps,
            "unsettled_steps": s.unsettled_steps,
            "halvings": s.halvings,
            "guarded_pieces": s.guarded_pieces,
            "guarded_energy": s.guarded_energy,
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

/// What is counted in a run, and what it means.
fn counted(s: &Stats) -> [(u64, &'static str); 6] {
    [
        (
            s.fallback_steps,
            "steps were made by implicit_midpoint, because an axis began or ceased to stand still, a servo was on its \
             way, a viscous term was stiff, or a joint is soft or a fixed one that may break",
        ),
        (
            s.halvings,
            "times a step was halved, because limbs turned too fast for its iteration: a finer step costs the same",
        ),
        (s.unsettled_steps, "steps ended before the axis laws had settled: allow more --iterations"),
        (
            s.guarded_pieces,
            "pieces of steps were not resolved by the shortest piece there is: the motion of the limbs was slowed down \
             to the energy that drives and weight had paid for (guarded_energy, J); take a finer step",
        ),
        (s.pole_steps, "steps had a 3dof group at its pole: torques about its angles were bounded there"),
        (s.diverged_steps, "step would have given values that are not finite: the world stood still from there on"),
    ]
}

fn settings(args: &SimulateArgs, scene: &Scene) -> Result<Settings, String> {
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
    if let Some(name) = args.engine.as_deref().filter(|n| !ENGINE_NAMES.contains(n)) {
        return Err(format!("engine '{name}' does not exist; choose one of: {}", ENGINE_NAMES.join(", ")));
    }
    s.check()?;
    Ok(s)
}

fn base(args: &SimulateArgs, scene: &Scene) -> Base {
    args.base.as_deref().map(super::base_by_name).or(scene.base).unwrap_or(Base::Fixed)
}

fn base_pose(args: &SimulateArgs, scene: &Scene) -> Result<Pose, String> {
    let Some(text) = &args.base_pose else { return Ok(scene.pose) };
    let form = "X,Y,Z,QX,QY,QZ,QW";
    pose(numbers("--base-pose", form, text)?).map_err(|reason| format!("--base-pose {text}: {reason}"))
}

fn switch_effects(args: &SimulateArgs, scene: &Scene, model: &mut Model) -> Result<(), String> {
    for (name, on) in &scene.effects {
        switch_effect(model, name, *on)?;
    }
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

fn switch_effect(model: &mut Model, name: &str, on: bool) -> Result<(), String> {
    let known = || format!("effect '{name}' does not exist; choose one of: {}", EFFECT_NAMES.join(", "));
    if model.effects.switch(name, on) { Ok(()) } else { Err(known()) }
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
    s.couple_given(m, &given).map_err(|reason| format!("--set: {reason}"))?;
    let coupled = |axis: usize| m.couplings_in_force().iter().any(|c| c.leader == axis || c.follower == axis);
    let refused = outside(m, &s).find(|(axis, _)| coupled(*axis));
    match refused {
        Some((_, said)) => Err(format!("--set: {said}; it is coupled to another axis, so it must start inside")),
        None => Ok(s),
    }
}

/// Simulated time of a control interval, s.
fn interval(s: &Settings) -> f64 {
    s.control_interval_ns as f64 * 1e-9 * s.time_scale
}

/// Number of intervals, and of intervals between two rows.
fn schedule(args: &SimulateArgs, s: &Settings) -> Result<(u64, u64), String> {
    let interval = interval(s);
    if interval <= 0.0 {
        return Err("time_scale 0 stops time: the duration would never be reached".into());
    }
    if !args.duration.is_finite() || args.duration < 0.0 {
        return Err(format!("--duration {}: must be a finite number of seconds, 0 or more", args.duration));
    }
    let every = args.every.unwrap_or(interval);
    let ratio = every / interval;
    // Far more than rounding, far less than a mistake.
    let whole = ratio.is_finite() && ratio >= 0.5 && (ratio - ratio.round()).abs() <= 1e-6;
    if !whole {
        let scaled = if s.time_scale == 1.0 { "" } else { " times the time scale" };
        return Err(format!("--every {every}: must be a whole multiple of the control interval{scaled}, {interval} s"));
    }
    Ok(((args.duration / interval).round() as u64, ratio.round() as u64))
}

/// Axes that start outside their range.
fn outside<'a>(m: &'a Model, s: &'a State) -> impl Iterator<Item = (usize, String)> + 'a {
    m.axes.iter().enumerate().filter(|_| m.effects.limits).filter_map(|(i, a)| {
        let (q, _) = s.axis(m, i);
        let slack = 1e-12 * (1.0 + q.abs());
        (q < a.lower - slack || q > a.upper + slack)
            .then(|| (i, format!("axis '{}' starts at {q}, outside its range {} to {}", a.name, a.lower, a.upper)))
    })
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
