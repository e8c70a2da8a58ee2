//! `realnoid run`: the ROS 2 node.

use super::load::{Loaded, load};
use crate::description::Severity;
use crate::ros::{self, Environment, Robot, RosArgs};
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
    let loaded = match load(urdf, values.base()).or_else(|_| stand_in(values.base())) {
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

fn print_findings(loaded: &Loaded) {
    for f in loaded.findings.iter().filter(|f| f.severity > Severity::Note) {
        let (file, line, column) = (&loaded.description.file, f.at.line, f.at.column);
        eprintln!("{file}:{line}:{column}: warning[{}]: {}: {} {}", f.code, f.element, f.message, f.mend);
    }
}

/// Until `load` is real.
fn stand_in(base: crate::model::Base) -> Result<Loaded, String> {
    use crate::description::{Description, DriveMode, MonitorFrame};
    use crate::model::{Axis, AxisKind, LinkInfo, Model};
    let axis = |name: &str, switchable| Axis {
        name: name.into(),
        kind: AxisKind::Rotary,
        lower: -1.0,
        upper: 1.0,
        max_torque: 10.0,
        no_load_speed: 5.0,
        mode: DriveMode::Idle,
        switchable,
    };
    let link = |name: &str, parent, fixed, monitor| LinkInfo { name: name.into(), parent, fixed, monitor };
    let model = Model {
        name: "stand_in".into(),
        axes: vec![axis("hip", true), axis("knee", true), Axis { mode: DriveMode::Torque, ..axis("ankle", false) }],
        links: vec![
            link("base", None, false, None),
            link("thigh", Some(0), false, Some(MonitorFrame::Body)),
            link("shank", Some(1), false, Some(MonitorFrame::World)),
            link("foot-sole", Some(2), false, Some(MonitorFrame::World)),
            link("toe", Some(3), true, None),
        ],
        base,
    };
    let description = Description {
        name: "stand_in".into(),
        file: "stand-in".into(),
        text: "<robot name='stand_in'/>".into(),
        links: vec![],
        joints: vec![],
        groups: vec![],
        chains: vec![],
    };
    Ok(Loaded { description, model: model.into(), findings: vec![] })
}
