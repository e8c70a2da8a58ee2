//! Elliptic cylinder and tube.

use super::flat::disc;
use super::frustum;
use super::moments::Moments;
use std::f64::consts::PI;

/// Filled, semi-axes `a` along X and `b` along Y, full height `length`, m.
pub(super) fn solid(a: f64, b: f64, length: f64) -> Moments {
    Moments::new(PI * a * b * length, 0.0, [a * a / 4.0, b * b / 4.0, length * length / 12.0])
}

/// Filled between the two radii.
pub(super) fn solid_tube(outer: f64, inner: f64, length: f64) -> Moments {
    // outer² − inner² as a product, which keeps its digits for a thin wall.
    let area = PI * (outer - inner) * (outer + inner);
    let mean_square = (outer * outer + inner * inner) / 4.0;
    Moments::new(area * length, 0.0, [mean_square, mean_square, length * length / 12.0])
}

/// Both mantles and both end rings.
pub(super) fn tube_surface(outer: f64, inner: f64, length: f64) -> Moments {
    let end = disc(outer, inner).raised(length / 2.0);
    Moments::join([
        frustum::mantle(outer, outer, [1.0, 1.0], length),
        frustum::mantle(inner, inner, [1.0, 1.0], length),
        end,
        end.flipped(),
    ])
}
