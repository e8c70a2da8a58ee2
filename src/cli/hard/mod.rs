//! `realnoid hard`: cases that hurt, over all integrators and steps: what becomes of each, and whether it is told.

mod grid;
mod page;

use super::args::HardArgs;
use super::compare::{kinds, write};
use super::conformance::machine;
use super::outcome::Progress;
use crate::world::{EngineKind, Integrator};
use std::process::ExitCode;

pub use grid::{Cell, Column, Grid, Row, STEPS, Verdict};
pub use page::{csv, page, tables};

/// Runs the cases. Exit codes: 0; 1 something is beyond its tolerance in silence or not finite, an engine does not take a scene, or a file
/// cannot be written; 2 wrong arguments or cases.
pub fn run(args: &HardArgs) -> ExitCode {
    match measured(args) {
        Ok(code) => code,
        Err((code, reason)) => {
            eprintln!("error: {}", reason.trim_end());
            ExitCode::from(code)
        }
    }
}

fn measured(args: &HardArgs) -> Result<ExitCode, (u8, String)> {
    let wrong = |reason: String| (2, reason);
    let columns = columns(&args.engine, &args.integrator).map_err(wrong)?;
    let steps = if args.step.is_empty() { STEPS.to_vec() } else { steps(&args.step).map_err(wrong)? };
    let files = super::conformance::files(&args.cases).map_err(wrong)?;
    let mut progress = Progress::new();
    let grid = Grid::of(&files, &columns, &steps, &mut |done, all| progress.show(done, all));
    progress.clear();
    let grid = grid.map_err(wrong)?;
    write("--csv", args.csv.as_deref(), || csv(&grid))?;
    write("--markdown", args.markdown.as_deref(), || page(&grid, &args.cases, &machine()))?;
    let said = super::say(&tables(&grid));
    Ok(if grid.fails() { ExitCode::FAILURE } else { said })
}

/// rbx with every integrator, and the other engines; those that are named, if any are.
fn columns(engines: &[String], integrators: &[String]) -> Result<Vec<Column>, String> {
    let mut chosen = vec![];
    for name in integrators {
        let found = Integrator::by_name(name).ok_or_else(|| {
            let names: Vec<&str> = Integrator::NAMES.iter().map(|(n, _)| *n).collect();
            format!("--integrator {name}: does not exist; choose one of: {}", names.join(", "))
        })?;
        chosen.push(found);
    }
    if chosen.is_empty() {
        chosen = Integrator::NAMES.iter().map(|(_, i)| *i).collect();
    }
    let mut columns = vec![];
    for engine in kinds(engines)? {
        if engine == EngineKind::Rbx {
            columns.extend(chosen.iter().map(|integrator| Column { engine, integrator: *integrator }));
        } else {
            columns.push(Column { engine, integrator: Integrator::default() });
        }
    }
    Ok(columns)
}

/// Milliseconds as whole nanoseconds.
fn steps(given: &[f64]) -> Result<Vec<i64>, String> {
    let step = |ms: &f64| {
        let ns = (ms * 1e6).round();
        if (1e3..=1e9).contains(&ns) {
            Ok(ns as i64)
        } else {
            Err(format!("--step {ms}: must be a number of milliseconds from 0.001 to 1000"))
        }
    };
    given.iter().map(step).collect()
}
