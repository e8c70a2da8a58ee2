//! Lanes in the vector registers of x86-64: four with AVX2, eight with AVX-512. `FUSED` says whether [`Real::mad`] rounds
//! once (as [`super::Fma`]) or twice (as f64).
//!
//! An operator may not demand a target feature, so every one of them is an `unsafe` call of an intrinsic: make values of
//! these types only where `is_available` has said yes, in functions compiled with the features (else no call is inlined).

use super::Real;
use super::lanes::{Lane, TOGETHER, one_by_one};
use super::sincos::octant;
use std::arch::x86_64::*;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Four lanes; needs AVX2 and FMA.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct X4<const FUSED: bool>(__m256d);

/// Eight lanes; needs AVX-512F.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct X8<const FUSED: bool>(__m512d);

impl<const FUSED: bool> X4<FUSED> {
    /// Has this machine what it needs?
    pub fn is_available() -> bool {
        std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
    }
}

impl X4<false> {
    /// Of four numbers; only where `is_available` has said yes.
    #[inline(always)]
    pub(crate) fn from_numbers(x: [f64; 4]) -> Self {
        // SAFETY: the machine has AVX, and the numbers are there to be read.
        Self(unsafe { _mm256_loadu_pd(x.as_ptr()) })
    }
}

impl<const FUSED: bool> X8<FUSED> {
    /// Has this machine what it needs?
    pub fn is_available() -> bool {
        X4::<FUSED>::is_available() && std::arch::is_x86_feature_detected!("avx512f")
    }
}

macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl<const FUSED: bool> $trait for $type<FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                // SAFETY: a value of this type exists, so the machine has the feature.
                Self(unsafe { $intrinsic(self.0, o.0) })
            }
        }
    };
}

macro_rules! lanes {
    ($type:ident, $count:literal, $set1:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $fmadd:ident) => {
        // SAFETY: repr(transparent) over a register of that many numbers.
        unsafe impl<const FUSED: bool> Lane for $type<FUSED> {
            const COUNT: usize = $count;
            #[inline(always)]
            fn transpose(block: &mut [Self]) {
                if let Ok(block) = block.try_into() {
                    Self::turn(block);
                }
            }
        }
        operator!($type, Add, add, $add);
        operator!($type, Sub, sub, $sub);
        operator!($type, Mul, mul, $mul);
        operator!($type, Div, div, $div);
        impl<const FUSED: bool> Default for $type<FUSED> {
            #[inline(always)]
            fn default() -> Self {
                Self::of(0.0)
            }
        }
        impl<const FUSED: bool> AddAssign for $type<FUSED> {
            #[inline(always)]
            fn add_assign(&mut self, o: Self) {
                *self = *self + o;
            }
        }
        impl<const FUSED: bool> SubAssign for $type<FUSED> {
            #[inline(always)]
            fn sub_assign(&mut self, o: Self) {
                *self = *self - o;
            }
        }
        impl<const FUSED: bool> Real for $type<FUSED> {
            const SEVERAL: bool = true;
            #[inline(always)]
            fn blend(self, other: Self, mask: Self) -> Self {
                self.choose(other, mask)
            }
            #[inline(always)]
            fn of(x: f64) -> Self {
                // SAFETY: only called where `is_available` has said yes.
                Self(unsafe { $set1(x) })
            }
            #[inline(always)]
            fn mad(self, b: Self, c: Self) -> Self {
                if FUSED {
                    // SAFETY: a value of this type exists, so the machine has the feature.
                    Self(unsafe { $fmadd(self.0, b.0, c.0) })
                } else {
                    self * b + c
                }
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                if self.is_far() {
                    let (mut s, mut c) = (self, self);
                    one_by_one(self.numbers(), s.numbers_mut(), c.numbers_mut());
                    return (s, c);
                }
                let (turns, s, c) = octant(self);
                turns.put(s, c)
            }
        }
    };
}
lanes!(X4, 4, _mm256_set1_pd, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd, _mm256_fmadd_pd);
lanes!(X8, 8, _mm512_set1_pd, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd, _mm512_fmadd_pd);

impl<const FUSED: bool> Neg for X4<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: a value of this type exists, so the machine has AVX.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

impl<const FUSED: bool> Neg for X8<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: a value of this type exists, so the machine has AVX-512F.
        unsafe {
            let flipped = _mm512_xor_si512(_mm512_castpd_si512(self.0), _mm512_set1_epi64(i64::MIN));
            Self(_mm512_castsi512_pd(flipped))
        }
    }
}

impl<const FUSED: bool> X4<FUSED> {
    /// See [`Lane::transpose`].
    #[inline(always)]
    fn turn(block: &mut [Self; 4]) {
        let [Self(a), Self(b), Self(c), Self(d)] = *block;
        // SAFETY: values of this type exist, so the machine has AVX.
        unsafe {
            let (ab, cd) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
            block[0].0 = _mm256_permute2f128_pd::<0x20>(ab, cd);
            block[2].0 = _mm256_permute2f128_pd::<0x31>(ab, cd);
            let (ab, cd) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
            block[1].0 = _mm256_permute2f128_pd::<0x20>(ab, cd);
            block[3].0 = _mm256_permute2f128_pd::<0x31>(ab, cd);
        }
    }

    /// See [`Real::blend`].
    #[inline(always)]
    fn choose(self, other: Self, mask: Self) -> Self {
        // SAFETY: a value of this type exists, so the machine has AVX.
        unsafe {
            let chosen = _mm256_cmp_pd::<_CMP_NEQ_UQ>(mask.0, _mm256_setzero_pd());
            Self(_mm256_blendv_pd(other.0, self.0, chosen))
        }
    }

    /// Is a lane beyond what is reduced together, or not a number?
    #[inline(always)]
    fn is_far(self) -> bool {
        // SAFETY: a value of this type exists, so the machine has AVX.
        unsafe {
            let size = _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0);
            _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_NLE_UQ>(size, _mm256_set1_pd(TOGETHER))) != 0
        }
    }

    /// Sine and cosine of the whole angle, where `self` counts quarter turns in its last bits: an odd number swaps them, and
    /// the second bit is the sign.
    #[inline(always)]
    fn put(self, s: Self, c: Self) -> (Self, Self) {
        // SAFETY: a value of this type exists, so the machine has AVX2.
        unsafe {
            let turns = _mm256_castpd_si256(self.0);
            let odd = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(turns));
            let sine = _mm256_blendv_pd(s.0, c.0, odd);
            let cosine = _mm256_blendv_pd(c.0, s.0, odd);
            let next = _mm256_add_epi64(turns, _mm256_set1_epi64x(1));
            (Self(signed4(sine, turns)), Self(signed4(cosine, next)))
        }
    }
}

impl<const FUSED: bool> X8<FUSED> {
    /// See [`Lane::transpose`].
    #[inline(always)]
    fn turn(block: &mut [Self; 8]) {
        let [Self(a), Self(b), Self(c), Self(d), Self(e), Self(f), Self(g), Self(h)] = *block;
        // SAFETY: values of this type exist, so the machine has AVX-512F.
        unsafe {
            let even = [
                _mm512_unpacklo_pd(a, b),
                _mm512_unpacklo_pd(c, d),
                _mm512_unpacklo_pd(e, f),
                _mm512_unpacklo_pd(g, h),
            ];
            [block[0].0, block[2].0, block[4].0, block[6].0] = quarters(even);
            let odd = [
                _mm512_unpackhi_pd(a, b),
                _mm512_unpackhi_pd(c, d),
                _mm512_unpackhi_pd(e, f),
                _mm512_unpackhi_pd(g, h),
            ];
            [block[1].0, block[3].0, block[5].0, block[7].0] = quarters(odd);
        }
    }

    /// See [`Real::blend`].
    #[inline(always)]
    fn choose(self, other: Self, mask: Self) -> Self {
        // SAFETY: a value of this type exists, so the machine has AVX-512F.
        unsafe {
            let chosen = _mm512_cmp_pd_mask::<_CMP_NEQ_UQ>(mask.0, _mm512_setzero_pd());
            Self(_mm512_mask_blend_pd(chosen, other.0, self.0))
        }
    }

    /// As [`X4::is_far`].
    #[inline(always)]
    fn is_far(self) -> bool {
        // SAFETY: a value of this type exists, so the machine has AVX-512F.
        unsafe { _mm512_cmp_pd_mask::<_CMP_NLE_UQ>(_mm512_abs_pd(self.0), _mm512_set1_pd(TOGETHER)) != 0 }
    }

    /// As [`X4::put`].
    #[inline(always)]
    fn put(self, s: Self, c: Self) -> (Self, Self) {
        // SAFETY: a value of this type exists, so the machine has AVX-512F.
        unsafe {
            let turns = _mm512_castpd_si512(self.0);
            let odd = _mm512_test_epi64_mask(turns, _mm512_set1_epi64(1));
            let sine = _mm512_mask_blend_pd(odd, s.0, c.0);
            let cosine = _mm512_mask_blend_pd(odd, c.0, s.0);
            let next = _mm512_add_epi64(turns, _mm512_set1_epi64(1));
            (Self(signed8(sine, turns)), Self(signed8(cosine, next)))
        }
    }
}

/// Of four values of four pairs each: the first pairs, the second ones …
///
/// # Safety
/// Needs AVX-512F.
#[inline(always)]
unsafe fn quarters([a, b, c, d]: [__m512d; 4]) -> [__m512d; 4] {
    // SAFETY: the caller has the feature.
    unsafe {
        let (ab, cd) = (_mm512_shuffle_f64x2::<0x88>(a, b), _mm512_shuffle_f64x2::<0x88>(c, d));
        let (ef, gh) = (_mm512_shuffle_f64x2::<0xdd>(a, b), _mm512_shuffle_f64x2::<0xdd>(c, d));
        [
            _mm512_shuffle_f64x2::<0x88>(ab, cd),
            _mm512_shuffle_f64x2::<0x88>(ef, gh),
            _mm512_shuffle_f64x2::<0xdd>(ab, cd),
            _mm512_shuffle_f64x2::<0xdd>(ef, gh),
        ]
    }
}

/// Negates the lanes whose count of quarter turns has its second bit set.
///
/// # Safety
/// Needs AVX2.
#[inline(always)]
unsafe fn signed4(x: __m256d, turns: __m256i) -> __m256d {
    // SAFETY: the caller has the feature.
    unsafe {
        let sign = _mm256_and_pd(_mm256_set1_pd(-0.0), _mm256_castsi256_pd(_mm256_slli_epi64::<62>(turns)));
        _mm256_xor_pd(x, sign)
    }
}

/// As [`signed4`].
///
/// # Safety
/// Needs AVX-512F.
#[inline(always)]
unsafe fn signed8(x: __m512d, turns: __m512i) -> __m512d {
    // SAFETY: the caller has the feature.
    unsafe {
        let sign = _mm512_and_si512(_mm512_set1_epi64(i64::MIN), _mm512_slli_epi64::<62>(turns));
        _mm512_castsi512_pd(_mm512_xor_si512(_mm512_castpd_si512(x), sign))
    }
}
