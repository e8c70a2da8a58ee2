//! `realnoid engines`: what engines there are, and how near each comes to what theory says of the scenes in case files.

mod case;
mod csv;
mod file;
mod formula;
mod list;
mod measure;
mod page;
mod quantity;
mod report;

use super::args::EnginesArgs;
use super::compare::{kinds, write};
use super::outcome::Progress;
use crate::engine::EngineKind;
use std::path::Path;
use std::process::ExitCode;

pub use case::{Case, Expectation, Rung, cases, files};
pub use file::Beyond;
pub use measure::{DRIFT, Figure, Outcome, Run, Verdict};
pub use page::{machine, page};

/// Cases on engines.
pub struct Results {
    /// In the order of their names.
    pub cases: Vec<Case>,
    /// Those that were asked for.
    pub engines: Vec<EngineKind>,
    /// Per case, per engine.
    pub outcomes: Vec<Vec<Outcome>>,
}

impl Results {
    /// Runs every case on every engine; `seen` is told after each of them how many there have been, and how many there are.
    pub fn of(cases: Vec<Case>, engines: &[EngineKind], seen: &mut dyn FnMut(u64, u64)) -> Self {
        let all = (cases.len() * engines.len()) as u64;
        let mut done = 0;
        let mut run = |case: &Case, engine: &EngineKind| {
            let outcome = case.run(*engine);
            done += 1;
            seen(done, all);
            outcome
        };
        let outcomes = cases.iter().map(|case| engines.iter().map(|e| run(case, e)).collect()).collect();
        Self { cases, engines: engines.to_vec(), outcomes }
    }

    /// True if an engine does not take a case, or is beyond a tolerance and the case does not say so.
    pub fn fail(&self) -> bool {
        self.outcomes.iter().flatten().any(Outcome::fails)
    }

    /// Nothing, if the engine was not asked for.
    fn outcome(&self, case: usize, engine: EngineKind) -> Option<&Outcome> {
        let at = self.engines.iter().position(|e| *e == engine)?;
        self.outcomes[case].get(at)
    }
}

/// What case files can look at, for `--help`.
pub fn help() -> String {
    quantity::help()
}

/// Lists the engines or runs cases. Exit codes: 0; 1 an engine is beyond a tolerance and the case does not say so, it does not take a scene, or a
/// file cannot be written; 2 wrong arguments or cases.
pub fn run(args: &EnginesArgs) -> ExitCode {
    let Some(path) = &args.cases else {
        return super::say(&if args.json { format!("{:#}\n", list::json()) } else { list::table() });
    };
    match measured(args, path) {
        Ok(code) => code,
        Err((code, reason)) => {
            eprintln!("error: {}", reason.trim_end());
            ExitCode::from(code)
        }
    }
}

fn measured(args: &EnginesArgs, path: &Path) -> Result<ExitCode, (u8, String)> {
    let engines = kinds(&args.engine).map_err(|reason| (2, reason))?;
    let cases = cases(path).map_err(|reason| (2, reason))?;
    let mut progress = Progress::new();
    let results = Results::of(cases, &engines, &mut |done, all| progress.show(done, all));
    progress.clear();
    write("--csv", args.csv.as_deref(), || csv::csv(&results))?;
    write("--markdown", args.markdown.as_deref(), || page(&results, path, &machine()))?;
    let text = if args.json { format!("{:#}\n", report::json(&results)) } else { report::tables(&results) };
    let said = super::say(&text);
    Ok(if results.fail() { ExitCode::FAILURE } else { said })
}
