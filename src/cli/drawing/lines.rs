//! Fewer points for the same lines.

use super::view::Point;
use std::collections::BTreeMap;

/// Segments joined end to end, each run simplified; segments that fall into one another on the page are drawn once.
pub(super) fn chained(segments: &[[Point; 2]], tolerance: f64) -> Vec<Vec<Point>> {
    let key = |p: &Point| p.map(|x| (x / tolerance).round() as i64);
    let mut at: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    let mut ends = BTreeMap::new();
    for segment in segments {
        let [a, b] = segment.map(|p| key(&p));
        if a != b {
            ends.entry([a.min(b), a.max(b)]).or_insert(*segment);
        }
    }
    let segments: Vec<[Point; 2]> = ends.into_values().collect();
    for (i, segment) in segments.iter().enumerate() {
        segment.iter().for_each(|p| at.entry(key(p)).or_default().push(i));
    }
    let mut used = vec![false; segments.len()];
    let mut runs = vec![];
    for start in 0..segments.len() {
        if std::mem::replace(&mut used[start], true) {
            continue;
        }
        let [first, second] = segments[start];
        let mut run = vec![second, first];
        for _ in 0..2 {
            run.reverse();
            while let Some(next) =
                run.last().and_then(|last| follow(&at[&key(last)], &segments, &mut used, key(last), key))
            {
                run.push(next);
            }
        }
        runs.push(simplified(&run, tolerance));
    }
    runs
}

/// The other end of an unused segment that starts at `place`.
fn follow(
    here: &[usize],
    segments: &[[Point; 2]],
    used: &mut [bool],
    place: [i64; 2],
    key: impl Fn(&Point) -> [i64; 2],
) -> Option<Point> {
    let next = *here.iter().find(|i| !used[**i])?;
    used[next] = true;
    let [a, b] = segments[next];
    Some(if key(&a) == place { b } else { a })
}

/// The line without the points that lie within `tolerance` of it (Ramer, Douglas and Peucker). A ring that does not repeat
/// its first point keeps its first and last.
pub(super) fn simplified(line: &[Point], tolerance: f64) -> Vec<Point> {
    let Some(&first) = line.first() else { return vec![] };
    let mut keep = vec![first];
    let mut open = vec![(0, line.len() - 1)];
    while let Some((from, to)) = open.pop() {
        let distance = |i: usize| from_line(line[i], line[from], line[to]);
        let furthest = (from + 1..to).max_by(|i, j| distance(*i).total_cmp(&distance(*j)));
        match furthest.filter(|i| distance(*i) > tolerance) {
            Some(middle) => open.extend([(middle, to), (from, middle)]),
            None => keep.push(line[to]),
        }
    }
    keep
}

/// A ring without the points at which it turns back upon itself, and which enclose nothing wider than `tolerance`.
pub(super) fn without_spikes(ring: &[Point], tolerance: f64) -> Vec<Point> {
    let spike = |a: Point, b: Point, c: Point| {
        let back = (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1]) > 0.0;
        back && from_line(c, a, b).min(from_line(a, b, c)) < tolerance
    };
    let mut kept = ring.to_vec();
    // The second time starts elsewhere: the first and the last point have neighbours as well.
    for _ in 0..2 {
        let mut next: Vec<Point> = Vec::with_capacity(kept.len());
        for point in kept {
            next.push(point);
            while let [.., a, b, c] = next[..]
                && spike(a, b, c)
            {
                next.truncate(next.len() - 2);
                next.push(c);
            }
        }
        let half = next.len() / 2;
        next.rotate_left(half);
        kept = next;
    }
    kept
}

/// Distance of `p` from the segment a b.
fn from_line(p: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = dx * dx + dy * dy;
    let t = if length > 0.0 { (((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    (p[0] - a[0] - t * dx).hypot(p[1] - a[1] - t * dy)
}
