//! docs/engines.md against a fresh run.
//!
//! The rule, which cannot flake: all that is not measured is the same, letter by letter. CPU times are not compared. Of an error, page and run
//! must agree on whether it is allowed; one that is not may be twice that of the page at most. Columns of engines that this program was not built with are left alone.

use super::{CASES, results};
use realnoid::cli::conformance::{DRIFT, page};
use realnoid::world::EngineKind;
use std::path::Path;

const MEND: &str = "make it anew: realnoid engines --cases tests/conformance --markdown docs/engines.md";

fn cells(line: &str) -> Vec<&str> {
    line.trim_matches('|').split('|').map(str::trim).collect()
}

/// Error and tolerance of `1.2e-7 of 1.0e-6`, the error in bold if it is not allowed.
fn figure(cell: &str) -> Option<(f64, f64, bool)> {
    let (error, allowed) = cell.split_once(" of ")?;
    let bold = error.starts_with("**");
    Some((error.trim_matches('*').parse().ok()?, allowed.parse().ok()?, bold))
}

fn agree(old: &str, new: &str) -> bool {
    match (figure(old), figure(new)) {
        (Some((e, a, bold)), Some((f, b, now_bold))) => {
            a == b && bold == now_bold && (bold || e <= a) && (!bold || f <= DRIFT * e)
        }
        // CPU times.
        _ if old.parse::<f64>().is_ok() && new.parse::<f64>().is_ok() => true,
        _ => old == new,
    }
}

/// Where the page is not that of a run.
fn differences(page: &str, fresh: &str) -> Vec<String> {
    let built = |column: &str| EngineKind::by_name(column).is_none_or(|kind| kind.available().is_ok());
    let measured_elsewhere = |line: &&str| !line.starts_with("Taken on:");
    let (old, new): (Vec<&str>, Vec<&str>) =
        (page.lines().filter(measured_elsewhere).collect(), fresh.lines().filter(measured_elsewhere).collect());
    let mut found = vec![];
    if old.len() != new.len() {
        found.push(format!("it has {} lines, a fresh one {}", old.len(), new.len()));
    }
    let mut header: Vec<&str> = vec![];
    for (a, b) in old.into_iter().zip(new) {
        let (x, y) = (cells(a), cells(b));
        if !b.starts_with('|') {
            header = vec![];
        } else if header.is_empty() {
            header = y.clone();
        }
        let same = |i: usize| !built(header.get(i).copied().unwrap_or("")) || agree(x[i], y[i]);
        if x.len() != y.len() || !(0..x.len()).all(same) {
            found.push(format!("page:  {a}\nfresh: {b}"));
        }
    }
    found
}

#[test]
fn the_page_is_that_of_a_fresh_run() {
    let text = std::fs::read_to_string("docs/engines.md").unwrap();
    let found = differences(&text, &page(&results(), Path::new(CASES), "this machine"));
    assert!(found.is_empty(), "docs/engines.md: {MEND}\n{}", found.join("\n"));
}

#[test]
fn the_page_names_every_case_quantity_and_engine() {
    let text = std::fs::read_to_string("docs/engines.md").unwrap();
    let all = realnoid::cli::conformance::cases(Path::new(CASES)).unwrap();
    for case in &all {
        let section = text.split(&format!("\n### {}\n", case.name)).nth(1).unwrap_or_else(|| panic!("{}", case.name));
        let section = section.split("\n### ").next().unwrap();
        let header = section.lines().find(|l| l.starts_with("| quantity")).unwrap();
        assert!(EngineKind::NAMES.iter().all(|(name, _)| cells(header).contains(name)), "{header}");
        for e in &case.expectations {
            assert!(section.contains(&format!("\n| {} | `{}`", e.name, e.formula())), "{}: {}", case.name, e.name);
        }
    }
    assert_eq!(text.matches("\n### ").count(), all.len());
}

#[test]
fn the_comparison_of_pages_can_fail() {
    let page = "| quantity | theory | rbx | rapier |\n|---|---|---|---|\n| z | `1` m | 1.00e-7 of 1.00e-6 | **2.00e-3** of 1.00e-6 |\n";
    assert!(differences(page, page).is_empty());
    for (from, to, same) in [
        ("1.00e-7 of", "5.00e-9 of", true),
        ("1.00e-7 of", "**2.00e-6** of", false),
        ("**2.00e-3**", "**3.90e-3**", true),
        ("**2.00e-3**", "**4.10e-3**", false),
        ("**2.00e-3**", "2.00e-9", false),
        ("1.00e-7 of 1.00e-6", "1.00e-7 of 2.00e-6", false),
        ("1.00e-7 of 1.00e-6", "skipped", false),
        ("`1`", "`2`", false),
        ("| z |", "| y |", false),
    ] {
        assert_eq!(differences(page, &page.replace(from, to)).is_empty(), same, "{from} {to}");
    }
    assert!(!differences(page, &format!("{page}| y | `1` m | 0 of 1.00e-6 | 0 of 1.00e-6 |\n")).is_empty());
}
