//! Nearest points of two convex cores: parry's GJK, and its EPA where they overlap.

use super::solid::Solid;
use super::vector::{Frame, across, norm, unit};
use crate::math::V3;
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::epa::EPA;
use parry3d_f64::query::gjk::{CsoPoint, GJKResult, VoronoiSimplex, closest_points};
use parry3d_f64::shape::SupportMap;

/// A core at its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'a> {
    pub solid: &'a Solid,
    pub frame: Frame,
}

impl Placed<'_> {
    pub(super) fn support(&self, d: V3<f64>) -> V3<f64> {
        self.frame.at(self.solid.support(self.frame.r.tv(d)))
    }
}

impl SupportMap for Placed<'_> {
    fn local_support_point(&self, d: Vector) -> Vector {
        let p = self.support(V3::new(d.x, d.y, d.z));
        Vector::new(p.x, p.y, p.z)
    }
}

/// How two cores lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// On either core.
    pub points: [V3<f64>; 2],
    /// Unit, from the first to the second.
    pub normal: V3<f64>,
    /// Below 0 where they overlap, m.
    pub distance: f64,
}

/// Memory of the search; made once.
#[derive(Default)]
pub(super) struct Search {
    simplex: VoronoiSimplex,
    epa: EPA,
}

impl Clone for Search {
    /// Nothing in it outlives one search.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl std::fmt::Debug for Search {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Search")
    }
}

/// How far two cores are apart along a unit vector from the first to the second: never more than their distance.
pub(super) fn separation(a: &Placed, b: &Placed, n: V3<f64>) -> f64 {
    n.dot(b.support(-n) - a.support(n))
}

impl Search {
    /// `None` if the cores are further apart than `reach`, or nothing was found.
    pub(super) fn nearest(&mut self, a: &Placed, b: &Placed, reach: f64) -> Option<Nearest> {
        let way = unit(b.frame.p - a.frame.p).unwrap_or(V3::new(1.0, 0.0, 0.0));
        let first = Vector::new(way.x, way.y, way.z);
        self.simplex.reset(CsoPoint::from_shapes(&Pose::IDENTITY, a, b, first));
        let (p, q, n, deep) = match closest_points(&Pose::IDENTITY, a, b, reach, true, &mut self.simplex) {
            GJKResult::ClosestPoints(p, q, n) => (p, q, n, false),
            GJKResult::Intersection => {
                let found = self.epa.closest_points(&Pose::IDENTITY, a, b, &self.simplex);
                let (p, q, n) = found.unwrap_or_default();
                (p, q, n, true)
            }
            _ => return None,
        };
        let [p, q, n] = [p, q, n].map(|v| V3::new(v.x, v.y, v.z));
        let Some(n) = unit(n).filter(|_| (p.dot(p) + q.dot(q)).is_finite()) else {
            // Just touching, or too deep for parry: the best direction that can be found from outside.
            let n = from_outside(a, b, way);
            let points = [a.support(n), b.support(-n)];
            return Some(Nearest { points, normal: n, distance: n.dot(points[1] - points[0]) });
        };
        let length = norm(q - p);
        let other = if deep { -n } else { unit(q - p).unwrap_or(n) };
        // The line between the points is the better normal where it has a length, and is no more than rounding where it has next
        // to none: what separates better counts.
        let n = if separation(a, b, other) > separation(a, b, n) { other } else { n };
        // Where they just touch, the search has no direction, and where they overlap it may have stopped at another one than the
        // best: then one from outside may be the right one.
        let said = if deep { n.dot(q - p) } else { length };
        let proven = separation(a, b, n);
        let doubtful = proven < said - 1e-6 * (said.abs() + 1e-3) || proven < -DEEP * width(a, n).min(width(b, n));
        let n = if doubtful { from_outside(a, b, n) } else { n };
        Some(Nearest { points: [p, q], normal: n, distance: 0.0 }.along(a, b, n))
    }
}

/// How wide a core is along a unit vector, m.
fn width(a: &Placed, n: V3<f64>) -> f64 {
    n.dot(a.support(n) - a.support(-n))
}

impl Nearest {
    /// The points moved onto the planes across `n` that bound the cores, so that the distance is what `n` proves.
    fn along(self, a: &Placed, b: &Placed, n: V3<f64>) -> Self {
        let [p, q] = self.points;
        let (h, g) = (n.dot(a.support(n)), n.dot(b.support(-n)));
        Self { points: [p + n * (h - n.dot(p)), q + n * (g - n.dot(q))], normal: n, distance: g - h }
    }

    /// With the direction that separates best: the search leaves curved cores when it is good to some 1e-3.
    pub(super) fn polished(self, a: &Placed, b: &Placed) -> Self {
        if !(a.solid.is_smooth() || b.solid.is_smooth()) {
            return self;
        }
        let n = newton(a, b, self.normal);
        let way = b.support(-n) - a.support(n);
        let across = norm(way - n * n.dot(way));
        let n = if across <= 1e-9 { n } else { planes(a, b, n, WIDE) };
        if separation(a, b, n) > self.distance { self.along(a, b, n) } else { self }
    }
}

/// Overlaps of more than this share of the thinner core's width are looked at from other sides, too.
const DEEP: f64 = 0.02;

/// The best direction near the best one among `n`, the normals of all faces, and directions all around.
fn from_outside(a: &Placed, b: &Placed, n: V3<f64>) -> V3<f64> {
    let mut best = (separation(a, b, n), n);
    let mut hear = |n: V3<f64>| {
        let s = separation(a, b, n);
        if s > best.0 {
            best = (s, n);
        }
    };
    for (side, placed) in [a, b].into_iter().enumerate() {
        let sense = if side == 0 { 1.0 } else { -1.0 };
        placed.solid.face_normals(|outward| hear(placed.frame.r.mv(outward) * sense));
    }
    for i in 0..27 {
        let digit = |k: i32| f64::from(i / k % 3 - 1);
        unit(V3::new(digit(1), digit(3), digit(9))).into_iter().for_each(&mut hear);
    }
    planes(a, b, best.1, WIDEST)
}

/// Rounds of Newton's method: it starts at about 1e-4 and doubles its digits.
const ROUNDS: usize = 4;
/// Step of the differences, rad.
const STEP: f64 = 1e-5;

/// The direction near `n` that separates two smooth cores best: where the vector between their supporting points, whose part
/// across `n` is the gradient of the separation, lies along `n`. Newton's method with differences, as long as it gains.
fn newton(a: &Placed, b: &Placed, n: V3<f64>) -> V3<f64> {
    let apart = |n: V3<f64>| b.support(-n) - a.support(n);
    let mut best = n;
    let mut way = apart(n);
    for _ in 0..ROUNDS {
        let u = across(best);
        let v = best.cross(u);
        let (gu, gv) = (way.dot(u), way.dot(v));
        let gradient = |n: V3<f64>| {
            let way = apart(n) - n * n.dot(apart(n));
            (way.dot(u) - gu, way.dot(v) - gv)
        };
        let turned = |x: f64, y: f64| unit(best + u * x + v * y).unwrap_or(best);
        let ((uu, vu), (uv, vv)) = (gradient(turned(STEP, 0.0)), gradient(turned(0.0, STEP)));
        let det = uu * vv - uv * vu;
        let (x, y) = (STEP * (uv * gv - vv * gu) / det, STEP * (vu * gu - uu * gv) / det);
        let turn = x.hypot(y);
        if turn >= 0.1 || turn.is_nan() {
            break;
        }
        let next = turned(x, y);
        let new = apart(next);
        if next.dot(new) <= best.dot(way) {
            break;
        }
        (best, way) = (next, new);
    }
    best
}

/// Widest turn that is tried, rad.
const WIDE: f64 = 0.1;
/// The same where the search has no direction to start from.
const WIDEST: f64 = 0.5;
/// Rounds at most.
const CUTS: usize = 48;
/// Directions are searched down to this, rad.
const FINE: f64 = 1e-8;
/// Supporting vectors of directions that gained nothing, which are kept.
const KEPT: usize = 3;

/// As [`newton`], where a corner or an edge meets a curved surface. Each supporting vector x bounds the separation by n·x from
/// above; the best direction under the bounds of the five directions around the best one so far, and of the last ones that
/// bounds promised too much of, is the next to try. Only what gains nothing makes the search finer: along a ridge that is
/// curved, a search that narrows with every step ends before its top.
fn planes(a: &Placed, b: &Placed, n: V3<f64>, widest: f64) -> V3<f64> {
    let apart = |n: V3<f64>| b.support(-n) - a.support(n);
    let (mut best, mut gain, mut wide) = (n, separation(a, b, n), widest);
    let mut kept = [apart(n); KEPT];
    for cut in 0..CUTS {
        let u = across(best);
        let v = best.cross(u);
        let bound = |way: V3<f64>| [way.dot(best), way.dot(u), way.dot(v)];
        let at = |x: f64, y: f64| bound(apart(best + (u * x + v * y) * (0.5 * wide)));
        let [p, q, r] = kept.map(bound);
        let around = [at(0.0, 0.0), at(1.0, 0.0), at(-1.0, 0.0), at(0.0, 1.0), at(0.0, -1.0), p, q, r];
        let (x, y) = highest(&around, wide);
        let next = unit(best + u * x + v * y).unwrap_or(best);
        let new = separation(a, b, next);
        if new > gain {
            (best, gain) = (next, new);
            wide = widest.min(1.5 * wide);
        } else {
            kept[cut % KEPT] = apart(next);
            wide *= 0.3;
        }
        if wide < FINE {
            break;
        }
    }
    best
}

/// Where the least of the planes c + g·x + h·y is highest, within a square: at a corner of it, or where planes meet.
fn highest(planes: &[[f64; 3]], wide: f64) -> (f64, f64) {
    let mut best = (f64::NEG_INFINITY, (0.0, 0.0));
    let mut try_at = |x: f64, y: f64| {
        if x.abs() <= wide && y.abs() <= wide {
            let least = planes.iter().fold(f64::INFINITY, |m, [c, g, h]| m.min(c + g * x + h * y));
            if least > best.0 {
                best = (least, (x, y));
            }
        }
    };
    for (x, y) in [(wide, wide), (wide, -wide), (-wide, wide), (-wide, -wide)] {
        try_at(x, y);
    }
    let minus = |i: usize, j: usize| [0, 1, 2].map(|k| planes[i][k] - planes[j][k]);
    for i in 0..planes.len() {
        for j in i + 1..planes.len() {
            let [c, g, h] = minus(i, j);
            for side in [wide, -wide] {
                try_at(side, -(c + g * side) / h);
                try_at(-(c + h * side) / g, side);
            }
            for k in j + 1..planes.len() {
                let [d, e, f] = minus(i, k);
                let det = g * f - h * e;
                try_at((h * d - c * f) / det, (c * e - g * d) / det);
            }
        }
    }
    best.1
}
