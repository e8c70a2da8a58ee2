//! Torus around Z, by Pappus: ring radius `ring`, pipe radius `pipe`, m.

use super::moments::Moments;
use std::f64::consts::PI;

/// Filled.
pub(super) fn solid(ring: f64, pipe: f64) -> Moments {
    let (ring2, pipe2) = (ring * ring, pipe * pipe);
    let across = (ring2 + 0.75 * pipe2) / 2.0;
    Moments::new(2.0 * PI * PI * ring * pipe2, 0.0, [across, across, pipe2 / 4.0])
}

/// Its surface.
pub(super) fn surface(ring: f64, pipe: f64) -> Moments {
    let (ring2, pipe2) = (ring * ring, pipe * pipe);
    let across = (ring2 + 1.5 * pipe2) / 2.0;
    Moments::new(4.0 * PI * PI * ring * pipe, 0.0, [across, across, pipe2 / 2.0])
}
