//! Surfaces of revolution, whole or sliced, with any outline, stretched along the axes.
//!
//! With factors a, b, c along X, Y, Z the point at t along the outline and φ around is (aρ cos φ, bρ sin φ, cz), and
//! the surface element ρ·√((bc z′ cos φ)² + (ac z′ sin φ)² + (ab ρ′)²) dt dφ. It bends sharply only where sin φ,
//! cos φ, z′ or ρ′ pass through zero, however thin or flat the shape: the ranges are cut there, and the tanh–sinh rule
//! crowds its points at the cuts. Where nothing bends, Gauss–Legendre is exact.

use super::lathe_solid::cut_faces;
use super::moments::Moments;
use super::rules::{Node, crowded, gauss, quarters};
use super::section::cut;
use crate::math::{Mat3, Vec3, sin_cos};
use crate::shape::{Lathe, Piece};
use std::f64::consts::FRAC_PI_2;

/// The whole surface, with the cut faces of a slice.
pub(super) fn surface(lathe: &Lathe) -> Moments {
    let pieces = lathe.pieces.iter().flat_map(cut).map(|piece| strip(&piece, lathe));
    Moments::join(pieces.chain(cut_faces(lathe)).collect::<Vec<_>>())
}

/// A point along a piece: weight, position and slope.
struct Along {
    weight: f64,
    at: [f64; 2],
    slope: [f64; 2],
}

/// An angle around: weight, cosine and sine.
#[derive(Clone, Copy)]
struct Around {
    weight: f64,
    cos: f64,
    sin: f64,
}

/// What one piece sweeps.
fn strip(piece: &Piece, lathe: &Lathe) -> Moments {
    let [a, b, c] = lathe.stretch.map(f64::abs);
    let flat = matches!(piece, Piece::Line { from, to } if from[1] == to[1]);
    let along =
        along(piece, if matches!(piece, Piece::Line { .. }) || (a == b && b == c) { gauss() } else { crowded() });
    let around = around(lathe.slice, if flat || a == b { gauss() } else { crowded() });
    let whole = lathe.slice.is_none();
    let spot = |p: &Along, o: Around| {
        let ([rho, z], [rho_slope, z_slope]) = (p.at, p.slope);
        let upright = (b * c * z_slope * o.cos).powi(2) + (a * c * z_slope * o.sin).powi(2);
        let element = rho * (upright + (a * b * rho_slope).powi(2)).sqrt();
        let weight = p.weight * o.weight * element;
        let [x, y, z] = [a * rho * o.cos, b * rho * o.sin, c * z];
        if whole {
            // The four points that mirror each other about the XZ and YZ planes.
            return Moments::new(4.0 * weight, z, [x * x, y * y, 0.0]);
        }
        Moments { measure: weight, center: Vec3::new(x, y, z), covariance: Mat3::zeros() }
    };
    let spots = along.iter().flat_map(|p| around.iter().map(move |o| spot(p, *o)));
    Moments::join(spots).stretched(lathe.stretch.map(f64::signum), 1.0)
}

fn along(piece: &Piece, rule: &[Node]) -> Vec<Along> {
    rule.iter().map(|&(weight, t)| Along { weight, at: piece.at(t), slope: piece.slope(t) }).collect()
}

/// Of a full turn the first quarter only; the others mirror it.
fn around(slice: Option<[f64; 2]>, rule: &[Node]) -> Vec<Around> {
    let parts = slice.map_or(vec![[0.0, FRAC_PI_2]], |[from, to]| quarters(from, to));
    let part = |[from, to]: [f64; 2]| {
        rule.iter().map(move |&(weight, t)| {
            let (sin, cos) = sin_cos(from + (to - from) * t);
            Around { weight: weight * (to - from), cos, sin }
        })
    };
    parts.into_iter().flat_map(part).collect()
}
