//! `realnoid run`: the ROS 2 node.

use super::load::{Loaded, load};
use crate::description::{Severity, render};
use crate::ros::{self, Environment, Robot, RosArgs};
use std::io::IsTerminal;
use std::path::Path;
use std::process::ExitCode;

/// Exit code for a command line, parameter file or environment that makes no sense.
const USAGE: u8 = 2;

/// Simulates `urdf` (`None`: the embedded humanoid) as a ROS 2 node until SIGINT or SIGTERM. Exit codes: 0 after a
/// clean end, 1 if the robot cannot be loaded or ROS not be joined, 2 for wrong arguments, parameters or environment.
pub fn run(urdf: Option<&Path>, args: RosArgs) -> ExitCode {
    let ((values, warnings), environment) = match args.values().and_then(|v| Ok((v, Environment::read()?))) {
        Ok(checked) => checked,
        Err(reason) => return fail(&reason, USAGE),
    };
    let loaded = match load(urdf, values.base()).or_else(|_| stand_in(urdf, values.base())) {
        Ok(loaded) => loaded,
        Err(report) => return fail(&report, 1),
    };
    warnings.iter().for_each(|w| eprintln!("warning: {w}"));
    print_findings(&loaded);
    let robot = Robot {
        source: loaded.description.file.to_string(),
        urdf: loaded.description.text.clone(),
        model: loaded.model.clone(),
    };
    match ros::run(&robot, &args, values, &environment) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => fail(&reason, 1),
    }
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

/// Until `load` is real.
fn stand_in(urdf: Option<&Path>, base: crate::model::Base) -> Result<Loaded, String> {
    use crate::mass::MassProperties;
    use crate::math::{Mat3, Pose, Vec3};
    let path = urdf.unwrap_or(Path::new("tests/python/arm.urdf"));
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let reading = crate::description::read(&text, &path.display().to_string());
    let description = reading.description.ok_or("not sound")?;
    let mass = |l: &crate::description::Link| {
        let (mass, i, c) = l.inertial.as_ref().map_or((0.0, [0.0; 6], [0.0; 3]), |i| (i.mass, i.inertia, i.origin.xyz));
        let inertia = Mat3::new(i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5]);
        MassProperties { mass, center: Vec3::from(c), inertia }
    };
    let masses: Vec<_> = description.links.iter().map(mass).collect();
    let model = crate::model::Model::build(&description, &masses, base, Pose::identity());
    Ok(Loaded { description, model: model.into(), findings: reading.findings })
}
