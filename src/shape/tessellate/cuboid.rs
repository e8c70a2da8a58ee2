//! Boxes, sharp or with rounded edges and corners.

use super::patch::Patches;
use crate::math::{Vec3, sin_cos};
use crate::shape::TriMesh;
use std::f64::consts::FRAC_PI_2;

/// A box of full edge lengths `size`: the balls of radius `fillet` around all points of a smaller box. `quarter`
/// segments round an edge, `flat` divide each straight one.
pub(super) fn cuboid(size: [f64; 3], fillet: f64, quarter: u32, flat: u32) -> TriMesh {
    let rounded = Rounded {
        half: Vec3::from(size).map(|s| (s / 2.0 - fillet).max(0.0)),
        fillet,
        // A sharp edge needs no segments: all of a corner falls into one point.
        quarter: if fillet > 0.0 { quarter } else { 1 },
        flat,
    };
    let mut patches = Patches::default();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            rounded.face(axis, sign, &mut patches);
        }
        for signs in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
            rounded.edge(axis, signs, &mut patches);
        }
    }
    for i in 0..8_u32 {
        rounded.corner(Vec3::from_fn(|axis, _| if i >> axis & 1 == 0 { 1.0 } else { -1.0 }), &mut patches);
    }
    patches.mesh()
}

struct Rounded {
    /// Half edge lengths of the inner box.
    half: Vec3,
    fillet: f64,
    quarter: u32,
    flat: u32,
}

impl Rounded {
    /// Where the ball of a point on the inner box touches the surface.
    fn at(&self, inner: Vec3, normal: Vec3) -> Vec3 {
        inner + normal * self.fillet
    }

    /// The inner edge along `axis`, from −half to half, both ends exact.
    fn along(&self, axis: usize, i: u32) -> f64 {
        2.0 * self.half[axis] * (f64::from(i) / f64::from(self.flat)) - self.half[axis]
    }

    fn face(&self, axis: usize, sign: f64, patches: &mut Patches) {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let at = |i: u32, j: u32| {
            let mut inner = Vec3::zeros();
            inner[axis] = sign * self.half[axis];
            (inner[a], inner[b]) = (self.along(a, j), self.along(b, i));
            self.at(inner, Vec3::ith(axis, sign))
        };
        patches.grid([self.flat, self.flat], at, sign < 0.0);
    }

    fn edge(&self, axis: usize, [sign_a, sign_b]: [f64; 2], patches: &mut Patches) {
        // In the order that `corner` uses, so that its borders are these to the bit.
        let (a, b) = [(1, 2), (0, 2), (0, 1)][axis];
        let at = |i: u32, j: u32| {
            let (sine, cosine) = quarter_turn(j, self.quarter);
            let mut inner = Vec3::zeros();
            (inner[axis], inner[a], inner[b]) = (self.along(axis, i), sign_a * self.half[a], sign_b * self.half[b]);
            let mut normal = Vec3::zeros();
            (normal[a], normal[b]) = (sign_a * cosine, sign_b * sine);
            self.at(inner, normal)
        };
        let left_handed = axis == 1;
        patches.grid([self.flat, self.quarter], at, (sign_a * sign_b < 0.0) != left_handed);
    }

    fn corner(&self, signs: Vec3, patches: &mut Patches) {
        let at = |row: u32, i: u32| {
            let (up, out) = quarter_turn(row, self.quarter);
            let (sine, cosine) = quarter_turn(i, self.quarter - row);
            let normal = Vec3::new(out * cosine, out * sine, up);
            self.at(self.half.component_mul(&signs), normal.component_mul(&signs))
        };
        patches.triangular_grid(self.quarter, at, signs.product() < 0.0);
    }
}

/// Sine and cosine of `i` of `n` parts of a quarter turn, exact at both ends.
fn quarter_turn(i: u32, n: u32) -> (f64, f64) {
    if i == 0 {
        (0.0, 1.0)
    } else if i >= n {
        (1.0, 0.0)
    } else {
        sin_cos(FRAC_PI_2 * (f64::from(i) / f64::from(n)))
    }
}
