//! Numbers of twice the digits: what a computation in f64 is held against.

use super::Real;
use std::f64::consts::FRAC_PI_2;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// The sum of two f64 of which the second is less than half a last digit of the first: 32 decimal digits (Dekker 1971; the sums of
/// Hida, Li and Bailey, *Algorithms for quad-double precision floating point arithmetic*, 2001).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twofold {
    high: f64,
    low: f64,
}

/// π/2 in four parts.
const PIO2: [f64; 4] = [FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33, 5.562_271_104_316_826e-50];
/// Of the series of sine and cosine up to π/4: the last is below 10⁻³³.
const TERMS: u32 = 15;

impl Twofold {
    /// Rounded.
    pub fn value(self) -> f64 {
        self.high
    }

    fn of_sum((high, low): (f64, f64)) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }

    /// Sine and cosine for |x| ≤ π/4, by their series.
    fn series(self) -> (Self, Self) {
        let square = self * self;
        let (mut sine, mut cosine, mut s, mut c) = (self, Self::of(1.0), self, Self::of(1.0));
        for k in 1..=TERMS {
            let n = f64::from(2 * k);
            c = -(c * square) / Self::of(n * (n - 1.0));
            s = -(s * square) / Self::of(n * (n + 1.0));
            cosine += c;
            sine += s;
        }
        (sine, cosine)
    }
}

/// The sum, and what it has lost by rounding (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The product, and what it has lost by rounding (Dekker, Veltkamp).
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let far = 134_217_729.0 * x;
        let high = far - (far - x);
        (high, x - high)
    };
    let product = a * b;
    let ((a, c), (b, d)) = (split(a), split(b));
    (product, ((a * b - product) + a * d + c * b) + c * d)
}

impl Add for Twofold {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let ((high, a), (low, b)) = (two_sum(self.high, o.high), two_sum(self.low, o.low));
        let sum = Self::of_sum((high, a + low));
        Self::of_sum((sum.high, sum.low + b))
    }
}

impl Neg for Twofold {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Twofold {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Twofold {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let (product, rest) = two_product(self.high, o.high);
        Self::of_sum((product, rest + (self.high * o.low + self.low * o.high)))
    }
}

impl Div for Twofold {
    type Output = Self;
    /// Long division, three digits.
    fn div(self, o: Self) -> Self {
        let first = self.high / o.high;
        let rest = self - o * Self::of(first);
        let second = rest.high / o.high;
        let third = (rest - o * Self::of(second)).high / o.high;
        Self::of_sum((first, second)) + Self::of(third)
    }
}

impl AddAssign for Twofold {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for Twofold {
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl Real for Twofold {
    fn of(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }

    fn mad(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    /// Less whole quarter turns, of which there may be 10⁹.
    fn sin_cos(self) -> (Self, Self) {
        let turns = (self.high / PIO2[0]).round();
        let rest = PIO2.iter().fold(self, |x, part| x - Self::of(turns) * Self::of(*part));
        let (s, c) = rest.series();
        match turns.rem_euclid(4.0) as u8 {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        }
    }

    fn blend(self, other: Self, mask: Self) -> Self {
        if mask.high == 0.0 { other } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2⁻¹⁰⁴: four times the unit of rounding.
    const EPSILON: f64 = 4.930_380_657_631_324e-32;

    fn numbers() -> impl Iterator<Item = Twofold> {
        (1..200).map(|k| Twofold::of(f64::from(k) - 77.5) / Twofold::of(7.0 + f64::from(k * k % 31)))
    }

    fn is_small(x: Twofold, scale: f64) -> bool {
        x.high.abs() <= EPSILON * scale
    }

    #[test]
    fn what_is_divided_is_multiplied_back() {
        for (a, b) in numbers().zip(numbers().skip(5)) {
            assert!(is_small(a / b * b - a, 4.0 * a.high.abs()), "{a:?} {b:?}");
            assert!(is_small((a + b) - a - b, 4.0 * (a.high.abs() + b.high.abs())), "{a:?} {b:?}");
            assert!(is_small((a + b) * (a - b) - (a * a - b * b), 8.0 * (a * a + b * b).high), "{a:?} {b:?}");
        }
    }

    /// 1/3 has 32 threes; f64 alone has 16.
    #[test]
    fn a_third_has_twice_the_digits() {
        let third = Twofold::of(1.0) / Twofold::of(3.0);
        assert!(third.high == 1.0 / 3.0 && third.low != 0.0);
        assert!(is_small(third + third + third - Twofold::of(1.0), 1.0));
    }

    /// Pythagoras, double angles, the sum of an angle and a small one, and the f64 rounded.
    #[test]
    fn sines_obey_their_theorems() {
        for x in numbers().flat_map(|x| [x, x * Twofold::of(40.0)]) {
            let ((s, c), (s2, c2)) = (x.sin_cos(), (x + x).sin_cos());
            let scale = 16.0 + x.high.abs();
            assert!(is_small(s * s + c * c - Twofold::of(1.0), 16.0), "{x:?}");
            assert!(is_small(s2 - (s * c + s * c), scale) && is_small(c2 - (c * c - s * s), scale), "{x:?}");
            let right = (libm::sin(x.high), libm::cos(x.high));
            let near = |a: Twofold, b: f64| (a.value() - b).abs() <= 4.0 * f64::EPSILON * (1.0 + x.high.abs());
            assert!(near(s, right.0) && near(c, right.1), "{x:?}");
        }
        // By series of 80 digits.
        for (x, high, low) in
            [(1.0, 0.8414709848078965, 1.776845092935536e-18), (100.0, -0.5063656411097588, -3.050947053792115e-18)]
        {
            let rest = Twofold::of(x).sin_cos().0 - Twofold::of(high) - Twofold::of(low);
            assert!(is_small(rest, 4.0 * x), "{x}: {rest:?}");
        }
    }
}
