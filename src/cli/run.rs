//! `realnoid run`: the ROS 2 node.

use super::load::{Loaded, Source};
use super::scene::{Assembly, Fault, Scene, Spare, assemble, inside, switch_effect};
use super::texts::{absolute, listening};
use crate::description::{Severity, render};
use crate::engine::{EngineKind, unused_integrator};
use crate::model::{Base, Model};
use crate::record::story::{Origin, Switched, file_digest};
use crate::ros::parameters::Values;
use crate::ros::{self, Environment, Robot, RosArgs};
use std::ffi::OsString;
use std::io::IsTerminal;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Exit code for a command line, parameter file or environment that makes no sense.
const USAGE: u8 = 2;

/// Parses the arguments that followed `--ros-args`, then as [`run`].
pub fn start(source: Source, ros_arguments: Vec<OsString>, record: Option<&Path>) -> ExitCode {
    match RosArgs::parse(ros_arguments) {
        Ok(args) => run(source, args, record),
        Err(reason) => fail(&reason, USAGE),
    }
}

/// Simulates a robot as a ROS 2 node until SIGINT or SIGTERM, and records it if a folder is given. Exit codes: 0 after a
/// clean end, 1 if the robot cannot be loaded or ROS not be joined, 2 for wrong arguments, parameters or environment.
pub fn run(source: Source, args: RosArgs, record: Option<&Path>) -> ExitCode {
    let ((values, warnings), environment) = match args.values().and_then(|v| Ok((v, Environment::read()?))) {
        Ok(checked) => checked,
        Err(reason) => return fail(&reason, USAGE),
    };
    let (assembly, mut origin, values) = match assembly(source, values) {
        Ok(all) => all,
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
    if record.is_some() {
        origin.meshes.iter_mut().for_each(|(file, digest)| *digest = file_digest(file));
    }
    let robot = Robot {
        source: loaded.description.file.to_string(),
        urdf: loaded.published.as_str().into(),
        model: Arc::new(assembly.model),
        initial: assembly.initial,
        origin,
        controls: loaded.description.controls.clone(),
    };
    match ros::run(&robot, &args, values, &environment, record) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => fail(&reason, 1),
    }
}

/// The robot and all that the scene puts beside it; the settings of the scene, where no parameter says otherwise.
fn assembly(source: Source, mut values: Values) -> Result<(Assembly, Origin, Values), Fault> {
    let scene = Scene::read(values.scene()).map_err(Fault::Scene)?;
    values.adopt(&scene.settings, &scene.given).map_err(Fault::Scene)?;
    let base = scene.base.filter(|_| !values.is_given("base")).unwrap_or(values.base());
    let packages = source.packages.iter().map(|(name, folder)| (name.clone(), absolute(folder)));
    let mut origin = Origin {
        urdf: source.urdf.map(Path::to_owned),
        packages: packages.collect(),
        scene: values.scene().map(Path::to_owned),
        ground: values.ground(),
        base: if base == Base::Fixed { "fixed" } else { "free" }.into(),
        engine: values.pace().settings.engine.name().into(),
        effects: values.effects().map(|(p, e, on)| Switched { parameter: p.into(), effect: e.into(), on }).collect(),
        ..Origin::default()
    };
    let (assembly, heard) = listening(|| build(&origin));
    // As messages show them while it is loaded; from any folder later.
    origin.urdf = origin.urdf.as_deref().map(absolute);
    origin.scene = origin.scene.as_deref().map(absolute);
    origin.texts = heard.texts;
    origin.meshes = heard.meshes.into_iter().map(|file| (file, None)).collect();
    Ok((assembly?, origin, values))
}

/// The robot and all that the scene puts beside it, as `origin` says.
pub(super) fn build(origin: &Origin) -> Result<Assembly, Fault> {
    let mut scene = Scene::read(origin.scene.as_deref()).map_err(Fault::Scene)?;
    let unknown = || Fault::Scene(format!("engine '{}' does not exist", origin.engine));
    scene.settings.engine = EngineKind::by_name(&origin.engine).ok_or_else(unknown)?;
    if origin.ground {
        scene.lay_ground();
    }
    let stand = (super::base_by_name(&origin.base), scene.robot.pose);
    let source = Source { urdf: origin.urdf.as_deref(), packages: &origin.packages };
    let switch = |m: &mut Model| {
        scene.switch_effects(m)?;
        let told = |s: &Switched, reason: String| format!("parameter '{}': {reason}", s.parameter);
        origin.effects.iter().try_for_each(|s| switch_effect(m, &s.effect, s.on).map_err(|reason| told(s, reason)))
    };
    assemble(&scene, source, stand, Spare::Humanoid, &switch)
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
