//! The grid for people: tables, a page, CSV.

use super::grid::{Cell, Entry, Grid, Row, Verdict, milliseconds};
use std::fmt::Write;
use std::path::Path;

const HEAD: &str = "# Hard cases

Made by `realnoid hard CASES --markdown FILE`; do not edit. How cases are written: [conformance.md](conformance.md).

Scenes that break simulators, with every integrator of rbx and every other engine of the program, at steps from 10 to 0.1 ms (one step per control interval).
A cell is *error of allowed* for the expectation that is missed by most. **good**: every error is allowed. **told**: not every one, and the engine has
counted what it could not do; the counters stand below the table, `realnoid simulate` prints them and `/diagnostics` shows them. **known**: not every one, as the
case says with the cause. **SILENT**: beyond, and nothing says so; **NOT FINITE**: blown up. `tests/hard.rs` runs rbx over the whole grid, and the last two must not be.
";

/// Everything. `machine` names the one on which it was run.
pub fn page(g: &Grid, cases: &Path, machine: &str) -> String {
    let mut text = HEAD.replace("CASES", &cases.display().to_string());
    let _ = writeln!(
        text,
        "\nTaken on: {machine}\n\n## Summary\n\nSteps of a case that are good, of all; what the others are.\n"
    );
    let names: Vec<&str> = g.entries.first().map_or(vec![], |e| e.rows.iter().map(|r| r.column.name()).collect());
    let _ = writeln!(text, "| case | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len()));
    for e in &g.entries {
        let cells: Vec<String> = e.rows.iter().map(summed).collect();
        let _ = writeln!(text, "| [{0}](#{0}) | {1} |", e.case.name, cells.join(" | "));
    }
    text += "\n## Cases\n";
    g.entries.iter().for_each(|e| text += &of_case(e, &g.steps));
    text
}

/// `6 of 6`, `4 of 6, 2 told`.
fn summed(row: &Row) -> String {
    let count =
        |v: Verdict| row.cells.iter().filter(|c| matches!(c, Cell::Done { verdict, .. } if *verdict == v)).count();
    if row.cells.iter().all(|c| matches!(c, Cell::Not(_))) {
        return "cannot".into();
    }
    let mut text = format!("{} of {}", count(Verdict::Good), row.cells.len());
    for v in [Verdict::Told, Verdict::Known, Verdict::Silent, Verdict::NotFinite] {
        if count(v) > 0 {
            let _ = write!(text, ", {} {}", count(v), v.name());
        }
    }
    text
}

fn of_case(e: &Entry, steps: &[i64]) -> String {
    let mut text = format!("\n### {}\n\n{}\n\n", e.case.name, e.case.shows);
    let _ = write!(text, "| |");
    steps.iter().for_each(|s| text += &format!(" {} ms |", milliseconds(*s)));
    let _ = writeln!(text, "\n|---|{}", "---|".repeat(steps.len()));
    for row in &e.rows {
        let _ = write!(text, "| {} |", row.column.name());
        row.cells.iter().for_each(|c| text += &format!(" {} |", shown(c)));
        text += "\n";
    }
    text += "\n";
    for x in &e.case.expectations {
        let _ = writeln!(text, "- {} = `{}`: {}. Allowed: {}", x.name, x.formula(), x.theory, x.because);
        for (name, known) in &x.beyond {
            let _ = writeln!(text, "  - **{name}** is beyond: {}", known.because);
        }
    }
    text + &counters(e, steps)
}

fn shown(cell: &Cell) -> String {
    let Cell::Done { verdict, worst: (_, error, allowed), .. } = cell else { return "-".into() };
    let figures = format!("{error:.1e} of {allowed:.1e}");
    if *verdict == Verdict::Good { figures } else { format!("**{}**: {figures}", verdict.name()) }
}

/// Of runs that are not good.
fn counters(e: &Entry, steps: &[i64]) -> String {
    let mut text = String::new();
    for row in &e.rows {
        if let Some(Cell::Not(why)) = row.cells.first() {
            let _ = writeln!(text, "- {} {why}", row.column.name());
        }
        for (cell, step) in row.cells.iter().zip(steps) {
            let Cell::Done { verdict, worst: (which, ..), told, .. } = cell else { continue };
            if *verdict != Verdict::Good {
                let counted: Vec<String> = told.iter().map(|(name, n)| format!("{name} {n}")).collect();
                let counted = if counted.is_empty() { "nothing counted".into() } else { counted.join(", ") };
                let (name, ms) = (&e.case.expectations[*which].name, milliseconds(*step));
                let _ = writeln!(text, "- {} at {ms} ms, {name}: {counted}", row.column.name());
            }
        }
    }
    if text.is_empty() { text } else { format!("\n{text}") }
}

/// For a terminal.
pub fn tables(g: &Grid) -> String {
    let mut text = String::new();
    for e in &g.entries {
        let _ = writeln!(text, "{}: {}", e.case.name, e.case.shows);
        let _ = write!(text, "  {:<22}", "ms");
        g.steps.iter().for_each(|s| text += &format!(" {:>22}", milliseconds(*s)));
        text += "\n";
        for row in &e.rows {
            let _ = write!(text, "  {:<22}", row.column.name());
            row.cells.iter().for_each(|c| text += &format!(" {:>22}", plain(c)));
            text += "\n";
        }
        e.wrong(&g.steps).iter().for_each(|line| text += &format!("  {line}\n"));
    }
    text
}

fn plain(cell: &Cell) -> String {
    let Cell::Done { verdict, worst: (_, error, allowed), .. } = cell else { return "-".into() };
    let mark = if *verdict == Verdict::Good { "" } else { verdict.name() };
    format!("{mark} {error:.1e}/{allowed:.1e}")
}

/// A row per case, engine, integrator and step.
pub fn csv(g: &Grid) -> String {
    let mut text = "case,engine,integrator,step,verdict,quantity,error,allowed,cpu_per_second,counted\n".to_owned();
    for e in &g.entries {
        for row in &e.rows {
            for (cell, step) in row.cells.iter().zip(&g.steps) {
                let Cell::Done { verdict, worst: (which, error, allowed), told, cpu } = cell else { continue };
                let (column, name) = (row.column, &e.case.expectations[*which].name);
                let counted: Vec<String> = told.iter().map(|(name, n)| format!("{name} {n}")).collect();
                let _ = writeln!(
                    text,
                    "{},{},{},{},{},\"{name}\",{error},{allowed},{cpu},\"{}\"",
                    e.case.name,
                    column.engine.name(),
                    column.integrator.name(),
                    *step as f64 * 1e-9,
                    verdict.name(),
                    counted.join("; ")
                );
            }
        }
    }
    text
}
