//! The figures as CSV.

use super::{Expectation, Figure, Outcome, Results};
use crate::math::Vec3;
use std::fmt::Write;

const HEAD: &str = "case,quantity,unit,engine,time,theory,value,error,allowed,verdict,cpu_per_second\n";

/// A row per case, quantity and engine that ran; vectors are three numbers separated by blanks.
pub(super) fn csv(r: &Results) -> String {
    let mut text = HEAD.to_owned();
    for (case, outcomes) in r.cases.iter().zip(&r.outcomes) {
        for (engine, outcome) in r.engines.iter().zip(outcomes) {
            let Outcome::Done(run) = outcome else { continue };
            for (e, f) in case.expectations.iter().zip(&run.figures) {
                let _ = writeln!(
                    text,
                    "{},{},{},{},{},{},{},{},{},{},{}",
                    quoted(&case.name),
                    quoted(&e.name),
                    e.unit(),
                    engine.name(),
                    f.at,
                    numbers(e, f.should),
                    numbers(e, f.value),
                    f.error,
                    f.allowed,
                    f.verdict.name(),
                    run.cpu
                );
            }
        }
    }
    text
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

fn numbers(e: &Expectation, v: Vec3) -> String {
    let some: Vec<String> = v.iter().take(e.size()).map(f64::to_string).collect();
    some.join(" ")
}

impl Figure {
    /// `1.2e-7 of 1e-6`.
    pub(super) fn shown(&self) -> String {
        format!("{} of {}", shown(self.error), shown(self.allowed))
    }
}

/// Two digits behind the point.
pub(super) fn shown(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.2e}") }
}
