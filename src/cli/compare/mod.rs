//! `realnoid compare`: the engines side by side on one scene.

mod contender;
mod difference;
mod json;
mod plot;
mod rows;
mod table;

use super::args::CompareArgs;
use super::outcome::{Progress, counted};
use super::scene::engine;
use super::simulate::{Start, catch_signals, stopped};
use crate::engine::{Shortfall, shortfalls, unused_integrator};
use crate::model::Model;
use crate::world::{EngineKind, Settings, World};
use contender::{Contender, floating_bodies};
use difference::{Worst, moving_links};
use rows::{Row, Rows};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// How much shorter the steps of the reference are. A run with half of that shows how much of a difference is the reference's own.
const FINER: u32 = 64;
/// Names of these two runs.
const REFERENCE: [&str; 2] = ["reference", "reference/2"];

/// Runs; prints tables or JSON to standard output. Exit codes: 0 all finite; 1 not finite, stopped by a signal, robot not loaded, a named engine that cannot
/// take the scene, output not written; 2 wrong arguments or scene.
pub fn run(args: &CompareArgs) -> ExitCode {
    match Contest::new(args).and_then(|mut contest| contest.run(args).map_err(|reason| (1, reason))) {
        Ok(code) => code,
        Err((code, reason)) => {
            eprintln!("error: {}", reason.trim_end());
            ExitCode::from(code)
        }
    }
}

/// All runs, and what is the same for them.
struct Contest {
    /// As it was at the start.
    model: Arc<Model>,
    settings: Settings,
    reference: Contender,
    /// The half as fine one, then the engines.
    others: Vec<Contender>,
    links: Vec<usize>,
    /// Something floats freely.
    floats: bool,
    within: f64,
    /// Control intervals to make, and between two rows.
    intervals: (u64, u64),
    stopped: bool,
    warnings: Vec<String>,
    rows: Rows,
}

impl Contest {
    /// `Err`: exit code and reason.
    fn new(args: &CompareArgs) -> Result<Self, (u8, String)> {
        let usage = |reason| (2, reason);
        if !(args.within.is_finite() && args.within > 0.0) {
            return Err(usage(format!("--within {}: must be a finite number above 0, rad or m", args.within)));
        }
        let kinds = kinds(&args.engine).map_err(usage)?;
        // What an engine does not honour is told of each, later; rbx honours it all.
        let Start { world, script, intervals, every, mut warnings, .. } =
            Start::new(&args.run, Some(EngineKind::Rbx.name()), args.every)?;
        let model = world.model().clone();
        let fine = |name, finer| Contender::fine(name, &world, &script, finer).map_err(usage);
        let (reference, half) = (fine(REFERENCE[0], FINER)?, fine(REFERENCE[1], FINER / 2)?);
        let settings = *world.settings();
        let contender =
            |kind: EngineKind| Contender::new(kind.name(), &world, &script, Settings { engine: kind, ..settings });
        let mut others = vec![half];
        for kind in kinds {
            if args.engine.is_empty() && !kind.capabilities().joints && !model.axes.is_empty() {
                let name = kind.name();
                warnings.push(format!("left out: {name}, which has no joints; --engine {name} shows its free bodies"));
                continue;
            }
            match contender(kind) {
                Ok(run) => others.push(run),
                Err(reason) if args.engine.is_empty() => warnings.push(format!("left out: {reason}")),
                Err(reason) => return Err((1, reason)),
            }
        }
        let names = std::iter::once(&reference).chain(&others).map(|c| c.name.clone()).collect();
        let (links, floats) = (moving_links(&model), !floating_bodies(&model).is_empty());
        let rows = Rows { names, ..Rows::default() };
        let (within, intervals, stopped) = (args.within, (intervals, every), false);
        Ok(Self { model, settings, reference, others, links, floats, within, intervals, stopped, warnings, rows })
    }

    fn run(&mut self, args: &CompareArgs) -> Result<ExitCode, String> {
        let csv = args.csv.as_deref().map(|path| create("--csv", path)).transpose()?;
        // Before the run: a file that cannot be written is known at once.
        args.svg.as_deref().map(|path| create("--svg", path)).transpose()?;
        catch_signals();
        let mut progress = Progress::new();
        self.advance(&mut progress);
        progress.clear();
        if let (Some(file), Some(path)) = (csv, &args.csv) {
            self.rows.write(&mut BufWriter::new(file)).map_err(|e| unwritten("--csv", path, &e))?;
        }
        if let Some(path) = &args.svg {
            let picture = plot::picture(self).map_err(|reason| format!("--svg: {reason}"))?;
            std::fs::write(path, picture).map_err(|e| unwritten("--svg", path, &e))?;
        }
        let text = if args.json { format!("{:#}\n", json::summary(self)) } else { table::tables(self) };
        let said = super::say(&text);
        let complete = !self.stopped && self.all().all(|c| c.finite);
        Ok(if complete { said } else { ExitCode::FAILURE })
    }

    fn advance(&mut self, progress: &mut Progress) {
        for interval in 0..=self.intervals.0 {
            self.stopped = interval < self.intervals.0 && stopped();
            let last = interval == self.intervals.0 || self.stopped;
            self.look(last || interval % self.intervals.1 == 0);
            if last {
                break;
            }
            progress.show(interval, self.intervals.0);
            std::iter::once(&mut self.reference).chain(&mut self.others).for_each(|c| c.advance(interval));
        }
    }

    /// Takes the differences, and keeps them if a row is due.
    fn look(&mut self, row: bool) {
        let mut rows = vec![Row::of(&self.reference, &[Worst::default(); 3])];
        for c in &mut self.others {
            let differences = c.measure(&self.reference, &self.links, self.within);
            rows.push(Row::of(c, &differences));
        }
        if row {
            self.rows.times.push(self.reference.world.time());
            self.rows.rows.push(rows);
        }
    }

    /// The reference first.
    fn all(&self) -> impl Iterator<Item = &Contender> {
        std::iter::once(&self.reference).chain(&self.others)
    }

    /// The engines in question.
    fn engines(&self) -> &[Contender] {
        &self.others[1..]
    }

    /// Simulated time, s.
    fn time(&self) -> f64 {
        self.reference.world.time()
    }

    /// CPU time per simulated second; nothing, if no time has passed.
    fn cpu(&self, c: &Contender) -> Option<f64> {
        (self.time() > 0.0).then(|| c.cpu / self.time())
    }

    /// What of the scene an engine does not honour.
    fn shortfalls(&self, c: &Contender) -> Vec<Shortfall> {
        let mut found = shortfalls(c.engine, &self.model);
        found.extend(unused_integrator(c.engine, self.settings.integrator));
        found
    }
}

/// What is worth telling of a run besides figures.
fn notes(world: &World) -> Vec<String> {
    let broken = world.broken().iter().map(|b| format!("joint '{}' {b}, more than its break_threshold", b.joint));
    let counts = counted(&world.stats()).into_iter().filter(|(n, _)| *n > 0).map(|(n, text)| format!("{n} {text}"));
    broken.chain(counts).collect()
}

/// The engines by name, each once; all of this program, if none is named.
pub(super) fn kinds(names: &[String]) -> Result<Vec<EngineKind>, String> {
    if names.is_empty() {
        return Ok(EngineKind::built().collect());
    }
    let mut kinds = vec![];
    for name in names {
        let kind = engine(name).map_err(|reason| format!("--engine: {reason}"))?;
        kind.available().map_err(|reason| format!("--engine {name}: {reason}"))?;
        if kinds.contains(&kind) {
            return Err(format!("--engine {name} is given twice; leave one of them out"));
        }
        kinds.push(kind);
    }
    Ok(kinds)
}

fn create(flag: &str, path: &Path) -> Result<File, String> {
    File::create(path).map_err(|e| unwritten(flag, path, &e))
}

/// Writes a file, if one was asked for.
///
/// # Errors
/// Exit code, flag, file and cause.
pub(super) fn write(flag: &str, file: Option<&Path>, text: impl FnOnce() -> String) -> Result<(), (u8, String)> {
    let Some(file) = file else { return Ok(()) };
    std::fs::write(file, text()).map_err(|e| (1, unwritten(flag, file, &e)))
}

/// Why there is no file.
pub(super) fn unwritten(flag: &str, path: &Path, cause: &std::io::Error) -> String {
    format!("{flag} {}: cannot write the file: {cause}", path.display())
}
