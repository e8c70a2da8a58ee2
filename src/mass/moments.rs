//! Uniform bodies that are symmetric about their XZ and YZ planes: all that analytic shapes need.

use super::MassProperties;
use crate::math::{Mat3, Vec3};

/// Volume (or area) and its moments; the centre lies on Z, and the products of inertia vanish.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    /// Volume in m³, or area in m².
    pub measure: f64,
    /// Height of the centre, m.
    pub z: f64,
    /// Mean squares of x, y and z about the centre, m².
    pub mean_square: Vec3,
}

impl Moments {
    /// Centred on `z`, with these mean squares.
    pub fn new(measure: f64, z: f64, mean_square: [f64; 3]) -> Self {
        Self { measure, z, mean_square: mean_square.into() }
    }

    /// The same body, `dz` higher.
    pub fn raised(self, dz: f64) -> Self {
        Self { z: self.z + dz, ..self }
    }

    /// The same body upside down, about z = 0.
    pub fn flipped(self) -> Self {
        Self { z: -self.z, ..self }
    }

    /// Several bodies as one.
    pub fn join(parts: &[Self]) -> Self {
        let measure: f64 = parts.iter().map(|p| p.measure).sum();
        let z = parts.iter().map(|p| p.z * p.measure).sum::<f64>() / measure;
        let mean_square = parts.iter().fold(Vec3::zeros(), |sum, p| {
            let about_whole = p.mean_square + Vec3::new(0.0, 0.0, (p.z - z).powi(2));
            sum + about_whole * (p.measure / measure)
        });
        Self { measure, z, mean_square }
    }

    /// With `density` in kg/m³ for a volume, kg/m² for an area.
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        let mass = self.measure * density;
        let [x2, y2, z2] = self.mean_square.into();
        let diagonal = Vec3::new(y2 + z2, z2 + x2, x2 + y2) * mass;
        MassProperties { mass, center: Vec3::new(0.0, 0.0, self.z), inertia: Mat3::from_diagonal(&diagonal) }
    }
}
