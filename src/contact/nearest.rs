//! Nearest points of two convex cores: parry's GJK, and its EPA where they overlap.

use super::solid::Solid;
use super::vector::{Frame, norm, unit};
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
        Some(Nearest { points: [p, q], normal: n, distance: if deep { n.dot(q - p) } else { length } })
    }
}
