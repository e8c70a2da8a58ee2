//! Products of rows, `Y Yᵀ`: how an impulse of one moves another.

use super::dense::{across, padded};
use super::rows::{Block, CHUNK, Rows};
use crate::math::{Lane, Lanes4, wide};
use std::ops::Range;

type Chunk = [f64; CHUNK];

/// Runs of fewer rows than this are not worth to be turned.
const FEW: usize = 3;

/// Memory of the products.
#[derive(Clone, Debug, Default)]
pub(super) struct Products {
    runs: Vec<Run>,
    /// The rows of a run, four after four: chunk by chunk a number of each, then the next one of each.
    turned: Vec<[Chunk; CHUNK]>,
    /// Chunks that two runs have in common, by their places in both.
    both: Vec<(usize, usize)>,
}

/// Blocks that follow each other over the same chunks of w: those of the contacts between two bodies.
#[derive(Clone, Debug)]
struct Run {
    blocks: Range<usize>,
    rows: Range<usize>,
    /// A pair of rows is multiplied number by number.
    pair: bool,
}

impl Products {
    /// Room for this many rows over a w of this many numbers.
    pub fn make_room(&mut self, rows: usize, width: usize) {
        let chunks = width.div_ceil(CHUNK);
        self.runs.reserve(rows - self.runs.len().min(rows));
        self.both.reserve(chunks - self.both.len().min(chunks));
        self.turned.resize(padded(rows) / CHUNK * chunks, [[0.0; CHUNK]; CHUNK]);
    }
}

impl Rows {
    /// `Y Yᵀ + R`, of rows that are [`padded`].
    pub(super) fn fill(&self, a: &mut [f64], s: &mut Products) {
        wide!(
            Self::fill_any::<Lanes4>,
            Rows::fill_any::<crate::math::X4<false>>,
            (this: &Rows = self, a: &mut [f64] = a, s: &mut Products = s)
        );
    }

    #[inline(always)]
    fn fill_any<L: Lane>(&self, a: &mut [f64], s: &mut Products) {
        let high = padded(self.rows.len());
        self.find_runs(&mut s.runs);
        if self.blocks.iter().any(Block::is_off) {
            a[..self.rows.len() * high].fill(0.0);
        }
        let Products { runs, turned, both } = s;
        for (i, c) in runs.iter().enumerate() {
            if !c.pair && c.rows.len() >= FEW {
                self.turn(c, turned);
            }
            for b in &runs[i..] {
                self.find_both(b, c, both);
                self.couple::<L>((b, c), (turned, both), a);
            }
        }
        for (i, row) in self.rows.iter().enumerate() {
            let (above, own) = a.split_at_mut(i * high);
            own[i] += row.softness;
            for (above, own) in above.chunks_exact_mut(high).zip(own) {
                above[i] = *own;
            }
        }
    }

    fn find_runs(&self, runs: &mut Vec<Run>) {
        runs.clear();
        for (k, b) in self.blocks.iter().enumerate().filter(|(_, b)| !b.is_off()) {
            let (pair, end) = (b.rows == 2, b.first + b.rows);
            match runs.last_mut() {
                Some(run)
                    if !run.pair && !pair && run.blocks.end == k && self.over(run) == &self.ids[b.ids.clone()] =>
                {
                    (run.blocks.end, run.rows.end) = (k + 1, end);
                }
                _ => runs.push(Run { blocks: k..k + 1, rows: b.first..end, pair }),
            }
        }
    }

    /// The chunks of a run.
    #[inline(always)]
    fn over(&self, run: &Run) -> &[u32] {
        &self.ids[self.blocks[run.blocks.start].ids.clone()]
    }

    /// All numbers of a run, row by row.
    #[inline(always)]
    fn all_numbers(&self, run: &Run) -> &[Chunk] {
        let b = &self.blocks[run.blocks.start];
        self.values[b.values..][..run.rows.len() * b.ids.len() * CHUNK].as_chunks().0
    }

    #[inline(always)]
    fn find_both(&self, b: &Run, c: &Run, both: &mut Vec<(usize, usize)>) {
        both.clear();
        let (ids, others) = (self.over(b), self.over(c));
        let (mut i, mut k) = (0, 0);
        while i < ids.len() && k < others.len() {
            if ids[i] == others[k] {
                both.push((i, k));
            }
            (i, k) = (i + usize::from(ids[i] <= others[k]), k + usize::from(others[k] <= ids[i]));
        }
    }

    #[inline(always)]
    fn turn(&self, run: &Run, turned: &mut [[Chunk; CHUNK]]) {
        let length = self.over(run).len().max(1);
        let rows = self.all_numbers(run).chunks(CHUNK * length);
        for (four, to) in rows.zip(turned.chunks_exact_mut(length)) {
            for (lane, row) in four.chunks_exact(length).enumerate() {
                for (to, y) in to.iter_mut().zip(row) {
                    for (to, y) in to.iter_mut().zip(y) {
                        to[lane] = *y;
                    }
                }
            }
        }
    }

    /// The products of the rows of b with those of c, which come first or are the same.
    #[inline(always)]
    fn couple<L: Lane>(
        &self,
        (b, c): (&Run, &Run),
        (turned, both): (&[[Chunk; CHUNK]], &[(usize, usize)]),
        a: &mut [f64],
    ) {
        if b.pair || c.pair {
            return self.couple_pair(b, c, a);
        }
        // Places, not chunks of as many: how many of those there are would be divided anew for every row.
        let (high, length, others) = (padded(self.rows.len()), self.over(b).len(), self.over(c).len());
        let (own, other) = (self.all_numbers(b), self.all_numbers(c));
        for row in b.rows.clone() {
            let y = &own[(row - b.rows.start) * length..][..length];
            let to = &mut a[row * high..][c.rows.clone()];
            if to.len() < FEW {
                for (q, to) in to.iter_mut().enumerate() {
                    *to = one::<L>(y, &other[q * others..][..others], both);
                }
                continue;
            }
            let last = (row - c.rows.start).min(to.len() - 1) / CHUNK;
            for k in 0..=last {
                let sums = four::<L>(y, &turned[k * others..][..others], both);
                let to = &mut to[k * CHUNK..];
                match to.first_chunk_mut::<CHUNK>() {
                    Some(to) => to.copy_from_slice(sums.numbers()),
                    None => to.iter_mut().zip(sums.numbers()).for_each(|(to, sum)| *to = *sum),
                }
            }
        }
    }

    fn couple_pair(&self, b: &Run, c: &Run, a: &mut [f64]) {
        let high = padded(self.rows.len());
        for b in &self.blocks[b.blocks.clone()] {
            for c in &self.blocks[c.blocks.clone()] {
                for p in 0..b.rows {
                    for q in 0..c.rows {
                        a[(b.first + p) * high + c.first + q] = self.between((b, p), (c, q));
                    }
                }
            }
        }
    }

    /// `y_a·y_b` of two rows, each given by its block and its number in it.
    pub(super) fn between(&self, (a, n): (&Block, usize), (b, m): (&Block, usize)) -> f64 {
        let (x, y) = (self.numbers(a, n).chunks_exact(CHUNK), self.numbers(b, m).chunks_exact(CHUNK));
        let (mut x, mut y) = (self.ids[a.ids.clone()].iter().zip(x), self.ids[b.ids.clone()].iter().zip(y));
        let (mut i, mut k, mut sum) = (x.next(), y.next(), 0.0);
        while let (Some((p, own)), Some((q, other))) = (i, k) {
            match p.cmp(q) {
                std::cmp::Ordering::Less => i = x.next(),
                std::cmp::Ordering::Greater => k = y.next(),
                std::cmp::Ordering::Equal => {
                    sum += own.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
                    (i, k) = (x.next(), y.next());
                }
            }
        }
        sum
    }
}

/// Of one row with one.
#[inline(always)]
fn one<L: Lane>(y: &[Chunk], z: &[Chunk], both: &[(usize, usize)]) -> f64 {
    let mut sum = L::of(0.0);
    for (i, k) in both {
        sum += L::read(&y[*i]) * L::read(&z[*k]);
    }
    across(sum.numbers())
}

/// The same of one row with four that are turned.
#[inline(always)]
fn four<L: Lane>(y: &[Chunk], z: &[[Chunk; CHUNK]], both: &[(usize, usize)]) -> L {
    let mut sums = [L::of(0.0); CHUNK];
    for (i, k) in both {
        let (y, z) = (&y[*i], &z[*k]);
        for j in 0..CHUNK {
            sums[j] += L::of(y[j]) * L::read(&z[j]);
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
