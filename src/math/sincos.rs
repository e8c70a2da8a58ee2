//! Sine and cosine with the same bits on every machine.
//!
//! libm's own may choose code by CPU, which would make bits depend on the machine. Reduction modulo π/2 in three parts
//! (Cody and Waite 1980), then the minimax polynomials of Moshier's Cephes library.

use super::Real;
use std::f64::consts::FRAC_2_PI;

/// π/2 in three parts; the first two have 33 bits, so that their product with a count below 2²⁰ is exact.
const PIO2: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Adding and taking away 1.5·2⁵² rounds to the nearest integer.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// Up to here the reduction is exact; beyond, crate libm takes over (also the same bits everywhere, but slower).
pub(super) const EXACT: f64 = 1.0e6;

/// `(sin x, cos x)`; the error is at most 2 ulp for |x| ≤ 10⁶. NaN and infinities give NaN.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if x.abs() <= EXACT { reduced(x) } else { far(x) }
}

#[cold]
fn far(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

#[inline(always)]
fn reduced(x: f64) -> (f64, f64) {
    let (turns, s, c) = octant(x);
    let quadrant = (turns - ROUND) as i64;
    let (s, c) = if quadrant & 1 == 0 { (s, c) } else { (c, s) };
    let s = if quadrant & 2 == 0 { s } else { -s };
    let c = if (quadrant + 1) & 2 == 0 { c } else { -c };
    (s, c)
}

/// Sine and cosine of what is left of `x` after whole quarter turns; their number (first) is still raised by [`ROUND`], so
/// that its last bits are those of the mantissa.
#[inline(always)]
pub(super) fn octant<T: Real>(x: T) -> (T, T, T) {
    let turns = x * T::of(FRAC_2_PI) + T::of(ROUND);
    let n = turns - T::of(ROUND);
    let r = ((x - n * T::of(PIO2[0])) - n * T::of(PIO2[1])) - n * T::of(PIO2[2]);
    let z = r * r;
    let s = r + r * z * poly(z, SINE);
    let c = T::of(1.0) - T::of(0.5) * z + z * z * poly(z, COSINE);
    (turns, s, c)
}

const SINE: [f64; 6] = [
    1.589_623_015_765_465_7e-10,
    -2.505_074_776_285_780_7e-8,
    2.755_731_362_138_572_5e-6,
    -1.984_126_982_958_954e-4,
    8.333_333_333_322_118e-3,
    -1.666_666_666_666_663e-1,
];
const COSINE: [f64; 6] = [
    -1.135_853_652_138_768_2e-11,
    2.087_570_084_197_473e-9,
    -2.755_731_417_929_674e-7,
    2.480_158_728_885_170_5e-5,
    -1.388_888_888_887_305_6e-3,
    4.166_666_666_666_659e-2,
];

#[inline(always)]
fn poly<T: Real>(z: T, k: [f64; 6]) -> T {
    ((((T::of(k[0]) * z + T::of(k[1])) * z + T::of(k[2])) * z + T::of(k[3])) * z + T::of(k[4])) * z + T::of(k[5])
}

#[cfg(test)]
mod tests {
    use super::sin_cos;

    /// The standard library is correctly rounded to within 1 ulp; 2 ulp of 1 is 4.4e-16.
    #[test]
    fn agrees_with_the_standard_library() {
        let mut x = -1.0e6;
        while x < 1.0e6 {
            let ((s, c), (s0, c0)) = (sin_cos(x), x.sin_cos());
            assert!((s - s0).abs() <= 4.5e-16 && (c - c0).abs() <= 4.5e-16, "{x}: {s} {s0} {c} {c0}");
            x += 7.345_678_9;
        }
    }

    #[test]
    fn small_angles_keep_their_relative_precision() {
        for k in 0..60 {
            let x = 0.7 * 0.5f64.powi(k);
            assert!((sin_cos(x).0 / x.sin() - 1.0).abs() <= 4.5e-16);
        }
    }

    #[test]
    fn not_a_number_in_not_a_number_out() {
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
    }
}
