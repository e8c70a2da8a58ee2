//! The figures for people at a terminal, and for programs.

use super::csv::shown;
use super::measure::Verdict;
use super::{Case, Outcome, Results, Run};
use crate::engine::EngineKind;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// A table for each case.
pub(super) fn tables(r: &Results) -> String {
    let mut text = String::new();
    for (i, case) in r.cases.iter().enumerate() {
        let _ = writeln!(text, "{}: {}", case.name, case.shows);
        let _ = write!(text, "  {:<48}", "error of allowed");
        r.engines.iter().for_each(|e| text += &format!(" {:>21}", e.name()));
        text += "\n";
        for (n, e) in case.expectations.iter().enumerate() {
            let _ = write!(text, "  {:<48}", e.name);
            r.outcomes[i].iter().for_each(|o| text += &format!(" {:>21}", cell(o, n)));
            let _ = writeln!(text, "\n    = {} {}: {}", e.formula(), e.unit(), e.theory);
        }
        let _ = write!(text, "  {:<48}", "CPU, s per simulated s");
        r.outcomes[i].iter().for_each(|o| text += &format!(" {:>21}", cpu(o)));
        text += "\n";
        r.engines.iter().zip(&r.outcomes[i]).for_each(|(e, o)| text += &notes(case, *e, o));
        text += "\n";
    }
    text + &summary(r)
}

fn cell(o: &Outcome, n: usize) -> String {
    match o {
        Outcome::Skipped(_) => "skipped".into(),
        Outcome::NotBuilt(_) => "not built".into(),
        Outcome::Refused(_) => "refused".into(),
        Outcome::Done(run) => run.figures[n].shown(),
    }
}

fn cpu(o: &Outcome) -> String {
    if let Outcome::Done(run) = o { format!("{:.4}", run.cpu) } else { "-".into() }
}

/// What a table does not say.
fn notes(case: &Case, engine: EngineKind, o: &Outcome) -> String {
    let name = engine.name();
    match o {
        Outcome::Skipped(lacks) => format!("  {name} is skipped: it has no {}\n", lacks.join(", ")),
        Outcome::NotBuilt(how) => format!("  {name}: {how}\n"),
        Outcome::Refused(reason) => format!("  {name} does not take the scene: {reason}\n"),
        Outcome::Done(run) => of_run(case, name, run),
    }
}

fn of_run(case: &Case, name: &str, run: &Run) -> String {
    let mut text = String::new();
    for (e, f) in case.expectations.iter().zip(&run.figures) {
        let known = e.beyond.get(name);
        let (because, error) = known.map_or(("", 0.0), |known| (known.because.as_str(), known.error));
        let _ = match f.verdict {
            Verdict::Within => Ok(()),
            Verdict::Known => {
                writeln!(text, "  {name} is beyond, as the case says ({}): {because}: {}", e.name, shown(error))
            }
            Verdict::Mended => writeln!(text, "  {name} is no longer beyond ({}): take it out of the case", e.name),
            Verdict::Beyond => {
                let said = known.map_or(String::new(), |k| format!(" (the case says {})", shown(k.error)));
                writeln!(text, "  {name} is BEYOND ITS TOLERANCE: {}: {}{said}", e.name, f.shown())
            }
        };
    }
    text
}

/// How many of each kind there are.
fn summary(r: &Results) -> String {
    let mut text = String::new();
    for (i, engine) in r.engines.iter().enumerate() {
        let mine = || r.outcomes.iter().map(|o| &o[i]);
        let count = |verdict: Verdict| {
            let of = |o: &Outcome| match o {
                Outcome::Done(run) => run.figures.iter().filter(|f| f.verdict == verdict).count(),
                _ => 0,
            };
            mine().map(of).sum::<usize>()
        };
        let skipped = mine().filter(|o| matches!(o, Outcome::Skipped(_))).count();
        let refused = mine().filter(|o| matches!(o, Outcome::Refused(_))).count();
        let (within, known) = (count(Verdict::Within) + count(Verdict::Mended), count(Verdict::Known));
        let _ = writeln!(
            text,
            "{:<8} {within} within, {known} beyond as the cases say, {} beyond; of {} cases {skipped} skipped, {refused} refused",
            engine.name(),
            count(Verdict::Beyond),
            r.cases.len()
        );
    }
    text
}

/// Everything, SI units.
pub(super) fn json(r: &Results) -> Value {
    let case = |(case, outcomes): (&Case, &Vec<Outcome>)| {
        let engines: Map<String, Value> =
            r.engines.iter().zip(outcomes).map(|(e, o)| (e.name().into(), outcome(case, o))).collect();
        json!({"name": case.name, "shows": case.shows, "needs": case.needs, "engines": engines})
    };
    json!({"cases": r.cases.iter().zip(&r.outcomes).map(case).collect::<Vec<_>>(), "passed": !r.fail()})
}

fn outcome(case: &Case, o: &Outcome) -> Value {
    let run = match o {
        Outcome::Skipped(lacks) => return json!({"skipped": lacks}),
        Outcome::NotBuilt(how) => return json!({"to_have_it": how}),
        Outcome::Refused(reason) => return json!({"refused": reason}),
        Outcome::Done(run) => run,
    };
    let figures = case.expectations.iter().zip(&run.figures).map(|(e, f)| {
        let number = |v: &crate::math::Vec3| if e.size() == 1 { json!(v.x) } else { json!(v.as_slice()) };
        json!({"quantity": e.name, "unit": e.unit(), "time": f.at, "theory": number(&f.should), "value": number(&f.value),
               "error": f.error, "allowed": f.allowed, "verdict": f.verdict.name()})
    });
    json!({"cpu_per_second": run.cpu, "quantities": figures.collect::<Vec<_>>()})
}
