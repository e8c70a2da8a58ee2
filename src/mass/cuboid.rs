//! Box, with sharp or rounded edges.
//!
//! A box with fillets is a smaller box (half edges p) grown by a ball of radius f. It mirrors itself in three planes,
//! so that one octant tells it: along each axis a part lies either within the core, where positions spread evenly from
//! 0 to p, or in the rounding, at p + d with known means of d and d².

use super::ellipsoid::octant;
use super::moments::Moments;
use super::rules::crowded;
use crate::math::sin_cos;
use std::f64::consts::{FRAC_PI_2, PI};

/// Filled, with full edge lengths `size`, m.
pub(super) fn solid([a, b, c]: [f64; 3]) -> Moments {
    Moments::new(a * b * c, 0.0, [a * a / 12.0, b * b / 12.0, c * c / 12.0])
}

/// Its six faces.
pub(super) fn surface(size: [f64; 3]) -> Moments {
    let [a, b, c] = size;
    let pair = [2.0 * b * c, 2.0 * c * a, 2.0 * a * b];
    let area: f64 = pair.iter().sum();
    // Along axis i the two end faces stand at ±size/2 and the other four spread evenly between them.
    let mean_square = |i: usize| size[i] * size[i] * (pair[i] / 4.0 + (area - pair[i]) / 12.0) / area;
    Moments::new(area, 0.0, [mean_square(0), mean_square(1), mean_square(2)])
}

/// Where an octant's part lies along one axis.
#[derive(Clone, Copy)]
enum Lies {
    Core,
    /// Means of d and d², m and m².
    Beyond(f64, f64),
}

/// All eight images of a part of an octant; `measure` is of one.
fn mirrored(measure: f64, core: [f64; 3], lies: [Lies; 3]) -> Moments {
    let mean_square = |i: usize| match lies[i] {
        Lies::Core => core[i] * core[i] / 3.0,
        Lies::Beyond(mean, square) => core[i] * (core[i] + 2.0 * mean) + square,
    };
    Moments::new(8.0 * measure, 0.0, [mean_square(0), mean_square(1), mean_square(2)])
}

/// Half edges of the core.
fn core(size: [f64; 3], fillet: f64) -> [f64; 3] {
    size.map(|edge| (edge / 2.0 - fillet).max(0.0))
}

/// Parts of an octant by axis: `face` for the slab on axis i, `edge` for the rounding along axis i.
fn parts(
    core: [f64; 3],
    face: impl Fn(usize) -> (f64, Lies),
    edge: impl Fn(usize) -> (f64, Lies, Lies),
) -> Vec<Moments> {
    let mut parts = Vec::with_capacity(6);
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let (measure, out) = face(i);
        let mut lies = [Lies::Core; 3];
        lies[i] = out;
        parts.push(mirrored(measure, core, lies));
        let (measure, at_j, at_k) = edge(i);
        lies[i] = Lies::Core;
        (lies[j], lies[k]) = (at_j, at_k);
        parts.push(mirrored(measure, core, lies));
    }
    parts
}

/// Filled, edges rounded by `f` > 0.
pub(super) fn solid_rounded(size: [f64; 3], f: f64) -> Moments {
    let p = core(size, f);
    let quarter = Lies::Beyond(4.0 / (3.0 * PI) * f, f * f / 4.0);
    let eighth = Lies::Beyond(3.0 / 8.0 * f, f * f / 5.0);
    let slab = |i: usize| (p[(i + 1) % 3] * p[(i + 2) % 3] * f, Lies::Beyond(f / 2.0, f * f / 3.0));
    let mut all = parts(p, slab, |i| (p[i] * PI / 4.0 * f * f, quarter, quarter));
    all.push(mirrored(p[0] * p[1] * p[2], p, [Lies::Core; 3]));
    all.push(mirrored(PI / 6.0 * f * f * f, p, [eighth; 3]));
    Moments::join(all)
}

/// The surface of a box rounded by `f` > 0 and then stretched.
pub(super) fn surface_rounded(size: [f64; 3], f: f64, stretch: [f64; 3]) -> Moments {
    let s = stretch.map(f64::abs);
    let p = core(size, f);
    let p = [p[0] * s[0], p[1] * s[1], p[2] * s[2]];
    let r = s.map(|factor| factor * f);
    let face = |i: usize| (p[(i + 1) % 3] * p[(i + 2) % 3], Lies::Beyond(r[i], r[i] * r[i]));
    let edge = |i: usize| {
        let (length, at_j, at_k) = quarter_ellipse(r[(i + 1) % 3], r[(i + 2) % 3]);
        (p[i] * length, at_j, at_k)
    };
    let mut all = parts(p, face, edge);
    let ball = if r[0] == r[1] && r[1] == r[2] { None } else { Some(octant(r)) };
    all.push(match ball {
        None => mirrored(FRAC_PI_2 * r[0] * r[0], p, [Lies::Beyond(r[0] / 2.0, r[0] * r[0] / 3.0); 3]),
        Some(o) => mirrored(o.area, p, [0, 1, 2].map(|i| Lies::Beyond(o.mean[i], o.mean_square[i]))),
    });
    Moments::join(all)
}

/// A quarter of an ellipse: its length, and where it lies along its semi-axes.
fn quarter_ellipse(a: f64, b: f64) -> (f64, Lies, Lies) {
    if a == b {
        let lies = Lies::Beyond(a / FRAC_PI_2, a * a / 2.0);
        return (FRAC_PI_2 * a, lies, lies);
    }
    let (mut length, mut mean, mut square) = (0.0, [0.0; 2], [0.0; 2]);
    for &(weight, t) in crowded() {
        let (sin, cos) = sin_cos(t * FRAC_PI_2);
        let weight = weight * ((a * sin).powi(2) + (b * cos).powi(2)).sqrt();
        length += weight;
        for (i, at) in [a * cos, b * sin].into_iter().enumerate() {
            mean[i] += weight * at;
            square[i] += weight * at * at;
        }
    }
    let lies = |i: usize| Lies::Beyond(mean[i] / length, square[i] / length);
    (FRAC_PI_2 * length, lies(0), lies(1))
}
