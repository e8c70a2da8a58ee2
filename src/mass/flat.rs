//! Flat and straight-edged plates: disc, rectangle, triangle.

use super::moments::Moments;
use crate::math::{Mat3, Vec3};
use std::f64::consts::PI;

/// A ring between two radii in the XY plane; `inner` may be 0.
pub(super) fn disc(outer: f64, inner: f64) -> Moments {
    let mean_square = (outer * outer + inner * inner) / 4.0;
    Moments::new(PI * (outer - inner) * (outer + inner), 0.0, [mean_square, mean_square, 0.0])
}

/// Full edge lengths, in the XY plane.
pub(super) fn rectangle([x, y]: [f64; 2]) -> Moments {
    Moments::new(x * y, 0.0, [x * x / 12.0, y * y / 12.0, 0.0])
}

/// the mean of d dᵀ over a triangle is a twelfth of the sum of the same over its corners, d measured from the
/// centre; the product of inertia in the plane is in it.
pub(super) fn triangle(corners: [Vec3; 3]) -> Moments {
    let [a, b, c] = corners;
    let center = (a + b + c) / 3.0;
    let covariance = corners.iter().fold(Mat3::zeros(), |sum, p| sum + square(p - center)) / 12.0;
    Moments { measure: (b - a).cross(&(c - a)).norm() / 2.0, center, covariance }
}

/// d dᵀ.
pub(super) fn square(d: Vec3) -> Mat3 {
    d * d.transpose()
}
