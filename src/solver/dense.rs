//! Dense factors in memory that is made once.

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
    pub fn resize(&mut self, n: usize) {
        self.l.resize(n * n, 0.0);
        self.x.resize(n, 0.0);
    }

    /// Of the matrix with these elements, asked for with row ≥ column.
    #[inline(always)]
    pub fn factorise(&mut self, n: usize, element: impl Fn(usize, usize) -> f64) {
        self.n = n;
        // Column by column: the elements of one do not wait for each other.
        for k in 0..n {
            let (above, below) = self.l.split_at_mut((k + 1) * n);
            let pivot = &mut above[k * n..];
            let own = element(k, k);
            let left = own - dot(&pivot[..k], &pivot[..k]);
            pivot[k] = if left > DEPENDENT * own { 1.0 / left.sqrt() } else { 0.0 };
            for (i, row) in (k + 1..n).zip(below.chunks_exact_mut(n)) {
                row[k] = (element(i, k) - dot(&row[..k], &pivot[..k])) * pivot[k];
            }
        }
    }

    /// Solves for this right-hand side; rows left out get 0.
    #[inline(always)]
    pub fn solve(&mut self, right: impl Fn(usize) -> f64) {
        let (n, l) = (self.n, &self.l);
        for i in 0..n {
            let row = &l[i * n..i * n + i + 1];
            self.x[i] = (right(i) - dot(&row[..i], &self.x[..i])) * row[i];
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
    pub fn resize(&mut self, n: usize) {
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
    pub fn solve(&mut self, right: impl Fn(usize) -> f64) {
        self.substitute(right);
        self.x[..self.n].copy_from_slice(&self.step[..self.n]);
    }

    /// Adds the solution for what the one that is there leaves over.
    #[inline(always)]
    pub fn refine(&mut self, left: impl Fn(usize, &[f64]) -> f64) {
        let x = std::mem::take(&mut self.x);
        let n = self.n;
        self.substitute(|i| left(i, &x[..n]));
        self.x = x;
        self.x.iter_mut().zip(&self.step[..self.n]).for_each(|(x, step)| *x += step);
    }

    #[inline(always)]
    fn substitute(&mut self, right: impl Fn(usize) -> f64) {
        let (n, lu) = (self.n, &self.lu);
        for i in 0..n {
            let row = &lu[i * n..i * n + n];
            self.step[i] = right(self.rows[i]) - dot(&row[..i], &self.step[..i]);
        }
        for i in (0..n).rev() {
            let row = &lu[i * n..i * n + n];
            self.step[i] = (self.step[i] - dot(&row[i + 1..], &self.step[i + 1..n])) * row[i];
        }
    }

    /// What was found.
    pub fn solution(&self) -> &[f64] {
        &self.x[..self.n]
    }
}

/// In a fixed order of four sums.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = [0.0; 4];
    let (x, y) = (a.chunks_exact(4), b.chunks_exact(4));
    // Loops, not closures: those may be compiled apart, without the features of the function around them.
    let mut rest = -0.0;
    for (a, b) in x.remainder().iter().zip(y.remainder()) {
        rest += a * b;
    }
    for (x, y) in x.zip(y) {
        for k in 0..4 {
            sum[k] += x[k] * y[k];
        }
    }
    (sum[0] + sum[1]) + (sum[2] + sum[3]) + rest
}
