//! Quadrature rules on the interval from 0 to 1, and where to cut a range of angles.

use crate::math::sin_cos;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

/// Weight and point.
pub(super) type Node = (f64, f64);

/// Gauss–Legendre, 16 points: exact for polynomials up to degree 31; on a quarter turn, sines and cosines of up to five
/// times the angle to rounding.
pub(super) fn gauss() -> &'static [Node] {
    static RULE: LazyLock<Vec<Node>> = LazyLock::new(|| (0..GAUSS_POINTS).map(gauss_node).collect());
    &RULE
}

const GAUSS_POINTS: u32 = 16;

/// The k-th root of the Legendre polynomial, by Newton's method, and its weight.
fn gauss_node(k: u32) -> Node {
    let degree = f64::from(GAUSS_POINTS);
    let mut x = sin_cos(PI * (f64::from(k) + 0.75) / (degree + 0.5)).1;
    let mut slope = 1.0;
    // Quadratic convergence from a guess that is off by less than 1e-3: six steps are more than enough.
    for _ in 0..6 {
        let (mut before, mut value) = (1.0, x);
        for n in 2..=GAUSS_POINTS {
            let n = f64::from(n);
            (before, value) = (value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n);
        }
        slope = degree * (x * value - before) / (x * x - 1.0);
        x -= value / slope;
    }
    (1.0 / ((1.0 - x * x) * slope * slope), (1.0 + x) / 2.0)
}

/// The tanh–sinh rule. It crowds points at both ends, where the surface element of a flat or thin shape bends sharply.
pub(super) fn crowded() -> &'static [Node] {
    const STEP: f64 = 1.0 / 24.0;
    static RULE: LazyLock<Vec<Node>> = LazyLock::new(|| {
        (-84..=84)
            .map(|k| {
                let t = f64::from(k) * STEP;
                let s = FRAC_PI_2 * libm::sinh(t);
                let weight = STEP * FRAC_PI_2 * libm::cosh(t) / libm::cosh(s).powi(2) / 2.0;
                (weight, 1.0 / (1.0 + libm::exp(-2.0 * s)))
            })
            .collect()
    });
    &RULE
}

/// A range of angles in rad, cut where a sine or cosine passes through zero: parts [from, to].
pub(super) fn quarters(from: f64, to: f64) -> Vec<[f64; 2]> {
    let mut cuts = vec![from];
    let mut k = (from / FRAC_PI_2).floor() + 1.0;
    // A turn has at most five cuts; the count bounds angles too large for k to grow by 1.
    while k * FRAC_PI_2 < to && cuts.len() < 8 {
        cuts.push(k * FRAC_PI_2);
        k += 1.0;
    }
    cuts.push(to);
    cuts.windows(2).map(|w| [w[0], w[1]]).collect()
}
