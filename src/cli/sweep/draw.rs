//! Random numbers that are the same on every machine, in every version and in every order of worlds: each value has a generator of its
//! own, seeded by the sweep, the world and the name of what is varied.

use fnv::FnvHasher;
use std::hash::Hasher;

/// SplitMix64.
pub struct Draw(u64);

impl Draw {
    /// For one value of one world.
    pub fn of(seed: u64, world: u64, name: &str) -> Self {
        let mut hash = FnvHasher::default();
        hash.write(&seed.to_le_bytes());
        hash.write(&world.to_le_bytes());
        hash.write(name.as_bytes());
        let mut draw = Self(hash.finish());
        draw.next_u64();
        draw
    }

    /// All 64 bits are random.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From 0 to below 1, with 53 random bits.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Mean 0, standard deviation 1 (Box–Muller).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.unit(), self.unit());
        libm::sqrt(-2.0 * libm::log(u)) * libm::cos(std::f64::consts::TAU * v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splitmix64_gives_its_published_numbers() {
        let mut draw = Draw(1_234_567);
        let first: Vec<u64> = (0..3).map(|_| draw.next_u64()).collect();
        assert_eq!(first, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    #[test]
    fn moments_are_those_of_the_distributions() {
        let n = 20_000;
        let draws = |f: fn(&mut Draw) -> f64| (0..n).map(|i| f(&mut Draw::of(5, i, "x"))).collect::<Vec<f64>>();
        let moments = |x: &[f64]| {
            let mean = x.iter().sum::<f64>() / n as f64;
            (mean, x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n as f64)
        };
        let (mean, variance) = moments(&draws(Draw::unit));
        assert!((mean - 0.5).abs() < 0.01 && (variance - 1.0 / 12.0).abs() < 0.003, "{mean} {variance}");
        let (mean, variance) = moments(&draws(Draw::normal));
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.04, "{mean} {variance}");
    }

    #[test]
    fn values_do_not_depend_on_each_other() {
        assert_eq!(Draw::of(1, 2, "a").unit(), Draw::of(1, 2, "a").unit());
        assert_ne!(Draw::of(1, 2, "a").unit(), Draw::of(1, 2, "b").unit());
        assert_ne!(Draw::of(1, 2, "a").unit(), Draw::of(1, 3, "a").unit());
        assert_ne!(Draw::of(1, 2, "a").unit(), Draw::of(2, 2, "a").unit());
    }
}
