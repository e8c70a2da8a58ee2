//! How often a surface goes around a point.

use crate::math::Vec3;

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Side {
    Inside,
    Outside,
    /// So near that rounding decides.
    OnSurface,
}

/// Where a point lies, by the sum of the solid angles that the triangles of a closed surface fill; whichever way it
/// faces. Van Oosterom and Strackee's formula, IEEE Trans. Biomed. Eng. 30 (1983).
pub(super) fn side_of(point: Vec3, triangles: impl Iterator<Item = [Vec3; 3]>) -> Side {
    let half_angles = triangles.map(|corners| {
        let [a, b, c] = corners.map(|p| p - point);
        let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
        let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        a.dot(&b.cross(&c)).atan2(below)
    });
    let turns = half_angles.sum::<f64>() / std::f64::consts::TAU;
    // Away from the surface the number is whole but for rounding; on it, it is the part of a sphere that lies inside.
    match (turns - turns.round()).abs() < 1e-6 {
        true if turns.round() != 0.0 => Side::Inside,
        true => Side::Outside,
        false => Side::OnSurface,
    }
}
