//! The position pass on the rows of the velocity pass: pseudo-impulses that undo penetrations, on a w of their own. Only the
//! first row of a block counts (the normal one of a contact), and its softness does not.

use super::dense::{Cholesky, padded};
use super::rows::{FINISH_ROWS, Rows, Solved};
use crate::math::Lanes4;

/// What is asked of a block's first row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LiftKind {
    /// Nothing; it takes no part.
    #[default]
    Off,
    /// `bias + y·w' ≥ 0`, by an impulse ≥ 0 that is 0 where it is greater.
    AtLeast,
    /// `bias + y·w' = 0`.
    Exactly,
}

/// A block in the position pass.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lift {
    /// What is asked.
    pub kind: LiftKind,
    /// Pseudo-velocity without impulses minus the one wanted: rad/s or m/s.
    pub bias: f64,
    /// Pseudo-impulse, N·m·s or N·s; kept as the start of the next solve.
    pub impulse: f64,
}

/// Softness of the direct finish, relative to a row's own mobility: it makes dependent rows (the corners of a box) solvable,
/// and [`REFINE`] takes its effect out again but for its square.
const SOFT: f64 = 1e-9;
/// Solutions of the soft problem, each around the one before.
const REFINE: u32 = 2;
/// Exchanges of many rows that need not reduce the number of wrong ones (Júdice and Pires 1994).
const PATIENCE: u32 = 3;

/// Memory of the position pass.
#[derive(Clone, Debug, Default)]
pub(super) struct Lifts {
    of: Vec<Lift>,
    w: Vec<f64>,
    /// Blocks that take part.
    active: Vec<usize>,
    /// `|y|²` of each.
    own: Vec<f64>,
    dense: Dense,
}

/// The direct finish: rows and columns are those of `active`.
#[derive(Clone, Debug, Default)]
struct Dense {
    /// `Y Yᵀ`.
    a: Vec<f64>,
    factor: Cholesky,
    /// Of those that have an impulse, [`padded`], softened.
    matrix: Vec<f64>,
    bias: Vec<f64>,
    x: Vec<f64>,
    velocity: Vec<f64>,
    /// Impulses on the way down.
    at: Vec<f64>,
    /// Which have an impulse: their velocity is 0.
    pushes: Vec<bool>,
    free: Vec<usize>,
    /// Right-hand side of those.
    right: Vec<f64>,
}

impl Lifts {
    pub fn new(width: usize) -> Self {
        Self { w: vec![0.0; width], ..Self::default() }
    }

    /// Room for one more block, so that a solve allocates nothing.
    pub fn add(&mut self) {
        self.of.push(Lift::default());
        let n = self.of.len();
        self.active.reserve(n - self.active.len().min(n));
        self.own.reserve(n - self.own.len().min(n));
        if n <= FINISH_ROWS {
            self.dense.make_room(n);
        }
    }

    pub fn truncate(&mut self, blocks: usize) {
        self.of.truncate(blocks);
    }
}

impl Dense {
    fn make_room(&mut self, n: usize) {
        if n <= self.x.len() {
            return;
        }
        self.a.resize(n * n, 0.0);
        self.matrix.resize(n * padded(n), 0.0);
        self.factor.make_room(n);
        for v in [&mut self.bias, &mut self.x, &mut self.velocity, &mut self.at] {
            v.resize(n, 0.0);
        }
        self.pushes.resize(n, false);
        self.free.clear();
        self.free.reserve(n);
        self.right.clear();
        self.right.reserve(n);
    }
}

impl Rows {
    /// What the position pass asks of a block.
    pub fn lift(&mut self, block: usize) -> &mut Lift {
        &mut self.lifts.of[block]
    }

    /// The same, to look at.
    pub fn lift_of(&self, block: usize) -> &Lift {
        &self.lifts.of[block]
    }

    /// Finds the pseudo-impulses, from those that are there: at most `sweeps` Gauss–Seidel sweeps, then the direct finish if
    /// it is needed and at most [`FINISH_ROWS`] rows take part. `aim` as in [`Rows::solve`]. The impulses of the velocity
    /// pass have no part in it.
    pub fn solve_lifts(&mut self, sweeps: u32, aim: f64) -> Solved {
        let mut l = std::mem::take(&mut self.lifts);
        self.start_lifts(&mut l);
        let mut solved = Solved { scale: self.lift_scale(&l), ..Solved::default() };
        let wanted = aim * solved.scale;
        while solved.sweeps < sweeps && !l.active.is_empty() {
            solved.sweeps += 1;
            if self.sweep_lifts(&mut l) <= wanted {
                break;
            }
        }
        solved.residual = self.lift_residual(&l);
        if solved.residual > wanted && l.active.len() <= FINISH_ROWS {
            solved.tries = 1;
            solved.residual = self.finish_lifts(&mut l, solved.residual, wanted);
        }
        self.lifts = l;
        solved
    }

    /// Who takes part, and w' of the impulses that are there.
    fn start_lifts(&self, l: &mut Lifts) {
        l.active.clear();
        l.own.clear();
        for (k, b) in self.blocks.iter().enumerate() {
            let lift = &mut l.of[k];
            let own = self.numbers(b, 0).iter().map(|y| y * y).sum();
            if lift.kind == LiftKind::Off || b.is_off() || own <= 0.0 {
                lift.impulse = 0.0;
            } else {
                l.active.push(k);
                l.own.push(own);
            }
        }
        self.gather_lifts(l);
    }

    fn gather_lifts(&self, l: &mut Lifts) {
        l.w.fill(0.0);
        for k in &l.active {
            self.push_into::<Lanes4>(&mut l.w, &self.blocks[*k], 0, l.of[*k].impulse);
        }
    }

    fn lift_scale(&self, l: &Lifts) -> f64 {
        let size = |k: &usize| l.of[*k].bias.abs() + self.reach_of::<Lanes4>(&l.w, &self.blocks[*k], 0).abs();
        l.active.iter().map(size).fold(0.0, f64::max)
    }

    fn sweep_lifts(&self, l: &mut Lifts) -> f64 {
        let mut most = 0.0f64;
        for (k, own) in l.active.iter().zip(&l.own) {
            let (b, lift) = (&self.blocks[*k], &mut l.of[*k]);
            let x = lift.clipped(lift.impulse - (lift.bias + self.reach_of::<Lanes4>(&l.w, b, 0)) / own);
            let by = x - lift.impulse;
            lift.impulse = x;
            self.push_into::<Lanes4>(&mut l.w, b, 0, by);
            most = most.max(by.abs() * own);
        }
        most
    }

    fn lift_residual(&self, l: &Lifts) -> f64 {
        let violation = |(k, own): (&usize, &f64)| {
            let lift = &l.of[*k];
            let to =
                lift.clipped(lift.impulse - (lift.bias + self.reach_of::<Lanes4>(&l.w, &self.blocks[*k], 0)) / own);
            (lift.impulse - to).abs() * own
        };
        l.active.iter().zip(&l.own).map(violation).fold(0.0, f64::max)
    }

    /// Block principal pivoting on the softened problem; kept if the residual falls, which is returned.
    fn finish_lifts(&self, l: &mut Lifts, residual: f64, wanted: f64) -> f64 {
        let mut d = std::mem::take(&mut l.dense);
        let n = l.active.len();
        d.make_room(n);
        for i in 0..n {
            for k in 0..=i {
                let a = self.between((&self.blocks[l.active[i]], 0), (&self.blocks[l.active[k]], 0));
                (d.a[i * n + k], d.a[k * n + i]) = (a, a);
            }
            d.x[i] = l.of[l.active[i]].impulse;
            d.pushes[i] = d.x[i] > 0.0 || l.of[l.active[i]].kind == LiftKind::Exactly;
        }
        for _ in 0..REFINE {
            for i in 0..n {
                d.bias[i] = l.of[l.active[i]].bias - SOFT * l.own[i] * d.x[i];
            }
            d.pivot(l, 0.1 * wanted);
            if d.violation(l) <= wanted {
                break;
            }
        }
        for (k, x) in l.active.iter().zip(&mut d.x) {
            let lift = &mut l.of[*k];
            (lift.impulse, *x) = (lift.clipped(*x), lift.impulse);
        }
        self.gather_lifts(l);
        let mut better = self.lift_residual(l);
        if better.is_nan() || better >= residual {
            for (k, x) in l.active.iter().zip(&d.x) {
                l.of[*k].impulse = *x;
            }
            self.gather_lifts(l);
            better = residual;
        }
        l.dense = d;
        better
    }
}

impl Dense {
    /// Exchanges rows until none is wrong: those with an impulse have a velocity of 0, the others one that is not less. All
    /// wrong ones at once as long as that makes them fewer, then one at a time on the way down the energy, which ends.
    fn pivot(&mut self, l: &Lifts, slack: f64) {
        let n = l.active.len();
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        loop {
            self.solve(&l.own);
            let wrong = (0..n).filter(|i| self.is_wrong(l, *i, slack)).count();
            if wrong == 0 {
                return;
            }
            if wrong < fewest {
                (fewest, patience) = (wrong, PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else {
                return self.descend(l, slack);
            }
            for i in 0..n {
                self.pushes[i] ^= self.is_wrong(l, i, slack);
            }
        }
    }

    fn is_wrong(&self, l: &Lifts, i: usize, slack: f64) -> bool {
        let lift = &l.of[l.active[i]];
        lift.kind == LiftKind::AtLeast && if self.pushes[i] { self.x[i] < 0.0 } else { self.velocity[i] < -slack }
    }

    /// The active set of Lawson and Hanson (1974), from the impulses of the sweeps: each step lowers the energy.
    fn descend(&mut self, l: &Lifts, slack: f64) {
        let n = l.active.len();
        for (i, k) in l.active.iter().enumerate() {
            self.at[i] = l.of[*k].impulse;
            self.pushes[i] = self.at[i] > 0.0 || l.of[*k].kind == LiftKind::Exactly;
        }
        for _ in 0..8 * n + 8 {
            self.solve(&l.own);
            let once = |i: usize| l.of[l.active[i]].kind == LiftKind::AtLeast;
            let share = |d: &Self, i: usize| d.at[i] / (d.at[i] - d.x[i]);
            let blocks = |d: &Self, i: usize| d.pushes[i] && once(i) && d.x[i] < 0.0;
            let nearest =
                (0..n).filter(|i| blocks(self, *i)).min_by(|i, k| share(self, *i).total_cmp(&share(self, *k)));
            let part = nearest.map_or(1.0, |i| share(self, i));
            for i in 0..n {
                self.at[i] += part * (self.x[i] - self.at[i]);
            }
            if let Some(i) = nearest {
                (self.at[i], self.pushes[i]) = (0.0, false);
                continue;
            }
            let worst =
                (0..n).filter(|i| !self.pushes[*i]).min_by(|i, k| self.velocity[*i].total_cmp(&self.velocity[*k]));
            match worst.filter(|i| self.velocity[*i] < -slack) {
                Some(i) => self.pushes[i] = true,
                None => return,
            }
        }
    }

    /// The largest, without softness.
    fn violation(&self, l: &Lifts) -> f64 {
        let of = |(i, k): (usize, &usize)| {
            let (lift, own, x) = (&l.of[*k], l.own[i], self.x[i]);
            let hard = self.velocity[i] - self.bias[i] + lift.bias;
            (x - lift.clipped(x - hard / own)).abs() * own
        };
        l.active.iter().enumerate().map(of).fold(0.0, f64::max)
    }

    /// Impulses and velocities for the present choice.
    fn solve(&mut self, own: &[f64]) {
        let n = own.len();
        self.free.clear();
        self.free.extend((0..n).filter(|i| self.pushes[*i]));
        let (a, free) = (&self.a, &self.free);
        for ((at, row), i) in self.matrix.chunks_exact_mut(padded(free.len())).enumerate().zip(free) {
            for (to, k) in row.iter_mut().zip(free) {
                *to = a[i * n + k];
            }
            row[at] += SOFT * own[*i];
        }
        self.factor.factorise::<Lanes4>(free.len(), &self.matrix, 0.0);
        self.right.clear();
        self.right.extend(free.iter().map(|i| -self.bias[*i]));
        self.factor.solve::<Lanes4>(&self.right);
        self.x.fill(0.0);
        for (i, x) in free.iter().zip(self.factor.solution()) {
            self.x[*i] = *x;
        }
        for i in 0..n {
            self.velocity[i] = self.bias[i] + free.iter().map(|k| a[i * n + k] * self.x[*k]).sum::<f64>();
        }
    }
}

impl Lift {
    #[inline(always)]
    fn clipped(&self, x: f64) -> f64 {
        if self.kind == LiftKind::AtLeast { x.max(0.0) } else { x }
    }
}
