//! Lanes: numbers of several robots in one value, so that one pass of a kernel serves them all.
//!
//! Every lane has the bits that the scalar has: the same operations in the same order, and no fusing unless the scalar fuses.

use super::Real;
use super::sincos::{EXACT, sin_cos};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A [`Real`] of several lanes.
///
/// # Safety
/// The type is [`Lane::COUNT`] numbers of type f64 in a row, and any bits make a value of it.
pub unsafe trait Lane: Real {
    /// Lanes.
    const COUNT: usize;

    /// The lanes as numbers.
    #[inline(always)]
    fn numbers(&self) -> &[f64] {
        // SAFETY: an implementor is that many numbers in a row.
        unsafe { std::slice::from_raw_parts(std::ptr::from_ref(self).cast(), Self::COUNT) }
    }

    /// Of as many numbers as there are lanes.
    #[inline(always)]
    fn read(x: &[f64]) -> Self {
        let mut lanes = Self::of(0.0);
        lanes.numbers_mut().copy_from_slice(x);
        lanes
    }

    /// The same, to write.
    #[inline(always)]
    fn numbers_mut(&mut self) -> &mut [f64] {
        // SAFETY: an implementor is that many numbers in a row, and the borrow is exclusive.
        unsafe { std::slice::from_raw_parts_mut(std::ptr::from_mut(self).cast(), Self::COUNT) }
    }

    /// Of as many as there are lanes: number k of value i becomes number i of value k.
    #[inline(always)]
    fn transpose(block: &mut [Self]) {
        for i in 1..Self::COUNT {
            for k in 0..i {
                let (a, b) = (block[i].numbers()[k], block[k].numbers()[i]);
                (block[i].numbers_mut()[k], block[k].numbers_mut()[i]) = (b, a);
            }
        }
    }
}

/// Four lanes without vector instructions of a certain machine: for those that have none of the others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Lanes4(pub [f64; 4]);

impl Lanes4 {
    /// Of four numbers.
    #[cfg(not(target_arch = "x86_64"))]
    pub(crate) fn from_numbers(x: [f64; 4]) -> Self {
        Self(x)
    }
}

// SAFETY: repr(transparent) over four numbers.
unsafe impl Lane for Lanes4 {
    const COUNT: usize = 4;
}

macro_rules! operator {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Lanes4 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                let (a, b) = (self.0, o.0);
                Self([a[0] $op b[0], a[1] $op b[1], a[2] $op b[2], a[3] $op b[3]])
            }
        }
    };
}
operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Neg for Lanes4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let a = self.0;
        Self([-a[0], -a[1], -a[2], -a[3]])
    }
}
impl AddAssign for Lanes4 {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl SubAssign for Lanes4 {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl Real for Lanes4 {
    const SEVERAL: bool = true;
    #[inline(always)]
    fn blend(self, other: Self, mask: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].blend(other.0[k], mask.0[k])))
    }
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self([x; 4])
    }
    #[inline(always)]
    fn mad(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let a = self.0;
        let (p, q, r, s) = (sin_cos(a[0]), sin_cos(a[1]), sin_cos(a[2]), sin_cos(a[3]));
        (Self([p.0, q.0, r.0, s.0]), Self([p.1, q.1, r.1, s.1]))
    }
}

/// Sine and cosine lane by lane, where the reduction of one of them is not exact (beyond [`EXACT`], or not a number).
#[cold]
#[inline(never)]
pub(super) fn one_by_one(x: &[f64], s: &mut [f64], c: &mut [f64]) {
    for ((x, s), c) in x.iter().zip(s).zip(c) {
        (*s, *c) = sin_cos(*x);
    }
}

/// Up to here the lanes reduce together.
pub(super) const TOGETHER: f64 = EXACT;

#[cfg(test)]
mod tests {
    use super::{Lane, Lanes4, Real};

    fn arithmetic<T: Lane>() {
        let mut x = T::of(0.0);
        let mut values = [0.1, -3.7, 8.0e5, 2.5e6, -1.0e7, f64::NAN, 1.0e300, -0.0].iter().cycle();
        for start in 0..4 {
            values.by_ref().take(start).for_each(drop);
            x.numbers_mut().iter_mut().zip(values.by_ref()).for_each(|(x, v)| *x = *v);
            let (s, c) = x.sin_cos();
            let (neg, mad, quotient) = (-x, x.mad(s, c), c / x);
            for (k, x) in x.numbers().iter().enumerate() {
                let (s0, c0) = x.sin_cos();
                let (s0, c0) = if x.is_nan() { (s0, c0) } else { Real::sin_cos(*x) };
                let own = [s.numbers()[k], c.numbers()[k], neg.numbers()[k], mad.numbers()[k], quotient.numbers()[k]];
                let scalar = [s0, c0, -x, Real::mad(*x, s0, c0), c0 / x];
                for (a, b) in own.iter().zip(scalar) {
                    assert!(a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan(), "{x}: {a} {b}");
                }
            }
        }
    }

    fn turned<T: Lane>() {
        let mut block = vec![T::of(0.0); T::COUNT];
        let numbers = block.iter_mut().flat_map(Lane::numbers_mut);
        numbers.enumerate().for_each(|(n, x)| *x = n as f64);
        T::transpose(&mut block);
        for (k, x) in block.iter().enumerate() {
            let column: Vec<f64> = (0..T::COUNT).map(|i| (i * T::COUNT + k) as f64).collect();
            assert_eq!(x.numbers(), column);
            let (mask, other) = (T::read(&column), T::of(-1.0));
            let chosen: Vec<f64> = column.iter().map(|x| if *x == 0.0 { -1.0 } else { *x }).collect();
            assert_eq!(x.blend(other, mask).numbers(), chosen);
        }
    }

    #[test]
    fn blocks_are_transposed_and_lanes_chosen() {
        turned::<Lanes4>();
        #[cfg(target_arch = "x86_64")]
        {
            if crate::math::X4::<false>::is_available() {
                turned::<crate::math::X4<false>>();
            }
            if crate::math::X8::<false>::is_available() {
                turned::<crate::math::X8<false>>();
            }
        }
    }

    #[test]
    fn every_lane_has_the_bits_of_the_scalar() {
        arithmetic::<Lanes4>();
        #[cfg(target_arch = "x86_64")]
        {
            if crate::math::X4::<false>::is_available() {
                arithmetic::<crate::math::X4<false>>();
            }
            if crate::math::X8::<false>::is_available() {
                arithmetic::<crate::math::X8<false>>();
            }
        }
    }

    #[test]
    fn sines_of_many_angles_have_the_bits_of_the_scalar() {
        #[cfg(target_arch = "x86_64")]
        for k in 0..20_000 {
            let x = (f64::from(k) - 10_000.0) * 1.234_567;
            let same = |(s, c): (f64, f64)| {
                let (s0, c0) = Real::sin_cos(x);
                assert!(s.to_bits() == s0.to_bits() && c.to_bits() == c0.to_bits(), "{x}");
            };
            if crate::math::X4::<false>::is_available() {
                let (s, c) = crate::math::X4::<false>::of(x).sin_cos();
                same((s.numbers()[3], c.numbers()[2]));
            }
            if crate::math::X8::<false>::is_available() {
                let (s, c) = crate::math::X8::<false>::of(x).sin_cos();
                same((s.numbers()[7], c.numbers()[5]));
            }
        }
    }
}
