//! Exact integration over triangle meshes (B-12).

use super::flat::{square, triangle};
use super::moments::Moments;
use crate::math::{Mat3, Vec3};
use crate::shape::TriMesh;

/// The inside of a closed mesh that faces outwards: signed tetrahedra between each triangle and a point near the
/// middle. `None` if they add up to no volume that stands out from rounding.
pub(super) fn solid(mesh: &TriMesh) -> Option<Moments> {
    let apex = middle(mesh)?;
    let parts = mesh.triangles.iter().map(|&t| tetrahedron(apex, mesh.corners(t)));
    let gross: f64 = parts.clone().map(|p| p.measure.abs()).sum();
    let whole = Moments::join(parts);
    (whole.measure > ROUNDING * gross).then_some(whole)
}

/// All triangles as a surface. `None` if they have no area.
pub(super) fn surface(mesh: &TriMesh) -> Option<Moments> {
    let whole = Moments::join(mesh.triangles.iter().map(|&t| triangle(mesh.corners(t))));
    (whole.measure > 0.0).then_some(whole)
}

/// A determinant of three rounded differences is off by at most this part of the product of the lengths; tetrahedra of
/// a mesh of no volume cancel down to it.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Middle of the bounds of the triangles.
fn middle(mesh: &TriMesh) -> Option<Vec3> {
    let mut used = mesh.triangles.iter().flatten().map(|i| mesh.vertices[*i as usize]);
    let first = used.next()?;
    let (low, high) = used.fold((first, first), |(l, h), v| (l.inf(&v), h.sup(&v)));
    Some(low / 2.0 + high / 2.0)
}

/// The mean of d dᵀ over a tetrahedron is a twentieth of the sum of the same over its corners, d measured from the
/// centre.
fn tetrahedron(apex: Vec3, [a, b, c]: [Vec3; 3]) -> Moments {
    let measure = (a - apex).cross(&(b - apex)).dot(&(c - apex)) / 6.0;
    let center = (apex + a + b + c) / 4.0;
    let covariance = [apex, a, b, c].iter().fold(Mat3::zeros(), |sum, p| sum + square(p - center)) / 20.0;
    Moments { measure, center, covariance }
}
