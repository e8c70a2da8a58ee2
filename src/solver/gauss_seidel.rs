//! Projected Gauss–Seidel over blocks, in factor space: a block sees all others through w alone.

use super::dense::across;
use super::inner::{Inner, within_disc};
use super::rows::{Block, CHUNK, Kind, Row, Rows};

/// What a visit reads and writes besides its block.
struct Field<'a> {
    rows: &'a mut [Row],
    w: &'a mut [[f64; CHUNK]],
    ids: &'a [u32],
    values: &'a [[f64; CHUNK]],
}

impl Rows {
    /// Solves every block once, in order; returns the largest change of a velocity that a block made to itself.
    pub(super) fn sweep(&mut self) -> f64 {
        let (w, values) = (self.w.as_chunks_mut().0, self.values.as_chunks().0);
        let mut field = Field { rows: &mut self.rows, w, ids: &self.ids, values };
        self.blocks.iter_mut().map(|b| visit(b, &mut field)).fold(0.0, f64::max)
    }

    /// The largest violation of any block as a velocity: how far a step of projected descent would still move it,
    /// `|x − P(x − ρ u)| / ρ`.
    pub fn residual(&self) -> f64 {
        let mut most = 0.0_f64;
        for block in 0..self.blocks.len() {
            most = most.max(self.violation(block));
        }
        most
    }

    #[inline(always)]
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
                let lifted = n + friction * hypot(a, c);
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
                let size = hypot(to[0], to[1]);
                let shrink = if size > radius { radius / size } else { 1.0 };
                distance(&x, &to.map(|t| t * shrink)) / step
            }
        }
    }
}

#[inline(always)]
fn visit(b: &mut Block, field: &mut Field) -> f64 {
    match (&b.inner, b.kind, b.rows) {
        (Inner::Single(h), Kind::Bounds { lower, upper }, _) => {
            let h = *h;
            field.change(b, |_, [r], [x]| [(x - r / h).max(lower).min(upper)]) * h
        }
        (Inner::Cone(inner), Kind::Cone { friction }, _) => {
            let mut slip = b.slip;
            let moved = field.change(b, |_, u, x: [f64; 3]| {
                let own = inner.times(x);
                inner.solve_from([u[0] - own[0], u[1] - own[1], u[2] - own[2]], friction, &mut slip)
            });
            b.slip = slip;
            moved * inner.trace()
        }
        (inner, Kind::Disc { ratio, normal }, 1) => {
            let h = inner.trace();
            let disc = |rows: &[Row], [u]: [f64; 1], [x]: [f64; 1]| {
                let radius = ratio * rows[normal].impulse.max(0.0);
                [within_disc(inner, [u - h * x, 0.0], radius)[0]]
            };
            if h > 0.0 { field.change(b, disc) * h } else { 0.0 }
        }
        (inner, Kind::Disc { ratio, normal }, _) => {
            let disc = |rows: &[Row], u: [f64; 2], x: [f64; 2]| {
                let own = inner.times([x[0], x[1], 0.0]);
                within_disc(inner, [u[0] - own[0], u[1] - own[1]], ratio * rows[normal].impulse.max(0.0))
            };
            if inner.trace() > 0.0 { field.change(b, disc) * inner.trace() } else { 0.0 }
        }
        _ => 0.0,
    }
}

impl Field<'_> {
    /// Sets the N impulses of a block to what `solve` makes of all rows, of the block's velocities and of its impulses;
    /// returns by how much they changed at most.
    #[inline(always)]
    fn change<const N: usize>(&mut self, b: &Block, solve: impl FnOnce(&[Row], [f64; N], [f64; N]) -> [f64; N]) -> f64 {
        let ids = &self.ids[b.ids.clone()];
        let y = &self.values[b.values / CHUNK..][..N * ids.len()];
        let mut rest = y;
        let y: [&[[f64; CHUNK]]; N] = std::array::from_fn(|_| {
            let (own, others) = rest.split_at(ids.len());
            rest = others;
            own
        });
        let Some(rows) = self.rows[b.first..].first_chunk::<N>() else { return 0.0 };
        let x = rows.map(|r| r.impulse);
        let mut sum = [[0.0; CHUNK]; N];
        for (i, id) in ids.iter().enumerate() {
            let w = &self.w[*id as usize];
            for n in 0..N {
                (0..CHUNK).for_each(|k| sum[n][k] += y[n][i][k] * w[k]);
            }
        }
        let u = std::array::from_fn(|n| rows[n].bias + across(&sum[n]) + rows[n].softness * x[n]);
        let to = solve(self.rows, u, x);
        let by: [f64; N] = std::array::from_fn(|n| to[n] - x[n]);
        let most = by.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        if most == 0.0 {
            return 0.0;
        }
        for (row, to) in self.rows[b.first..].iter_mut().zip(to) {
            row.impulse = to;
        }
        for (i, id) in ids.iter().enumerate() {
            let w = &mut self.w[*id as usize];
            for n in 0..N {
                (0..CHUNK).for_each(|k| w[k] += y[n][i][k] * by[n]);
            }
        }
        most
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
#[inline(always)]
fn onto_cone(x: [f64; 3], mu: f64) -> [f64; 3] {
    let size = hypot(x[1], x[2]);
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

/// Velocities and impulses are far from the limits of f64.
#[inline(always)]
fn hypot(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

#[inline(always)]
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
