//! Rotations of the kernels: any 3×3 matrix, or one with the zeros of a hinge that lies along an axis of its parent's frame.
//!
//! Both do the same operations in the same order but for products with those zeros, so a result has the same bits either way
//! (a zero may change its sign). The zeros are more than a quarter of the arithmetic of a hinge.

use super::articulated::Art;
use super::joint::turned_z;
use crate::math::{M3, Real, S3, V3};

/// Rotation `R` from the child's axes to the parent's.
pub(crate) trait Turn<T: Real>: Copy {
    /// `R v`.
    fn mv(&self, v: V3<T>) -> V3<T>;
    /// `Rᵀ v`.
    fn tv(&self, v: V3<T>) -> V3<T>;
    /// `R S Rᵀ`.
    fn rotated(&self, s: &S3<T>) -> S3<T>;
    /// `R Rz(q)`, of its sine and cosine.
    fn turned_z(&self, turn: (T, T)) -> Self;
    /// All its numbers.
    fn matrix(&self) -> M3<T>;
    /// `R J Rᵀ` of a J whose z row and column are zero, `R [h0; h1; 0] Rᵀ`, and M, about an origin that lies at −p.
    fn flat(&self, j: [T; 3], h: [V3<T>; 2], m: S3<T>, p: V3<T>) -> Art<T>;
}

impl<T: Real> Turn<T> for M3<T> {
    #[inline(always)]
    fn mv(&self, v: V3<T>) -> V3<T> {
        M3::mv(self, v)
    }

    #[inline(always)]
    fn tv(&self, v: V3<T>) -> V3<T> {
        M3::tv(self, v)
    }

    #[inline(always)]
    fn rotated(&self, s: &S3<T>) -> S3<T> {
        S3::rotated(s, self)
    }

    #[inline(always)]
    fn turned_z(&self, turn: (T, T)) -> Self {
        turned_z(self, turn)
    }

    #[inline(always)]
    fn matrix(&self) -> M3<T> {
        *self
    }

    #[inline(always)]
    fn flat(&self, [xx, xy, yy]: [T; 3], h: [V3<T>; 2], m: S3<T>, p: V3<T>) -> Art<T> {
        let (c0, c1) = (self.col0(), self.col1());
        let (a, b) = (c1.mad(xy, c0 * xx), c1.mad(yy, c0 * xy));
        let j = S3 {
            xx: a.x.mad(c0.x, b.x * c1.x),
            xy: a.x.mad(c0.y, b.x * c1.y),
            xz: a.x.mad(c0.z, b.x * c1.z),
            yy: a.y.mad(c0.y, b.y * c1.y),
            yz: a.y.mad(c0.z, b.y * c1.z),
            zz: a.z.mad(c0.z, b.z * c1.z),
        };
        let (g0, g1) = (self.mv(h[0]), self.mv(h[1]));
        let h = M3::rows(
            g0.mad(self.r[0].x, g1 * self.r[0].y),
            g0.mad(self.r[1].x, g1 * self.r[1].y),
            g0.mad(self.r[2].x, g1 * self.r[2].y),
        );
        Art { j, h, m: self.rotated(&m) }.moved(p)
    }
}

/// `$use`, with `$turn` the rotation `$r` (an [`M3`]) of a hinge that lies along this axis of its parent's frame, if along any.
macro_rules! with_turn {
    ($along:expr, $r:expr, $turn:ident => $use:expr) => {
        match $along {
            Some($crate::model::Along::X) => {
                let $turn = &$crate::dynamics::turn::Planar::<_, 0>::of($r);
                $use
            }
            Some($crate::model::Along::Y) => {
                let $turn = &$crate::dynamics::turn::Planar::<_, 1>::of($r);
                $use
            }
            Some($crate::model::Along::Z) => {
                let $turn = &$crate::dynamics::turn::Planar::<_, 2>::of($r);
                $use
            }
            None => {
                let $turn = $r;
                $use
            }
        }
    };
}

pub(crate) use with_turn;

/// A rotation whose column z is ± the `K`th axis of the parent: of each other row the first two numbers, in ascending order of
/// the rows, and the sign.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planar<T, const K: usize> {
    first: Pair<T>,
    second: Pair<T>,
    sign: T,
}

// No closures here: in a function of other target features they would be calls.
#[derive(Clone, Copy, Debug)]
struct Pair<T> {
    x: T,
    y: T,
}

impl<T: Real> Pair<T> {
    #[inline(always)]
    fn of(v: V3<T>) -> Self {
        Self { x: v.x, y: v.y }
    }

    #[inline(always)]
    fn dot(self, x: T, y: T) -> T {
        self.x.mad(x, self.y * y)
    }

    #[inline(always)]
    fn turned_z(self, s: T, c: T) -> Self {
        Self { x: self.x.mad(c, self.y * s), y: self.y.mad(c, -(self.x * s)) }
    }

    /// `[xx xy; xy yy] (x, y)`.
    #[inline(always)]
    fn times(self, xx: T, xy: T, yy: T) -> Self {
        Self { x: self.y.mad(xy, self.x * xx), y: self.y.mad(yy, self.x * xy) }
    }

    /// `S (x, y, 0)`.
    #[inline(always)]
    fn through(self, s: &S3<T>) -> V3<T> {
        V3::new(s.xx.mad(self.x, s.xy * self.y), s.xy.mad(self.x, s.yy * self.y), s.xz.mad(self.x, s.yz * self.y))
    }

    #[inline(always)]
    fn combine(self, g0: V3<T>, g1: V3<T>) -> V3<T> {
        g0.mad(self.x, g1 * self.y)
    }
}

impl<T: Real, const K: usize> Planar<T, K> {
    const FIRST: usize = if K == 0 { 1 } else { 0 };
    const SECOND: usize = if K == 2 { 1 } else { 2 };

    /// That has these numbers; the others must be zero.
    #[inline(always)]
    pub fn of(r: &M3<T>) -> Self {
        Self { first: Pair::of(r.r[Self::FIRST]), second: Pair::of(r.r[Self::SECOND]), sign: r.r[K].z }
    }

    /// A symmetric matrix of the parent: (first, first), (first, second), (second, second); along the hinge with first, second
    /// and itself.
    #[inline(always)]
    fn symmetric([ff, fs, ss]: [T; 3], [af, a_s, aa]: [T; 3]) -> S3<T> {
        match K {
            0 => S3 { xx: aa, xy: af, xz: a_s, yy: ff, yz: fs, zz: ss },
            1 => S3 { xx: ff, xy: af, xz: fs, yy: aa, yz: a_s, zz: ss },
            _ => S3 { xx: ff, xy: fs, xz: af, yy: ss, yz: a_s, zz: aa },
        }
    }
}

impl<T: Real, const K: usize> Turn<T> for Planar<T, K> {
    #[inline(always)]
    fn mv(&self, v: V3<T>) -> V3<T> {
        let (first, second, along) = (self.first.dot(v.x, v.y), self.second.dot(v.x, v.y), self.sign * v.z);
        match K {
            0 => V3::new(along, first, second),
            1 => V3::new(first, along, second),
            _ => V3::new(first, second, along),
        }
    }

    #[inline(always)]
    fn tv(&self, v: V3<T>) -> V3<T> {
        let (first, second, along) = match K {
            0 => (v.y, v.z, v.x),
            1 => (v.x, v.z, v.y),
            _ => (v.x, v.y, v.z),
        };
        V3::new(
            self.first.x.mad(first, self.second.x * second),
            self.first.y.mad(first, self.second.y * second),
            self.sign * along,
        )
    }

    #[inline(always)]
    fn rotated(&self, s: &S3<T>) -> S3<T> {
        let (a, b) = (self.first, self.second);
        let (f, g) = (a.through(s), b.through(s));
        let flat = [a.dot(f.x, f.y), b.dot(f.x, f.y), b.dot(g.x, g.y)];
        Self::symmetric(flat, [f.z * self.sign, g.z * self.sign, s.zz])
    }

    #[inline(always)]
    fn turned_z(&self, (s, c): (T, T)) -> Self {
        Self { first: self.first.turned_z(s, c), second: self.second.turned_z(s, c), sign: self.sign }
    }

    #[inline(always)]
    fn matrix(&self) -> M3<T> {
        let o = T::of(0.0);
        let (first, second, along) = (
            V3::new(self.first.x, self.first.y, o),
            V3::new(self.second.x, self.second.y, o),
            V3::new(o, o, self.sign),
        );
        match K {
            0 => M3::rows(along, first, second),
            1 => M3::rows(first, along, second),
            _ => M3::rows(first, second, along),
        }
    }

    #[inline(always)]
    fn flat(&self, [xx, xy, yy]: [T; 3], [h0, h1]: [V3<T>; 2], m: S3<T>, p: V3<T>) -> Art<T> {
        let (a, b, o) = (self.first, self.second, T::of(0.0));
        let (f, g) = (a.times(xx, xy, yy), b.times(xx, xy, yy));
        let j = Self::symmetric([f.dot(a.x, a.y), f.dot(b.x, b.y), g.dot(b.x, b.y)], [o, o, o]);
        let (g0, g1) = (self.mv(h0), self.mv(h1));
        let (first, second, along) = (a.combine(g0, g1), b.combine(g0, g1), V3::default());
        let h = match K {
            0 => M3::rows(along, first, second),
            1 => M3::rows(first, along, second),
            _ => M3::rows(first, second, along),
        };
        Art { j, h, m: self.rotated(&m) }.moved_flat::<K>(p)
    }
}
