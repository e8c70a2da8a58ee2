//! The node from start to end.

use super::args::RosArgs;
use super::clock;
use super::connection::{Plan, spawn};
use super::control::ControlLoop;
use super::environment::Environment;
use super::exchange::exchange;
use super::listen::{Desk, Live, Quit};
use super::log::{self, Logger};
use super::parameters::{Definition, Values, show};
use super::publish_loop::PublishLoop;
use super::recording::{Tape, told};
use super::ros2_control::Control;
use crate::description::ControlBlock;
use crate::engine::State;
use crate::model::{Base, Model};
use crate::record::story::Origin;
use crate::world::{AxisCommand, Mode, World};
use ros2_client::ParameterValue;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};

/// Parameters that are told at start in any case.
const ALWAYS_TOLD: [&str; 9] = [
    "control_interval",
    "steps_per_interval",
    "solver_iterations",
    "time_scale",
    "gravity",
    "integrator",
    "engine",
    "base",
    "start",
];

/// What is simulated.
#[derive(Clone, Debug)]
pub struct Robot {
    /// File name or label of the URDF.
    pub source: String,
    /// The URDF text, as it is published.
    pub urdf: Arc<str>,
    /// The model.
    pub model: Arc<Model>,
    /// Where everything starts.
    pub initial: State,
    /// What all this was made of, for recordings.
    pub origin: Origin,
    /// Its `<ros2_control>` blocks.
    pub controls: Vec<ControlBlock>,
}

/// Simulates `robot` until SIGINT or SIGTERM, and records it if a folder is given. `Err` says what kept it from starting, or from
/// going on.
pub fn run(
    robot: &Robot,
    args: &RosArgs,
    values: Values,
    environment: &Environment,
    record: Option<&Path>,
) -> Result<(), String> {
    let tape = Tape::default();
    record.map(|folder| tape.start(folder)).transpose()?;
    let done = simulate(robot, args, values, environment, &tape);
    if let Some(report) = tape.stop() {
        say(&format!("{}\n", told(&report)));
    }
    done
}

fn simulate(
    robot: &Robot,
    args: &RosArgs,
    mut values: Values,
    environment: &Environment,
    tape: &Tape,
) -> Result<(), String> {
    log::show_library_errors();
    let stop = stop_on_signals()?;
    values.pause_at_start()?;
    values.set_axes(robot.model.axes.iter().map(|a| a.name.clone()).collect());
    let (world, commands) = world(robot, &values)?;
    let mut initial = world.new_snapshot();
    world.write_snapshot(&mut initial);

    let (control_end, publish_end, end) = exchange(&world, &commands, &values.pace(), stop.clone())?;
    let live = Arc::new(Live::default());
    live.take(&values);
    let settings = settings_report(&values);
    let priority = values.realtime_priority();
    let control = Control::of(&robot.controls, &robot.model, values.ros2_control()).map(Arc::new);
    let plan = Plan { robot, args, environment, initial: &initial, tape, control: control.as_ref() };
    let quit = Quit { stop: stop.clone(), main: thread::current() };
    let desk = Desk { commands, values, end, live: live.clone(), quit };
    let publish = PublishLoop::new(plan, desk, publish_end)?;
    let connection = publish.connection();
    say(&start_report(plan, &settings, &connection.topics));
    environment.warnings.iter().for_each(|w| connection.log.warn(w));

    let control = ControlLoop::new(world, control_end, thread::current(), live)?;
    let control = spawn_control(control, priority, &connection.log)?;
    let publish = publish.run(&stop);
    stop.store(true, Ordering::Relaxed);
    let _ = control.join();
    say(&publish?.finish());
    Ok(())
}

/// To standard output; a reader that has gone away does not stop the node.
fn say(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// A flag that SIGINT and SIGTERM set, waking this thread.
fn stop_on_signals() -> Result<Arc<AtomicBool>, String> {
    let stop = Arc::new(AtomicBool::new(false));
    let (flag, main) = (stop.clone(), thread::current());
    let handler = move || {
        flag.store(true, Ordering::Relaxed);
        main.unpark();
    };
    ctrlc::set_handler(handler).map_err(|e| format!("cannot handle SIGINT and SIGTERM: {e}"))?;
    Ok(stop)
}

/// The world at its start, and the commands of its axes.
fn world(robot: &Robot, values: &Values) -> Result<(World, Vec<AxisCommand>), String> {
    let mut world = World::new(robot.model.clone(), values.pace().settings)?;
    world.set_initial_state(robot.initial.clone());
    let mut initial = world.new_snapshot();
    world.write_snapshot(&mut initial);
    let commands = initial_commands(&robot.model, &initial.position, values.hold_at_start());
    let unsound = |axis: usize| format!("axis '{}' cannot be held where it is at start", robot.model.axes[axis].name);
    world.set_commands(&commands).map_err(unsound)?;
    Ok((world, commands))
}

/// Hold: every axis that may switch its mode servos where it is; what follows another axis is held by that one. Free: the
/// modes of the drive tags.
fn initial_commands(model: &Model, positions: &[f64], hold: bool) -> Vec<AxisCommand> {
    let follows = |i: usize| model.couplings_in_force().iter().any(|c| c.follower == i);
    let command = |(i, (axis, &position)): (usize, (&crate::model::Axis, &f64))| match axis.mode {
        _ if hold && axis.switchable && !follows(i) => AxisCommand::servo(position),
        Mode::Servo => AxisCommand::servo(position),
        Mode::Torque => AxisCommand::torque(0.0),
        Mode::Idle => AxisCommand::IDLE,
    };
    model.axes.iter().zip(positions).enumerate().map(command).collect()
}

fn spawn_control(control: ControlLoop, priority: i32, log: &Logger) -> Result<JoinHandle<()>, String> {
    let (report, scheduling) = mpsc::channel();
    let thread = spawn("control", move || {
        let _ = report.send(clock::prepare_thread(priority));
        drop(report);
        control.run();
    })?;
    match scheduling.recv() {
        Ok(Err(reason)) => {
            let mend = "raise RLIMIT_RTPRIO or grant CAP_SYS_NICE";
            log.warn(format!("realtime_priority {priority} was refused: {reason}; {mend}. Going on without"));
        }
        _ if priority > 0 => log.info(format!("the control thread runs with SCHED_FIFO priority {priority}")),
        _ => {}
    }
    Ok(thread)
}

/// What the world is set to, and whatever else is not as it is by default.
fn settings_report(values: &Values) -> String {
    let told =
        |d: &Definition, v: &ParameterValue| ALWAYS_TOLD.contains(&d.name) || (d.name != "axes" && *v != d.default);
    let settings = values.iter().filter(|(d, v)| told(d, v)).map(|(d, v)| format!("{} {}", d.name, show(v)));
    settings.collect::<Vec<_>>().join(", ")
}

fn start_report(plan: Plan, settings: &str, topics: &[String]) -> String {
    let model = &plan.robot.model;
    let base = if model.base == Base::Fixed { "fixed" } else { "free" };
    let mut text = format!("{}: '{}' from ", super::names::join(&plan.args.namespace, &plan.args.node), model.name);
    text += &format!("{}\n  {} links, {} axes, ", plan.robot.source, model.links.len(), model.axes.len());
    text += &format!("{:.3} kg, base {base}\n  {settings}\n", model.mass());
    text += &format!("  ROS domain {}, discovery range {}\n", plan.environment.domain, plan.environment.range);
    topics.iter().for_each(|t| text += &format!("  {t}\n"));
    text
}
