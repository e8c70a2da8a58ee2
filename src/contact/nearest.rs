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
                let (p, q, n) = self.epa.closest_points(&Pose::IDENTITY, a, b, &self.simplex)?;
                (p, q, n, true)
            }
            _ => return None,
        };
        let [p, q, n] = [p, q, n].map(|v| V3::new(v.x, v.y, v.z));
        let length = norm(q - p);
        // The line between the points is the better normal where it has a length.
        let n = if !deep && length > 1e-7 { (q - p) * (1.0 / length) } else { unit(n)? };
        let n = if deep && separation(a, b, -n) > separation(a, b, n) { -n } else { n };
        let n = if a.solid.is_smooth() || b.solid.is_smooth() { polished(a, b, n) } else { n };
        // Where they just touch, the search has no direction: then that of a face may be the right one.
        let said = if deep { n.dot(q - p) } else { length };
        let doubtful = separation(a, b, n) < said - 1e-6 * (said.abs() + 1e-3);
        let n = if doubtful { of_faces(a, b, n) } else { n };
        // Onto the planes that bound the cores in this direction, so that the distance is what the direction proves.
        let (h, g) = (n.dot(a.support(n)), n.dot(b.support(-n)));
        let points = [p + n * (h - n.dot(p)), q + n * (g - n.dot(q))];
        Some(Nearest { points, normal: n, distance: g - h })
    }
}

/// The direction among `n` and the normals of all faces that separates best.
fn of_faces(a: &Placed, b: &Placed, n: V3<f64>) -> V3<f64> {
    let mut best = (separation(a, b, n), n);
    for (side, placed) in [a, b].into_iter().enumerate() {
        placed.solid.face_normals(|outward| {
            let n = placed.frame.r.mv(outward) * if side == 0 { 1.0 } else { -1.0 };
            let s = separation(a, b, n);
            if s > best.0 {
                best = (s, n);
            }
        });
    }
    best.1
}

/// Rounds of Newton's method: it starts at about 1e-4 and doubles its digits.
const ROUNDS: usize = 4;
/// Step of the differences, rad.
const STEP: f64 = 1e-5;

/// The direction near `n` that separates two smooth cores best: where the vector between their supporting points, whose part
/// across `n` is the gradient of the separation, lies along `n`. Newton's method with differences, as long as it gains.
fn polished(a: &Placed, b: &Placed, n: V3<f64>) -> V3<f64> {
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
