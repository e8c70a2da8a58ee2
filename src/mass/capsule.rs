//! Uniform and tapered capsule: a frustum between two half spheres, as the source defines it.
//!
//! Where the radii differ this is not the hull of two spheres: the mantle meets the half spheres at their rims.

use super::ellipsoid::{hemisphere_surface, solid_hemisphere};
use super::frustum;
use super::moments::Moments;

/// Filled; `length` is the part between the half spheres, m. Not both radii 0.
pub(super) fn solid(top: f64, bottom: f64, length: f64) -> Moments {
    Moments::join([
        solid_hemisphere(top).raised(length / 2.0),
        frustum::solid_between(1.0, 1.0, [bottom, top], length),
        solid_hemisphere(bottom).flipped().raised(-length / 2.0),
    ])
}

/// Its whole surface.
pub(super) fn surface(top: f64, bottom: f64, length: f64) -> Moments {
    Moments::join([
        hemisphere_surface(top).raised(length / 2.0),
        frustum::mantle(1.0, 1.0, [bottom, top], length),
        hemisphere_surface(bottom).flipped().raised(-length / 2.0),
    ])
}
