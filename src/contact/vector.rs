//! Lengths and directions of the kernel's vectors.

use crate::math::{M3, V3};

/// Length.
pub(super) fn norm(v: V3<f64>) -> f64 {
    v.dot(v).sqrt()
}

/// Unit vector; `None` for 0 and what is not finite.
pub(super) fn unit(v: V3<f64>) -> Option<V3<f64>> {
    let length = norm(v);
    (length > 1e-300 && length < f64::INFINITY).then(|| v * (1.0 / length))
}

/// Some unit vector perpendicular to a unit vector.
pub(super) fn across(n: V3<f64>) -> V3<f64> {
    let side = if n.x.abs() < 0.7 { V3::new(1.0, 0.0, 0.0) } else { V3::new(0.0, 1.0, 0.0) };
    unit(n.cross(side)).unwrap_or(V3::new(0.0, 0.0, 1.0))
}

/// A frame: axes and origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub r: M3<f64>,
    pub p: V3<f64>,
}

impl Frame {
    pub(super) fn at(&self, x: V3<f64>) -> V3<f64> {
        self.r.mv(x) + self.p
    }
    pub(super) fn inside(&self, x: V3<f64>) -> V3<f64> {
        self.r.tv(x - self.p)
    }
    /// This frame after `inner`, which is told in it.
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self { r: self.r.mm(&inner.r), p: self.at(inner.p) }
    }
}
