//! Balls and capsules against each other, and balls against boxes: in closed form.

use super::raw::{Raw, reduce};
use super::vector::{Frame, across, norm, unit};
use crate::math::V3;

/// A core that is a point or a line along z, with its radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rod {
    pub frame: Frame,
    /// 0: a ball.
    pub half: f64,
    pub radius: f64,
}

impl Rod {
    fn at(&self, t: f64) -> V3<f64> {
        self.frame.p + self.frame.r.col2() * t
    }
    /// Where on the line (−half … half) the foot of a point is, and where it would be on the endless line.
    fn foot(&self, x: V3<f64>) -> (f64, f64) {
        let t = self.frame.r.col2().dot(x - self.frame.p);
        (t.clamp(-self.half, self.half), t)
    }
}

/// Two rods nearer to parallel than this sine touch in two points.
const PARALLEL: f64 = 0.1;

/// Balls and capsules.
pub(super) fn rods(a: &Rod, b: &Rod, (reach, size): (f64, f64), out: &mut Vec<Raw>) {
    let from = out.len();
    let (u, v) = (a.frame.r.col2(), b.frame.r.col2());
    let cross = u.cross(v);
    let radius = [a.radius, b.radius];
    let otherwise = if a.half * b.half == 0.0 {
        if a.half > 0.0 { across(u) } else { across(v) }
    } else {
        unit(cross).filter(|_| norm(cross) > 1e-6).unwrap_or(across(u))
    };
    let otherwise = if a.half + b.half == 0.0 { V3::new(0.0, 0.0, 1.0) } else { otherwise };
    let mut add = |feature: u32, s: f64, t: f64| {
        let raw = Raw::between(feature, [a.at(s), b.at(t)], radius, otherwise);
        if raw.gap < reach {
            out.push(raw);
        }
    };
    if a.half > 0.0 && b.half > 0.0 && norm(cross) < PARALLEL {
        // Ends of either that lie beside the other.
        for (k, t) in [-b.half, b.half].into_iter().enumerate() {
            let (s, free) = a.foot(b.at(t));
            if s == free {
                add(1 + k as u32, s, t);
            }
        }
        for (k, s) in [-a.half, a.half].into_iter().enumerate() {
            let (t, free) = b.foot(a.at(s));
            if t == free {
                add(3 + k as u32, s, t);
            }
        }
    }
    let (s, t) = nearest(a, b);
    let raw = Raw::between(0, [a.at(s), b.at(t)], radius, otherwise);
    let least = out[from..].iter().fold(f64::INFINITY, |m, r| m.min(r.gap));
    if raw.gap < reach && raw.gap < least - 1e-9 {
        out.push(raw);
    }
    reduce(out, from, 1e-4 * size);
}

/// Nearest points of two lines, as distances from their middles (Ericson, Real-Time Collision Detection, 5.1.9).
fn nearest(a: &Rod, b: &Rod) -> (f64, f64) {
    let (u, v) = (a.frame.r.col2(), b.frame.r.col2());
    let w = b.frame.p - a.frame.p;
    let c = u.dot(v);
    let sine = u.cross(v);
    let det = sine.dot(sine);
    let free = if det > 1e-12 { (u.dot(w) - c * v.dot(w)) / det } else { u.dot(w) };
    let s = free.clamp(-a.half, a.half);
    let (t, _) = b.foot(a.at(s));
    let (s, _) = a.foot(b.at(t));
    (s, t)
}

/// A cuboid (side 0) with edges rounded by `round`, and a ball.
pub(super) fn cuboid_ball(
    (frame, half, round): (&Frame, [f64; 3], f64),
    (center, radius): (V3<f64>, f64),
    reach: f64,
    out: &mut Vec<Raw>,
) {
    let local = frame.inside(center);
    let c = [local.x, local.y, local.z];
    let mut beyond = [0.0; 3];
    for k in 0..3 {
        beyond[k] = (c[k].abs() - half[k]).max(0.0).copysign(c[k]);
    }
    let outside = beyond.iter().filter(|x| **x != 0.0).count();
    let nearest = |best: usize, k: usize| if half[k] - c[k].abs() < half[best] - c[best].abs() { k } else { best };
    let raw = if outside <= 1 {
        // Over a face, or inside: the face that is nearest.
        let axis = (0..3).find(|k| beyond[*k] != 0.0).unwrap_or((1..3).fold(0, nearest));
        let side = 1f64.copysign(c[axis]);
        let mut foot = c;
        foot[axis] = side * half[axis];
        let n = [frame.r.col0(), frame.r.col1(), frame.r.col2()][axis] * side;
        let foot = frame.at(V3::new(foot[0], foot[1], foot[2]));
        Raw::on(0, (0, n), [foot, center], [round, radius])
    } else {
        let foot = frame.at(local - V3::new(beyond[0], beyond[1], beyond[2]));
        let n = unit(center - foot).unwrap_or(frame.r.col2());
        Raw::between(0, [foot, center], [round, radius], n)
    };
    if raw.gap < reach {
        out.push(raw);
    }
}
