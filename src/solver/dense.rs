//! Dense factors in memory that is made once. `L` is how four numbers are multiplied at once: the bits are the same.

use crate::math::Lane;

/// A pivot below this share of its diagonal is rounding: the row depends on those before it, and is left out.
const DEPENDENT: f64 = 1e-12;

/// Numbers that are multiplied, and rows that are solved for, at once.
const FOUR: usize = 4;
type Four = [f64; FOUR];

/// How long a row of n numbers is in a matrix for [`Cholesky`]: whole fours, what is in the last one besides does not count.
pub(super) fn padded(n: usize) -> usize {
    n.next_multiple_of(FOUR).max(FOUR)
}

/// Lower factor of a symmetric positive semidefinite matrix, and a solution. Four rows share a register, so nothing is added up
/// across lanes; what is added up in one has the order of [`dot`].
#[derive(Clone, Debug, Default)]
pub(super) struct Cholesky {
    n: usize,
    /// Four rows after four, each column by column. What is above the diagonal does not count.
    l: Vec<Four>,
    /// The same, four columns after four, each row by row.
    turned: Vec<Four>,
    /// Of the diagonal, by itself: a number put into a register by way of memory is waited for. 0 for a row left out.
    inverse: Vec<Four>,
    x: Vec<Four>,
}

impl Cholesky {
    /// Room for n rows.
    pub fn make_room(&mut self, n: usize) {
        let high = padded(n);
        if high > FOUR * self.x.len() {
            self.x.resize(high / FOUR, [0.0; FOUR]);
            self.inverse.resize(high / FOUR, [0.0; FOUR]);
            self.l.resize(high / FOUR * high, [0.0; FOUR]);
            self.turned.resize(high / FOUR * high, [0.0; FOUR]);
        }
    }

    /// Of the matrix of n rows that are [`padded`], whose diagonal is more by its share `soft`.
    #[inline(always)]
    pub fn factorise<L: Lane>(&mut self, n: usize, matrix: &[f64], soft: f64) {
        self.n = n;
        let (high, fours) = (padded(n), padded(n) / FOUR);
        // Column by column: the elements of one do not wait for each other.
        for k in 0..n {
            let (first, lane) = (k / FOUR, k % FOUR);
            let own = matrix[k * high..][..high].as_chunks::<FOUR>().0;
            let (above, below) = self.l.split_at_mut((first + 1) * high);
            let pivot = &mut above[first * high..];
            let turned = self.turned[first * high..][..high].as_chunks_mut::<FOUR>().0;
            let found = dots::<L>(pivot, pivot, (k, lane));
            let diagonal = own[first][lane] + soft * own[first][lane];
            let left = diagonal - found.numbers()[lane];
            let inverse = if left > DEPENDENT * diagonal { 1.0 / left.sqrt() } else { 0.0 };
            self.inverse[first][lane] = inverse;
            let x = (L::read(&own[first]) - found) * L::of(inverse);
            put(&x, &mut pivot[k], (&mut turned[first], lane));
            for four in first + 1..fours {
                let rows = &mut below[(four - first - 1) * high..][..high];
                let x = (L::read(&own[four]) - dots::<L>(rows, pivot, (k, lane))) * L::of(inverse);
                put(&x, &mut rows[k], (&mut turned[four], lane));
            }
        }
    }

    /// Solves for this right-hand side of n numbers; rows left out get 0.
    #[inline(always)]
    pub fn solve<L: Lane>(&mut self, right: &[f64]) {
        let (high, fours) = (padded(self.n), padded(self.n) / FOUR);
        for four in 0..fours {
            let (known, own) = self.l[four * high..][..high].split_at(FOUR * four);
            let (sum, mut rest, mut x) = (times::<L>(known, &self.x), [-0.0; FOUR], [0.0; FOUR]);
            for lane in 0..FOUR {
                let Some(right) = right.get(FOUR * four + lane) else { break };
                x[lane] = (right - (sum.numbers()[lane] + rest[lane])) * self.inverse[four][lane];
                for below in lane + 1..FOUR {
                    rest[below] += own[lane][below] * x[lane];
                }
            }
            self.x[four] = x;
        }
        for four in (0..fours).rev() {
            let (own, below) = self.turned[four * high..][FOUR * four..high].split_at(FOUR);
            let found = &self.x[four + 1..fours].as_flattened()[..self.n.saturating_sub(FOUR * (four + 1))];
            let mut left = L::read(&self.x[four]);
            for (row, x) in below[..found.len()].iter().zip(found).rev() {
                left -= L::read(row) * L::of(*x);
            }
            let mut x = [left.numbers()[0], left.numbers()[1], left.numbers()[2], left.numbers()[3]];
            for lane in (0..FOUR).rev() {
                if FOUR * four + lane >= self.n {
                    continue;
                }
                x[lane] *= self.inverse[four][lane];
                for above in 0..lane {
                    x[above] -= own[lane][above] * x[lane];
                }
            }
            self.x[four] = x;
        }
    }

    /// What the last solve found.
    pub fn solution(&self) -> &[f64] {
        &self.x.as_flattened()[..self.n]
    }
}

/// Puts the numbers of a column of four rows where both orders want them.
#[inline(always)]
fn put<L: Lane>(x: &L, column: &mut Four, (rows, lane): (&mut [Four; FOUR], usize)) {
    column.copy_from_slice(x.numbers());
    for (row, x) in rows.iter_mut().zip(column) {
        row[lane] = *x;
    }
}

/// [`dot`] of the first k numbers of each of four rows with those of row `lane` of four others; both column by column.
#[inline(always)]
fn dots<L: Lane>(rows: &[Four], others: &[Four], (k, lane): (usize, usize)) -> L {
    let ((rows, last), (others, other)) = (rows[..k].as_chunks::<FOUR>(), others[..k].as_chunks::<FOUR>());
    let (mut sums, mut rest) = ([L::of(0.0); FOUR], L::of(-0.0));
    for (row, other) in rows.iter().zip(others) {
        for j in 0..FOUR {
            sums[j] += L::read(&row[j]) * L::of(other[j][lane]);
        }
    }
    for (row, other) in last.iter().zip(other) {
        rest += L::read(row) * L::of(other[lane]);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// [`dot`] of each of four rows, column by column in whole fours, with x.
#[inline(always)]
fn times<L: Lane>(rows: &[Four], x: &[Four]) -> L {
    let mut sums = [L::of(0.0); FOUR];
    for (row, x) in rows.as_chunks::<FOUR>().0.iter().zip(x) {
        for j in 0..FOUR {
            sums[j] += L::read(&row[j]) * L::of(x[j]);
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
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
    across(sum.numbers()) + rest
}

/// The sum of four lanes, in a fixed order.
#[inline(always)]
pub(super) fn across(s: &[f64]) -> f64 {
    (s[0] + s[1]) + (s[2] + s[3])
}
