//! Tables, CSV and JSON.

use super::fit::Fit;
use super::measure::{Curve, Measured, Run};
use super::rung::Ladder;
use serde_json::{Value, json};
use std::fmt::Write;

/// Columns of the CSV, a row per run.
pub const COLUMNS: [&str; 23] = [
    "case",
    "engine",
    "integrator",
    "ladder",
    "dt",
    "accuracy",
    "control_interval",
    "steps_per_interval",
    "iterations",
    "unit",
    "rms",
    "max",
    "half_way",
    "at_end",
    "cpu_per_second",
    "diverged",
    "steps",
    "fallback_steps",
    "halvings",
    "unsettled_steps",
    "guarded_pieces",
    "worst_penetration",
    "warnings",
];

/// One row per run, after a row with the [`COLUMNS`].
///
/// # Errors
/// What the writer says.
pub fn csv(all: &[Measured]) -> Result<String, csv::Error> {
    let mut out = csv::Writer::from_writer(vec![]);
    out.write_record(COLUMNS)?;
    for m in all {
        for curve in &m.curves {
            for r in &curve.runs {
                out.write_record(row(m, curve, r))?;
            }
        }
    }
    let bytes = out.into_inner().map_err(|e| e.into_error())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn row(m: &Measured, c: &Curve, r: &Run) -> [String; COLUMNS.len()] {
    let (s, p) = (&r.stats, &r.point);
    // What another program does not count.
    let own = |x: String| if c.peer { String::new() } else { x };
    [
        m.case.name.into(),
        c.engine.clone(),
        c.integrator.clone(),
        c.ladder.name().into(),
        round(p.step()).to_string(),
        if c.ladder == Ladder::Accuracy { p.accuracy.to_string() } else { String::new() },
        (p.interval_ns as f64 * 1e-9).to_string(),
        p.steps.to_string(),
        own(p.iterations.to_string()),
        m.case.unit.into(),
        digits(r.rms),
        digits(r.max),
        digits(r.at[0]),
        digits(r.at[1]),
        digits(r.cpu),
        r.diverged.to_string(),
        own(s.steps.to_string()),
        own(s.fallback_steps.to_string()),
        own(s.halvings.to_string()),
        own(s.unsettled_steps.to_string()),
        own(s.guarded_pieces.to_string()),
        own(digits(s.worst_penetration)),
        own(r.warnings.to_string()),
    ]
}

/// More than a measurement has.
fn digits(x: f64) -> String {
    format!("{x:.5e}")
}

/// Everything, SI units.
pub fn json(all: &[Measured]) -> Value {
    let cases = all.iter().map(|m| {
        let curves: Vec<Value> = m.curves.iter().map(|c| curve(m, c)).collect();
        json!({
            "case": m.case.name,
            "shows": m.case.shows,
            "compared": m.case.compared,
            "unit": m.case.unit,
            "size": m.case.size,
            "seconds": m.case.duration(),
            "reference": m.reference.words,
            "reference_error": m.reference.own,
            "left_out": m.left_out,
            "curves": curves,
        })
    });
    cases.collect()
}

fn curve(m: &Measured, c: &Curve) -> Value {
    let fit = c.fit(m.case.size, m.reference.own);
    let runs: Vec<Value> = c.runs.iter().map(|r| run(c, r)).collect();
    json!({
        "engine": c.engine,
        "integrator": c.integrator,
        "ladder": c.ladder.name(),
        "order": fit.map(|f| json!({"order": f.order, "coarsest": f.steps[0], "finest": f.steps[1], "points": f.points})),
        "diverges_from": c.diverges(),
        "runs": runs,
    })
}

fn run(c: &Curve, r: &Run) -> Value {
    let s = &r.stats;
    let mut out = json!({
        "dt": r.point.step(),
        "accuracy": (c.ladder == Ladder::Accuracy).then_some(r.point.accuracy),
        "iterations": (!c.peer).then_some(r.point.iterations),
        "rms": r.rms,
        "max": r.max,
        "half_way": r.at[0],
        "at_end": r.at[1],
        "cpu_per_second": r.cpu,
        "diverged": r.diverged,
    });
    if !c.peer {
        out["steps"] = s.steps.into();
        out["fallback_steps"] = s.fallback_steps.into();
        out["halvings"] = s.halvings.into();
        out["unsettled_steps"] = s.unsettled_steps.into();
        out["guarded_pieces"] = s.guarded_pieces.into();
        out["worst_penetration"] = s.worst_penetration.into();
        out["warnings"] = r.warnings.into();
    }
    out
}

/// For people.
pub fn tables(all: &[Measured]) -> String {
    all.iter().map(table).collect::<Vec<_>>().join("\n")
}

fn table(m: &Measured) -> String {
    let (case, times) = (&m.case, m.case.times());
    let mut text = format!("{}: {}\n", case.name, case.shows);
    let _ = writeln!(text, "error: {}, {}; {} s", case.compared, case.unit, case.duration());
    let own = if m.reference.own > 0.0 { format!("; errs by {:.1e}", m.reference.own) } else { String::new() };
    let _ = writeln!(text, "reference: {}{own}", m.reference.words);
    let half = format!("at {} s", round(times[times.len().div_ceil(2) - 1]));
    let end = format!("at {} s", round(times[times.len() - 1]));
    let _ = writeln!(
        text,
        "{:<34}{:>10}{:>10}{:>10}{:>10}{:>10}{:>12}  notes",
        "", "", "RMS", "greatest", half, end, "CPU s / s"
    );
    for c in &m.curves {
        let head = if c.ladder == Ladder::Iterations { format!("{}, iterations", c.label) } else { c.label.clone() };
        for (i, r) in c.runs.iter().enumerate() {
            let _ = writeln!(
                text,
                "{:<34}{:>10}{:>10}{:>10}{:>10}{:>10}{:>12.3e}  {}",
                if i == 0 { &head } else { "" },
                at(c, r),
                figure(r.rms),
                figure(r.max),
                figure(r.at[0]),
                figure(r.at[1]),
                r.cpu,
                notes(r)
            );
        }
        let told = [c.fit(case.size, m.reference.own).map(|f| order(&f)), c.diverges().map(diverging)];
        let told: Vec<String> = told.into_iter().flatten().collect();
        if !told.is_empty() {
            let _ = writeln!(text, "{:<34}{}", "", told.join("; "));
        }
    }
    text.extend(m.left_out.iter().map(|reason| format!("left out: {reason}\n")));
    text
}

/// The place of a point on its ladder.
pub(super) fn at(c: &Curve, r: &Run) -> String {
    match c.ladder {
        Ladder::Steps => milliseconds(r.point.step()),
        Ladder::Accuracy => format!("{:e}", r.point.accuracy),
        Ladder::Iterations => r.point.iterations.to_string(),
    }
}

/// The same in a sentence, after the name of the rung.
pub(super) fn setting(c: &Curve, r: &Run) -> String {
    match c.ladder {
        Ladder::Accuracy => format!("with accuracy {}", at(c, r)),
        _ => format!("at {}", at(c, r)),
    }
}

/// `0.125 ms`.
pub(super) fn milliseconds(step: f64) -> String {
    format!("{} ms", round(1e3 * step))
}

pub(super) fn order(f: &Fit) -> String {
    format!(
        "order {:.2} from {} to {}, {} points",
        f.order,
        milliseconds(f.steps[0]),
        milliseconds(f.steps[1]),
        f.points
    )
}

fn diverging(step: f64) -> String {
    format!("diverges at {} and above", milliseconds(step))
}

/// Without what rounding adds.
pub(super) fn round(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}

pub(super) fn figure(x: f64) -> String {
    if x == 0.0 {
        "0".into()
    } else if x.is_finite() {
        format!("{x:.1e}")
    } else {
        "-".into()
    }
}

fn notes(r: &Run) -> String {
    let s = &r.stats;
    let counted = [
        (s.fallback_steps, "fell back"),
        (s.halvings, "halvings"),
        (s.unsettled_steps, "unsettled"),
        (s.guarded_pieces, "guarded"),
    ];
    let mut notes: Vec<String> = if r.diverged { vec!["diverged".into()] } else { vec![] };
    notes.extend(counted.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} of {} {what}", s.steps)));
    if s.worst_penetration > 0.0 {
        notes.push(format!("penetration {:.1e} m", s.worst_penetration));
    }
    notes.join(", ")
}
