//! Elliptic frustum; an elliptic cone is one whose top section has shrunk to a point.
//!
//! Derivation: the section at u = 0 … 1 of the height is an ellipse of semi-axes a·s, b·s with
//! s = s₀ + (s₁ − s₀)u. Its area is πab·s² and its mean square of x is a²s²/4, so that the volume needs ∫s² du, the
//! mean square of x ∫s⁴ du, and the height ∫u s² du and ∫u² s² du: polynomials in s₀ and s₁. On the mantle the surface
//! element is s·g(φ) du dφ with g² = L²(b²cos²φ + a²sin²φ) + (ab(s₁ − s₀))², so that height and circumference
//! separate too.

use super::moments::Moments;
use crate::math::sin_cos;
use std::f64::consts::{PI, TAU};

/// Filled; semi-axes `a`, `b` of the base at −length/2, the top section scaled by `top_scale` ≥ 0.
pub(super) fn solid(a: f64, b: f64, top_scale: f64, length: f64) -> Moments {
    solid_between(a, b, [1.0, top_scale], length)
}

/// Filled, between sections scaled by `s0` at −length/2 and `s1` at +length/2; not both 0.
pub(super) fn solid_between(a: f64, b: f64, [s0, s1]: [f64; 2], length: f64) -> Moments {
    let s2 = (s0 * s0 + s0 * s1 + s1 * s1) / 3.0;
    let s4 = (s0.powi(4) + s0.powi(3) * s1 + s0 * s0 * s1 * s1 + s0 * s1.powi(3) + s1.powi(4)) / 5.0;
    let u = (s0 * s0 + 2.0 * s0 * s1 + 3.0 * s1 * s1) / 12.0 / s2;
    let u2 = (s0 * s0 + 3.0 * s0 * s1 + 6.0 * s1 * s1) / 30.0 / s2;
    let across = s4 / s2 / 4.0;
    Moments::new(
        PI * a * b * s2 * length,
        length * (u - 0.5),
        [a * a * across, b * b * across, length * length * (u2 - u * u)],
    )
}

/// Mantle and both end discs.
pub(super) fn surface(a: f64, b: f64, top_scale: f64, length: f64) -> Moments {
    Moments::join([
        mantle(a, b, [1.0, top_scale], length),
        disc(a, b).raised(-length / 2.0),
        disc(a * top_scale, b * top_scale).raised(length / 2.0),
    ])
}

/// The curved surface between sections scaled by `s0` at −length/2 and `s1` at +length/2; not both 0.
pub(super) fn mantle(a: f64, b: f64, [s0, s1]: [f64; 2], length: f64) -> Moments {
    let s = (s0 + s1) / 2.0;
    let s3 = (s0.powi(3) + s0 * s0 * s1 + s0 * s1 * s1 + s1.powi(3)) / 4.0;
    let u = (s0 + 2.0 * s1) / 6.0 / s;
    let u2 = (s0 + 3.0 * s1) / 12.0 / s;
    let ring = circumference(a * length, b * length, a * b * (s1 - s0));
    Moments::new(
        s * ring.whole,
        length * (u - 0.5),
        [a * a * s3 / s * ring.cos2, b * b * s3 / s * ring.sin2, length * length * (u2 - u * u)],
    )
}

/// A flat ellipse at z = 0.
fn disc(a: f64, b: f64) -> Moments {
    Moments::new(PI * a * b, 0.0, [a * a / 4.0, b * b / 4.0, 0.0])
}

/// ∫g dφ over the circumference, and the means of cos²φ and sin²φ weighted with g.
struct Circumference {
    whole: f64,
    cos2: f64,
    sin2: f64,
}

/// The trapezium rule on a periodic analytic integrand converges geometrically, and is exact for a round section.
fn circumference(a: f64, b: f64, slope: f64) -> Circumference {
    if a == 0.0 && slope == 0.0 {
        return Circumference { whole: 0.0, cos2: 0.5, sin2: 0.5 };
    }
    let mut last = circumference_by(8, a, b, slope);
    for doubling in 4..=20 {
        let next = circumference_by(1 << doubling, a, b, slope);
        let settled = (next.whole - last.whole).abs() <= 1e-15 * next.whole && (next.cos2 - last.cos2).abs() <= 1e-15;
        last = next;
        if settled {
            break;
        }
    }
    last
}

fn circumference_by(points: u32, a: f64, b: f64, slope: f64) -> Circumference {
    let (mut whole, mut cos2) = (0.0, 0.0);
    for k in 0..points {
        let (sin, cos) = sin_cos(TAU * f64::from(k) / f64::from(points));
        let g = ((b * cos).powi(2) + (a * sin).powi(2) + slope * slope).sqrt();
        whole += g;
        cos2 += g * cos * cos;
    }
    Circumference { whole: whole * TAU / f64::from(points), cos2: cos2 / whole, sin2: 1.0 - cos2 / whole }
}
