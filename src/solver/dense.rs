//! Dense factors in memory that is made once. `L` is how four numbers are multiplied at once: the bits are the same.

use crate::math::Lane;

/// A pivot below this share of its diagonal is rounding: the row depends on those before it, and is left out.
const DEPENDENT: f64 = 1e-12;

/// Lower factor of a symmetric positive semidefinite matrix, and a solution.
#[derive(Clone, Debug, Default)]
pub(super) struct Cholesky {
    n: usize,
    /// Row by row; the diagonal holds its inverse, 0 for a row left out.
    l: Vec<f64>,
    x: Vec<f64>,
}

impl Cholesky {
    /// Room for n rows.
    pub fn make_room(&mut self, n: usize) {
        if n > self.x.len() {
            self.l.resize(n * n, 0.0);
            self.x.resize(n, 0.0);
        }
    }

    /// Of the matrix with these elements, asked for with row ≥ column.
    #[inline(always)]
    pub fn factorise<L: Lane>(&mut self, n: usize, element: impl Fn(usize, usize) -> f64) {
        self.n = n;
        // Column by column: the elements of one do not wait for each other.
        for k in 0..n {
            let (above, below) = self.l.split_at_mut((k + 1) * n);
            let pivot = &mut above[k * n..];
            let own = element(k, k);
            let left = own - dot::<L>(&pivot[..k], &pivot[..k]);
            pivot[k] = if left > DEPENDENT * own { 1.0 / left.sqrt() } else { 0.0 };
            let mut i = k + 1;
            let (pivot, inverse) = (&pivot[..k], pivot[k]);
            let mut fours = below[..(n - k - 1) * n].chunks_exact_mut(FOUR * n);
            for four in &mut fours {
                let found = dots::<L>(four, n, pivot);
                for (r, found) in found.into_iter().enumerate() {
                    four[r * n + k] = (element(i + r, k) - found) * inverse;
                }
                i += FOUR;
            }
            for (i, row) in (i..n).zip(fours.into_remainder().chunks_exact_mut(n)) {
                row[k] = (element(i, k) - dot::<L>(&row[..k], pivot)) * inverse;
            }
        }
    }

    /// Solves for this right-hand side; rows left out get 0.
    #[inline(always)]
    pub fn solve<L: Lane>(&mut self, right: &[f64]) {
        let (n, l) = (self.n, &self.l);
        for (i, right) in right.iter().enumerate().take(n) {
            let row = &l[i * n..i * n + i + 1];
            self.x[i] = (right - dot::<L>(&row[..i], &self.x[..i])) * row[i];
        }
        for i in (0..n).rev() {
            let row = &l[i * n..i * n + i + 1];
            let x = self.x[i] * row[i];
            self.x[i] = x;
            for (to, l) in self.x[..i].iter_mut().zip(row) {
                *to -= l * x;
            }
        }
    }

    /// What the last solve found.
    pub fn solution(&self) -> &[f64] {
        &self.x[..self.n]
    }
}

/// LU factor with row exchanges, and a solution.
#[derive(Clone, Debug, Default)]
pub(super) struct Lu {
    n: usize,
    /// Row by row, in the order of `rows`; the diagonal of U holds its inverse, 0 for what is left out.
    lu: Vec<f64>,
    rows: Vec<usize>,
    x: Vec<f64>,
    step: Vec<f64>,
}

impl Lu {
    /// Room for n rows.
    pub fn make_room(&mut self, n: usize) {
        if n <= self.x.len() {
            return;
        }
        self.lu.resize(n * n, 0.0);
        self.rows.resize(n, 0);
        self.x.resize(n, 0.0);
        self.step.resize(n, 0.0);
    }

    /// Of a matrix of n rows, row by row, with something added to its diagonal.
    #[inline(always)]
    pub fn factorise(&mut self, n: usize, matrix: &[f64], added: impl Fn(usize) -> f64) {
        self.n = n;
        self.lu[..n * n].copy_from_slice(matrix);
        for i in 0..n {
            self.rows[i] = i;
            self.lu[i * n + i] += added(i);
        }
        for k in 0..n {
            let best = self.largest(k);
            if best != k {
                self.rows.swap(best, k);
                let (above, below) = self.lu.split_at_mut(best * n);
                above[k * n..k * n + n].swap_with_slice(&mut below[..n]);
            }
            let pivot = self.lu[k * n + k];
            let inverse = if pivot.abs() > f64::MIN_POSITIVE { 1.0 / pivot } else { 0.0 };
            let (above, below) = self.lu.split_at_mut((k + 1) * n);
            let from = &mut above[k * n..];
            from[k] = inverse;
            for row in below[..(n - k - 1) * n].chunks_exact_mut(n) {
                let factor = row[k] * inverse;
                row[k] = factor;
                if factor != 0.0 {
                    for (to, from) in row[k + 1..].iter_mut().zip(&from[k + 1..]) {
                        *to -= factor * from;
                    }
                }
            }
        }
    }

    /// Row of the largest number in a column, from the diagonal down; the last one of equals.
    #[inline(always)]
    fn largest(&self, k: usize) -> usize {
        let (mut best, mut size) = (k, self.lu[k * self.n + k].abs());
        for i in k + 1..self.n {
            let own = self.lu[i * self.n + k].abs();
            if own >= size {
                (best, size) = (i, own);
            }
        }
        best
    }

    /// Solves for this right-hand side.
    #[inline(always)]
    pub fn solve<L: Lane>(&mut self, right: impl Fn(usize) -> f64) {
        self.substitute::<L>(right);
        self.x[..self.n].copy_from_slice(&self.step[..self.n]);
    }

    /// Adds the solution for what the one that is there leaves over.
    #[inline(always)]
    pub fn refine<L: Lane>(&mut self, left: impl Fn(usize, &[f64]) -> f64) {
        let x = std::mem::take(&mut self.x);
        let n = self.n;
        self.substitute::<L>(|i| left(i, &x[..n]));
        self.x = x;
        self.x.iter_mut().zip(&self.step[..self.n]).for_each(|(x, step)| *x += step);
    }

    #[inline(always)]
    fn substitute<L: Lane>(&mut self, right: impl Fn(usize) -> f64) {
        let (n, lu) = (self.n, &self.lu);
        for i in 0..n {
            let row = &lu[i * n..i * n + n];
            self.step[i] = right(self.rows[i]) - dot::<L>(&row[..i], &self.step[..i]);
        }
        for i in (0..n).rev() {
            let row = &lu[i * n..i * n + n];
            self.step[i] = (self.step[i] - dot::<L>(&row[i + 1..], &self.step[i + 1..n])) * row[i];
        }
    }

    /// What was found.
    pub fn solution(&self) -> &[f64] {
        &self.x[..self.n]
    }
}

/// Numbers that are multiplied, and rows that are read, at once.
const FOUR: usize = 4;

/// [`dot`] of each of four rows of n with the same other one, which may be shorter.
#[inline(always)]
fn dots<L: Lane>(rows: &[f64], n: usize, other: &[f64]) -> [f64; FOUR] {
    let (others, last) = other.as_chunks::<FOUR>();
    let row = |r: usize| &rows[r * n..r * n + other.len()];
    let chunks = |r: usize| &row(r).as_chunks::<FOUR>().0[..others.len()];
    let (r0, r1, r2, r3) = (chunks(0), chunks(1), chunks(2), chunks(3));
    let mut sums = [L::of(0.0); FOUR];
    for (c, other) in others.iter().enumerate() {
        let other = L::read(other);
        sums[0] += L::read(&r0[c]) * other;
        sums[1] += L::read(&r1[c]) * other;
        sums[2] += L::read(&r2[c]) * other;
        sums[3] += L::read(&r3[c]) * other;
    }
    let mut rest = [-0.0; FOUR];
    let start = FOUR * others.len();
    for (k, b) in last.iter().enumerate() {
        for (r, rest) in rest.iter_mut().enumerate() {
            *rest += rows[r * n + start + k] * b;
        }
    }
    let mut out = [0.0; FOUR];
    for (out, (sum, rest)) in out.iter_mut().zip(sums.iter().zip(&rest)) {
        let s = sum.numbers();
        *out = (s[0] + s[1]) + (s[2] + s[3]) + rest;
    }
    out
}

/// In a fixed order of four sums.
#[inline(always)]
pub(super) fn dot<L: Lane>(a: &[f64], b: &[f64]) -> f64 {
    let ((x, a), (y, b)) = (a.as_chunks::<FOUR>(), b.as_chunks::<FOUR>());
    // Loops, not closures: those may be compiled apart, without the features of the function around them.
    let (mut sum, mut rest) = (L::of(0.0), -0.0);
    for (x, y) in x.iter().zip(y) {
        sum += L::read(x) * L::read(y);
    }
    for (a, b) in a.iter().zip(b) {
        rest += a * b;
    }
    let s = sum.numbers();
    (s[0] + s[1]) + (s[2] + s[3]) + rest
}
