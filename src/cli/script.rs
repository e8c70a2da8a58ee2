//! `--script`: commands over time (J-13, J-14), in YAML. Unknown keys are refused, with their line.

use super::commands::{axis, refusal};
use crate::description::Description;
use crate::model::DriveLimits;
use crate::world::{AxisCommand, Mode, World};
use serde::Deserialize;
use serde_saphyr::Spanned;
use std::f64::consts::TAU;
use std::path::Path;

/// A time is on a control interval if it is this near to it, in intervals: far more than rounding, far less than a mistake.
const ON_INTERVAL: f64 = 1e-6;

/// One entry; what it does not name stays as it is.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Entry {
    /// Simulated time, s.
    at: f64,
    /// Name.
    axis: String,
    /// idle, torque or servo: begins a new command.
    mode: Option<String>,
    /// J-13 c.
    torque: Option<f64>,
    /// J-13 d.
    speed: Option<f64>,
    /// J-13 h.
    target: Option<f64>,
    /// J-13 a.
    max_torque: Option<f64>,
    /// J-13 b.
    no_load_speed: Option<f64>,
    /// J-13 e.
    static_resistance: Option<f64>,
    /// J-13 f.
    dynamic_resistance: Option<f64>,
    /// J-13 g.
    short_brake: Option<bool>,
    /// Of the servo's position loop, Hz.
    bandwidth: Option<f64>,
    /// As the axis feels it, kg·m² or kg.
    rotor_inertia: Option<f64>,
}

/// A checked script.
#[derive(Clone, Debug, Default)]
pub struct Script {
    /// In the order of time.
    events: Vec<Event>,
    next: usize,
    /// What is odd about it.
    pub warnings: Vec<String>,
}

/// What an axis is told, as a whole.
#[derive(Clone, Debug)]
struct Event {
    /// Before this control interval.
    interval: u64,
    axis: usize,
    command: AxisCommand,
    drive: Option<DriveLimits>,
}

/// The drive of an axis, as far as the limits do not tell it.
#[derive(Clone, Copy)]
struct Machine {
    limits: DriveLimits,
    /// URDF's bound of the speed.
    velocity: f64,
    /// As given: what counts is at least the dynamic resistance.
    static_resistance: f64,
}

/// The text of a script.
pub struct ScriptText {
    /// The file, for messages.
    pub label: String,
    /// YAML.
    pub text: String,
}

impl ScriptText {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the file.
    pub fn read(path: &Path) -> Result<Self, String> {
        Ok(Self { label: path.display().to_string(), text: super::check::read_text(path)? })
    }

    /// For a world with its commands at start. `interval` is the simulated time of a control interval, s, and `count` how many of
    /// them there are.
    ///
    /// # Errors
    /// Names the file and line, and what is wrong there.
    pub fn compile(&self, world: &World, d: &Description, (interval, count): (f64, u64)) -> Result<Script, String> {
        let shown = &self.label;
        let entries: Vec<Spanned<Entry>> =
            serde_saphyr::from_str(&self.text).map_err(|e| format!("--script {shown}: {e}"))?;
        let script = Script::compile(entries, shown, (world, d), (interval, count));
        script.map_err(|reason| format!("--script {reason}"))
    }
}

impl Script {
    /// Of the entries of a file.
    ///
    /// # Errors
    /// Names the file and line, and what is wrong there.
    pub(super) fn compile(
        entries: Vec<Spanned<Entry>>,
        file: &str,
        (world, d): (&World, &Description),
        (interval, count): (f64, u64),
    ) -> Result<Self, String> {
        let mut compiler = Compiler::new(world, d, interval);
        let mut script = Self::default();
        for entry in entries {
            let place = format!("{file}:{}", entry.referenced.line());
            let event = compiler.event(&entry.value).map_err(|reason| format!("{place}: {reason}"))?;
            let odd = oddity(&entry.value, &event, (interval, count)).into_iter();
            script.warnings.extend(odd.chain(compiler.beyond(&event)).map(|w| format!("{place}: {w}")));
            script.events.push(event);
        }
        Ok(script)
    }

    /// Tells the world what is due before control interval `interval`.
    pub fn apply(&mut self, interval: u64, world: &mut World) {
        while let Some(event) = self.events.get(self.next).filter(|event| event.interval <= interval) {
            let mut commands = world.commands().to_vec();
            commands[event.axis] = event.command;
            // Both were checked when the script was read.
            let _ = world.set_commands(&commands);
            if let Some(drive) = event.drive {
                let _ = world.set_drive(event.axis, drive);
            }
            self.next += 1;
        }
    }
}

fn oddity(entry: &Entry, event: &Event, (interval, count): (f64, u64)) -> Option<String> {
    let acts = event.interval as f64 * interval;
    if event.interval >= count {
        return Some(format!("at {} s is not before the end of the run: without effect", entry.at));
    }
    let late = event.interval as f64 - entry.at / interval > ON_INTERVAL;
    late.then(|| {
        format!("at {} s is inside a control interval: it takes effect with the next one, at {acts} s", entry.at)
    })
}

/// Follows commands and drives from entry to entry.
struct Compiler {
    trial: World,
    commands: Vec<AxisCommand>,
    machines: Vec<Machine>,
    interval: f64,
    last: f64,
}

impl Compiler {
    fn new(world: &World, d: &Description, interval: f64) -> Self {
        let machine = |(i, a): (usize, &crate::model::Axis)| {
            let joint = d.joint(&a.name);
            let velocity = joint.and_then(|j| j.limit.as_ref()?.velocity).unwrap_or(f64::INFINITY);
            let given = joint.and_then(|j| j.drive.as_ref()?.static_resistance);
            let limits = world.drive(i).copied().unwrap_or(a.drive);
            Machine { limits, velocity, static_resistance: given.unwrap_or(0.0) }
        };
        let machines = world.model().axes.iter().enumerate().map(machine).collect();
        Self { trial: world.clone(), commands: world.commands().to_vec(), machines, interval, last: 0.0 }
    }

    /// What the axis cannot do of its new command.
    fn beyond(&self, event: &Event) -> Option<String> {
        event.command.beyond(&self.trial.model().axes[event.axis], self.trial.drive(event.axis)?)
    }

    fn event(&mut self, e: &Entry) -> Result<Event, String> {
        if !e.at.is_finite() || e.at < 0.0 {
            return Err(format!("at is {}; it must be a time of 0 s or more", e.at));
        }
        if e.at < self.last {
            return Err(format!("at {} s comes after {} s: put the entries in the order of time", e.at, self.last));
        }
        self.last = e.at;
        let axis = axis(self.trial.model(), "axis", &e.axis)?;
        self.commands[axis] = command(e, self.commands[axis])?;
        if let Some(reason) = refusal(self.trial.model(), axis, &self.commands[axis]) {
            return Err(reason);
        }
        self.trial.set_commands(&self.commands).map_err(|_| format!("axis '{}': a value is not finite", e.axis))?;
        let drive = self.machines[axis].change(e);
        if let Some(drive) = drive {
            self.trial.set_drive(axis, drive).map_err(|reason| format!("axis '{}': {reason}", e.axis))?;
        }
        let interval = (e.at / self.interval - ON_INTERVAL).ceil().max(0.0) as u64;
        Ok(Event { interval, axis, command: self.commands[axis], drive })
    }
}

/// The command in force after an entry: a mode begins a new one, other values change the present one.
fn command(e: &Entry, present: AxisCommand) -> Result<AxisCommand, String> {
    let mut c = match e.mode.as_deref() {
        None => present,
        Some("idle") => AxisCommand::IDLE,
        Some("torque") => AxisCommand::torque(f64::NAN),
        Some("servo") => AxisCommand::servo(f64::NAN),
        Some(other) => return Err(format!("mode '{other}' does not exist; choose one of: idle, torque, servo")),
    };
    for (name, value, to) in
        [("torque", e.torque, &mut c.torque), ("speed", e.speed, &mut c.speed), ("target", e.target, &mut c.target)]
    {
        match value {
            Some(x) if !x.is_finite() => return Err(format!("{name} is {x}; it must be a finite number")),
            Some(x) => *to = x,
            None => {}
        }
    }
    let (torque, target) = (e.torque.is_some() || e.speed.is_some(), e.target.is_some());
    match c.mode {
        Mode::Servo if c.target.is_nan() => Err("a servo needs a target".into()),
        Mode::Idle if torque || target => Err("an idle drive takes no torque, speed or target: give a mode".into()),
        Mode::Torque if target => Err("a target is for mode: servo".into()),
        _ => Ok(c),
    }
}

impl Machine {
    /// The limits after an entry; `None` if it changes none of them.
    fn change(&mut self, e: &Entry) -> Option<DriveLimits> {
        let before = self.limits;
        let l = &mut self.limits;
        l.max_torque = e.max_torque.unwrap_or(l.max_torque);
        l.no_load_speed = e.no_load_speed.unwrap_or(l.no_load_speed);
        l.max_speed = if l.no_load_speed < self.velocity { l.no_load_speed } else { self.velocity };
        l.dynamic_resistance = e.dynamic_resistance.unwrap_or(l.dynamic_resistance);
        self.static_resistance = e.static_resistance.unwrap_or(self.static_resistance);
        l.static_resistance = self.static_resistance;
        if (0.0..l.dynamic_resistance).contains(&l.static_resistance) {
            l.static_resistance = l.dynamic_resistance;
        }
        l.short_brake = e.short_brake.unwrap_or(l.short_brake);
        l.rotor_inertia = e.rotor_inertia.unwrap_or(l.rotor_inertia);
        l.servo_time = e.bandwidth.map_or(l.servo_time, |hertz| 1.0 / (TAU * hertz));
        let resistances = [e.static_resistance, e.dynamic_resistance];
        let named = [e.max_torque, e.no_load_speed, e.bandwidth, e.rotor_inertia].into_iter().chain(resistances);
        let any = e.short_brake.is_some() || named.flatten().next().is_some();
        if !any {
            self.limits = before;
        }
        any.then_some(self.limits)
    }
}
