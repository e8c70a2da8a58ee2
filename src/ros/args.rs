//! The ROS command line: everything from `--ros-args` on.

use super::log::Severity;
use super::names::Remap;
use super::parameters::Values;
use super::params_file;
use std::ffi::OsString;
use std::path::PathBuf;

const DEFAULT_NODE_NAME: &str = "forward_dynamics";

/// A checked ROS command line.
#[derive(Clone, Debug)]
pub struct RosArgs {
    /// Node name.
    pub node: String,
    /// Namespace, absolute.
    pub namespace: String,
    /// Name remaps, in order.
    pub remaps: Vec<Remap>,
    /// Assignments and files, in order; later ones win.
    parameters: Vec<Source>,
    /// What is logged.
    pub log_level: Severity,
    /// Is the log published on `/rosout`?
    pub rosout: bool,
    /// Is the log written to standard error?
    pub stderr: bool,
}

#[derive(Clone, Debug)]
enum Source {
    /// `-p [node:]name:=value`, with the argument as it was written.
    Assignment { node: Option<String>, name: String, value: String, written: String },
    /// `--params-file`.
    File(PathBuf),
}

impl Default for RosArgs {
    fn default() -> Self {
        Self {
            node: DEFAULT_NODE_NAME.into(),
            namespace: "/".into(),
            remaps: vec![],
            parameters: vec![],
            log_level: Severity::Info,
            rosout: true,
            stderr: true,
        }
    }
}

/// Parts a command line (without the program's name) into the program's arguments and those for ROS: from
/// `--ros-args` to `--` or the end, any number of times.
pub fn split_arguments(arguments: impl IntoIterator<Item = OsString>) -> (Vec<OsString>, Vec<OsString>) {
    let (mut own, mut ros, mut inside) = (vec![], vec![], false);
    for argument in arguments {
        match argument.to_str() {
            Some("--ros-args") => inside = true,
            Some("--") if inside => inside = false,
            _ if inside => ros.push(argument),
            _ => own.push(argument),
        }
    }
    (own, ros)
}

impl RosArgs {
    /// Reads the arguments after `--ros-args` (which may itself be the first). `Err` names the argument and the mend.
    pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Self, String> {
        let mut args = Self::default();
        let mut rest = arguments
            .into_iter()
            .map(|a| a.into_string().map_err(|a| format!("argument {} is not valid UTF-8", a.display())));
        while let Some(argument) = rest.next() {
            let argument = argument?;
            let mut operand = || {
                let missing = || format!("{argument} needs a value after it");
                rest.next().unwrap_or_else(|| Err(missing()))
            };
            match argument.as_str() {
                "--ros-args" | "--" => {}
                "-p" | "--param" => args.assign(operand()?)?,
                "--params-file" => args.parameters.push(Source::File(operand()?.into())),
                "-r" | "--remap" => args.remap(&operand()?)?,
                "--log-level" => args.set_log_level(&operand()?)?,
                "--enable-rosout-logs" => args.rosout = true,
                "--disable-rosout-logs" => args.rosout = false,
                "--enable-stdout-logs" => args.stderr = true,
                "--disable-stdout-logs" => args.stderr = false,
                // Security enclaves and rcl's logging back end have no counterpart here.
                "-e" | "--enclave" | "--log-config-file" => drop(operand()?),
                "--enable-external-lib-logs" | "--disable-external-lib-logs" => {}
                other => return Err(unknown(other)),
            }
        }
        Ok(args)
    }

    /// The parameters' values after all assignments and files, and warnings about names that sections for any
    /// node (`/**`) contain and this node does not have. `Err` names the argument or file and line.
    pub fn values(&self) -> Result<(Values, Vec<String>), String> {
        let mut values = Values::default();
        let mut warnings = vec![];
        let full_name = super::names::join(&self.namespace, &self.node);
        for source in &self.parameters {
            match source {
                Source::File(path) => params_file::read(path, &full_name, &mut values, &mut warnings)?,
                Source::Assignment { node, name, value, written } if node.as_ref().is_none_or(|n| *n == self.node) => {
                    params_file::scalar(value)
                        .and_then(|value| values.set_at_start(name, value))
                        .map_err(|reason| format!("-p {written}: {reason}"))?;
                }
                Source::Assignment { .. } => {}
            }
        }
        Ok((values, warnings))
    }

    fn assign(&mut self, written: String) -> Result<(), String> {
        let Some((left, value)) = written.split_once(":=") else {
            return Err(format!("-p {written}: expected name:=value, as in -p time_scale:=0.5"));
        };
        let (node, name) = match left.split_once(':') {
            Some((node, name)) => (Some(node.to_string()), name.to_string()),
            None => (None, left.to_string()),
        };
        self.parameters.push(Source::Assignment { node, name, value: value.into(), written: written.clone() });
        Ok(())
    }

    fn remap(&mut self, written: &str) -> Result<(), String> {
        let bad = |reason: &str| format!("-r {written}: {reason}");
        let remap = Remap::parse(written).map_err(|e| bad(&e))?;
        if remap.node.as_ref().is_some_and(|n| *n != self.node) && remap.from.starts_with("__") {
            return Ok(());
        }
        match remap.from.as_str() {
            "__node" | "__name" => {
                super::names::check_token(&remap.to).map_err(|e| bad(&e))?;
                self.node = remap.to;
            }
            "__ns" => self.namespace = super::names::check_namespace(&remap.to).map_err(|e| bad(&e))?,
            from if from.starts_with("__") => return Err(bad("only __node, __name and __ns can be remapped")),
            _ => self.remaps.push(remap),
        }
        Ok(())
    }

    fn set_log_level(&mut self, written: &str) -> Result<(), String> {
        let (logger, level) = written.split_once(":=").unwrap_or(("", written));
        let severity = Severity::parse(level)
            .ok_or_else(|| format!("--log-level {written}: expected debug, info, warn, error or fatal"))?;
        if logger.is_empty() || logger.rsplit('.').next() == Some(&self.node) {
            self.log_level = severity;
        }
        Ok(())
    }
}

fn unknown(argument: &str) -> String {
    let mend = if argument.contains(":=") { "; write -r or -p before it" } else { "" };
    format!(
        "unknown ROS argument '{argument}'{mend} (known: -p NAME:=VALUE, --params-file FILE, -r FROM:=TO, --log-level LEVEL)"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use ros2_client::ParameterValue as V;

    fn parse(arguments: &[&str]) -> Result<RosArgs, String> {
        RosArgs::parse(arguments.iter().map(OsString::from))
    }

    #[test]
    fn ros_arguments_are_parted_from_the_programs_own() {
        let all = ["run", "--ros-args", "-r", "a:=b", "--", "robot.urdf", "--ros-args", "-p", "x:=1"];
        let (own, ros) = split_arguments(all.map(OsString::from));
        assert_eq!(own, ["run", "robot.urdf"].map(OsString::from));
        assert_eq!(ros, ["-r", "a:=b", "-p", "x:=1"].map(OsString::from));
    }

    #[test]
    fn name_namespace_remaps_and_level() {
        let a = parse(&["-r", "__ns:=/bench", "-r", "__node:=fd", "-r", "joint_states:=foo", "--log-level", "warn"])
            .unwrap();
        assert_eq!((a.namespace.as_str(), a.node.as_str(), a.remaps.len()), ("/bench", "fd", 1));
        assert_eq!(a.log_level, Severity::Warn);
    }

    #[test]
    fn later_assignments_win_and_other_nodes_are_none_of_our_business() {
        let a = parse(&["-p", "tf_rate:=1", "-p", "tf_rate:=2.5", "-p", "other:tf_rate:=9"]).unwrap();
        assert_eq!(a.values().unwrap().0.tf_rate(), 2.5);
    }

    #[test]
    fn values_are_yaml() {
        let a = parse(&["-p", "gravity:=[0, 0, -1.62]", "-p", "integrator:=rk4", "-p", "allow_mode_switch:=false"])
            .unwrap();
        let (values, _) = a.values().unwrap();
        assert_eq!(*values.get("gravity").unwrap().1, V::DoubleArray(vec![0.0, 0.0, -1.62]));
        assert!(!values.allow_mode_switch());
    }

    #[test]
    fn what_is_wrong_is_said_with_the_argument() {
        assert!(parse(&["-p", "tf_rate"]).unwrap_err().contains("-p tf_rate: expected name:=value"));
        assert!(parse(&["-p"]).unwrap_err().contains("-p needs a value"));
        assert!(parse(&["--fast"]).unwrap_err().contains("unknown ROS argument '--fast'"));
        assert!(parse(&["tf_rate:=1"]).unwrap_err().contains("write -r or -p before it"));
        assert!(parse(&["-r", "__ns:=bench"]).unwrap_err().contains("must start with /"));
        assert!(parse(&["--log-level", "loud"]).unwrap_err().contains("expected debug"));
        let values = |argument| parse(&["-p", argument]).unwrap().values().unwrap_err();
        assert!(
            values("steps_per_interval:=0").contains("-p steps_per_interval:=0: parameter 'steps_per_interval' = 0")
        );
        assert!(values("speed:=1").contains("there is no parameter 'speed'"));
        assert!(values("steps_per_interval:=abc").contains("is of type integer"));
    }
}
