//! Corners around round shapes, for engines that know them only as polyhedra.

use crate::math::{V3, sin_cos};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Corners around a rim; their flats are 1 − cos(π/48) = 0.2 % of the radius too low.
pub const AROUND: u32 = 48;

/// `around` corners of the ellipse with the half axes `a`, `b` at the height `z`; one if it is a point. m.
pub fn rim([a, b]: [f64; 2], z: f64, around: u32) -> Vec<V3<f64>> {
    let corner = |k: u32| {
        let (s, c) = sin_cos(TAU * f64::from(k) / f64::from(around));
        V3::new(a * c, b * s, z)
    };
    if a == 0.0 && b == 0.0 { vec![corner(0)] } else { (0..around).map(corner).collect() }
}

/// Corners of an ellipsoid whose centre is at the height `z`: `along` bands from pole to pole. m.
pub fn ellipsoid([a, b, c]: [f64; 3], z: f64, (around, along): (u32, u32)) -> Vec<V3<f64>> {
    let ring = |k: u32| {
        let (s, up) = sin_cos(FRAC_PI_2 * (2.0 * f64::from(k) / f64::from(along) - 1.0));
        let at = if k == 0 || k == along { [0.0; 2] } else { [a * up, b * up] };
        rim(at, z + c * s, around)
    };
    (0..=along).flat_map(ring).collect()
}
