//! Sphere, hemisphere and ellipsoid.

use super::moments::Moments;
use super::rules::crowded;
use crate::math::sin_cos;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Filled ellipsoid with these semi-axes, m.
pub(super) fn solid([a, b, c]: [f64; 3]) -> Moments {
    Moments::new(4.0 / 3.0 * PI * a * b * c, 0.0, [a * a / 5.0, b * b / 5.0, c * c / 5.0])
}

/// Filled half sphere on z ≥ 0 with its flat side at z = 0.
pub(super) fn solid_hemisphere(r: f64) -> Moments {
    let r2 = r * r;
    // about its centre at 3/8·r the mean square of z is 1/5 − 9/64 = 19/320.
    Moments::new(2.0 / 3.0 * PI * r2 * r, 3.0 / 8.0 * r, [r2 / 5.0, r2 / 5.0, 19.0 / 320.0 * r2])
}

/// Surface of a sphere.
pub(super) fn sphere_surface(r: f64) -> Moments {
    let third = r * r / 3.0;
    Moments::new(2.0 * TAU * r * r, 0.0, [third; 3])
}

/// Curved surface of the half sphere on z ≥ 0.
pub(super) fn hemisphere_surface(r: f64) -> Moments {
    let r2 = r * r;
    Moments::new(TAU * r2, r / 2.0, [r2 / 3.0, r2 / 3.0, r2 / 12.0])
}

/// Surface of an ellipsoid: eight octants.
pub(super) fn surface(radii: [f64; 3]) -> Moments {
    let octant = octant(radii);
    Moments::new(8.0 * octant.area, 0.0, octant.mean_square)
}

/// The part of an ellipsoid's surface where x, y and z are positive.
pub(super) struct Octant {
    /// m².
    pub area: f64,
    /// Means of x, y, z, m.
    pub mean: [f64; 3],
    /// Means of their squares, m².
    pub mean_square: [f64; 3],
}

/// Its area is no elementary function: it is integrated over u = z/c and the angle φ about Z, where the surface element
/// is √((1 − u²)(b²c²cos²φ + a²c²sin²φ) + a²b²u²) du dφ.
pub(super) fn octant([a, b, c]: [f64; 3]) -> Octant {
    let (ab, bc, ca) = (a * b, b * c, c * a);
    let (mut area, mut mean, mut mean_square) = (0.0, [0.0; 3], [0.0; 3]);
    for &(weight_u, u) in crowded() {
        let across = (1.0 - u) * (1.0 + u);
        for &(weight_phi, part) in crowded() {
            let (sin, cos) = sin_cos(part * FRAC_PI_2);
            let element = (across * ((bc * cos).powi(2) + (ca * sin).powi(2)) + (ab * u).powi(2)).sqrt();
            let weight = weight_u * weight_phi * element;
            area += weight;
            for (i, at) in [a * across.sqrt() * cos, b * across.sqrt() * sin, c * u].into_iter().enumerate() {
                mean[i] += weight * at;
                mean_square[i] += weight * at * at;
            }
        }
    }
    Octant { area: FRAC_PI_2 * area, mean: mean.map(|sum| sum / area), mean_square: mean_square.map(|sum| sum / area) }
}
