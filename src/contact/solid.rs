//! Convex shapes as the narrow phase sees them: a core with a radius around it.

use super::polytope::Polytope;
use super::vector::{norm, unit};
use crate::math::V3;
use crate::shape::ContactForm;
use std::sync::Arc;

/// The core of a shape, in the shape's frame, metres.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    Point,
    /// From z = −half to half.
    Segment {
        half: f64,
    },
    /// The hull of balls of these radii at z = −half and half.
    Balls {
        radii: [f64; 2],
        half: f64,
    },
    Cuboid {
        half: [f64; 3],
    },
    Ellipsoid {
        radii: [f64; 3],
    },
    Frustum {
        radii: [f64; 2],
        top: f64,
        half: f64,
    },
    Hull(Arc<Polytope>),
    Triangle([V3<f64>; 3]),
}

/// All points within `round` of the core.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    pub kind: Kind,
    /// m; the margin is part of it.
    pub round: f64,
}

impl Solid {
    /// `None`: not convex.
    pub(super) fn of(form: &ContactForm, margin: f64) -> Option<Self> {
        let (kind, radius) = match form {
            ContactForm::HalfSpace | ContactForm::Surface(_) => return None,
            ContactForm::Ball { radius } => (Kind::Point, *radius),
            ContactForm::Cuboid { half } => (Kind::Cuboid { half: *half }, 0.0),
            ContactForm::RoundCuboid { half, radius } => (Kind::Cuboid { half: *half }, *radius),
            ContactForm::Capsule { bottom, top, half } if bottom == top => (Kind::Segment { half: *half }, *bottom),
            ContactForm::Capsule { bottom, top, half } => (Kind::Balls { radii: [*bottom, *top], half: *half }, 0.0),
            ContactForm::Ellipsoid { radii } => (Kind::Ellipsoid { radii: *radii }, 0.0),
            ContactForm::Cylinder { radius, half } => {
                (Kind::Frustum { radii: [*radius; 2], top: 1.0, half: *half }, 0.0)
            }
            ContactForm::Cone { radius, half } => (Kind::Frustum { radii: [*radius; 2], top: 0.0, half: *half }, 0.0),
            ContactForm::Frustum { radii, top, half } => (Kind::Frustum { radii: *radii, top: *top, half: *half }, 0.0),
            ContactForm::Hull(corners) => {
                let points: Vec<V3<f64>> = corners.iter().map(|c| V3::from(*c)).collect();
                let hull = Polytope::of(&points).unwrap_or_else(|| Polytope::bare(&points));
                (Kind::Hull(Arc::new(hull)), 0.0)
            }
        };
        Some(Self { kind, round: radius + margin })
    }

    /// Has the core a curved surface?
    pub(super) fn is_smooth(&self) -> bool {
        matches!(self.kind, Kind::Balls { .. } | Kind::Ellipsoid { .. } | Kind::Frustum { .. })
    }

    /// Tells the outward normals of all faces, in the shape's frame.
    pub(super) fn face_normals(&self, mut tell: impl FnMut(V3<f64>)) {
        let (x, y, z) = (V3::new(1.0, 0.0, 0.0), V3::new(0.0, 1.0, 0.0), V3::new(0.0, 0.0, 1.0));
        match &self.kind {
            Kind::Cuboid { .. } => [x, -x, y, -y, z, -z].into_iter().for_each(tell),
            Kind::Frustum { .. } => [z, -z].into_iter().for_each(tell),
            Kind::Hull(hull) => hull.normals.iter().copied().for_each(tell),
            Kind::Triangle([a, b, c]) => {
                let n = unit((*b - *a).cross(*c - *a));
                n.into_iter().flat_map(|n| [n, -n]).for_each(&mut tell);
            }
            _ => {}
        }
    }

    /// The point of the core furthest in a direction of any length.
    pub(super) fn support(&self, d: V3<f64>) -> V3<f64> {
        let up = |z: f64, half: f64| V3::new(0.0, 0.0, half.copysign(z));
        match &self.kind {
            Kind::Point => V3::default(),
            Kind::Segment { half } => up(d.z, *half),
            Kind::Balls { radii: [bottom, top], half } => {
                let n = unit(d).unwrap_or(V3::new(0.0, 0.0, 1.0));
                let higher = half * n.z + top >= -half * n.z + bottom;
                let (z, radius) = if higher { (*half, *top) } else { (-half, *bottom) };
                V3::new(0.0, 0.0, z) + n * radius
            }
            Kind::Cuboid { half: [x, y, z] } => V3::new(x.copysign(d.x), y.copysign(d.y), z.copysign(d.z)),
            Kind::Ellipsoid { radii: [a, b, c] } => {
                let s = V3::new(a * d.x, b * d.y, c * d.z);
                unit(s).map_or(V3::default(), |u| V3::new(a * u.x, b * u.y, c * u.z))
            }
            Kind::Frustum { radii, top, half } => {
                let e = rim(*radii, d);
                let gain = (1.0 - top) * (e.x * d.x + e.y * d.y);
                if 2.0 * half * d.z > gain { e * *top + up(1.0, *half) } else { e + up(-1.0, *half) }
            }
            Kind::Hull(hull) => hull.support(d),
            Kind::Triangle([a, b, c]) => {
                let (x, y, z) = (a.dot(d), b.dot(d), c.dot(d));
                if x >= y && x >= z {
                    *a
                } else if y >= z {
                    *b
                } else {
                    *c
                }
            }
        }
    }

    /// Least box around it: middle and half edges, m.
    pub(super) fn extent(&self) -> (V3<f64>, V3<f64>) {
        let reach = |x: f64, y: f64, z: f64| {
            let d = V3::new(x, y, z);
            self.support(d).dot(d)
        };
        let high = V3::new(reach(1.0, 0.0, 0.0), reach(0.0, 1.0, 0.0), reach(0.0, 0.0, 1.0));
        let low = V3::new(-reach(-1.0, 0.0, 0.0), -reach(0.0, -1.0, 0.0), -reach(0.0, 0.0, -1.0));
        let round = V3::new(self.round, self.round, self.round);
        ((high + low) * 0.5, (high - low) * 0.5 + round)
    }

    /// Radius of a ball about `middle` that holds it, m.
    pub(super) fn ball(&self, middle: V3<f64>, half: V3<f64>) -> f64 {
        let core = match &self.kind {
            Kind::Point => 0.0,
            Kind::Segment { half } => *half,
            Kind::Balls { radii: [bottom, top], half } => {
                ((half - middle.z).abs() + top).max((half + middle.z).abs() + bottom)
            }
            Kind::Ellipsoid { radii } => radii.iter().copied().fold(0.0, f64::max),
            Kind::Frustum { radii: [a, b], half, .. } => a.max(*b).hypot(*half),
            Kind::Hull(hull) => hull.points.iter().fold(0.0, |m: f64, p| m.max(norm(*p - middle))),
            Kind::Cuboid { half: [x, y, z] } => norm(V3::new(*x, *y, *z)),
            Kind::Triangle(_) => norm(half),
        };
        (core + self.round).min(norm(half))
    }
}

/// The point of an ellipse in the plane z = 0 furthest in a direction.
pub(super) fn rim([a, b]: [f64; 2], d: V3<f64>) -> V3<f64> {
    let (x, y) = (a * d.x, b * d.y);
    let length = x.hypot(y);
    if length > 0.0 { V3::new(a * x / length, b * y / length, 0.0) } else { V3::new(a, 0.0, 0.0) }
}
