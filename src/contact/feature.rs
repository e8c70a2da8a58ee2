//! The part of a convex shape that faces a direction: a face, an edge or a point.

use super::solid::{Kind, Solid, rim};
use super::vector::{Frame, norm, unit};
use crate::math::{V3, sin_cos};
use std::f64::consts::TAU;

/// A point of a feature.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spot {
    /// On the core.
    pub at: V3<f64>,
    /// Radius of the round surface of the core that touches there, m; 0 for a corner or a flat.
    pub curve: f64,
    /// The same from step to step.
    pub id: u32,
}

/// Makes its memory once.
#[derive(Clone, Debug, Default)]
pub(super) struct Feature {
    /// In order around a face; the ends of an edge; a point.
    pub spots: Vec<Spot>,
    /// Outward normal of a face.
    pub normal: Option<V3<f64>>,
}

/// Points of the rim of a round cap that stand for it.
pub(super) const RIM: u32 = 12;
/// A capsule touches along its side if the direction is this close to perpendicular to it (cosine).
const ALONG: f64 = 0.1;
/// Above this sine of the angle between direction and axis a round rim is taken as a ball about a point of the axis.
pub(super) const STEEP: f64 = 0.5;

impl Feature {
    fn begin(&mut self, normal: Option<V3<f64>>) {
        self.spots.clear();
        self.normal = normal;
    }
    fn add(&mut self, at: V3<f64>, curve: f64, id: u32) {
        self.spots.push(Spot { at, curve, id });
    }

    /// What `solid` (its core) turns towards the unit vector `d`; everything in the frame in which `frame` is told.
    pub(super) fn of(&mut self, solid: &Solid, frame: &Frame, d: V3<f64>) {
        self.local(solid, frame.r.tv(d));
        for spot in &mut self.spots {
            spot.at = frame.at(spot.at);
        }
        self.normal = self.normal.map(|n| frame.r.mv(n));
    }

    fn local(&mut self, solid: &Solid, d: V3<f64>) {
        self.begin(None);
        match &solid.kind {
            Kind::Point => self.add(V3::default(), 0.0, 0),
            Kind::Segment { half } => self.ends(d.z, [-half, *half], |_| (V3::default(), 0.0)),
            Kind::Balls { radii: [bottom, top], half } => {
                let lean = if *half > 0.0 { (bottom - top) / (2.0 * half) } else { d.z };
                let radii = [*bottom, *top];
                self.ends(d.z - lean, [-half, *half], |end| (d * radii[end], radii[end]));
            }
            Kind::Cuboid { half } => self.cuboid(*half, d),
            Kind::Ellipsoid { radii } => {
                let at = solid.support(d);
                self.add(at, curvature(*radii, at), 0);
            }
            Kind::Frustum { radii, top, half } => self.frustum((*radii, *top, *half), d),
            Kind::Hull(hull) => {
                let better = |best: Option<usize>, i: usize| match best {
                    Some(b) if hull.normals[i].dot(d) <= hull.normals[b].dot(d) => Some(b),
                    _ => Some(i),
                };
                match (0..hull.normals.len()).fold(None, better) {
                    Some(face) => {
                        self.normal = Some(hull.normals[face]);
                        for id in hull.face(face) {
                            self.add(hull.points[*id as usize], 0.0, *id);
                        }
                    }
                    None => self.add(solid.support(d), 0.0, 0),
                }
            }
            Kind::Triangle(corners) => self.triangle(corners, d),
        }
    }

    /// Both ends of a line along z if the direction is across it, else one; what each adds to its place and its curve.
    fn ends(&mut self, along: f64, z: [f64; 2], more: impl Fn(usize) -> (V3<f64>, f64)) {
        for (end, z) in z.into_iter().enumerate() {
            let mine = if end == 0 { along <= ALONG } else { along >= -ALONG };
            if mine {
                let (shift, curve) = more(end);
                self.add(V3::new(0.0, 0.0, z) + shift, curve, end as u32);
            }
        }
    }

    fn cuboid(&mut self, half: [f64; 3], d: V3<f64>) {
        let d = [d.x, d.y, d.z];
        let more = |best: usize, axis: usize| if d[axis].abs() > d[best].abs() { axis } else { best };
        let axis = (1..3).fold(0, more);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let side = 1f64.copysign(d[axis]);
        let mut normal = [0.0; 3];
        normal[axis] = side;
        self.normal = Some(V3::new(normal[0], normal[1], normal[2]));
        for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            // Anticlockwise seen from outside on the negative side as well.
            let signs = [(axis, side), (u, a * side), (v, b)];
            let mut at = [0.0; 3];
            let mut id = 0;
            for (k, s) in signs {
                at[k] = s * half[k];
                id |= u32::from(s > 0.0) << k;
            }
            self.add(V3::new(at[0], at[1], at[2]), 0.0, id);
        }
    }

    fn frustum(&mut self, (radii, top, half): ([f64; 2], f64, f64), d: V3<f64>) {
        let e = rim(radii, d);
        let flat = d.x.hypot(d.y);
        let out = if flat > 0.0 { (d.x * e.x + d.y * e.y) / flat } else { radii[0] };
        let mantle = unit(V3::new(2.0 * half, (1.0 - top) * out, 0.0)).unwrap_or(V3::new(1.0, 0.0, 0.0));
        let faced = mantle.x * flat + mantle.y * d.z;
        let caps = [(-d.z, 1.0, -half), (if top > 0.0 { d.z } else { -1.0 }, top, half)];
        let (best, scale, z) = if caps[0].0 > caps[1].0 { caps[0] } else { caps[1] };
        if best < faced {
            for (end, scale) in [1.0, top].into_iter().enumerate() {
                let at = V3::new(0.0, 0.0, if end == 0 { -half } else { half }) + e * scale;
                let round = radii[0] == radii[1] && flat > STEEP;
                self.add(at, if round { radii[0] * scale / flat } else { 0.0 }, RIM + end as u32);
            }
            return;
        }
        let side = 1f64.copysign(z);
        self.normal = Some(V3::new(0.0, 0.0, if half > 0.0 { side } else { 1f64.copysign(d.z) }));
        for k in 0..RIM {
            // Seen from below, the other way round.
            let turn = TAU * f64::from(k) / f64::from(RIM);
            let (s, c) = sin_cos(if self.normal.is_some_and(|n| n.z < 0.0) { -turn } else { turn });
            self.add(V3::new(radii[0] * scale * c, radii[1] * scale * s, z), 0.0, k);
        }
    }

    fn triangle(&mut self, corners: &[V3<f64>; 3], d: V3<f64>) {
        let normal = unit((corners[1] - corners[0]).cross(corners[2] - corners[0]));
        let below = normal.is_some_and(|n| n.dot(d) < 0.0);
        self.normal = normal.map(|n| if below { -n } else { n });
        for k in if below { [0, 2, 1] } else { [0, 1, 2] } {
            self.add(corners[k], 0.0, k as u32);
        }
    }
}

/// Radius of the ball that fits an ellipsoid at a point of it, where its two principal radii agree; else 0.
///
/// With g = (x/a², y/b², z/c²) and the curvature matrix diag(1/a², 1/b², 1/c²)/|g|, taken across g, the curvatures are its
/// two eigenvalues.
pub(super) fn curvature([a, b, c]: [f64; 3], p: V3<f64>) -> f64 {
    let inverse = V3::new(1.0 / (a * a), 1.0 / (b * b), 1.0 / (c * c));
    let g = V3::new(p.x * inverse.x, p.y * inverse.y, p.z * inverse.z);
    let Some(n) = unit(g) else { return 0.0 };
    let bend = |u: V3<f64>, v: V3<f64>| u.x * v.x * inverse.x + u.y * v.y * inverse.y + u.z * v.z * inverse.z;
    let u = super::vector::across(n);
    let v = n.cross(u);
    let (uu, uv, vv) = (bend(u, u), bend(u, v), bend(v, v));
    let same = (uu - vv).abs().max(2.0 * uv.abs()) <= 1e-6 * (uu + vv);
    let radius = 2.0 * norm(g) / (uu + vv);
    if same && radius.is_finite() { radius } else { 0.0 }
}
