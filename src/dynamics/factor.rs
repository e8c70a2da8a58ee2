//! Square roots of the inverse inertias that the elimination leaves.

use super::Workspace;
use super::articulated::Spatial;
use super::ball::{Ball, BallIn};
use crate::math::{M3, S3, V3};
use crate::model::{JointType, Model};

/// What is left of a locked direction of a spherical joint after the others have been taken out of it, relative: less
/// is a lock that depends on those before it.
const DEPENDENT: f64 = 1e-12;

/// A root of the mobility of a floating body, `IA⁻¹ = Wᵀ W`, by the Schur complement of M.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FloatingRoot {
    /// `W` of M.
    linear: M3<f64>,
    /// `H M⁻¹`.
    lever: M3<f64>,
    /// `W` of `J − H M⁻¹ Hᵀ`.
    angular: M3<f64>,
    /// H.
    h: M3<f64>,
}

impl FloatingRoot {
    /// Of a body's articulated inertia after the inward pass.
    #[inline]
    pub fn of(ws: &Workspace<f64>, body: usize) -> Self {
        let ia = &ws.acc[body].ia;
        let h = ia.h;
        let linear = inverse_root(&ia.m);
        let m = |row: V3<f64>| linear.tv(linear.mv(row));
        let lever = M3::rows(m(h.r[0]), m(h.r[1]), m(h.r[2]));
        let mut j = ia.j;
        j.xx -= lever.r[0].dot(h.r[0]);
        j.xy -= lever.r[0].dot(h.r[1]);
        j.xz -= lever.r[0].dot(h.r[2]);
        j.yy -= lever.r[1].dot(h.r[1]);
        j.yz -= lever.r[1].dot(h.r[2]);
        j.zz -= lever.r[2].dot(h.r[2]);
        Self { linear, lever, angular: inverse_root(&j), h }
    }

    /// `W u`.
    #[inline]
    pub fn response(&self, u: Spatial<f64>) -> Spatial<f64> {
        Spatial { a: self.angular.mv(u.a - self.lever.mv(u.l)), l: self.linear.mv(u.l) }
    }

    /// `IA⁻¹ u`.
    pub fn acceleration(&self, u: Spatial<f64>) -> Spatial<f64> {
        let a = self.angular.tv(self.angular.mv(u.a - self.lever.mv(u.l)));
        Spatial { a, l: self.linear.tv(self.linear.mv(u.l - self.h.tv(a))) }
    }
}

/// A matrix W with `P = Wᵀ W`, where P is the mobility of a spherical joint whose locked directions are taken out:
/// `W = (1 − Q Qᵀ) Lᵀ` with `D⁻¹ = L Lᵀ` and Q an orthonormal basis of `Lᵀ G`. So what a lock holds has no response at all,
/// which a factorisation of P itself would lose in rounding.
pub(super) fn ball_root(ball: &Ball<f64>, input: &BallIn<f64>) -> M3<f64> {
    let upper = transposed(&cholesky(&ball.inverse));
    let mut basis = [V3::default(); 3];
    let mut known = 0;
    for lock in &input.lock[..input.locks] {
        let full = upper.mv(lock.gradient);
        let rest = without(without(full, &basis[..known]), &basis[..known]);
        if rest.dot(rest) > DEPENDENT * full.dot(full) {
            basis[known] = rest * (1.0 / rest.dot(rest).sqrt());
            known += 1;
        }
    }
    let column = |c: V3<f64>| without(c, &basis[..known]);
    transposed(&M3::rows(column(upper.col0()), column(upper.col1()), column(upper.col2())))
}

/// Number of floating joints before each body.
pub(super) fn floating_index(m: &Model) -> (Vec<usize>, usize) {
    let mut count = 0;
    let index = m.bodies.iter().enumerate().map(|(i, b)| {
        let here = count;
        count += usize::from(i > 0 && b.joint == JointType::Floating);
        here
    });
    (index.collect(), count)
}

fn without(mut v: V3<f64>, basis: &[V3<f64>]) -> V3<f64> {
    for b in basis {
        v -= *b * b.dot(v);
    }
    v
}

fn transposed(m: &M3<f64>) -> M3<f64> {
    M3::rows(m.col0(), m.col1(), m.col2())
}

/// Lower triangular L with `S = L Lᵀ`; S positive definite.
fn cholesky(s: &S3<f64>) -> M3<f64> {
    let a = s.xx.sqrt();
    let (b, c) = (s.xy / a, s.xz / a);
    let d = (s.yy - b * b).sqrt();
    let e = (s.yz - c * b) / d;
    let f = (s.zz - c * c - e * e).sqrt();
    M3::rows(V3::new(a, 0.0, 0.0), V3::new(b, d, 0.0), V3::new(c, e, f))
}

/// Lower triangular W with `S⁻¹ = Wᵀ W`: the inverse of the Cholesky factor.
fn inverse_root(s: &S3<f64>) -> M3<f64> {
    let l = cholesky(s);
    let (a, d, f) = (1.0 / l.r[0].x, 1.0 / l.r[1].y, 1.0 / l.r[2].z);
    let b = -l.r[1].x * a * d;
    let e = -l.r[2].y * d * f;
    let c = -(l.r[2].x * a + l.r[2].y * b) * f;
    M3::rows(V3::new(a, 0.0, 0.0), V3::new(b, d, 0.0), V3::new(c, e, f))
}
