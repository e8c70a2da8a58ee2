//! Box.

use super::moments::Moments;

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
