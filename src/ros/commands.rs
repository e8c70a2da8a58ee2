//! Command messages → axis commands. All or nothing: a refused message changes nothing.

use super::messages::JointState;
pub use super::refusal::{Refusal, RefusalKind};
use super::ros2_control::{Control, Entry};
use crate::world::{AxisCommand, Mode};
use std::collections::HashMap;
use std::sync::Arc;

/// Speed that stands for 0 where a drive holds still, rad/s or m/s.
const SLOWEST: f64 = 1e-9;

/// A command message, as it came in.
#[derive(Clone, Copy, Debug)]
pub enum Command<'a> {
    /// Applied torque of every axis, N·m or N, in the order of `Model::axes`.
    Effort(&'a [f64]),
    /// Target of every axis, rad or m, in the order of `Model::axes`.
    Servo(&'a [f64]),
    /// Any subset of the axes, by name.
    Joint(&'a JointState),
    /// From ros2_control.
    Control(&'a JointState),
}

impl Command<'_> {
    /// Its stamp, ns; `None` where the message has none, or where it means nothing.
    pub fn stamp_ns(&self) -> Option<i64> {
        match self {
            Self::Joint(message) => Some(message.header.stamp.ns()),
            Self::Effort(_) | Self::Servo(_) | Self::Control(_) => None,
        }
    }
}

/// What commands are checked against.
#[derive(Clone, Debug)]
pub struct Rules {
    axes: Vec<Axis>,
    by_name: HashMap<String, usize>,
    /// Parameter `allow_mode_switch`.
    pub allow_mode_switch: bool,
    /// What ros2_control may command.
    pub control: Option<Arc<Control>>,
}

#[derive(Clone, Debug)]
struct Axis {
    index: usize,
    name: String,
    switchable: bool,
}

impl Rules {
    /// Rules for axes given as (name, may its mode be switched?), in the order of `Model::axes`.
    pub fn new<'a>(axes: impl IntoIterator<Item = (&'a str, bool)>, allow_mode_switch: bool) -> Self {
        let axis = |(index, (name, switchable)): (usize, (&str, bool))| Axis { index, name: name.into(), switchable };
        let axes: Vec<_> = axes.into_iter().enumerate().map(axis).collect();
        let by_name = axes.iter().enumerate().map(|(i, a)| (a.name.clone(), i)).collect();
        Self { axes, by_name, allow_mode_switch, control: None }
    }
}

/// Merges a message into the commands of all axes (order of `Model::axes`). `Err`: nothing has changed.
pub fn apply(commands: &mut [AxisCommand], message: Command, rules: &Rules) -> Result<(), Refusal> {
    let merged = match message {
        Command::Effort(values) => every_axis(commands, values, rules, AxisCommand::torque)?,
        Command::Servo(values) => every_axis(commands, values, rules, AxisCommand::servo)?,
        Command::Joint(message) => {
            sizes(message)?;
            let command =
                |axis: &Axis, present: &AxisCommand, i: usize| one_axis(axis, present, entry(axis, message, i)?);
            named_axes(commands, &message.name, rules, command)?
        }
        Command::Control(message) => {
            let Some(control) = &rules.control else {
                return refuse(RefusalKind::UnknownName, "the robot has no <ros2_control> block".into());
            };
            let entries = control.entries(message)?;
            let command = |axis: &Axis, present: &AxisCommand, i: usize| controlled(axis, present, entries[i], control);
            named_axes(commands, &message.name, rules, command)?
        }
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
    let axes = &rules.axes;
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

/// `command` makes the new command of an axis from its present one and entry i of the message.
fn named_axes(
    commands: &[AxisCommand],
    names: &[String],
    rules: &Rules,
    command: impl Fn(&Axis, &AxisCommand, usize) -> Result<AxisCommand, Refusal>,
) -> Result<Vec<AxisCommand>, Refusal> {
    let mut merged = commands.to_vec();
    let mut named = vec![false; merged.len()];
    for (i, name) in names.iter().enumerate() {
        let Some(&index) = rules.by_name.get(name.as_str()) else {
            return refuse(
                RefusalKind::UnknownName,
                format!("there is no axis '{name}' (parameter 'axes' lists them)"),
            );
        };
        if std::mem::replace(&mut named[index], true) {
            return refuse(RefusalKind::DuplicateName, format!("axis '{name}' is named twice"));
        }
        let axis = &rules.axes[index];
        let command = command(axis, &merged[index], i)?;
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

/// Entry `i` of a message whose arrays are as long as its names.
fn entry(axis: &Axis, message: &JointState, i: usize) -> Result<Entry, Refusal> {
    let value = |field: &str, values: &[f64]| match values.get(i) {
        Some(&v) => finite(axis, field, v).map(|()| Some(v)),
        None => Ok(None),
    };
    Ok([
        value("position", &message.position)?,
        value("velocity", &message.velocity)?,
        value("effort", &message.effort)?,
    ])
}

/// The command of one axis after position, velocity and effort.
fn one_axis(axis: &Axis, present: &AxisCommand, [position, velocity, effort]: Entry) -> Result<AxisCommand, Refusal> {
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

/// As [`one_axis`]; but a velocity alone is a velocity to be driven with all that the drive has, and nothing is no command.
fn controlled(axis: &Axis, present: &AxisCommand, entry: Entry, control: &Control) -> Result<AxisCommand, Refusal> {
    match entry {
        [None, None, None] => Ok(*present),
        [None, Some(speed), None] => {
            let torque = control.max_torque[axis.index];
            if torque.is_infinite() {
                let reason = format!(
                    "axis '{}': nothing bounds the torque by which it would be driven at a velocity; give its drive a max_torque",
                    axis.name
                );
                return refuse(RefusalKind::NotFinite, reason);
            }
            // A drive stands still at the slowest speed that its line can have (X-8 forbids torque at speed 0).
            let speed = if speed.abs() < SLOWEST { SLOWEST } else { speed };
            Ok(AxisCommand { speed, ..AxisCommand::torque(torque.copysign(speed)) })
        }
        _ => one_axis(axis, present, entry),
    }
}

/// in torque mode, torque and speed must point the same way.
fn consistent(axis: &Axis, c: &AxisCommand) -> Result<(), Refusal> {
    if c.contradicts() {
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    const AXES: [(&str, bool); 3] = [("hip", true), ("knee", true), ("fixed_mode", false)];

    fn start() -> Vec<AxisCommand> {
        vec![AxisCommand::servo(0.1), AxisCommand::torque(2.0), AxisCommand::IDLE]
    }

    pub fn joint(name: &[&str], position: &[f64], velocity: &[f64], effort: &[f64]) -> JointState {
        JointState {
            name: name.iter().map(ToString::to_string).collect(),
            position: position.to_vec(),
            velocity: velocity.to_vec(),
            effort: effort.to_vec(),
            ..JointState::default()
        }
    }

    /// Bits, because NaN means "not given" and must compare equal.
    fn bits(commands: &[AxisCommand]) -> Vec<(Mode, [u64; 3])> {
        commands.iter().map(|c| (c.mode, [c.torque, c.speed, c.target].map(f64::to_bits))).collect()
    }

    fn accepted(message: Command) -> Vec<AxisCommand> {
        let mut commands = start();
        apply(&mut commands, message, &Rules::new(AXES, true)).unwrap();
        commands
    }

    /// The kind and the reason of the refusal; the commands must be untouched.
    fn refused_by(rules: &Rules, message: Command) -> (RefusalKind, String) {
        let mut commands = start();
        let refusal = apply(&mut commands, message, rules).unwrap_err();
        assert_eq!(bits(&commands), bits(&start()), "a refused message changed something");
        (refusal.kind, refusal.reason)
    }

    fn refused(message: Command) -> (RefusalKind, String) {
        refused_by(&Rules::new(AXES, true), message)
    }

    #[test]
    fn arrays_command_every_axis() {
        let rules = Rules::new([("a", true), ("b", true)], true);
        let mut commands = vec![AxisCommand::IDLE; 2];
        apply(&mut commands, Command::Effort(&[1.0, -2.0]), &rules).unwrap();
        assert_eq!(bits(&commands), bits(&[AxisCommand::torque(1.0), AxisCommand::torque(-2.0)]));
        apply(&mut commands, Command::Servo(&[0.5, 0.0]), &rules).unwrap();
        assert_eq!(bits(&commands), bits(&[AxisCommand::servo(0.5), AxisCommand::servo(0.0)]));
    }

    #[test]
    fn names_command_a_subset_in_any_order() {
        let c = accepted(Command::Joint(&joint(&["knee", "hip"], &[], &[], &[3.0, -4.0])));
        assert_eq!(bits(&c), bits(&[AxisCommand::torque(-4.0), AxisCommand::torque(3.0), AxisCommand::IDLE]));
    }

    #[test]
    fn a_position_makes_a_servo_with_bounds() {
        let c = accepted(Command::Joint(&joint(&["knee"], &[0.3], &[-1.5], &[7.0])));
        assert_eq!(c[1], AxisCommand { mode: Mode::Servo, torque: 7.0, speed: -1.5, target: 0.3 });
    }

    #[test]
    fn velocity_alone_changes_only_the_applied_speed() {
        let c = accepted(Command::Joint(&joint(&["hip", "knee"], &[], &[0.7, 0.8], &[])));
        assert_eq!((c[0].mode, c[0].target, c[0].speed), (Mode::Servo, 0.1, 0.7));
        assert_eq!((c[1].mode, c[1].torque, c[1].speed), (Mode::Torque, 2.0, 0.8));
    }

    #[test]
    fn sizes_must_fit() {
        let (kind, reason) = refused(Command::Effort(&[1.0]));
        assert_eq!(
            (kind, reason.as_str()),
            (RefusalKind::WrongSize, "1 values for 3 axes (their order is parameter 'axes')")
        );
        assert_eq!(refused(Command::Joint(&joint(&["hip"], &[0.0, 1.0], &[], &[]))).0, RefusalKind::WrongSize);
        assert_eq!(refused(Command::Joint(&joint(&["hip"], &[], &[], &[]))).0, RefusalKind::Empty);
        assert_eq!(refused(Command::Joint(&joint(&[], &[], &[], &[]))).0, RefusalKind::Empty);
    }

    #[test]
    fn values_must_be_finite() {
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(refused(Command::Servo(&[0.0, bad, 0.0])).0, RefusalKind::NotFinite);
            assert_eq!(
                refused(Command::Joint(&joint(&["hip", "knee"], &[], &[], &[1.0, bad]))).0,
                RefusalKind::NotFinite
            );
        }
    }

    #[test]
    fn names_must_be_known_and_single() {
        let (kind, reason) = refused(Command::Joint(&joint(&["hip", "elbow"], &[0.0, 0.0], &[], &[])));
        assert_eq!(kind, RefusalKind::UnknownName);
        assert!(reason.contains("'elbow'"), "{reason}");
        assert_eq!(
            refused(Command::Joint(&joint(&["hip", "hip"], &[0.0, 0.0], &[], &[]))).0,
            RefusalKind::DuplicateName
        );
    }

    #[test]
    fn a_mode_is_switched_only_where_that_is_allowed() {
        let (kind, reason) = refused(Command::Effort(&[0.0; 3]));
        assert_eq!(kind, RefusalKind::ModeSwitch);
        assert_eq!(reason, "axis 'fixed_mode' is in idle mode and its <drive> tag forbids torque mode");
        let strict = Rules::new(AXES, false);
        let (kind, reason) = refused_by(&strict, Command::Joint(&joint(&["hip"], &[], &[], &[1.0])));
        assert_eq!(kind, RefusalKind::ModeSwitch);
        assert!(reason.contains("allow_mode_switch"), "{reason}");
        let mut commands = start();
        apply(&mut commands, Command::Joint(&joint(&["hip"], &[0.2], &[], &[])), &strict).unwrap();
        assert_eq!(commands[0].target, 0.2);
    }

    #[test]
    fn torque_against_speed_has_no_meaning() {
        for (velocity, effort) in [(-1.0, 2.0), (1.0, -2.0), (0.0, 2.0)] {
            let message = joint(&["knee"], &[], &[velocity], &[effort]);
            assert_eq!(refused(Command::Joint(&message)).0, RefusalKind::OppositeSigns, "{velocity} {effort}");
        }
        // The knee is driven with 2 N·m already.
        assert_eq!(refused(Command::Joint(&joint(&["knee"], &[], &[-1.0], &[]))).0, RefusalKind::OppositeSigns);
        accepted(Command::Joint(&joint(&["knee"], &[], &[0.0], &[0.0])));
        accepted(Command::Joint(&joint(&["knee"], &[], &[-1.0], &[-2.0])));
        accepted(Command::Joint(&joint(&["knee"], &[0.0], &[-1.0], &[2.0])));
    }

    fn controlled_by(message: &JointState, max_torque: f64) -> Result<Vec<AxisCommand>, Refusal> {
        let mut commands = start();
        let control = Control::for_tests(&["hip", "knee", "fixed_mode"], max_torque);
        let rules = Rules { control: Some(Arc::new(control)), ..Rules::new(AXES, true) };
        apply(&mut commands, Command::Control(message), &rules).map(|()| commands)
    }

    #[test]
    fn what_no_controller_commands_stays_as_it_is() {
        let nan = f64::NAN;
        let c = controlled_by(&joint(&["hip", "knee"], &[nan, nan], &[nan, nan], &[nan, 3.0]), 20.0).unwrap();
        assert_eq!(bits(&c[..1]), bits(&start()[..1]));
        assert_eq!(bits(&c[1..]), bits(&[AxisCommand::torque(3.0), AxisCommand::IDLE]));
        let c = controlled_by(&joint(&["hip", "knee"], &[nan, nan], &[], &[nan, nan]), 20.0).unwrap();
        assert_eq!(bits(&c), bits(&start()));
    }

    #[test]
    fn a_velocity_alone_is_driven_with_all_that_the_drive_has() {
        let c = controlled_by(&joint(&["hip", "knee"], &[], &[-0.7, 0.0], &[]), 20.0).unwrap();
        assert_eq!((c[0].mode, c[0].torque, c[0].speed), (Mode::Torque, -20.0, -0.7));
        assert_eq!((c[1].mode, c[1].torque, c[1].speed), (Mode::Torque, 20.0, SLOWEST));
        assert!(c.iter().all(AxisCommand::is_sound));
        let refusal = controlled_by(&joint(&["hip"], &[], &[0.7], &[]), f64::INFINITY).unwrap_err();
        assert!(refusal.reason.contains("max_torque"), "{}", refusal.reason);
        let switch = controlled_by(&joint(&["fixed_mode"], &[], &[0.7], &[]), 20.0).unwrap_err();
        assert_eq!(switch.kind, RefusalKind::ModeSwitch);
    }
}
