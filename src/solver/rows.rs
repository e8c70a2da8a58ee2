//! Constraint rows in factor space: each holds its response y; its velocity is `bias + y·w`, its impulse x moves w by y x.

use super::dense::across;
use super::inner::Inner;
use crate::math::{Lane, Lanes4, wide};

/// Numbers in a chunk of w.
pub(super) const CHUNK: usize = crate::dynamics::CHUNK;
/// A residual within this many times the wanted one is not worth another try that may not help.
pub(super) const NEARLY: f64 = 1e3;
/// More rows than this are left to the iteration: the direct finish costs their cube.
pub const FINISH_ROWS: usize = 120;

/// What the impulses of a block may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// One row with an impulse from `lower` to `upper`, which may be infinite: an equality, a stop, a bounded drive.
    Bounds {
        /// N·m·s or N·s.
        lower: f64,
        /// N·m·s or N·s.
        upper: f64,
    },
    /// Three rows, normal, tangent, tangent: Coulomb's law.
    Cone {
        /// Coefficient of friction.
        friction: f64,
    },
    /// One row (spinning) or two (rolling) within a disc whose radius is `ratio` times the impulse of another row.
    Disc {
        /// m.
        ratio: f64,
        /// Index of the row: the normal one of a contact.
        normal: usize,
    },
}

impl Kind {
    /// An impulse of any size and sign.
    pub const EQUALITY: Self = Self::Bounds { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
}

/// One row.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// Velocity without impulses, minus the one wanted: rad/s or m/s.
    pub bias: f64,
    /// Softness R ≥ 0: the row gives way by R times its impulse, rad/s per N·m·s. From J-18's CFM: CFM / step.
    pub softness: f64,
    /// Impulse, kept for the next step; N·m·s or N·s.
    pub impulse: f64,
}

/// Rows that act on the same bodies and are solved as one.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub kind: Kind,
    /// First row.
    pub first: usize,
    pub rows: usize,
    /// Chunks of w in which its rows differ from 0.
    pub ids: std::ops::Range<usize>,
    /// Start of its numbers.
    pub values: usize,
    pub inner: Inner,
    /// Of a contact that slides: velocity against impulse, from the last visit.
    pub slip: f64,
}

/// What a solve came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solved {
    /// Largest violation, rad/s or m/s.
    pub residual: f64,
    /// Sweeps made.
    pub sweeps: u32,
    /// Tries of the direct finish.
    pub tries: u32,
    /// The largest velocity that the rows started with, rad/s or m/s: what a tolerance is relative to.
    pub scale: f64,
}

impl Solved {
    /// Is the residual at most this share of the velocities that the rows started with?
    pub fn within(&self, tolerance: f64) -> bool {
        self.residual <= tolerance * self.scale
    }
}

/// The rows of a problem. Adding blocks may allocate; solving does not.
#[derive(Clone, Debug)]
pub struct Rows {
    pub(super) blocks: Vec<Block>,
    pub(super) rows: Vec<Row>,
    pub(super) ids: Vec<u32>,
    pub(super) values: Vec<f64>,
    pub(super) w: Vec<f64>,
    /// `y·w` of each row, since w was last gathered or measured.
    reached: Vec<f64>,
    pub(super) finish: super::finish::Scratch,
    pub(super) lifts: super::lifts::Lifts,
}

impl Rows {
    /// No rows yet, over a w of this many numbers (a multiple of 4).
    pub fn new(width: usize) -> Self {
        Self {
            blocks: vec![],
            rows: vec![],
            ids: vec![],
            values: vec![],
            w: vec![0.0; width],
            reached: vec![],
            finish: Default::default(),
            lifts: super::lifts::Lifts::new(width),
        }
    }

    /// Adds a block of `rows` rows over these chunks of w, ascending; returns its index. It starts switched off, with all
    /// numbers 0; [`Rows::seal`] switches it on.
    pub fn add(&mut self, kind: Kind, rows: usize, ids: &[u32]) -> usize {
        let (first, start, values) = (self.rows.len(), self.ids.len(), self.values.len());
        self.ids.extend_from_slice(ids);
        self.values.resize(values + rows * ids.len() * CHUNK, 0.0);
        self.rows.resize(first + rows, Row::default());
        self.reached.resize(first + rows, 0.0);
        self.blocks.push(Block { kind, first, rows, ids: start..self.ids.len(), values, inner: Inner::Off, slip: 0.0 });
        self.finish.make_room(self.rows.len(), self.w.len());
        self.lifts.add();
        self.blocks.len() - 1
    }

    /// Drops the blocks from this index on and keeps their memory: adding as many again allocates nothing.
    pub fn truncate(&mut self, blocks: usize) {
        let Some(b) = self.blocks.get(blocks) else { return };
        self.rows.truncate(b.first);
        self.reached.truncate(b.first);
        self.ids.truncate(b.ids.start);
        self.values.truncate(b.values);
        self.blocks.truncate(blocks);
        self.lifts.truncate(blocks);
    }

    /// Chunks of a block, and the numbers of its row `n` in them.
    pub fn response(&mut self, block: usize, n: usize) -> (&[u32], &mut [f64]) {
        let b = &self.blocks[block];
        let (ids, length) = (&self.ids[b.ids.clone()], b.ids.len() * CHUNK);
        let start = b.values + n * length;
        (ids, &mut self.values[start..start + length])
    }

    /// Row `n` of a block.
    pub fn row(&mut self, block: usize, n: usize) -> &mut Row {
        &mut self.rows[self.blocks[block].first + n]
    }

    /// Index of the first row of a block.
    pub fn first_row(&self, block: usize) -> usize {
        self.blocks[block].first
    }

    /// Impulse of row `n` of a block.
    pub fn impulse(&self, block: usize, n: usize) -> f64 {
        self.rows[self.blocks[block].first + n].impulse
    }

    /// Impulse of the only row of a block.
    pub(super) fn row_impulse(&self, block: usize) -> f64 {
        self.rows[self.blocks[block].first].impulse
    }

    /// True if a block takes no part.
    pub fn is_off(&self, block: usize) -> bool {
        self.blocks[block].is_off()
    }

    /// All rows in the order of their blocks.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Takes a block out, and its impulses.
    pub fn switch_off(&mut self, block: usize) {
        let b = &mut self.blocks[block];
        b.inner = Inner::Off;
        for row in &mut self.rows[b.first..b.first + b.rows] {
            row.impulse = 0.0;
        }
    }

    /// Trace of a block's own part of `Y Yᵀ + R`.
    pub fn trace(&self, block: usize) -> f64 {
        self.blocks[block].inner.trace()
    }

    /// Forgets all impulses.
    pub fn reset(&mut self) {
        for row in &mut self.rows {
            row.impulse = 0.0;
        }
    }

    /// Scales the impulses of the last step to a step of another length.
    pub fn scale_impulses(&mut self, factor: f64) {
        for row in &mut self.rows {
            row.impulse *= factor;
        }
    }

    /// Finds the impulses, from those of the last solve: at most `sweeps` Gauss–Seidel sweeps, then the direct finish if
    /// it is needed and there are not too many rows. Ends early where the residual is `aim` times the velocities at the
    /// start; about 1e-15 of them is rounding.
    pub fn solve(&mut self, sweeps: u32, aim: f64) -> Solved {
        self.solve_within((sweeps.max(1), super::finish::MANY), aim)
    }

    /// The same with a bound on the tries of the finish.
    pub fn solve_within(&mut self, (sweeps, tries): (u32, usize), aim: f64) -> Solved {
        self.gather();
        let mut solved = Solved { scale: self.scale(), ..Solved::default() };
        let wanted = aim * solved.scale;
        while solved.sweeps < sweeps {
            solved.sweeps += 1;
            if self.sweep() <= wanted {
                break;
            }
        }
        if solved.sweeps > 0 {
            self.measure();
        }
        solved.residual = self.residual();
        if solved.residual > wanted && self.rows.len() <= FINISH_ROWS {
            (solved.residual, solved.tries) = self.finish(solved.residual, wanted, tries);
        }
        solved
    }

    /// w of the impulses, and what it does to the rows.
    pub(super) fn gather(&mut self) {
        if self.rows.iter().all(|row| row.impulse == 0.0) {
            self.w.fill(0.0);
            return self.reached.fill(0.0);
        }
        let mut w = std::mem::take(&mut self.w);
        self.gather_into(&mut w);
        self.w = w;
        self.measure();
    }

    fn gather_into(&self, w: &mut [f64]) {
        wide!(Self::gather_any::<Lanes4>, Rows::gather_any::<crate::math::X4<false>>, (this: &Rows = self, w: &mut [f64] = w));
    }

    #[inline(always)]
    fn gather_any<L: Lane>(&self, w: &mut [f64]) {
        w.fill(0.0);
        for b in &self.blocks {
            for (n, row) in self.rows[b.first..b.first + b.rows].iter().enumerate() {
                self.push_into::<L>(w, b, n, row.impulse);
            }
        }
    }

    /// What w does to the rows, after sweeps.
    pub(super) fn measure(&mut self) {
        let mut reached = std::mem::take(&mut self.reached);
        self.measure_into(&mut reached);
        self.reached = reached;
    }

    fn measure_into(&self, out: &mut [f64]) {
        wide!(
            Self::measure_any::<Lanes4>,
            Rows::measure_any::<crate::math::X4<false>>,
            (this: &Rows = self, out: &mut [f64] = out)
        );
    }

    #[inline(always)]
    fn measure_any<L: Lane>(&self, out: &mut [f64]) {
        for b in &self.blocks {
            for (n, out) in out[b.first..b.first + b.rows].iter_mut().enumerate() {
                *out = self.reach_of::<L>(&self.w, b, n);
            }
        }
    }

    /// The velocities that the tolerance is relative to.
    fn scale(&self) -> f64 {
        let mut most = 0.0_f64;
        for b in self.blocks.iter().filter(|b| !b.is_off()) {
            let own = b.first..b.first + b.rows;
            for (row, reached) in self.rows[own.clone()].iter().zip(&self.reached[own]) {
                most = most.max(row.bias.abs() + reached.abs());
            }
        }
        most
    }

    /// Σ x·(bias + y·w/2) for the w of [`Rows::gather`].
    pub(super) fn work(&self) -> f64 {
        let of = |b: &Block, n: usize| {
            let row = &self.rows[b.first + n];
            row.impulse * (row.bias + 0.5 * self.reached[b.first + n])
        };
        self.blocks.iter().filter(|b| !b.is_off()).map(|b| (0..b.rows).map(|n| of(b, n)).sum::<f64>()).sum()
    }

    /// The greatest velocity without impulses, against the one wanted.
    pub(super) fn most_bias(&self) -> f64 {
        self.rows.iter().map(|row| row.bias.abs()).fold(0.0, f64::max)
    }

    /// `|w|²`.
    pub(super) fn size(&self) -> f64 {
        self.w.iter().map(|w| w * w).sum()
    }

    /// `y·w` of a row, with another w.
    #[inline(always)]
    pub(super) fn reach_of<L: Lane>(&self, w: &[f64], b: &Block, n: usize) -> f64 {
        let (mut sum, w) = (L::of(0.0), w.as_chunks::<CHUNK>().0);
        for (id, y) in self.ids[b.ids.clone()].iter().zip(self.numbers(b, n).as_chunks::<CHUNK>().0) {
            sum += L::read(y) * L::read(&w[*id as usize]);
        }
        across(sum.numbers())
    }

    /// `w += y x`, of another w.
    #[inline(always)]
    pub(super) fn push_into<L: Lane>(&self, w: &mut [f64], b: &Block, n: usize, x: f64) {
        if x == 0.0 {
            return;
        }
        let (x, w) = (L::of(x), w.as_chunks_mut::<CHUNK>().0);
        for (id, y) in self.ids[b.ids.clone()].iter().zip(self.numbers(b, n).as_chunks::<CHUNK>().0) {
            let w = &mut w[*id as usize];
            let sum = L::read(w) + L::read(y) * x;
            w.copy_from_slice(sum.numbers());
        }
    }

    /// The numbers of a row, in the order of its chunks.
    #[inline(always)]
    pub(super) fn numbers(&self, b: &Block, n: usize) -> &[f64] {
        let length = b.ids.len() * CHUNK;
        &self.values[b.values + n * length..b.values + (n + 1) * length]
    }

    /// Velocity of a row with all impulses, what its softness gives way included.
    #[inline(always)]
    pub(super) fn velocity(&self, b: &Block, n: usize) -> f64 {
        let row = &self.rows[b.first + n];
        row.bias + self.reached[b.first + n] + row.softness * row.impulse
    }
}

impl Block {
    pub fn is_off(&self) -> bool {
        matches!(self.inner, Inner::Off)
    }
}
