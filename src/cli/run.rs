//! `realnoid run`: the ROS 2 node.

use super::load::{Loaded, Source};
use super::scene::{Assembly, Fault, Scene, Spare, assemble, inside};
use crate::description::{Severity, render};
use crate::engine::unused_integrator;
use crate::ros::parameters::Values;
use crate::ros::{self, Environment, Robot, RosArgs};
use std::ffi::OsString;
use std::io::IsTerminal;
use std::process::ExitCode;
use std::sync::Arc;

/// Exit code for a command line, parameter file or environment that makes no sense.
const USAGE: u8 = 2;

/// Parses the arguments that followed `--ros-args`, then as [`run`].
pub fn start(source: Source, ros_arguments: Vec<OsString>) -> ExitCode {
    match RosArgs::parse(ros_arguments) {
        Ok(args) => run(source, args),
        Err(reason) => fail(&reason, USAGE),
    }
}

/// Simulates a robot as a ROS 2 node until SIGINT or SIGTERM. Exit codes: 0 after a
/// clean end, 1 if the robot cannot be loaded or ROS not be joined, 2 for wrong arguments, parameters or environment.
pub fn run(source: Source, args: RosArgs) -> ExitCode {
    let ((values, warnings), environment) = match args.values().and_then(|v| Ok((v, Environment::read()?))) {
        Ok(checked) => checked,
        Err(reason) => return fail(&reason, USAGE),
    };
    let (assembly, values) = match assembly(source, values) {
        Ok(both) => both,
        Err(Fault::Scene(reason)) => return fail(&reason, USAGE),
        Err(Fault::Robot(report)) => {
            eprintln!("{}", report.trim_end());
            return ExitCode::FAILURE;
        }
    };
    let loaded = &assembly.first;
    let inside = inside(&assembly.model, &assembly.initial);
    let settings = values.pace().settings;
    let unused = unused_integrator(settings.engine, settings.integrator).map(|s| s.of(settings.engine));
    warnings.iter().chain(&assembly.warnings).chain(&inside).chain(&unused).for_each(|w| eprintln!("warning: {w}"));
    print_findings(loaded);
    let robot = Robot {
        source: loaded.description.file.to_string(),
        urdf: loaded.published.as_str().into(),
        model: Arc::new(assembly.model),
        initial: assembly.initial,
    };
    match ros::run(&robot, &args, values, &environment) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => fail(&reason, 1),
    }
}

/// The robot and all that the scene puts beside it; the settings of the scene, where no parameter says otherwise.
fn assembly(source: Source, mut values: Values) -> Result<(Assembly, Values), Fault> {
    let mut scene = Scene::read(values.scene()).map_err(Fault::Scene)?;
    values.adopt(&scene.settings, &scene.given).map_err(Fault::Scene)?;
    scene.settings.engine = values.pace().settings.engine;
    if values.ground() {
        scene.lay_ground();
    }
    let base = scene.base.filter(|_| !values.is_given("base")).unwrap_or(values.base());
    let assembly = assemble(&scene, source, (base, scene.robot.pose), Spare::Humanoid, &|m| scene.switch_effects(m))?;
    Ok((assembly, values))
}

fn fail(reason: &str, code: u8) -> ExitCode {
    eprintln!("error: {}", reason.trim_end());
    ExitCode::from(code)
}

/// Warnings, with their source lines; notes are for `realnoid check`.
fn print_findings(loaded: &Loaded) {
    let warnings: Vec<_> = loaded.findings.iter().filter(|f| f.severity > Severity::Note).cloned().collect();
    if !warnings.is_empty() {
        let d = &loaded.description;
        eprint!("{}", render(&warnings, &d.file, &d.text, std::io::stderr().is_terminal()));
    }
}
