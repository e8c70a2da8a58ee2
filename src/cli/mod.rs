//! The command line, thin.

pub mod accuracy;
pub mod args;
pub mod bench;
pub mod check;
pub mod commands;
pub mod compare;
pub mod conformance;
pub mod drawing;
mod drop;
pub mod effects;
mod estimate;
pub mod evaluate;
pub mod hard;
pub mod inspect;
pub mod load;
mod outcome;
pub mod recover;
pub mod replay;
pub mod run;
pub mod scene;
pub mod script;
pub mod simulate;
mod start;
mod start_args;
mod stopwatch;
pub mod sweep;
mod texts;

use args::{Cli, Command};
use clap::Parser;
use std::io::Write;
use std::process::ExitCode;

/// Reads the command line and does what it says.
pub fn main() -> ExitCode {
    let (own, ros) = crate::ros::split_arguments(std::env::args_os());
    let cli = Cli::parse_from(own);
    match cli.command.unwrap_or(Command::Run { urdf: None, packages: Default::default(), record: None }) {
        Command::Run { urdf, packages, record } => run::start(packages.source(urdf.as_deref()), ros, record.as_deref()),
        Command::Check { urdf, scene, engine, packages } => {
            check::run(packages.source(urdf.as_deref()), scene.as_deref(), engine.as_deref())
        }
        Command::Inspect(args) => inspect::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Engines(args) => conformance::run(&args),
        Command::Hard(args) => hard::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Recover { bag } => recover::run(&bag),
        Command::Accuracy(args) => accuracy::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Effects(args) => effects::run(&args),
        Command::Evaluate(args) => evaluate::run(&args),
    }
}

fn base_by_name(name: &str) -> crate::model::Base {
    if name == "free" { crate::model::Base::Free } else { crate::model::Base::Fixed }
}

/// Prints a result; failure if it cannot be written, but not for a reader that has seen enough (`| head`).
fn say(text: &str) -> ExitCode {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            let _ = writeln!(std::io::stderr(), "error: cannot write to standard output: {error}");
            ExitCode::FAILURE
        }
        _ => ExitCode::SUCCESS,
    }
}
