//! Oil tank: a cylinder between two caps of a sphere.
//!
//! A cap of rim radius r and height c has at u = 0 … 1 of its height the section radius ρ² = (1 − u)(r² + c²u): its
//! moments are polynomials in r² and c² with positive terms, which lose no digits however flat the cap is.

use super::moments::Moments;
use super::{cylinder, frustum};
use std::f64::consts::PI;

/// Filled; `length` is the part between the caps, m.
pub(super) fn solid(radius: f64, length: f64, cap_height: f64) -> Moments {
    let cap = solid_cap(radius, cap_height).raised(length / 2.0);
    Moments::join([cap, cylinder::solid(radius, radius, length), cap.flipped()])
}

/// Its whole surface.
pub(super) fn surface(radius: f64, length: f64, cap_height: f64) -> Moments {
    let cap = cap_surface(radius, cap_height).raised(length / 2.0);
    Moments::join([cap, frustum::mantle(radius, radius, [1.0, 1.0], length), cap.flipped()])
}

/// Rim at z = 0, pole at z = c.
fn solid_cap(r: f64, c: f64) -> Moments {
    let (r2, c2) = (r * r, c * c);
    let area = r2 / 2.0 + c2 / 6.0;
    let u = (r2 / 6.0 + c2 / 12.0) / area;
    let u2 = (r2 / 12.0 + c2 / 20.0) / area;
    let across = (r2 * r2 / 3.0 + r2 * c2 / 6.0 + c2 * c2 / 30.0) / area / 4.0;
    Moments::new(PI * c * area, c * u, [across, across, c2 * (u2 - u * u)])
}

/// Its area lies evenly over its height (Archimedes).
fn cap_surface(r: f64, c: f64) -> Moments {
    let (r2, c2) = (r * r, c * c);
    let across = (r2 / 2.0 + c2 / 6.0) / 2.0;
    Moments::new(PI * (r2 + c2), c / 2.0, [across, across, c2 / 12.0])
}
