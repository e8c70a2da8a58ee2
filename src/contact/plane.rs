//! A half-space against convex shapes: in closed form.

use super::feature::{STEEP, curvature};
use super::raw::{Raw, SAME, reduce};
use super::solid::{Kind, Solid, rim};
use super::vector::Frame;
use crate::math::{V3, sin_cos};
use std::f64::consts::TAU;

/// Points of a round rim that are looked at, besides its lowest one.
const AROUND: u32 = 6;

/// The half-space below its frame's z = 0 with its margin, in the world's axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground {
    pub point: V3<f64>,
    /// Unit, outward.
    pub normal: V3<f64>,
    pub margin: f64,
}

/// Points of a solid against a half-space.
struct Probe<'a> {
    ground: &'a Ground,
    frame: &'a Frame,
    round: f64,
    reach: f64,
    out: &'a mut Vec<Raw>,
}

impl Probe<'_> {
    /// A ball of the solid about a point of its frame.
    fn ball(&mut self, feature: u32, center: V3<f64>, radius: f64) {
        let center = self.frame.at(center);
        let foot = center - self.ground.normal * self.ground.normal.dot(center - self.ground.point);
        let radius = [self.ground.margin, self.round + radius];
        let raw = Raw::on(feature, (0, self.ground.normal), [foot, center], radius);
        if raw.gap < self.reach {
            self.out.push(raw);
        }
    }
}

/// Adds the points whose gap is below `reach`; side 0 is the half-space.
pub(super) fn on_ground(ground: &Ground, solid: &Solid, frame: &Frame, (reach, size): (f64, f64), out: &mut Vec<Raw>) {
    let from = out.len();
    let up = frame.r.tv(ground.normal);
    let mut probe = Probe { ground, frame, round: solid.round, reach, out };
    match &solid.kind {
        Kind::Point => probe.ball(0, V3::default(), 0.0),
        Kind::Segment { half } => {
            probe.ball(0, V3::new(0.0, 0.0, -half), 0.0);
            probe.ball(1, V3::new(0.0, 0.0, *half), 0.0);
        }
        Kind::Balls { radii, half } => {
            probe.ball(0, V3::new(0.0, 0.0, -half), radii[0]);
            probe.ball(1, V3::new(0.0, 0.0, *half), radii[1]);
        }
        Kind::Cuboid { half: [x, y, z] } => {
            for i in 0..8u32 {
                let s = |bit: u32, v: f64| if i >> bit & 1 == 1 { v } else { -v };
                probe.ball(i, V3::new(s(0, *x), s(1, *y), s(2, *z)), 0.0);
            }
        }
        Kind::Ellipsoid { radii } => {
            let lowest = solid.support(-up);
            let curve = curvature(*radii, lowest);
            probe.ball(0, lowest + up * curve, curve);
        }
        Kind::Frustum { radii, top, half } => {
            rim_on_ground(&mut probe, up, (*radii, -half, 0));
            match *top {
                0.0 => probe.ball(2 * AROUND + 2, V3::new(0.0, 0.0, *half), 0.0),
                top => rim_on_ground(&mut probe, up, (radii.map(|r| r * top), *half, AROUND + 1)),
            }
        }
        Kind::Hull(hull) => hull.points.iter().enumerate().for_each(|(i, p)| probe.ball(i as u32, *p, 0.0)),
        Kind::Triangle(corners) => corners.iter().enumerate().for_each(|(i, p)| probe.ball(i as u32, *p, 0.0)),
    }
    if matches!(solid.kind, Kind::Hull(_)) {
        reduce(out, from, 1e-4 * size);
    }
}

/// The rim of a cap at height `z` of the solid's frame: points fixed to it, and its lowest point between them. A round rim
/// that stands steeply rolls as a ball about a point of the axis does.
fn rim_on_ground(probe: &mut Probe, up: V3<f64>, (radii, z, first): ([f64; 2], f64, u32)) {
    let middle = V3::new(0.0, 0.0, z);
    let steep = up.x.hypot(up.y);
    if radii[0] == radii[1] && steep > STEEP {
        // The lowest point is −r·d, d the direction in the cap that rises most; from there r/steep upwards is the axis.
        let curve = radii[0] / steep;
        return probe.ball(first, middle + V3::new(0.0, 0.0, curve * up.z), curve);
    }
    let lowest = rim(radii, -up);
    let mut deepest = f64::INFINITY;
    for k in 0..AROUND {
        let (s, c) = sin_cos(TAU * f64::from(k) / f64::from(AROUND));
        let at = V3::new(radii[0] * c, radii[1] * s, 0.0);
        deepest = deepest.min(at.dot(up));
        probe.ball(first + 1 + k, middle + at, 0.0);
    }
    if lowest.dot(up) < deepest - SAME {
        probe.ball(first, middle + lowest, 0.0);
    }
}
