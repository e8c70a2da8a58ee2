//! The three angles H, P, B of a 3DOF group over its quaternion.
//!
//! The group's frame F has z along H, y along P and ±x along B at zero, so that the rotation is Rz(h) Ry(p) Rx(s·b).

use crate::math::{M3, Mat3, Real, V3, Vec3, sin_cos};
use std::f64::consts::{PI, TAU};

/// Below this |cos P| the inverse of the angle rates is bounded instead of exact, and the step is counted.
pub const POLE: f64 = 1e-4;

/// Frames of a 3DOF group.
#[derive(Clone, Debug)]
pub struct EulerFrame {
    /// Body that carries the group's link.
    pub body: usize,
    /// First coordinate (quaternion).
    pub q: usize,
    /// First velocity.
    pub v: usize,
    /// +1 or −1: sense of B about x.
    pub sense: f64,
}

/// H, P, B, read out of a quaternion, and how their rates follow from the angular velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct EulerRates {
    /// Rows: rate of H, P, B per angular velocity in the child frame.
    pub gradient: [V3<f64>; 3],
    /// True if |cos P| was below [`POLE`].
    pub at_pole: bool,
}

impl EulerFrame {
    /// Quaternion (w, x, y, z) of the angles.
    pub fn quaternion(&self, hpb: [f64; 3]) -> [f64; 4] {
        let half = |a: f64| sin_cos(0.5 * a);
        let ((sh, ch), (sp, cp), (sb, cb)) = (half(hpb[0]), half(hpb[1]), half(self.sense * hpb[2]));
        [
            ch * cp * cb + sh * sp * sb,
            ch * cp * sb - sh * sp * cb,
            ch * sp * cb + sh * cp * sb,
            sh * cp * cb - ch * sp * sb,
        ]
    }

    /// The angles of a rotation, on the branch next to `before`, so that they stay continuous through the pole.
    pub fn angles(&self, r: &M3<f64>, before: [f64; 3]) -> [f64; 3] {
        let cos_p = libm::hypot(r.r[0].x, r.r[1].x);
        if cos_p < 1e-9 {
            return self.angles_at_pole(r, before);
        }
        let p = libm::atan2(-r.r[2].x, cos_p);
        let near = [libm::atan2(r.r[1].x, r.r[0].x), p, self.sense * libm::atan2(r.r[2].y, r.r[2].z)];
        let far = [near[0] + PI, PI - p, near[2] + PI];
        let (near, far) = (unwrap(near, before), unwrap(far, before));
        if distance(near, before) <= distance(far, before) { near } else { far }
    }

    /// At the pole only h ∓ b is determined: H keeps its value.
    fn angles_at_pole(&self, r: &M3<f64>, before: [f64; 3]) -> [f64; 3] {
        let up = r.r[2].x < 0.0;
        let (s, c) = sin_cos(before[0]);
        // Rz(−h) R = Ry(±π/2) Rx(φ): its second row is (0, cos φ, −sin φ).
        let row1 = r.r[0] * (-s) + r.r[1] * c;
        let phi = libm::atan2(-row1.z, row1.y);
        unwrap([before[0], if up { 0.5 * PI } else { -0.5 * PI }, self.sense * phi], before)
    }

    /// Gradients of the angles at `hpb`: the rates are `gradient[k]·ω`, and a torque τ about angle k is the torque
    /// `gradient[k] τ` on the child (the covariant axis), because both do the same work.
    pub fn rates(&self, hpb: [f64; 3]) -> EulerRates {
        let ((sp, cp), (sf, cf)) = (sin_cos(hpb[1]), sin_cos(self.sense * hpb[2]));
        let at_pole = cp.abs() < POLE;
        let k = if at_pole { cp / (POLE * POLE) } else { 1.0 / cp };
        let t = sp * k;
        EulerRates {
            gradient: [
                V3::new(0.0, sf * k, cf * k),
                V3::new(0.0, cf, -sf),
                V3::new(self.sense, self.sense * sf * t, self.sense * cf * t),
            ],
            at_pole,
        }
    }

    /// Angular velocity in the child frame per rate of H, P, B (columns).
    pub fn directions(&self, hpb: [f64; 3]) -> [V3<f64>; 3] {
        let ((sp, cp), (sf, cf)) = (sin_cos(hpb[1]), sin_cos(self.sense * hpb[2]));
        [V3::new(-sp, sf * cp, cf * cp), V3::new(0.0, cf, -sf), V3::new(self.sense, 0.0, 0.0)]
    }

    /// `Ė ḣ`: the part of ω̇ that comes from the turning of the [`EulerFrame::directions`] at these rates.
    pub fn direction_rates(&self, hpb: [f64; 3], rates: [f64; 3]) -> V3<f64> {
        let ((sp, cp), (sf, cf)) = (sin_cos(hpb[1]), sin_cos(self.sense * hpb[2]));
        let (h, p, f) = (rates[0], rates[1], self.sense * rates[2]);
        let of_h = V3::new(-cp * p, cf * cp * f - sf * sp * p, -sf * cp * f - cf * sp * p);
        of_h * h + V3::new(0.0, -sf * f, -cf * f) * p
    }

    /// The frame F in the H joint's frame, and the sense of B about its x, from the axes of H, P, B at zero.
    pub fn frame(axes: &[Vec3; 3]) -> (Mat3, f64) {
        let x = axes[1].cross(&axes[0]);
        (Mat3::from_columns(&[x, axes[1], axes[0]]), x.dot(&axes[2]).signum())
    }
}

fn unwrap(a: [f64; 3], before: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - TAU * ((a[k] - before[k]) / TAU).round())
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).abs()).sum()
}

/// Rotation matrix of a quaternion (w, x, y, z) of any length but zero.
#[inline(always)]
pub fn rotation<T: Real>(q: [T; 4]) -> M3<T> {
    let [w, x, y, z] = q;
    let s = T::of(2.0) / w.mad(w, x.mad(x, y.mad(y, z * z)));
    let (xs, ys, zs) = (x * s, y * s, z * s);
    let one = T::of(1.0);
    M3::rows(
        V3::new(one - (y * ys + z * zs), x * ys - w * zs, x * zs + w * ys),
        V3::new(x * ys + w * zs, one - (x * xs + z * zs), y * zs - w * xs),
        V3::new(x * zs - w * ys, y * zs + w * xs, one - (x * xs + y * ys)),
    )
}
