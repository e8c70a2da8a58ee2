//! Command messages → axis commands. All or nothing: a refused message changes nothing.

use super::messages::JointState;
use crate::model::{Axis, Model};
use crate::world::{AxisCommand, Mode};
use std::collections::HashMap;

/// A command message, as it came in.
#[derive(Clone, Copy, Debug)]
pub enum Command<'a> {
    /// Applied torque of every axis, N·m or N, in the order of `Model::axes`.
    Effort(&'a [f64]),
    /// Target of every axis, rad or m, in the order of `Model::axes`.
    Servo(&'a [f64]),
    /// Any subset of the axes, by name.
    Joint(&'a JointState),
}

/// Why a message was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RefusalKind {
    /// An array has the wrong length.
    WrongSize,
    /// A value is NaN or infinite.
    NotFinite,
    /// No axis has this name.
    UnknownName,
    /// An axis is named twice.
    DuplicateName,
    /// The axis or the parameter `allow_mode_switch` forbids to switch the drive's mode.
    ModeSwitch,
    /// Applied torque and applied speed contradict each other.
    OppositeSigns,
    /// Names axes, but gives no values.
    Empty,
}

impl RefusalKind {
    /// Every kind.
    pub const ALL: [Self; 7] = [
        Self::WrongSize,
        Self::NotFinite,
        Self::UnknownName,
        Self::DuplicateName,
        Self::ModeSwitch,
        Self::OppositeSigns,
        Self::Empty,
    ];

    /// Name in `/diagnostics`.
    pub fn name(self) -> &'static str {
        match self {
            Self::WrongSize => "wrong size",
            Self::NotFinite => "not finite",
            Self::UnknownName => "unknown name",
            Self::DuplicateName => "duplicate name",
            Self::ModeSwitch => "mode switch not allowed",
            Self::OppositeSigns => "torque against speed",
            Self::Empty => "no values",
        }
    }
}

/// A refused message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// For counting.
    pub kind: RefusalKind,
    /// For people: names the axis, the value and what would be accepted.
    pub reason: String,
}

/// What commands are checked against.
#[derive(Clone, Debug)]
pub struct Rules<'a> {
    model: &'a Model,
    by_name: HashMap<&'a str, usize>,
    /// Parameter `allow_mode_switch`.
    pub allow_mode_switch: bool,
}

impl<'a> Rules<'a> {
    /// Rules for the axes of `model`.
    pub fn new(model: &'a Model, allow_mode_switch: bool) -> Self {
        let by_name = model.axes.iter().enumerate().map(|(i, a)| (a.name.as_str(), i)).collect();
        Self { model, by_name, allow_mode_switch }
    }
}

/// Merges a message into the commands of all axes (order of `Model::axes`). `Err`: nothing has changed.
pub fn apply(commands: &mut [AxisCommand], message: Command, rules: &Rules) -> Result<(), Refusal> {
    let merged = match message {
        Command::Effort(values) => every_axis(commands, values, rules, AxisCommand::torque)?,
        Command::Servo(values) => every_axis(commands, values, rules, AxisCommand::servo)?,
        Command::Joint(message) => named_axes(commands, message, rules)?,
    };
    commands.copy_from_slice(&merged);
    Ok(())
}

fn every_axis(
    commands: &[AxisCommand],
    values: &[f64],
    rules: &Rules,
    make: fn(f64) -> AxisCommand,
) -> Result<Vec<AxisCommand>, Refusal> {
    let axes = &rules.model.axes;
    if values.len() != axes.len() {
        let reason = format!("{} values for {} axes (their order is parameter 'axes')", values.len(), axes.len());
        return refuse(RefusalKind::WrongSize, reason);
    }
    let mut merged = Vec::with_capacity(axes.len());
    for ((axis, &value), present) in axes.iter().zip(values).zip(commands) {
        finite(axis, "value", value)?;
        let command = make(value);
        may_switch(axis, present.mode, command.mode, rules)?;
        merged.push(command);
    }
    Ok(merged)
}

fn named_axes(commands: &[AxisCommand], message: &JointState, rules: &Rules) -> Result<Vec<AxisCommand>, Refusal> {
    sizes(message)?;
    let mut merged = commands.to_vec();
    let mut named = vec![false; merged.len()];
    for (i, name) in message.name.iter().enumerate() {
        let Some(&index) = rules.by_name.get(name.as_str()) else {
            return refuse(RefusalKind::UnknownName, format!("there is no axis '{name}' (parameter 'axes' lists them)"));
        };
        if std::mem::replace(&mut named[index], true) {
            return refuse(RefusalKind::DuplicateName, format!("axis '{name}' is named twice"));
        }
        let axis = &rules.model.axes[index];
        let command = one_axis(axis, &merged[index], message, i)?;
        may_switch(axis, merged[index].mode, command.mode, rules)?;
        merged[index] = command;
    }
    Ok(merged)
}

fn sizes(message: &JointState) -> Result<(), Refusal> {
    let n = message.name.len();
    let arrays = [("position", &message.position), ("velocity", &message.velocity), ("effort", &message.effort)];
    for (field, values) in arrays {
        if !values.is_empty() && values.len() != n {
            let reason = format!("{field} has {} values for {n} names; it must have none or {n}", values.len());
            return refuse(RefusalKind::WrongSize, reason);
        }
    }
    if arrays.iter().all(|(_, values)| values.is_empty()) {
        return refuse(RefusalKind::Empty, "position, velocity and effort are all empty".into());
    }
    Ok(())
}

/// The command of one axis after entry `i` of `message`.
fn one_axis(axis: &Axis, present: &AxisCommand, message: &JointState, i: usize) -> Result<AxisCommand, Refusal> {
    let value = |field: &str, values: &[f64]| match values.get(i) {
        Some(&v) => finite(axis, field, v).map(|()| Some(v)),
        None => Ok(None),
    };
    let position = value("position", &message.position)?;
    let velocity = value("velocity", &message.velocity)?;
    let effort = value("effort", &message.effort)?;
    let command = match (position, effort) {
        (Some(target), _) => AxisCommand {
            torque: effort.unwrap_or(f64::NAN),
            speed: velocity.unwrap_or(f64::NAN),
            ..AxisCommand::servo(target)
        },
        (None, Some(torque)) => AxisCommand { speed: velocity.unwrap_or(f64::NAN), ..AxisCommand::torque(torque) },
        (None, None) => AxisCommand { speed: velocity.unwrap_or(present.speed), ..*present },
    };
    consistent(axis, &command)?;
    Ok(command)
}

/// in torque mode, torque and speed must point the same way.
fn consistent(axis: &Axis, c: &AxisCommand) -> Result<(), Refusal> {
    // A comparison with NaN (= not given) is false.
    let contradicts = c.torque * c.speed < 0.0 || (c.speed == 0.0 && c.torque.abs() > 0.0);
    if c.mode == Mode::Torque && contradicts {
        let reason = format!(
            "axis '{}': applied torque {} with applied speed {} has no meaning; give both the same sign, or no speed",
            axis.name, c.torque, c.speed
        );
        return refuse(RefusalKind::OppositeSigns, reason);
    }
    Ok(())
}

fn finite(axis: &Axis, field: &str, value: f64) -> Result<(), Refusal> {
    if value.is_finite() {
        return Ok(());
    }
    refuse(RefusalKind::NotFinite, format!("axis '{}': {field} is {value}", axis.name))
}

fn may_switch(axis: &Axis, from: Mode, to: Mode, rules: &Rules) -> Result<(), Refusal> {
    let by = match (axis.switchable, rules.allow_mode_switch) {
        _ if from == to => return Ok(()),
        (true, true) => return Ok(()),
        (false, _) => "its <drive> tag",
        (true, false) => "parameter allow_mode_switch",
    };
    let (from, to) = (mode_name(from), mode_name(to));
    refuse(RefusalKind::ModeSwitch, format!("axis '{}' is in {from} mode and {by} forbids {to} mode", axis.name))
}

fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Idle => "idle",
        Mode::Torque => "torque",
        Mode::Servo => "servo",
    }
}

fn refuse<T>(kind: RefusalKind, reason: String) -> Result<T, Refusal> {
    Err(Refusal { kind, reason })
}
