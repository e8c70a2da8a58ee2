//! Cases over engines, integrators and steps.

use crate::cli::conformance::{Case, Outcome, Run, Rung};
use crate::world::{EngineKind, Integrator, Stats};
use std::path::{Path, PathBuf};

/// Steps of the suite, ns.
pub const STEPS: [i64; 6] = [10_000_000, 5_000_000, 2_000_000, 1_000_000, 500_000, 100_000];

/// Of a step in ns. Divided: a product with 1e-6 would write 0.1 as 0.09999999999999999.
pub(super) fn milliseconds(step: i64) -> f64 {
    step as f64 / 1e6
}

/// What a case is run with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Engine.
    pub engine: EngineKind,
    /// Of rbx; others have their own.
    pub integrator: Integrator,
}

impl Column {
    /// In tables.
    pub fn name(self) -> &'static str {
        if self.engine == EngineKind::Rbx { self.integrator.name() } else { self.engine.name() }
    }
}

/// What became of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every error is allowed.
    Good,
    /// Not every one, and the engine has counted what it could not do.
    Told,
    /// Not every one, as the case says of this engine or integrator.
    Known,
    /// Not every one, and nobody says so.
    Silent,
    /// A value is not finite.
    NotFinite,
}

impl Verdict {
    /// In tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Told => "told",
            Self::Known => "known",
            Self::Silent => "SILENT",
            Self::NotFinite => "NOT FINITE",
        }
    }

    /// Must not be.
    pub fn fails(self) -> bool {
        matches!(self, Self::Silent | Self::NotFinite)
    }
}

/// A case with one engine, integrator and step.
#[derive(Clone, Debug)]
pub enum Cell {
    /// It ran.
    Done {
        /// What became of it.
        verdict: Verdict,
        /// The expectation that is missed by most: its place in the case, its error and what is allowed.
        worst: (usize, f64, f64),
        /// What the engine counted, by name.
        told: Vec<(&'static str, f64)>,
        /// CPU time per simulated second, s.
        cpu: f64,
    },
    /// It did not, and why.
    Not(String),
}

/// A case with one engine and integrator over all steps.
#[derive(Clone, Debug)]
pub struct Row {
    /// Engine and integrator.
    pub column: Column,
    /// One per step.
    pub cells: Vec<Cell>,
}

/// A case over everything.
pub struct Entry {
    /// With the first step and integrator: names and words are the same for all.
    pub case: Case,
    /// One per engine and integrator.
    pub rows: Vec<Row>,
}

/// All cases.
pub struct Grid {
    /// In the order of their names.
    pub entries: Vec<Entry>,
    /// ns.
    pub steps: Vec<i64>,
}

impl Grid {
    /// Runs every case of these files; `seen` is told after each run how many there have been, and how many there are.
    ///
    /// # Errors
    /// A case that cannot be read, or has times that are no multiples of a step: the file, and what is wrong.
    pub fn of(
        files: &[PathBuf],
        columns: &[Column],
        steps: &[i64],
        seen: &mut dyn FnMut(u64, u64),
    ) -> Result<Self, String> {
        let all = (files.len() * columns.len() * steps.len()) as u64;
        let mut done = 0;
        let mut entries = vec![];
        for file in files {
            let (mut rows, mut first) = (vec![], None);
            for column in columns {
                let mut cells = vec![];
                for step in steps {
                    let case = read(file, *column, *step)?;
                    cells.push(cell(&case, *column));
                    first.get_or_insert(case);
                    done += 1;
                    seen(done, all);
                }
                rows.push(Row { column: *column, cells });
            }
            entries.extend(first.map(|case| Entry { case, rows }));
        }
        Ok(Self { entries, steps: steps.to_vec() })
    }

    /// True if something is beyond in silence or not finite, or an engine does not take a scene.
    pub fn fails(&self) -> bool {
        self.entries.iter().any(|e| !e.wrong(&self.steps).is_empty())
    }
}

impl Entry {
    /// What must not be, a line each.
    pub fn wrong(&self, steps: &[i64]) -> Vec<String> {
        let mut wrong = vec![];
        for row in &self.rows {
            for (cell, step) in row.cells.iter().zip(steps) {
                let Cell::Done { verdict, worst: (which, error, allowed), .. } = cell else { continue };
                if verdict.fails() {
                    let (case, name) = (&self.case.name, &self.case.expectations[*which].name);
                    wrong.push(format!(
                        "{case} with {} at {} ms: {}: {name}: {error:.2e} of {allowed:.2e}",
                        row.column.name(),
                        milliseconds(*step),
                        verdict.name()
                    ));
                }
            }
        }
        wrong
    }
}

fn read(file: &Path, column: Column, step_ns: i64) -> Result<Case, String> {
    Case::read_at(file, Some(Rung { integrator: column.integrator, step_ns }))
}

fn cell(case: &Case, column: Column) -> Cell {
    match case.run(column.engine) {
        Outcome::Done(run) => judged(&run, column),
        Outcome::Skipped(lacks) => Cell::Not(format!("has no {}", lacks.join(", "))),
        Outcome::NotBuilt(how) => Cell::Not(how),
        Outcome::Refused(reason) => Cell::Not(reason),
    }
}

fn judged(run: &Run, column: Column) -> Cell {
    use crate::cli::conformance::Verdict as Figured;
    let shares = run.figures.iter().map(|f| if f.error.is_nan() { f64::INFINITY } else { f.share() }).enumerate();
    let which = shares.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i);
    let told = told(&run.stats);
    let any = |v: Figured| run.figures.iter().any(|f| f.verdict == v);
    let verdict = match () {
        () if run.figures.iter().any(|f| !f.error.is_finite()) => Verdict::NotFinite,
        () if any(Figured::Beyond) && told.iter().any(|(name, _)| excuses(name, column)) => Verdict::Told,
        () if any(Figured::Beyond) => Verdict::Silent,
        () if any(Figured::Known) => Verdict::Known,
        () => Verdict::Good,
    };
    let worst = run.figures.get(which).map_or((0, 0.0, 0.0), |f| (which, f.error, f.allowed));
    Cell::Done { verdict, worst, told, cpu: run.cpu }
}

/// What a user is told of a run by its counters (`simulate`, `/diagnostics`), those that are not 0.
fn told(s: &Stats) -> Vec<(&'static str, f64)> {
    let all = [
        ("fallback_steps", s.fallback_steps as f64),
        ("unsettled_steps", s.unsettled_steps as f64),
        ("halvings", s.halvings as f64),
        ("divided_steps", s.divided_steps as f64),
        ("fast_pieces", s.fast_pieces as f64),
        ("guarded_pieces", s.guarded_pieces as f64),
        ("guarded_energy", s.guarded_energy),
        ("trimmed_energy", s.trimmed_energy),
        ("tempered_steps", s.tempered_steps as f64),
        ("pole_steps", s.pole_steps as f64),
        ("diverged_steps", s.diverged_steps as f64),
    ];
    all.into_iter().filter(|(_, n)| *n > 0.0).collect()
}

/// Does this say that the result is not what it should be? Work that was only done in another way does not, and neither does a world of rbx
/// that stands still because it diverged: that must not be.
fn excuses(name: &str, column: Column) -> bool {
    match name {
        "unsettled_steps" | "fast_pieces" | "guarded_pieces" | "guarded_energy" | "trimmed_energy"
        | "tempered_steps" | "pole_steps" => true,
        "diverged_steps" => column.engine != EngineKind::Rbx,
        _ => false,
    }
}
