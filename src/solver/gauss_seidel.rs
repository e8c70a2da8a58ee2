//! Projected Gauss–Seidel over blocks, in factor space: a block sees all others through w alone.

use super::rows::{Inner, Kind, Rows, within_disc};

impl Rows {
    /// Solves every block once, in order; returns the largest change of a velocity that a block made to itself.
    pub(super) fn sweep(&mut self) -> f64 {
        (0..self.blocks.len()).map(|b| self.visit(b)).fold(0.0, f64::max)
    }

    #[inline(always)]
    fn visit(&mut self, block: usize) -> f64 {
        let b = &self.blocks[block];
        match (b.inner, b.kind) {
            (Inner::Off, _) => 0.0,
            (Inner::Single(h), Kind::Bounds { lower, upper }) => {
                let row = &self.rows[b.first];
                let x = (row.impulse - self.velocity(b, 0) / h).max(lower).min(upper);
                self.change(block, 0, x) * h
            }
            (Inner::Cone(inner), Kind::Cone { friction }) => {
                let x = inner.solve(self.without_own(block), friction);
                let moved = [0, 1, 2].map(|n| self.change(block, n, x[n]));
                moved.into_iter().fold(0.0, f64::max) * inner.trace()
            }
            (inner, Kind::Disc { ratio, normal }) => {
                let [r0, r1, _] = self.without_own(block);
                let x = within_disc(&inner, [r0, r1], ratio * self.rows[normal].impulse.max(0.0));
                let (trace, rows) = (inner.trace(), b.rows);
                (0..rows.min(2)).map(|n| self.change(block, n, x[n])).fold(0.0, f64::max) * trace
            }
            _ => 0.0,
        }
    }

    /// Velocities of a block without its own impulses.
    #[inline(always)]
    fn without_own(&self, block: usize) -> [f64; 3] {
        let b = &self.blocks[block];
        let x = |n: usize| if n < b.rows { self.rows[b.first + n].impulse } else { 0.0 };
        let own = b.inner.times([x(0), x(1), x(2)]);
        std::array::from_fn(|n| if n < b.rows { self.velocity(b, n) - own[n] } else { 0.0 })
    }

    /// Sets an impulse; returns by how much it changed.
    #[inline(always)]
    fn change(&mut self, block: usize, n: usize, x: f64) -> f64 {
        let row = &mut self.rows[self.blocks[block].first + n];
        let by = x - row.impulse;
        row.impulse = x;
        self.push(block, n, by);
        by.abs()
    }

    /// The largest violation of any block as a velocity: how far a step of projected descent would still move it,
    /// `|x − P(x − ρ u)| / ρ`.
    pub fn residual(&self) -> f64 {
        (0..self.blocks.len()).map(|b| self.violation(b)).fold(0.0, f64::max)
    }

    fn violation(&self, block: usize) -> f64 {
        let b = &self.blocks[block];
        let trace = b.inner.trace();
        if b.is_off() {
            return 0.0;
        }
        let x = |n: usize| self.rows[b.first + n].impulse;
        match b.kind {
            Kind::Bounds { lower, upper } => {
                let u = self.velocity(b, 0);
                (x(0) - (x(0) - u / trace).max(lower).min(upper)).abs() * trace
            }
            Kind::Cone { friction } => {
                let step = 3.0 / trace;
                let (n, a, c) = (self.velocity(b, 0), self.velocity(b, 1), self.velocity(b, 2));
                // De Saxcé's lift: it makes Coulomb's law the complementarity of a cone and its dual.
                let lifted = n + friction * libm::hypot(a, c);
                let x = [x(0), x(1), x(2)];
                let p = onto_cone([x[0] - step * lifted, x[1] - step * a, x[2] - step * c], friction);
                distance(&x, &p) / step
            }
            Kind::Disc { ratio, normal } => {
                let step = b.rows as f64 / trace;
                let radius = ratio * self.rows[normal].impulse.max(0.0);
                let x: [f64; 2] = std::array::from_fn(|n| if n < b.rows { x(n) } else { 0.0 });
                let to: [f64; 2] =
                    std::array::from_fn(|n| if n < b.rows { x[n] - step * self.velocity(b, n) } else { 0.0 });
                let size = libm::hypot(to[0], to[1]);
                let shrink = if size > radius { radius / size } else { 1.0 };
                distance(&x, &to.map(|t| t * shrink)) / step
            }
        }
    }
}

impl Inner {
    /// Trace of the block.
    #[inline(always)]
    pub(super) fn trace(&self) -> f64 {
        match self {
            Self::Off => 0.0,
            Self::Single(h) => *h,
            Self::Pair(_, trace) => *trace,
            Self::Cone(block) => block.trace(),
        }
    }

    /// The block times impulses.
    #[inline(always)]
    fn times(&self, x: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Off => [0.0; 3],
            Self::Single(h) => [h * x[0], 0.0, 0.0],
            Self::Pair(plane, _) => {
                let [a, b] = plane.times([x[0], x[1]]);
                [a, b, 0.0]
            }
            Self::Cone(block) => block.times(x),
        }
    }
}

/// The nearest point of the cone `|x_t| ≤ μ x_n`.
fn onto_cone(x: [f64; 3], mu: f64) -> [f64; 3] {
    let size = libm::hypot(x[1], x[2]);
    if size <= mu * x[0] {
        return x;
    }
    if mu * size <= -x[0] {
        return [0.0; 3];
    }
    let n = (x[0] + mu * size) / (1.0 + mu * mu);
    let shrink = mu * n / size;
    [n, x[1] * shrink, x[2] * shrink]
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
