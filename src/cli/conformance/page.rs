//! The figures as a page of documentation.

use super::csv::shown;
use super::list::abilities;
use super::measure::Verdict;
use super::{Case, Outcome, Results};
use crate::engine::EngineKind;
use std::fmt::Write;
use std::path::Path;

const HEAD: &str = "# Engines against theory

Made by `realnoid engines --cases CASES --markdown FILE`; do not edit. How cases are written: [conformance.md](conformance.md).

What every engine makes of scenes whose outcome is known. A cell is *error of allowed*: how far the engine is from theory, and how far it may be; both
in the unit of the quantity. Where there are several instants, it is the one with the greatest share. What is allowed was fixed
before the cases were run: from theory, or, of soft contacts and rows that are iterated, from what was seen when the engines were chosen; the reason stands below each table. An engine that
misses it is in **bold**, with its cause: the tolerance stays.
The words of a case are its reference: `g` is gravity, `t` the time, `h` the step, `n` solver_iterations (substeps of rapier), `single` 2⁻²⁴.
";

/// Everything. `machine` names the one on which CPU times were taken.
pub fn page(r: &Results, cases: &Path, machine: &str) -> String {
    let mut text = HEAD.replace("CASES", &cases.display().to_string());
    text += "\n## What the engines can\n\n| capability |";
    let kinds = EngineKind::NAMES.map(|(_, kind)| kind);
    kinds.iter().for_each(|k| text += &format!(" {} |", k.name()));
    text += &format!(" |\n|---|{}---|\n", "---|".repeat(kinds.len()));
    let all = kinds.map(|kind| abilities(&kind.capabilities()));
    for (i, ability) in all[0].iter().enumerate() {
        let _ = write!(text, "| `{}` |", ability.name);
        all.iter().for_each(|engine| text += if engine[i].can { " yes |" } else { " - |" });
        let _ = writeln!(text, " {} |", ability.means.replace('<', "&lt;"));
    }
    text += "\n## CPU time\n\nSeconds per simulated second.\n";
    let _ = writeln!(text, "Taken on: {machine}\n");
    text += &header("| case |");
    for (i, case) in r.cases.iter().enumerate() {
        let _ = write!(text, "| [{0}](#{0}) |", case.name);
        kinds.iter().for_each(|k| text += &format!(" {} |", cpu(r, i, *k)));
        text += "\n";
    }
    text += "\n## Cases\n";
    (0..r.cases.len()).for_each(|i| text += &of_case(r, i));
    text
}

fn header(first: &str) -> String {
    let names = EngineKind::NAMES.map(|(name, _)| name);
    let columns = first.matches('|').count() - 1 + names.len();
    format!("{first} {} |\n|{}\n", names.join(" | "), "---|".repeat(columns))
}

fn cpu(r: &Results, i: usize, kind: EngineKind) -> String {
    match r.outcome(i, kind) {
        Some(Outcome::Done(run)) => format!("{:.4}", run.cpu),
        other => without(other, kind).into(),
    }
}

/// Why there are no figures.
fn without(o: Option<&Outcome>, kind: EngineKind) -> &'static str {
    match o {
        Some(Outcome::Skipped(_)) => "skipped",
        Some(Outcome::Refused(_)) => "refused",
        _ if kind.available().is_err() => "not built",
        _ => "not asked",
    }
}

fn of_case(r: &Results, i: usize) -> String {
    let case = &r.cases[i];
    let s = &case.settings;
    let mut text = format!("\n### {}\n\n{}\n", case.name, case.shows);
    let _ = write!(
        text,
        "{} s, control interval {} s, {} steps in each, solver_iterations {}, rbx with {}",
        case.duration(),
        s.control_interval_ns as f64 * 1e-9,
        s.steps_per_interval,
        s.solver_iterations,
        s.integrator.name()
    );
    let needs: Vec<String> = case.needs.iter().map(|n| format!("`{n}`")).collect();
    text += &if needs.is_empty() { ".\n\n".into() } else { format!("; needs {}.\n\n", needs.join(", ")) };
    if !case.constants.is_empty() {
        let _ = writeln!(text, "With `{}`.\n", case.constants.join("`, `"));
    }
    text += &header("| quantity | theory |");
    for (n, e) in case.expectations.iter().enumerate() {
        let unit = if e.unit() == "1" { String::new() } else { format!(" {}", e.unit()) };
        let _ = write!(text, "| {} | `{}`{unit} |", e.name, e.formula());
        EngineKind::NAMES.iter().for_each(|(_, k)| text += &format!(" {} |", cell(r, (i, n), *k)));
        text += "\n";
    }
    text += "\n";
    for e in &case.expectations {
        let _ = writeln!(text, "- {}: {}. Allowed: {}", e.name, e.theory, e.because);
        for (engine, known) in &e.beyond {
            let _ = writeln!(text, "  - **{engine}** is beyond, {}: {}", shown(known.error), known.because);
        }
    }
    text
}

fn cell(r: &Results, (i, n): (usize, usize), kind: EngineKind) -> String {
    let o = r.outcome(i, kind);
    let Some(Outcome::Done(run)) = o else { return without(o, kind).into() };
    let f = &run.figures[n];
    match f.verdict {
        Verdict::Within | Verdict::Mended => f.shown(),
        Verdict::Known | Verdict::Beyond => format!("**{}** of {}", shown(f.error), shown(f.allowed)),
    }
}

/// The processor of this machine, and how many of it there are.
pub fn machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|l| l.strip_prefix("model name")?.split_once(':')).map(|(_, name)| name.trim());
    let count = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    format!("{}, {count} cores, {}", name.unwrap_or("unknown processor"), std::env::consts::ARCH)
}

impl Case {
    /// Simulated time, s.
    fn duration(&self) -> f64 {
        self.intervals as f64 * self.settings.control_interval_ns as f64 * 1e-9 * self.settings.time_scale
    }
}
