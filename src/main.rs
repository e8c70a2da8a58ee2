//! Temporary entry until the command line is written: `realnoid [run] [FILE.urdf] [--ros-args …]`.

use realnoid::ros::{RosArgs, split_arguments};
use std::process::ExitCode;

fn main() -> ExitCode {
    let (own, ros) = split_arguments(std::env::args_os().skip(1));
    let urdf = own.iter().find(|a| *a != "run").map(std::path::PathBuf::from);
    match RosArgs::parse(ros) {
        Ok(args) => realnoid::cli::run::run(urdf.as_deref(), args),
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::from(2)
        }
    }
}
