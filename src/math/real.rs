//! The scalar of the kernels: one source for a plain f64, a fused one, and (later) lanes of worlds.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// What a kernel needs of its scalar.
pub trait Real:
    Copy
    + Default
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// A model constant, in every lane.
    fn of(x: f64) -> Self;
    /// `self·b + c`; the type says whether it rounds once or twice.
    fn mad(self, b: Self, c: Self) -> Self;
    /// Sine and cosine, the same bits on every machine.
    fn sin_cos(self) -> (Self, Self);
    /// Is it of several lanes?
    const SEVERAL: bool = false;
    /// `self` in the lanes where `mask` is not 0, `other` in the others.
    fn blend(self, other: Self, mask: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn of(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn mad(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        super::sin_cos(self)
    }
    #[inline(always)]
    fn blend(self, other: Self, mask: Self) -> Self {
        if mask == 0.0 { other } else { self }
    }
}

/// f64 with fused multiply-add. Use it only inside functions compiled with the `fma` target feature: elsewhere
/// `mul_add` is a library call, eight times slower.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Fma(pub f64);

macro_rules! operator {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Fma {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $op other.0)
            }
        }
    };
}
operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Neg for Fma {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}
impl AddAssign for Fma {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}
impl SubAssign for Fma {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.0 -= other.0;
    }
}

impl Real for Fma {
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self(x)
    }
    #[inline(always)]
    fn mad(self, b: Self, c: Self) -> Self {
        Self(self.0.mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = super::sin_cos(self.0);
        (Self(s), Self(c))
    }
    #[inline(always)]
    fn blend(self, other: Self, mask: Self) -> Self {
        if mask.0 == 0.0 { other } else { self }
    }
}
