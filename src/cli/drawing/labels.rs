//! Numbers beside the centres of mass, where there is room.

use super::marks::Mark;
use super::svg::text;
use super::view::{Point, View};

/// Size of the digits, pixels.
const DIGIT: f64 = 6.2;
const HEIGHT: f64 = 9.0;

/// More numbers than this at one place are told by dots.
const MOST: usize = 3;

#[derive(Clone, Copy)]
struct Frame {
    low: Point,
    high: Point,
}

impl Frame {
    fn around(center: Point, half: Point) -> Self {
        Self { low: [center[0] - half[0], center[1] - half[1]], high: [center[0] + half[0], center[1] + half[1]] }
    }

    fn overlap(&self, other: &Self) -> f64 {
        let side = |i: usize| (self.high[i].min(other.high[i]) - self.low[i].max(other.low[i])).max(0.0);
        side(0) * side(1)
    }
}

/// A number, or several where links coincide on the page, each beside its sign where it covers least. `signs` are other
/// circles to stay clear of: centre, radius.
pub(super) fn labels(marks: &[Mark], signs: &[(Point, f64)], view: &View) -> String {
    let groups = grouped(marks, view);
    let circles = groups.iter().map(|g| (g.at, g.radius)).chain(signs.iter().copied());
    let mut taken: Vec<Frame> = circles.map(|(at, r)| Frame::around(at, [r, r])).collect();
    let mut out = String::new();
    for group in &groups {
        let half = [group.text.chars().count() as f64 * DIGIT / 2.0, HEIGHT / 2.0];
        let frames = candidates(group.at, group.radius, half).map(|at| Frame::around(at, half));
        let cost = |f: &Frame| taken.iter().map(|t| t.overlap(f)).sum::<f64>();
        let Some(best) = frames.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b))) else { continue };
        taken.push(best);
        out += &text("n", [best.low[0] + half[0], best.high[1]], &group.text);
    }
    out
}

/// Beside, above, below and across, nearest first; then the same further off.
fn candidates(at: Point, radius: f64, half: Point) -> [Point; 16] {
    let mut all = [at; 16];
    let ways = [[1.0, 0.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 1.0], [0.8, -0.8], [-0.8, -0.8], [0.8, 0.8], [-0.8, 0.8]];
    for (i, place) in all.iter_mut().enumerate() {
        let (way, gap) = (ways[i % 8], if i < 8 { 2.0 } else { 10.0 });
        place[0] += way[0] * (radius + gap + half[0]);
        place[1] += way[1] * (radius + gap + half[1]);
    }
    all
}

struct Group {
    at: Point,
    radius: f64,
    text: String,
    count: usize,
}

fn grouped(marks: &[Mark], view: &View) -> Vec<Group> {
    let mut groups: Vec<Group> = vec![];
    for mark in marks {
        let at = view.at(&mark.center);
        let near = |g: &&mut Group| (g.at[0] - at[0]).hypot(g.at[1] - at[1]) < 2.0;
        match groups.iter_mut().find(near) {
            Some(group) => {
                group.count += 1;
                match group.count {
                    ..=MOST => group.text += &format!(" {}", mark.number),
                    _ if !group.text.ends_with('…') => group.text.push_str(" …"),
                    _ => {}
                }
                group.radius = group.radius.max(mark.radius);
            }
            None => groups.push(Group { at, radius: mark.radius, text: mark.number.to_string(), count: 1 }),
        }
    }
    groups
}
