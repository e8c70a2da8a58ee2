//! Vectors and matrices of the kernels: 3-vectors, 3×3 matrices by rows, packed symmetric 3×3 matrices.

use super::Real;
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// 3-vector.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct V3<T> {
    /// First.
    pub x: T,
    /// Second.
    pub y: T,
    /// Third.
    pub z: T,
}

/// 3×3 matrix, `r` its rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct M3<T> {
    /// Rows.
    pub r: [V3<T>; 3],
}

/// Symmetric 3×3 matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)]
#[repr(C)]
pub struct S3<T> {
    pub xx: T,
    pub xy: T,
    pub xz: T,
    pub yy: T,
    pub yz: T,
    pub zz: T,
}

impl<T: Real> V3<T> {
    /// From components.
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }
    /// A model constant.
    #[inline(always)]
    pub fn of(v: V3<f64>) -> Self {
        Self::new(T::of(v.x), T::of(v.y), T::of(v.z))
    }
    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, b: Self) -> T {
        self.x.mad(b.x, self.y.mad(b.y, self.z * b.z))
    }
    /// Vector product.
    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self::new(self.y.mad(b.z, -(self.z * b.y)), self.z.mad(b.x, -(self.x * b.z)), self.x.mad(b.y, -(self.y * b.x)))
    }
    /// `self × b + c`.
    #[inline(always)]
    pub fn cross_add(self, b: Self, c: Self) -> Self {
        Self::new(
            self.y.mad(b.z, (-self.z).mad(b.y, c.x)),
            self.z.mad(b.x, (-self.x).mad(b.z, c.y)),
            self.x.mad(b.y, (-self.y).mad(b.x, c.z)),
        )
    }
    /// `self·s + c`.
    #[inline(always)]
    pub fn mad(self, s: T, c: Self) -> Self {
        Self::new(self.x.mad(s, c.x), self.y.mad(s, c.y), self.z.mad(s, c.z))
    }
}

impl<T: Real> Add for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}
impl<T: Real> Sub for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}
impl<T: Real> Neg for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
impl<T: Real> Mul<T> for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: T) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}
impl<T: Real> AddAssign for V3<T> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}
impl<T: Real> SubAssign for V3<T> {
    #[inline(always)]
    fn sub_assign(&mut self, b: Self) {
        *self = *self - b;
    }
}

impl<T: Real> M3<T> {
    /// From rows.
    #[inline(always)]
    pub fn rows(a: V3<T>, b: V3<T>, c: V3<T>) -> Self {
        Self { r: [a, b, c] }
    }
    /// A model constant.
    #[inline(always)]
    pub fn of(m: &M3<f64>) -> Self {
        Self::rows(V3::of(m.r[0]), V3::of(m.r[1]), V3::of(m.r[2]))
    }
    /// The unit matrix.
    #[inline(always)]
    pub fn identity() -> Self {
        let (o, l) = (T::of(0.0), T::of(1.0));
        Self::rows(V3::new(l, o, o), V3::new(o, l, o), V3::new(o, o, l))
    }
    /// First column.
    #[inline(always)]
    pub fn col0(&self) -> V3<T> {
        V3::new(self.r[0].x, self.r[1].x, self.r[2].x)
    }
    /// Second column.
    #[inline(always)]
    pub fn col1(&self) -> V3<T> {
        V3::new(self.r[0].y, self.r[1].y, self.r[2].y)
    }
    /// Third column.
    #[inline(always)]
    pub fn col2(&self) -> V3<T> {
        V3::new(self.r[0].z, self.r[1].z, self.r[2].z)
    }
    /// `M v`.
    #[inline(always)]
    pub fn mv(&self, v: V3<T>) -> V3<T> {
        V3::new(self.r[0].dot(v), self.r[1].dot(v), self.r[2].dot(v))
    }
    /// `Mᵀ v`.
    #[inline(always)]
    pub fn tv(&self, v: V3<T>) -> V3<T> {
        self.r[0].mad(v.x, self.r[1].mad(v.y, self.r[2] * v.z))
    }
    /// `M N`.
    #[inline(always)]
    pub fn mm(&self, n: &Self) -> Self {
        Self::rows(n.tv(self.r[0]), n.tv(self.r[1]), n.tv(self.r[2]))
    }
    /// `Mᵀ N`.
    #[inline(always)]
    pub fn tmm(&self, n: &Self) -> Self {
        let (x, y, z) = (self.tv(n.col0()), self.tv(n.col1()), self.tv(n.col2()));
        Self::rows(V3::new(x.x, y.x, z.x), V3::new(x.y, y.y, z.y), V3::new(x.z, y.z, z.z))
    }
    /// `M Nᵀ`.
    #[inline(always)]
    pub fn mmt(&self, n: &Self) -> Self {
        Self::rows(n.mv(self.r[0]), n.mv(self.r[1]), n.mv(self.r[2]))
    }
}

impl<T: Real> S3<T> {
    /// A model constant.
    #[inline(always)]
    pub fn of(s: &S3<f64>) -> Self {
        let f = T::of;
        Self { xx: f(s.xx), xy: f(s.xy), xz: f(s.xz), yy: f(s.yy), yz: f(s.yz), zz: f(s.zz) }
    }
    /// Row 0.
    #[inline(always)]
    pub fn row0(&self) -> V3<T> {
        V3::new(self.xx, self.xy, self.xz)
    }
    /// Row 1.
    #[inline(always)]
    pub fn row1(&self) -> V3<T> {
        V3::new(self.xy, self.yy, self.yz)
    }
    /// Row 2.
    #[inline(always)]
    pub fn row2(&self) -> V3<T> {
        V3::new(self.xz, self.yz, self.zz)
    }
    /// `S v`.
    #[inline(always)]
    pub fn mv(&self, v: V3<T>) -> V3<T> {
        V3::new(self.row0().dot(v), self.row1().dot(v), self.row2().dot(v))
    }
    /// `R S Rᵀ`.
    #[inline(always)]
    pub fn rotated(&self, r: &M3<T>) -> Self {
        let a = M3::rows(self.mv(r.r[0]), self.mv(r.r[1]), self.mv(r.r[2]));
        Self {
            xx: a.r[0].dot(r.r[0]),
            xy: a.r[0].dot(r.r[1]),
            xz: a.r[0].dot(r.r[2]),
            yy: a.r[1].dot(r.r[1]),
            yz: a.r[1].dot(r.r[2]),
            zz: a.r[2].dot(r.r[2]),
        }
    }
    /// `self − a bᵀ`, for a and b parallel (so that it stays symmetric).
    #[inline(always)]
    pub fn sub_outer(&mut self, a: V3<T>, b: V3<T>) {
        self.xx = (-a.x).mad(b.x, self.xx);
        self.xy = (-a.x).mad(b.y, self.xy);
        self.xz = (-a.x).mad(b.z, self.xz);
        self.yy = (-a.y).mad(b.y, self.yy);
        self.yz = (-a.y).mad(b.z, self.yz);
        self.zz = (-a.z).mad(b.z, self.zz);
    }
    /// Inverse of a positive definite matrix (by cofactors; 3×3 only).
    #[inline(always)]
    pub fn inverse(&self) -> Self {
        let a = self.yy.mad(self.zz, -(self.yz * self.yz));
        let b = self.xz.mad(self.yz, -(self.xy * self.zz));
        let c = self.xy.mad(self.yz, -(self.xz * self.yy));
        let d = T::of(1.0) / self.xx.mad(a, self.xy.mad(b, self.xz * c));
        Self {
            xx: a * d,
            xy: b * d,
            xz: c * d,
            yy: self.xx.mad(self.zz, -(self.xz * self.xz)) * d,
            yz: self.xy.mad(self.xz, -(self.xx * self.yz)) * d,
            zz: self.xx.mad(self.yy, -(self.xy * self.xy)) * d,
        }
    }
}
impl<T: Real> AddAssign for S3<T> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        self.xx += b.xx;
        self.xy += b.xy;
        self.xz += b.xz;
        self.yy += b.yy;
        self.yz += b.yz;
        self.zz += b.zz;
    }
}

impl From<[f64; 3]> for V3<f64> {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self::new(x, y, z)
    }
}
impl From<crate::math::Vec3> for V3<f64> {
    fn from(v: crate::math::Vec3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}
impl From<V3<f64>> for crate::math::Vec3 {
    fn from(v: V3<f64>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}
impl From<crate::math::Mat3> for M3<f64> {
    fn from(m: crate::math::Mat3) -> Self {
        let r = |i: usize| V3::new(m[(i, 0)], m[(i, 1)], m[(i, 2)]);
        Self::rows(r(0), r(1), r(2))
    }
}
impl From<M3<f64>> for crate::math::Mat3 {
    fn from(m: M3<f64>) -> Self {
        Self::from_columns(&[m.col0().into(), m.col1().into(), m.col2().into()])
    }
}
impl From<S3<f64>> for crate::math::Mat3 {
    fn from(s: S3<f64>) -> Self {
        Self::new(s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz)
    }
}
impl From<crate::math::Mat3> for S3<f64> {
    /// Takes the upper triangle.
    fn from(m: crate::math::Mat3) -> Self {
        Self { xx: m[(0, 0)], xy: m[(0, 1)], xz: m[(0, 2)], yy: m[(1, 1)], yz: m[(1, 2)], zz: m[(2, 2)] }
    }
}
