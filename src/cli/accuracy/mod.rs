//! `realnoid accuracy`: what accuracy costs in time.

mod advice;
mod args;
mod case;
mod cases;
mod closed;
mod exact;
mod fit;
mod measure;
mod mjcf;
mod output;
mod page;
mod peer;
mod plot;
mod report;
mod rung;
mod stage;
mod style;
mod summary;

use super::outcome::Progress;
use std::process::ExitCode;

pub use advice::LEVELS;
pub use args::AccuracyArgs;
pub use case::{Case, Closed, G, GRID, GRID_NS, Look, Make, Orders, Sample, Seat, Truth, sample};
pub use cases::cases;
pub use closed::{FreeBody, bounce, jacobi, slide, slow_precession};
pub use fit::{Fit, diverges, fit};
pub use measure::{Care, Curve, Measured, Reference, Run};
pub use output::{origin, write};
pub use page::{IMAGES, Origin, page};
pub use plot::diagram;
pub use report::{COLUMNS, csv, json, tables};
pub use rung::{ITERATED_STEP, ITERATIONS, Ladder, Point, Rung, STEPS, Wish};
pub use summary::summary;

/// Measures and prints. Exit codes: 0; 1 a case cannot be run, a file not be written, or the peer not be had; 2 wrong arguments.
pub fn run(args: &AccuracyArgs) -> ExitCode {
    match measured(args) {
        Ok(code) => code,
        Err((code, reason)) => {
            eprintln!("error: {}", reason.trim_end());
            ExitCode::from(code)
        }
    }
}

fn measured(args: &AccuracyArgs) -> Result<ExitCode, (u8, String)> {
    let chosen = chosen(&args.cases).map_err(|reason| (2, reason))?;
    if args.list {
        return Ok(super::say(&list(&chosen)));
    }
    let wish = Wish::new(&args.engines, &args.integrators, (&args.dt, args.quick)).map_err(|reason| (2, reason))?;
    if !(args.seconds.is_finite() && args.seconds >= 0.0) {
        return Err((2, format!("--seconds {}: must be a CPU time of 0 s or more", args.seconds)));
    }
    let care = Care { seconds: if args.quick { 0.0 } else { args.seconds }, quick: args.quick };
    let (mut progress, count) = (Progress::new(), chosen.len() as u64);
    let mut all = vec![];
    for case in chosen {
        all.push(Measured::of(case, &wish, care).map_err(|reason| (1, reason))?);
        progress.show(all.len() as u64, count);
    }
    progress.clear();
    if args.peer.is_some() {
        peer::add(&mut all, &wish.steps, care).map_err(|reason| (1, format!("--peer mujoco: {reason}")))?;
    }
    if let Some(folder) = &args.out {
        write(&all, folder, &origin()).map_err(|reason| (1, reason))?;
    }
    let text = if args.json { format!("{:#}\n", json(&all)) } else { tables(&all) };
    Ok(super::say(&text))
}

/// The cases of these names, in their own order; all, if there are none.
fn chosen(names: &[String]) -> Result<Vec<Case>, String> {
    let all = cases();
    if let Some(name) = names.iter().find(|name| all.iter().all(|c| c.name != **name)) {
        let known: Vec<&str> = all.iter().map(|c| c.name).collect();
        return Err(format!("case '{name}' does not exist; choose from: {}", known.join(", ")));
    }
    Ok(all.into_iter().filter(|c| names.is_empty() || names.iter().any(|n| n == c.name)).collect())
}

fn list(cases: &[Case]) -> String {
    let one = |c: &Case| {
        let reference = match &c.truth {
            Truth::Closed { words, .. } => format!("closed form: {words}"),
            Truth::Exact { steps } => format!("twice the digits of f64, {steps} steps in {GRID} s"),
            Truth::Own { integrator, steps_per_ms } => {
                format!("our own run, {}, {steps_per_ms} steps in a millisecond", integrator.name())
            }
        };
        format!(
            "{:<18}{}\n{:<18}  compared: {} ({}), {} s\n{:<18}  with: {reference}\n",
            c.name,
            c.shows,
            "",
            c.compared,
            c.unit,
            c.duration(),
            ""
        )
    };
    cases.iter().map(one).collect()
}
