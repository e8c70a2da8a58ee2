//! Commands of `simulate` that hold from the start: `--effort`, `--servo`, `--turn`.

use super::args::{RunArgs, assignment};
use crate::model::Model;
use crate::world::{AxisCommand, Mode, Side, World};

/// An axis by name.
///
/// # Errors
/// Names the flag (or the place) and the axes there are.
pub fn axis(m: &Model, place: &str, name: &str) -> Result<usize, String> {
    m.axis(name).ok_or_else(|| {
        let names: Vec<&str> = m.axes.iter().map(|a| a.name.as_str()).collect();
        format!("{place}: there is no axis '{name}'; the axes are: {}", names.join(", "))
    })
}

/// Turns axes from their root side (J-12), in the order given, and makes that the state at start.
///
/// # Errors
/// Names the flag and what is wrong with it.
pub fn turn(args: &RunArgs, world: &mut World) -> Result<(), String> {
    for text in &args.turn {
        let form = "AXIS=POSITION";
        let (name, values) = assignment("--turn", form, text)?;
        let [position] = values[..] else { return Err(format!("--turn {text}: must be {form}")) };
        let axis = axis(world.model(), "--turn", name)?;
        world.set_joint_angle(axis, position, Side::Root).map_err(|reason| format!("--turn {text}: {reason}"))?;
    }
    if !args.turn.is_empty() {
        world.remember();
        world.reset();
    }
    Ok(())
}

/// Gives the axes their commands.
///
/// # Errors
/// Names the flag and what is wrong with it.
pub fn command(args: &RunArgs, world: &mut World) -> Result<(), String> {
    let model = world.model().clone();
    let (mut commands, mut taken) = (world.commands().to_vec(), Vec::new());
    let efforts = args.start.effort.iter().map(|text| ("--effort", "AXIS=TORQUE[,SPEED]", text, effort as Make));
    let servos = args.start.servo.iter().map(|text| ("--servo", "AXIS=POSITION[,TORQUE[,SPEED]]", text, servo as Make));
    for (flag, form, text, make) in efforts.chain(servos) {
        let (name, values) = assignment(flag, form, text)?;
        let Some(command) = make(&values) else { return Err(format!("{flag} {text}: must be {form}")) };
        let axis = axis(&model, flag, name)?;
        let wrong = |reason: &str| Err(format!("{flag} {text}: axis '{name}' {reason}"));
        if taken.contains(&axis) {
            return wrong("already has a command; give it one --effort or one --servo");
        }
        if let Some(reason) = refusal(&model, axis, &command) {
            return Err(format!("{flag} {text}: {reason}"));
        }
        taken.push(axis);
        commands[axis] = command;
    }
    world.set_commands(&commands).map_err(|axis| format!("the command of axis {axis} is not sound"))
}

type Make = fn(&[f64]) -> Option<AxisCommand>;

fn effort(values: &[f64]) -> Option<AxisCommand> {
    match values {
        [torque] => Some(AxisCommand::torque(*torque)),
        [torque, speed] => Some(AxisCommand { speed: *speed, ..AxisCommand::torque(*torque) }),
        _ => None,
    }
}

fn servo(values: &[f64]) -> Option<AxisCommand> {
    match values {
        [target] => Some(AxisCommand::servo(*target)),
        [target, torque] => Some(AxisCommand { torque: *torque, ..AxisCommand::servo(*target) }),
        [target, torque, speed] => Some(AxisCommand { torque: *torque, speed: *speed, ..AxisCommand::servo(*target) }),
        _ => None,
    }
}

/// Why an axis does not take a command: X-8, or a drive that stays in its mode.
pub fn refusal(m: &Model, axis: usize, command: &AxisCommand) -> Option<String> {
    let a = &m.axes[axis];
    if !a.switchable && a.mode != command.mode {
        let mode = mode_name(a.mode);
        return Some(format!(
            "axis '{}' has a drive that stays in {mode} mode; its tag can allow the change with switchable=\"true\"",
            a.name
        ));
    }
    if command.contradicts() {
        return Some(format!(
            "axis '{}': applied torque {} with applied speed {} has no meaning; give both the same sign, or no speed",
            a.name, command.torque, command.speed
        ));
    }
    None
}

/// As it is written in tags and scripts.
pub fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Idle => "idle",
        Mode::Torque => "torque",
        Mode::Servo => "servo",
    }
}
