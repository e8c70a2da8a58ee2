//! The list of links and the key to the signs.

use super::marks::{Mark, WHOLE, radius};
use super::svg::{line, quartered_circle, text};
use super::view::Point;

/// Width of one column of links, pixels.
pub(super) const COLUMN: f64 = 250.0;
/// Distance between lines.
const ROW: f64 = 15.5;
/// More links than this take a second column.
const ROWS: usize = 40;

/// So many reasons for shapes that are not drawn are told in full.
const FEW: usize = 2;

/// Columns that the list takes.
pub(super) fn columns(links: usize) -> usize {
    links.div_ceil(ROWS).max(1)
}

/// Number, name and mass of every link, from `corner` down; and where it ends.
pub(super) fn list(marks: &[Mark], corner: Point) -> (String, f64) {
    let per_column = marks.len().div_ceil(columns(marks.len())).max(1);
    let mut out = String::new();
    for (i, mark) in marks.iter().enumerate() {
        let x = corner[0] + COLUMN * (i / per_column) as f64;
        let y = corner[1] + ROW * (i % per_column) as f64;
        out += &text("r", [x + 18.0, y], &mark.number.to_string());
        out += &text("l", [x + 26.0, y], &shortened(mark.name));
        out += &text("r", [x + COLUMN - 22.0, y], &kilograms(mark.mass));
    }
    (out, corner[1] + ROW * marks.len().min(per_column) as f64)
}

/// Three significant digits, in kg or g.
pub(super) fn kilograms(mass: f64) -> String {
    let (value, unit) = if mass >= 0.1 { (mass, "kg") } else { (mass * 1e3, "g") };
    let decimals = if value >= 100.0 {
        0
    } else if value >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.decimals$} {unit}")
}

fn shortened(name: &str) -> String {
    const MOST: usize = 24;
    if name.chars().count() <= MOST { name.into() } else { name.chars().take(MOST - 1).chain(['…']).collect() }
}

/// What the signs mean; and where it ends.
pub(super) fn key(marks: &[Mark], missing: &[String], corner: Point) -> (String, f64) {
    let [x, mut y] = corner;
    let mut out = String::new();
    let mut row = |sign: &dyn Fn(Point) -> String, words: &[String]| {
        out += &sign([x + 14.0, y - 4.0]);
        for words in words {
            out += &text("l", [x + 34.0, y], words);
            y += ROW;
        }
        y += 6.0;
    };
    let heaviest = marks.iter().map(|m| m.mass).fold(0.0, f64::max);
    if heaviest > 0.0 {
        row(
            &|at| quartered_circle("whole", at, WHOLE),
            &["centre of mass of the whole,".into(), "with its plumb line".into()],
        );
        let size = radius(heaviest, heaviest);
        let words = format!("centre of mass of a link ({})", kilograms(heaviest));
        row(&|at| quartered_circle("com", at, size), &[words, "its area is in proportion to the mass".into()]);
        let names = ["first principal axis (least moment)", "second principal axis", "third principal axis (greatest)"];
        for (class, name) in ["a1", "a2", "a3"].iter().zip(names) {
            row(&|[x, y]| line(class, [x - 12.0, y], [x + 12.0, y]), &[name.into()]);
        }
        row(
            &|_| String::new(),
            &["each as long as the radius of gyration".into(), "about it, to the scale of the drawing".into()],
        );
    }
    for words in missing.iter().take(FEW) {
        let lines = std::iter::once("not drawn:".to_string()).chain(wrapped(words, 38));
        row(&|_| String::new(), &lines.collect::<Vec<_>>());
    }
    if missing.len() > FEW {
        row(&|_| String::new(), &[format!("and {} more shapes not drawn", missing.len() - FEW)]);
    }
    (out, y)
}

/// Lines of at most `most` characters, broken at blanks and slashes where there are any.
fn wrapped(words: &str, most: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for piece in words.split_inclusive([' ', '/']) {
        let length = |s: &str| s.chars().count();
        if lines.last().is_some_and(|l| !l.is_empty() && length(l) + length(piece) > most) {
            lines.push(String::new());
        }
        if let Some(last) = lines.last_mut() {
            last.push_str(piece);
        }
    }
    lines
}
