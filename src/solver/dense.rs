//! A dense Cholesky factor in memory that is made once.

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
        for i in 0..n {
            let (above, row) = self.l.split_at_mut(i * n);
            for k in 0..=i {
                let own = element(i, k);
                let other = if k < i { &above[k * n..k * n + k] } else { &[][..] };
                let left = own - if k < i { dot(&row[..k], other) } else { dot(&row[..k], &row[..k]) };
                row[k] = match () {
                    () if k < i => left * above[k * n + k],
                    () if left > DEPENDENT * own => 1.0 / left.sqrt(),
                    () => 0.0,
                };
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

/// In a fixed order of four sums.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = [0.0; 4];
    let (x, y) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = x.remainder().iter().zip(y.remainder()).map(|(a, b)| a * b).sum();
    for (x, y) in x.zip(y) {
        for k in 0..4 {
            sum[k] += x[k] * y[k];
        }
    }
    (sum[0] + sum[1]) + (sum[2] + sum[3]) + rest
}
