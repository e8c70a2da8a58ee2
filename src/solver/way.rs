//! Impulses along two rows against their disc.

use super::rows::Row;

/// Within a disc of this radius.
pub(super) fn shorten(rows: &mut [Row], radius: f64) {
    let size = rows.iter().map(|r| r.impulse * r.impulse).sum::<f64>().sqrt();
    if size > radius {
        rows.iter_mut().for_each(|r| r.impulse *= radius / size);
    }
}

pub(super) fn length(x: [f64; 2]) -> f64 {
    (x[0] * x[0] + x[1] * x[1]).sqrt()
}

/// Where an impulse of two rows is in its disc.
pub(super) enum Way {
    Inside,
    Rim { direction: [f64; 2], stiffness: f64 },
}

impl Way {
    pub fn of(x: [f64; 2], u: [f64; 2], step: f64, radius: f64) -> Self {
        let to = [x[0] - step * u[0], x[1] - step * u[1]];
        let size = length(to);
        if size <= radius {
            return Self::Inside;
        }
        Self::Rim { direction: to.map(|t| t / size), stiffness: (size - radius) / (radius * step) }
    }
}
