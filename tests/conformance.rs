//! One data-driven suite for all engines that are built in: the cases of tests/conformance. An engine skips only what it declares that it
//! cannot; that is printed. The page docs/engines.md is that of the cases.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "conformance/command.rs"]
mod command;
#[path = "conformance/page.rs"]
mod page;

use realnoid::cli::conformance::{Outcome, Results, Verdict, cases};
use realnoid::world::EngineKind;
use std::path::Path;

const CASES: &str = "tests/conformance";

/// Every case on every engine of this program.
fn results() -> Results {
    let engines: Vec<EngineKind> = EngineKind::built().collect();
    assert!(engines.contains(&EngineKind::Rbx) && engines.contains(&EngineKind::Rapier));
    Results::of(cases(Path::new(CASES)).unwrap(), &engines, &mut |_, _| {})
}

#[test]
fn every_engine_is_where_theory_says() {
    let r = results();
    // Those that need nothing are for all.
    assert!(r.cases.iter().filter(|c| c.needs.is_empty()).count() >= 10 && r.cases.len() >= 20);
    let mut wrong = vec![];
    for (case, outcomes) in r.cases.iter().zip(&r.outcomes) {
        assert!(!case.expectations.is_empty(), "{} expects nothing", case.name);
        for (engine, outcome) in r.engines.iter().zip(outcomes) {
            let place = format!("{} on {}", case.name, engine.name());
            match outcome {
                Outcome::Skipped(lacks) => {
                    println!("skipped: {place}, which has no {}", lacks.join(", "));
                    assert!(
                        *engine != EngineKind::Rbx && case.lacks(*engine) == *lacks && !lacks.is_empty(),
                        "{place}"
                    );
                }
                Outcome::NotBuilt(why) | Outcome::Refused(why) => wrong.push(format!("{place}: {why}")),
                Outcome::Done(run) => {
                    assert_eq!(run.figures.len(), case.expectations.len());
                    for (e, f) in case.expectations.iter().zip(&run.figures) {
                        let told = format!("{place}: {}: {:e} of {:e}", e.name, f.error, f.allowed);
                        match f.verdict {
                            Verdict::Within => {}
                            Verdict::Known => println!("beyond, as the case says: {told}"),
                            Verdict::Mended => wrong.push(format!("{told}: no longer beyond; take it out of the case")),
                            Verdict::Beyond => wrong.push(told),
                        }
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
