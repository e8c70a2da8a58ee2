//! Names: unique, and fit for ROS.

use super::super::finding::{Finding, Place};
use super::super::report::Report;
use super::super::{Description, Position};
use super::{place_of_joint, place_of_link};
use std::collections::HashMap;

/// Duplicate names, names that cannot be part of a topic name.
pub(super) fn check(d: &Description, report: &mut Report) {
    refuse_duplicates("link", d.links.iter().map(|l| (l.name.as_str(), l.at)), report);
    refuse_duplicates("joint", d.joints.iter().map(|j| (j.name.as_str(), j.at)), report);
    let places = d.links.iter().map(|l| (&l.name, place_of_link(l)));
    for (name, place) in places.chain(d.joints.iter().map(|j| (&j.name, place_of_joint(j)))) {
        warn_of_odd_name(name, place, report);
    }
}

fn refuse_duplicates<'d>(what: &str, items: impl Iterator<Item = (&'d str, Position)>, report: &mut Report) {
    let mut first_at: HashMap<&str, Position> = HashMap::new();
    for (name, at) in items.filter(|(name, _)| !name.is_empty()) {
        match first_at.get(name) {
            None => {
                first_at.insert(name, at);
            }
            Some(first) => {
                let place = Place { element: format!("{what} '{name}'"), at };
                let message = format!("a second {what} named '{name}'; the first one is in line {}", first.line);
                report.add(Finding::error("duplicate-name", place, message, format!("rename one {what}")));
            }
        }
    }
}

fn warn_of_odd_name(name: &str, place: Place, report: &mut Report) {
    let odd = name.chars().find(|c| !(c.is_ascii_alphanumeric() || *c == '_'));
    let digit = name.chars().next().filter(char::is_ascii_digit);
    let message = match (odd, digit) {
        (Some(c), _) => format!("the name '{name}' contains '{c}': it cannot be part of a ROS topic name"),
        (None, Some(_)) => format!("the name '{name}' starts with a digit: it cannot be part of a ROS topic name"),
        (None, None) => return,
    };
    report.add_once("", Finding::warning("odd-name", place, message, "use letters, digits and '_'"));
}
