//! Products of rows, `Y Yᵀ`: how an impulse of one moves another.

use super::rows::{Block, CHUNK, Rows};
use crate::math::{Lane, Lanes4, wide};

impl Rows {
    /// `Y Yᵀ + R`.
    pub(super) fn fill(&self, a: &mut [f64]) {
        wide!(Self::fill_any::<Lanes4>, Rows::fill_any::<crate::math::X4<false>>, (this: &Rows = self, a: &mut [f64] = a));
    }

    #[inline(always)]
    fn fill_any<L: Lane>(&self, a: &mut [f64]) {
        let n = self.rows.len();
        for (i, b) in self.blocks.iter().enumerate() {
            for c in &self.blocks[..=i] {
                if !b.is_off() && !c.is_off() {
                    self.couple_blocks::<L>(b, c, a);
                    continue;
                }
                for k in 0..b.rows {
                    a[(b.first + k) * n + c.first..][..c.rows].fill(0.0);
                }
            }
        }
        for (i, row) in self.rows.iter().enumerate() {
            let (above, own) = a.split_at_mut(i * n);
            own[i] += row.softness;
            for (above, own) in above.chunks_exact_mut(n).zip(own) {
                above[i] = *own;
            }
        }
    }

    #[inline(always)]
    fn couple_blocks<L: Lane>(&self, b: &Block, c: &Block, a: &mut [f64]) {
        match (b.rows, c.rows) {
            (3, 3) => self.couple::<L, 3, 3>(b, c, a),
            (3, 1) => self.couple::<L, 3, 1>(b, c, a),
            (1, 3) => self.couple::<L, 1, 3>(b, c, a),
            (1, 1) => self.couple::<L, 1, 1>(b, c, a),
            _ => {
                for p in 0..b.rows {
                    for q in 0..c.rows {
                        a[(b.first + p) * self.rows.len() + c.first + q] = self.between((b, p), (c, q));
                    }
                }
            }
        }
    }

    /// Two blocks of P and Q rows.
    #[inline(always)]
    fn couple<L: Lane, const P: usize, const Q: usize>(&self, b: &Block, c: &Block, a: &mut [f64]) {
        let n = self.rows.len();
        let (ids, others) = (&self.ids[b.ids.clone()], &self.ids[c.ids.clone()]);
        let mut y: [&[[f64; CHUNK]]; P] = [&[]; P];
        for (p, y) in y.iter_mut().enumerate() {
            *y = &self.numbers(b, p).as_chunks().0[..ids.len()];
        }
        let mut z: [&[[f64; CHUNK]]; Q] = [&[]; Q];
        for (q, z) in z.iter_mut().enumerate() {
            *z = &self.numbers(c, q).as_chunks().0[..others.len()];
        }
        let mut sums = [[L::of(0.0); Q]; P];
        let (mut i, mut k) = (0, 0);
        while i < ids.len() && k < others.len() {
            match ids[i].cmp(&others[k]) {
                std::cmp::Ordering::Less => i += 1,
                std::cmp::Ordering::Greater => k += 1,
                std::cmp::Ordering::Equal => {
                    for q in 0..Q {
                        let other = L::read(&z[q][k]);
                        for p in 0..P {
                            sums[p][q] += L::read(&y[p][i]) * other;
                        }
                    }
                    (i, k) = (i + 1, k + 1);
                }
            }
        }
        for (p, sums) in sums.iter().enumerate() {
            for (q, sum) in sums.iter().enumerate() {
                let s = sum.numbers();
                a[(b.first + p) * n + c.first + q] = (s[0] + s[1]) + (s[2] + s[3]);
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
