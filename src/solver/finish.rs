//! The direct finish: where the iteration has not converged, the rows with bounds are solved by an active set, with a
//! dense factor of `Y Yᵀ + R`. Semismooth Newton on the projection: a row is free if a step of descent stays inside its
//! bounds, else it stands at the bound. Cones and discs keep their impulses and are swept again.

use super::rows::{FINISH_ROWS, Inner, Kind, Rows};

/// Times that the active set may change.
const TRIES: u32 = 3;
/// A pivot below this share of its diagonal is rounding: the row depends on those before it, and is left as it is.
const DEPENDENT: f64 = 1e-12;

/// Memory of the finish.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// Free rows' blocks.
    free: Vec<usize>,
    /// Cholesky factor, row by row; the diagonal holds its inverse, 0 for a row left out.
    factor: Vec<f64>,
    step: Vec<f64>,
    /// Impulses to go back to.
    kept: Vec<f64>,
}

impl Scratch {
    /// Room for this many, so that a finish allocates nothing.
    pub fn make_room(&mut self, blocks: usize, rows: usize) {
        if rows > FINISH_ROWS {
            return;
        }
        self.free.reserve(blocks.saturating_sub(self.free.len()));
        self.factor.resize(blocks * blocks, 0.0);
        self.step.resize(blocks, 0.0);
        self.kept.resize(rows, 0.0);
    }
}

impl Rows {
    /// Improves the impulses; returns the residual, which never grows, and the number of tries.
    pub(super) fn finish(&mut self, mut residual: f64, wanted: f64) -> (f64, u32) {
        let mut s = std::mem::take(&mut self.finish);
        let mut tries = 0;
        while residual > wanted && tries < TRIES {
            tries += 1;
            for (kept, row) in s.kept.iter_mut().zip(&self.rows) {
                *kept = row.impulse;
            }
            self.newton(&mut s);
            let better = self.residual();
            if better < residual {
                residual = better;
                continue;
            }
            for (kept, row) in s.kept.iter().zip(&mut self.rows) {
                row.impulse = *kept;
            }
            self.gather();
            break;
        }
        self.finish = s;
        (residual, tries)
    }

    fn newton(&mut self, s: &mut Scratch) {
        self.choose(s);
        self.gather();
        self.factorise(s);
        // The second solution takes out what rounding left of the first.
        for _ in 0..2 {
            self.solve_free(s);
            for k in 0..s.free.len() {
                self.rows[self.blocks[s.free[k]].first].impulse += s.step[k];
            }
            self.gather();
        }
        for b in 0..self.blocks.len() {
            if let (Kind::Bounds { lower, upper }, false) = (self.blocks[b].kind, self.blocks[b].is_off()) {
                let row = &mut self.rows[self.blocks[b].first];
                row.impulse = row.impulse.max(lower).min(upper);
            }
        }
        self.gather();
        if self.blocks.iter().any(|b| !matches!(b.kind, Kind::Bounds { .. })) {
            self.sweep();
        }
    }

    /// Which rows are free; puts the others at their bounds.
    fn choose(&mut self, s: &mut Scratch) {
        s.free.clear();
        for k in 0..self.blocks.len() {
            let b = &self.blocks[k];
            let (Kind::Bounds { lower, upper }, Inner::Single(h)) = (b.kind, b.inner) else { continue };
            let (u, row) = (self.velocity(b, 0), b.first);
            let x = self.rows[row].impulse - u / h;
            if x < lower {
                self.rows[row].impulse = lower;
            } else if x > upper {
                self.rows[row].impulse = upper;
            } else {
                s.free.push(k);
            }
        }
    }

    /// Cholesky of the free part of `Y Yᵀ + R`.
    fn factorise(&self, s: &mut Scratch) {
        let n = s.free.len();
        for i in 0..n {
            let a = &self.blocks[s.free[i]];
            for k in 0..=i {
                let sum: f64 = (0..k).map(|j| s.factor[i * n + j] * s.factor[k * n + j]).sum();
                let own = if i == k { a.inner.trace() } else { self.between((a, 0), (&self.blocks[s.free[k]], 0)) };
                let left = own - sum;
                s.factor[i * n + k] = match () {
                    () if i > k => left * s.factor[k * n + k],
                    () if left > DEPENDENT * own => 1.0 / left.sqrt(),
                    () => 0.0,
                };
            }
        }
    }

    /// The step that brings the free rows' velocities to 0.
    fn solve_free(&self, s: &mut Scratch) {
        let n = s.free.len();
        for i in 0..n {
            let sum: f64 = (0..i).map(|j| s.factor[i * n + j] * s.step[j]).sum();
            s.step[i] = (-self.velocity(&self.blocks[s.free[i]], 0) - sum) * s.factor[i * n + i];
        }
        for i in (0..n).rev() {
            let sum: f64 = (i + 1..n).map(|j| s.factor[j * n + i] * s.step[j]).sum();
            s.step[i] = (s.step[i] - sum) * s.factor[i * n + i];
        }
    }
}
