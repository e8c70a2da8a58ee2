//! Flat surfaces with straight edges.

use super::patch::Patches;
use crate::math::Vec3;
use crate::shape::TriMesh;

/// A rectangle of full sizes in the XY plane, facing +Z.
pub(super) fn plane([x, y]: [f64; 2], flat: u32) -> TriMesh {
    let mut patches = Patches::default();
    let along = |size: f64, i: u32| size * (f64::from(i) / f64::from(flat)) - size / 2.0;
    patches.grid([flat, flat], |i, j| Vec3::new(along(x, j), along(y, i), 0.0), false);
    patches.mesh()
}

/// A triangle, each edge in `flat` parts.
pub(super) fn triangle(corners: &[[f64; 3]; 3], flat: u32) -> TriMesh {
    let mut patches = Patches::default();
    divided(corners.map(Vec3::from), flat, &mut patches);
    patches.mesh()
}

/// Two triangles, a b c and a c d, each edge in `flat` parts.
pub(super) fn quad(corners: &[[f64; 3]; 4], flat: u32) -> TriMesh {
    let [a, b, c, d] = corners.map(Vec3::from);
    let mut patches = Patches::default();
    divided([a, b, c], flat, &mut patches);
    divided([a, c, d], flat, &mut patches);
    patches.mesh()
}

/// Points of an edge depend on its two ends only, so that neighbours meet to the bit.
fn divided([a, b, c]: [Vec3; 3], flat: u32, patches: &mut Patches) {
    let part = |i: u32| f64::from(i) / f64::from(flat);
    let at = |row: u32, i: u32| a * part(flat - row - i) + (b * part(i) + c * part(row));
    patches.triangular_grid(flat, at, false);
}
