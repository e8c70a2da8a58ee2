//! Impulses between touching bodies that add up, on each body, to what it got: the least ones that do.
//!
//! With potentials λ, a pair gives its second body λ₂ − λ₁, and the ground has λ = 0. That these add up to what each body got is
//! a linear system in λ, sparse, symmetric and positive; conjugate gradients solve it.

use crate::math::Vec3;

/// Keeps what floats, and so has no potential of its own, from running away.
const ANCHOR: f64 = 1e-9;
/// What is left of what was asked for.
const LEFT: f64 = 1e-9;
/// Passes at most: a chain of as many bodies is exact.
const PASSES: usize = 100;

/// Pairs of touching bodies, `None` for what stands still. Makes its memory as it grows.
#[derive(Clone, Debug, Default)]
pub struct Shares {
    /// Sorted once they are solved; with the sum of the normal impulses, N·s.
    pairs: Vec<([Option<usize>; 2], f64)>,
    /// Per body.
    potential: Vec<Vec3>,
    asked: Vec<Vec3>,
    way: Vec<Vec3>,
    image: Vec<Vec3>,
}

impl Shares {
    /// For so many bodies.
    pub fn new(bodies: usize) -> Self {
        let zero = vec![Vec3::zeros(); bodies];
        Self { pairs: vec![], potential: zero.clone(), asked: zero.clone(), way: zero.clone(), image: zero }
    }

    /// Forgets all pairs.
    pub fn clear(&mut self) {
        self.pairs.clear();
        self.asked.fill(Vec3::zeros());
    }

    /// Two bodies touch with a normal impulse, N·s.
    pub fn touch(&mut self, bodies: [Option<usize>; 2], impulse: f64) {
        self.pairs.push((bodies, impulse));
    }

    /// What a body got, N·s.
    pub fn ask(&mut self, body: usize, impulse: Vec3) {
        self.asked[body] = impulse;
    }

    /// Finds the impulses.
    pub fn solve(&mut self) {
        self.pairs.sort_by_key(|(bodies, _)| *bodies);
        self.pairs.dedup_by(|again, first| {
            let same = again.0 == first.0;
            first.1 += if same { again.1 } else { 0.0 };
            same
        });
        self.potential.fill(Vec3::zeros());
        self.way.copy_from_slice(&self.asked);
        let enough = LEFT * LEFT * square(&self.asked);
        let mut left = square(&self.asked);
        for _ in 0..PASSES {
            if left <= enough {
                break;
            }
            self.apply();
            let curvature: f64 = self.way.iter().zip(&self.image).map(|(w, i)| w.dot(i)).sum();
            let far = left / curvature;
            for (i, way) in self.way.iter().enumerate() {
                self.potential[i] += way * far;
                self.asked[i] -= self.image[i] * far;
            }
            let now = square(&self.asked);
            for (way, asked) in self.way.iter_mut().zip(&self.asked) {
                *way = asked + *way * (now / left);
            }
            left = now;
        }
    }

    /// The system times `way`.
    fn apply(&mut self) {
        for (image, way) in self.image.iter_mut().zip(&self.way) {
            *image = way * ANCHOR;
        }
        for ([a, b], _) in &self.pairs {
            let of = |body: &Option<usize>| body.map_or(Vec3::zeros(), |i| self.way[i]);
            let apart = of(b) - of(a);
            if let Some(i) = b {
                self.image[*i] += apart;
            }
            if let Some(i) = a {
                self.image[*i] -= apart;
            }
        }
    }

    /// What a point of a pair with this normal impulse gives the second body, N·s.
    pub fn of(&self, bodies: [Option<usize>; 2], impulse: f64) -> Vec3 {
        let Ok(at) = self.pairs.binary_search_by_key(&bodies, |(bodies, _)| *bodies) else { return Vec3::zeros() };
        let of = |body: Option<usize>| body.map_or(Vec3::zeros(), |i| self.potential[i]);
        (of(bodies[1]) - of(bodies[0])) * (impulse / self.pairs[at].1)
    }
}

fn square(v: &[Vec3]) -> f64 {
    v.iter().map(Vec3::norm_squared).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tower of three, pushed at the top: what its joints carry is what lies above them.
    #[test]
    fn a_chain_is_exact() {
        let mut s = Shares::new(3);
        for (pair, impulse) in [([None, Some(0)], 3.0), ([Some(0), Some(1)], 1.0), ([Some(0), Some(1)], 1.0)] {
            s.touch(pair, impulse);
        }
        s.touch([Some(1), Some(2)], 1.0);
        let push = Vec3::new(1.0, 2.0, 0.0);
        s.ask(2, push);
        s.solve();
        for (pair, impulse, share) in [([None, Some(0)], 3.0, 1.0), ([Some(0), Some(1)], 1.0, 0.5)] {
            assert!((s.of(pair, impulse) - push * share).norm() < 1e-6);
        }
    }

    /// Two that meet in flight: what one gets the other gives.
    #[test]
    fn what_floats_has_its_share() {
        let mut s = Shares::new(2);
        s.touch([Some(0), Some(1)], 2.0);
        s.ask(0, Vec3::new(-1.0, 0.0, 0.0));
        s.ask(1, Vec3::new(1.0, 0.0, 0.0));
        s.solve();
        assert!((s.of([Some(0), Some(1)], 2.0) - Vec3::x()).norm() < 1e-6);
    }
}
