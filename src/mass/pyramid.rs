//! Pyramid on a rectangle: base at −z/2, tip at +z/2.

use super::moments::Moments;

/// Filled, with base edges and height, m. Sections shrink as (1 − u) over the height u, so that the means of (1 − u)⁴,
/// u and u² over (1 − u)² give it.
pub(super) fn solid([x, y, z]: [f64; 3]) -> Moments {
    Moments::new(x * y * z / 3.0, -z / 4.0, [x * x / 20.0, y * y / 20.0, 3.0 / 80.0 * z * z])
}
