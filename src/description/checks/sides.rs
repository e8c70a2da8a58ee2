//! Left and right of a humanoid weigh the same; a factor of ten is a slip of the decimal point.

use super::super::finding::{Finding, Place};
use super::super::report::Report;
use super::super::{Description, Inertial};
use std::collections::HashMap;

/// Ratio of the two masses from which the finding is made.
const FACTOR: f64 = 10.0;
/// How the two sides are told apart in names; the words are whole parts of a name, between underscores.
const SIDES: [(&str, &str); 2] = [("left", "right"), ("l", "r")];

/// Pairs of links whose names differ by the side only.
pub(super) fn check(d: &Description, report: &mut Report) {
    let inertials: HashMap<_, _> =
        d.links.iter().filter_map(|l| Some((l.name.as_str(), l.inertial.as_ref()?))).collect();
    for link in &d.links {
        let (Some(left), Some(mirrored)) = (&link.inertial, mirror(&link.name)) else { continue };
        let Some(right) = inertials.get(mirrored.as_str()) else { continue };
        if left.mass > 0.0 && right.mass > 0.0 && ratio(left, right) >= FACTOR {
            let place = Place { element: format!("link '{}' <inertial>", link.name), at: left.at };
            let message = format!(
                "{} kg, but its mirror image '{mirrored}' (line {}) has {} kg",
                left.mass, right.at.line, right.mass
            );
            report.add(Finding::warning("unequal-sides", place, message, "is there a slip in one of the two masses?"));
        }
    }
}

fn ratio(a: &Inertial, b: &Inertial) -> f64 {
    (a.mass / b.mass).max(b.mass / a.mass)
}

/// The name with its left word turned into the right one, in the same case; `None` if it has none.
fn mirror(name: &str) -> Option<String> {
    let mut found = false;
    let words = name.split('_').map(|word| match right_of(word) {
        Some(right) if !found => {
            found = true;
            right
        }
        _ => word.to_string(),
    });
    let mirrored = words.collect::<Vec<_>>().join("_");
    found.then_some(mirrored)
}

fn right_of(word: &str) -> Option<String> {
    let (left, right) = SIDES.iter().find(|(left, _)| word.eq_ignore_ascii_case(left))?;
    if word == *left {
        return Some(right.to_string());
    }
    let upper = right.to_uppercase();
    let capital = format!("{}{}", &upper[..1], &right[1..]);
    Some(if word == left.to_uppercase() { upper } else { capital })
}
