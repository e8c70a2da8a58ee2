//! Solids of revolution, whole or sliced, with any outline.

use super::moments::Moments;
use super::section::Section;
use crate::math::{Mat3, Vec3, sin_cos};
use crate::shape::Lathe;

/// Filled and stretched.
pub(super) fn solid(lathe: &Lathe) -> Moments {
    let turned = Section::of(lathe).turned();
    let [from, to] = lathe.turn();
    let sweep = to - from;
    let fan = Fan::of(lathe.slice.map(|_| sweep));
    let [rho, z] = turned.center;
    let [rr, rz, zz] = turned.spread;
    // Along the bisector of the slice (x) and across it (y): both are symmetric, which leaves few terms to cancel.
    let xx = rr * fan.cos2 + rho * rho * fan.cos_spread;
    let yy = (rr + rho * rho) * fan.sin2;
    let xz = rz * fan.cos;
    let whole = Moments {
        measure: turned.volume * sweep,
        center: Vec3::new(rho * fan.cos, 0.0, z),
        covariance: Mat3::new(xx, 0.0, xz, 0.0, yy, 0.0, xz, 0.0, zz),
    };
    let placed = if lathe.slice.is_some() { whole.turned((from + to) / 2.0) } else { whole };
    placed.stretched(lathe.stretch, lathe.stretch.iter().product::<f64>().abs())
}

/// Means over a range of angles, measured from its bisector.
struct Fan {
    cos: f64,
    cos2: f64,
    sin2: f64,
    /// Mean square of cos about its mean.
    cos_spread: f64,
}

impl Fan {
    /// `None`: a full turn.
    fn of(sweep: Option<f64>) -> Self {
        let Some(x) = sweep else {
            return Self { cos: 0.0, cos2: 0.5, sin2: 0.5, cos_spread: 0.5 };
        };
        let cos = sin_cos(x / 2.0).0 / (x / 2.0);
        if x < 1.0 {
            let (sin2, cos_spread) = narrow(x);
            return Self { cos, cos2: 1.0 - sin2, sin2, cos_spread };
        }
        let wave = sin_cos(x).0 / (2.0 * x);
        Self { cos, cos2: 0.5 + wave, sin2: 0.5 - wave, cos_spread: 0.5 + wave - cos * cos }
    }
}

/// `sin2` and `cos_spread` of a narrow range, as series, whose closed forms would cancel:
/// Σ (−1)ᵏ⁺¹ x²ᵏ / 2(2k + 1)! from k = 1, and Σ (−1)ᵏ (k − 1) x²ᵏ / (2k + 2)! from k = 2.
fn narrow(x: f64) -> (f64, f64) {
    let (mut sin2, mut cos_spread) = (0.0, 0.0);
    // x²ᵏ / (2k + 1)!, with its sign.
    let mut term = 1.0;
    for k in 1..=12 {
        let k = f64::from(k);
        term *= -x * x / (2.0 * k * (2.0 * k + 1.0));
        sin2 -= term / 2.0;
        cos_spread += term * (k - 1.0) / (2.0 * k + 2.0);
    }
    (sin2, cos_spread)
}

/// The two faces where a slice cuts a closed outline; none where nothing is cut.
pub(super) fn cut_faces(lathe: &Lathe) -> Vec<Moments> {
    let Some(angles) = lathe.slice.filter(|_| lathe.closed) else { return vec![] };
    let section = Section::of(lathe);
    let face = |angle: f64| {
        let [x, y, z] = lathe.stretch;
        let (sin, cos) = sin_cos(angle);
        let out = Vec3::new(x * cos, y * sin, 0.0);
        let up = Vec3::new(0.0, 0.0, z);
        let [rr, rz, zz] = section.spread;
        Moments {
            measure: section.area * out.norm() * z.abs(),
            center: out * section.center[0] + up * section.center[1],
            covariance: out * out.transpose() * rr
                + (out * up.transpose() + up * out.transpose()) * rz
                + up * up.transpose() * zz,
        }
    };
    angles.map(face).to_vec()
}
