//! Sphere, hemisphere and ellipsoid.

use super::moments::Moments;
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

/// Surface of an ellipsoid. Its area is no elementary function: one octant is integrated over u = z/c and the angle φ
/// about Z, where the surface element is √((1 − u²)(b²c²cos²φ + a²c²sin²φ) + a²b²u²) du dφ.
pub(super) fn surface([a, b, c]: [f64; 3]) -> Moments {
    let (ab, bc, ca) = (a * b, b * c, c * a);
    let nodes = unit_interval();
    let (mut area, mut x2, mut y2, mut z2) = (0.0, 0.0, 0.0, 0.0);
    for &(weight_u, u) in &nodes {
        let across = (1.0 - u) * (1.0 + u);
        for &(weight_phi, part) in &nodes {
            let (sin, cos) = (part * FRAC_PI_2).sin_cos();
            let element = (across * ((bc * cos).powi(2) + (ca * sin).powi(2)) + (ab * u).powi(2)).sqrt();
            let weight = weight_u * weight_phi * element;
            area += weight;
            x2 += weight * across * (a * cos).powi(2);
            y2 += weight * across * (b * sin).powi(2);
            z2 += weight * (c * u).powi(2);
        }
    }
    Moments::new(8.0 * FRAC_PI_2 * area, 0.0, [x2 / area, y2 / area, z2 / area])
}

/// Weights and points of the tanh–sinh rule on (0, 1). It crowds points at both ends, where the surface element of a
/// flat or thin ellipsoid bends sharply.
fn unit_interval() -> Vec<(f64, f64)> {
    const STEP: f64 = 1.0 / 24.0;
    (-84..=84)
        .map(|k| {
            let t = f64::from(k) * STEP;
            let s = FRAC_PI_2 * t.sinh();
            let weight = STEP * FRAC_PI_2 * t.cosh() / s.cosh().powi(2) / 2.0;
            (weight, 1.0 / (1.0 + (-2.0 * s).exp()))
        })
        .collect()
}
