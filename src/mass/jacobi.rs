//! Eigenvalues and eigenvectors of a symmetric 3×3 matrix by cyclic Jacobi rotations (B-12).

use super::Principal;
use crate::math::{Mat3, Vec3};

/// Sweeps after which a matrix is taken as it is; five do for any of finite numbers.
const SWEEPS: usize = 40;

/// Principal moments of `inertia` (kg·m²), ascending, and their axes.
///
/// A rotation is left out only when its element is small against the geometric mean of its two diagonal elements, not
/// against the largest: that keeps the digits of a small moment beside large ones.
pub(super) fn principal(inertia: &Mat3) -> Principal {
    let mut a = *inertia;
    let mut axes = Mat3::identity();
    for _ in 0..SWEEPS {
        let mut turned = false;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            turned |= rotate(&mut a, &mut axes, p, q);
        }
        if !turned {
            break;
        }
    }
    sorted(&a, &axes)
}

/// Makes the element (p, q) zero; false if it was nothing already.
fn rotate(a: &mut Mat3, axes: &mut Mat3, p: usize, q: usize) -> bool {
    let off = a[(p, q)];
    let scale = a[(p, p)].abs().sqrt() * a[(q, q)].abs().sqrt();
    if off == 0.0 || off.abs() <= f64::EPSILON / 4.0 * scale {
        return false;
    }
    // Tangent of the smaller of the two angles that do it.
    let theta = (a[(q, q)] - a[(p, p)]) / (2.0 * off);
    let tan = theta.signum() / (theta.abs() + libm::hypot(theta, 1.0));
    let cos = 1.0 / libm::hypot(tan, 1.0);
    let sin = tan * cos;
    let third = 3 - p - q;
    let (rp, rq) = (a[(third, p)], a[(third, q)]);
    a[(p, p)] -= tan * off;
    a[(q, q)] += tan * off;
    for (i, j, value) in [(p, q, 0.0), (third, p, cos * rp - sin * rq), (third, q, sin * rp + cos * rq)] {
        a[(i, j)] = value;
        a[(j, i)] = value;
    }
    for i in 0..3 {
        let (vp, vq) = (axes[(i, p)], axes[(i, q)]);
        axes[(i, p)] = cos * vp - sin * vq;
        axes[(i, q)] = sin * vp + cos * vq;
    }
    true
}

fn sorted(a: &Mat3, axes: &Mat3) -> Principal {
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[(i, i)].total_cmp(&a[(j, j)]));
    let moments = Vec3::from_fn(|i, _| a[(order[i], order[i])]);
    let mut axes = Mat3::from_fn(|i, j| axes[(i, order[j])]);
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    Principal { moments, axes }
}
