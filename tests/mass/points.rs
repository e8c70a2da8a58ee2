//! Integrals as weighted points, and how far two bodies differ.

use realnoid::mass::MassProperties;
use realnoid::math::{Mat3, Vec3};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Weighted points: the integral of f is Σ w·f(point).
pub type Cloud = Vec<(f64, Vec3)>;

/// Measure, centre and mean of d dᵀ about the centre.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    pub measure: f64,
    pub center: Vec3,
    pub covariance: Mat3,
}

impl Moments {
    pub fn of(cloud: &Cloud) -> Self {
        let measure: f64 = cloud.iter().map(|(w, _)| w).sum();
        let start = cloud[0].1;
        let center = start + cloud.iter().map(|(w, p)| (p - start) * *w).sum::<Vec3>() / measure;
        let square = |p: Vec3| p * p.transpose();
        let covariance = cloud.iter().map(|(w, p)| square(p - center) * *w).sum::<Mat3>() / measure;
        Self { measure, center, covariance }
    }

    /// From mass properties of this density (kg/m³ or kg/m²).
    pub fn from_mass(body: &MassProperties, density: f64) -> Self {
        let spread = Mat3::from_diagonal_element(body.inertia.trace() / 2.0) - body.inertia;
        Self { measure: body.mass / density, center: body.center, covariance: spread / body.mass }
    }

    /// Greatest deviation from `other`, each element against its own axis: the extent along that axis alone, so that
    /// the thin side of a plate counts as much as its length. An axis without extent takes the longest one.
    pub fn deviation(&self, other: &Self) -> f64 {
        let longest = other.covariance.diagonal().max().sqrt();
        let extent = Vec3::from_fn(|i, _| {
            let own = other.covariance[(i, i)].max(0.0).sqrt();
            if own > 1e-6 * longest { own } else { longest }
        });
        let measure = (self.measure / other.measure - 1.0).abs();
        let center = (self.center - other.center).component_div(&extent).abs().max();
        // Second moments come out of an inertia tensor, which cannot hold more than rounding of its largest element.
        let rounding = 8.0 * f64::EPSILON * other.covariance.trace();
        let spread = Mat3::from_fn(|i, j| {
            let off = (self.covariance[(i, j)] - other.covariance[(i, j)]).abs() - rounding;
            off.max(0.0) / (extent[i] * extent[j])
        });
        measure.max(center).max(spread.max())
    }
}

/// Points of order 8 on [from, to].
pub fn gauss(from: f64, to: f64) -> Vec<(f64, f64)> {
    static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| (0..8).map(legendre_root).collect());
    let half = (to - from) / 2.0;
    RULE.iter().map(|(x, w)| (w * half, from + half * (1.0 + x))).collect()
}

/// Root of P₈ and its weight, by Newton's method from the usual cosine guess.
fn legendre_root(k: u32) -> (f64, f64) {
    let mut x = (PI * (f64::from(k) + 0.75) / 8.5).cos();
    let mut slope = 0.0;
    for _ in 0..50 {
        let (mut p0, mut p1) = (1.0, x);
        for n in 2..=8 {
            let n = f64::from(n);
            (p0, p1) = (p1, ((2.0 * n - 1.0) * x * p1 - (n - 1.0) * p0) / n);
        }
        slope = 8.0 * (x * p1 - p0) / (x * x - 1.0);
        x -= p1 / slope;
    }
    (x, 2.0 / ((1.0 - x * x) * slope * slope))
}

/// Gauss points on panels that shrink towards both ends, where an integrand may bend sharply.
pub fn graded(from: f64, to: f64) -> Vec<(f64, f64)> {
    let mut cuts: Vec<f64> = (1..=5).rev().map(|k| 0.25f64.powi(k)).collect();
    cuts.insert(0, 0.0);
    cuts.push(0.5);
    let upper: Vec<f64> = cuts.iter().rev().skip(1).map(|c| 1.0 - c).collect();
    cuts.extend(upper);
    let at = |c: f64| from + (to - from) * c;
    cuts.windows(2).flat_map(|w| gauss(at(w[0]), at(w[1]))).collect()
}

/// Points on [from, to] for an integrand that starts and ends like a square root.
pub fn rooted(from: f64, to: f64) -> Vec<(f64, f64)> {
    let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
    let cuts = [-1.0, -0.95, -0.8, -0.4, 0.0, 0.4, 0.8, 0.95, 1.0].map(|c| c * PI / 2.0);
    let angles = cuts.windows(2).flat_map(|w| gauss(w[0], w[1]));
    angles.map(|(w, t)| (w * half * t.cos(), middle + half * t.sin())).collect()
}

/// Images of all points; weights times `grows`.
pub fn stretched(cloud: Cloud, factors: [f64; 3], grows: f64) -> Cloud {
    cloud.into_iter().map(|(w, p)| (w * grows, p.component_mul(&Vec3::from(factors)))).collect()
}
