//! Uniform bodies and surfaces: measure, centre, covariance.

use super::MassProperties;
use crate::math::{Mat3, Vec3, sin_cos};

/// Volume (or area) and its first two moments.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    /// Volume in m³, or area in m². Negative for a part that is taken away.
    pub measure: f64,
    /// Its centre, m.
    pub center: Vec3,
    /// Mean of d dᵀ, d = point − centre, m².
    pub covariance: Mat3,
}

impl Moments {
    /// Centred on `z` and symmetric about the XZ and YZ planes, with these mean squares about the centre.
    pub fn new(measure: f64, z: f64, mean_square: [f64; 3]) -> Self {
        let covariance = Mat3::from_diagonal(&mean_square.into());
        Self { measure, center: Vec3::new(0.0, 0.0, z), covariance }
    }

    /// The same body, `dz` higher.
    pub fn raised(self, dz: f64) -> Self {
        Self { center: self.center + Vec3::new(0.0, 0.0, dz), ..self }
    }

    /// The same body upside down, about z = 0.
    pub fn flipped(self) -> Self {
        self.stretched([1.0, 1.0, -1.0], 1.0)
    }

    /// Its image under factors along the axes, which multiply the measure by `grows`.
    pub fn stretched(self, factors: [f64; 3], grows: f64) -> Self {
        let s = Vec3::from(factors);
        let covariance = Mat3::from_fn(|i, j| s[i] * self.covariance[(i, j)] * s[j]);
        Self { measure: self.measure * grows, center: self.center.component_mul(&s), covariance }
    }

    /// Turned by `angle` rad about Z.
    pub fn turned(self, angle: f64) -> Self {
        let (sin, cos) = sin_cos(angle);
        let r = Mat3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        Self { measure: self.measure, center: r * self.center, covariance: r * self.covariance * r.transpose() }
    }

    /// Several parts as one. Sums are compensated, and second moments taken about the common centre: the error does
    /// not grow with the number of parts, nor with the distance from the origin.
    pub fn join<P: IntoIterator<Item = Self> + Clone>(parts: P) -> Self {
        let Some(start) = parts.clone().into_iter().find(|p| p.measure != 0.0).map(|p| p.center) else {
            return Self { measure: 0.0, center: Vec3::zeros(), covariance: Mat3::zeros() };
        };
        let rough = Sums::about(start, parts.clone()).moments();
        Sums::about(rough.center, parts).moments()
    }

    /// With `density` in kg/m³ for a volume, kg/m² for an area.
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        let mass = self.measure * density;
        let c = self.covariance * mass;
        // Each diagonal element as a sum of two squares: trace − own square would cancel for a thin rod.
        let diagonal = Vec3::new(c[(1, 1)] + c[(2, 2)], c[(2, 2)] + c[(0, 0)], c[(0, 0)] + c[(1, 1)]);
        let inertia = Mat3::from_fn(|i, j| if i == j { diagonal[i] } else { -(c[(i, j)] + c[(j, i)]) / 2.0 });
        MassProperties { mass, center: self.center, inertia }
    }
}

/// The six elements of a symmetric matrix that differ.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Sums of measure, and of first and second moments about a reference point.
struct Sums {
    reference: Vec3,
    measure: Sum,
    first: [Sum; 3],
    second: [Sum; 6],
}

impl Sums {
    fn about(reference: Vec3, parts: impl IntoIterator<Item = Moments>) -> Self {
        let mut sums = Self { reference, measure: Sum::ZERO, first: [Sum::ZERO; 3], second: [Sum::ZERO; 6] };
        for part in parts {
            let d = part.center - reference;
            sums.measure.add(part.measure);
            (0..3).for_each(|i| sums.first[i].add(part.measure * d[i]));
            for (sum, (i, j)) in sums.second.iter_mut().zip(PAIRS) {
                sum.add(part.measure * (part.covariance[(i, j)] + d[i] * d[j]));
            }
        }
        sums
    }

    fn moments(&self) -> Moments {
        let measure = self.measure.value();
        let d = Vec3::from(self.first.map(|s| s.value() / measure));
        let mut covariance = Mat3::zeros();
        for (sum, (i, j)) in self.second.iter().zip(PAIRS) {
            covariance[(i, j)] = sum.value() / measure - d[i] * d[j];
            covariance[(j, i)] = covariance[(i, j)];
        }
        Moments { measure, center: self.reference + d, covariance }
    }
}

/// A running sum with the sum of its rounding errors beside it (two-sum without branches).
#[derive(Clone, Copy, Debug)]
pub(super) struct Sum {
    total: f64,
    lost: f64,
}

impl Sum {
    /// Nothing yet.
    pub const ZERO: Self = Self { total: 0.0, lost: 0.0 };

    /// Adds a term.
    pub fn add(&mut self, term: f64) {
        let total = self.total + term;
        let kept = total - self.total;
        self.lost += (self.total - (total - kept)) + (term - kept);
        self.total = total;
    }

    /// The sum so far.
    pub fn value(&self) -> f64 {
        self.total + self.lost
    }
}
