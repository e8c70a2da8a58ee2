//! Gragg–Bulirsch–Stoer: the explicit midpoint rule with 2, 4, 6 … parts of a step, whose error is a series in even powers of
//! the part, extrapolated to parts of no length (Hairer, Nørsett, Wanner: *Solving Ordinary Differential Equations I*, 1993, §II.9).
//! k such rows have order 2k and cost k² + 1 evaluations. How many rows, and how long a step, follows from the differences of
//! the last two columns, as Deuflhard has it (eq. 9.20–9.26 there).
//!
//! The error is that of a unit of time: a step of h seconds may be wrong by accuracy · h in each coordinate. So what adds up over
//! a second does not depend on how the second is divided, and is proportional to the accuracy.

use super::rbx::{Rbx, State, normalize_all};
use crate::dynamics::{aba_hybrid, coordinate_rates, damping_power};
use crate::model::Model;
use crate::solver::{CouplingStage, Margins, Shape};

/// Rows at the most: order 20.
const ROWS: usize = 10;
/// Rows at the first step.
const FIRST: usize = 4;
/// Work of the drives and losses are integrated, too.
pub(super) const WORKS: usize = 2;
/// What rounding leaves of a step, relative to 1 and the coordinate: a smaller error cannot be told from it.
const ROUNDING: f64 = 1e-15;
/// Of the length that is expected to fit, this share is tried, and the error is aimed at this share of the bound.
const CAUTION: f64 = 0.94;
const AIM: f64 = 0.65;
/// A length grows and shrinks at most by these factors at once.
const GROWTH: f64 = 20.0;
const SHRINKING: f64 = 0.1;
const LEAST_SHRINKING: f64 = 0.7;

/// Buffers of the method, and what it has learnt. Made only when it is chosen.
#[derive(Clone, Debug)]
pub(super) struct Extrapolation {
    /// State at the start of the piece.
    pub from: State,
    /// Rates there: coordinates (nq), accelerations (nv), powers (2).
    pub slope: Vec<f64>,
    /// Way since the start, in the same order: at the last node but one, and at the last.
    before: Vec<f64>,
    now: Vec<f64>,
    /// The way of the piece, extrapolated.
    pub way: Vec<f64>,
    rates: Vec<f64>,
    /// The last row of the table: column l at l · n.
    columns: Vec<f64>,
    /// Per row: error of the last try over its bound.
    ratios: [f64; ROWS],
    /// Row that was taken last.
    used: usize,
    /// Per row: did one of its nodes leave the laws?
    strayed: [bool; ROWS],
    /// How far the axes are from leaving their laws, at the start and at the end.
    pub margins: Vec<Margins>,
    pub after: Vec<Margins>,
    /// Row that is expected to be enough.
    target: usize,
    /// Length that is expected to fit, s; 0: not known.
    length: f64,
    /// The rest of the last step was made by the implicit midpoint rule.
    pub handed: bool,
}

/// A piece that is tried.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// Length, s.
    pub h: f64,
    pub gravity: [f64; 3],
    /// Error per second.
    pub accuracy: f64,
    pub shape: Shape,
}

impl Extrapolation {
    pub fn new(m: &Model) -> Self {
        let n = m.nq + m.nv + WORKS;
        Self {
            from: State::initial(m),
            slope: vec![0.0; n],
            before: vec![0.0; n],
            now: vec![0.0; n],
            way: vec![0.0; n],
            rates: vec![0.0; n],
            columns: vec![0.0; n * ROWS],
            ratios: [0.0; ROWS],
            used: 0,
            strayed: [false; ROWS],
            margins: vec![[f64::INFINITY; 4]; m.axes.len()],
            after: vec![[f64::INFINITY; 4]; m.axes.len()],
            target: FIRST,
            length: 0.0,
            handed: false,
        }
    }

    /// Forgets what it has learnt.
    pub fn forget(&mut self) {
        (self.target, self.length, self.handed) = (FIRST, 0.0, false);
    }

    /// Length of the next piece, s, of `rest` seconds that are to be done: equal parts that are expected to fit.
    pub fn part_of(&self, rest: f64) -> f64 {
        if self.length > 0.0 && self.length < rest { rest / (rest / self.length).ceil() } else { rest }
    }

    /// Did a node of the row that was taken leave the laws?
    pub fn strayed(&self) -> bool {
        self.strayed[self.used]
    }

    /// Learns from a piece that was taken; pieces of `whole` seconds are to come.
    pub fn learn(&mut self, h: f64, whole: f64) {
        let (mut best, mut least) = (1, f64::INFINITY);
        for j in 1..=self.used {
            let length = self.fitting(j, h);
            let work = cost(j) * (whole / length).ceil();
            if work < least {
                (best, least, self.length) = (j, work, length);
            }
        }
        self.target = best;
        if best == self.used && self.length < whole && best + 1 < ROWS {
            self.target = best + 1;
            self.length *= cost(best + 1) / cost(best);
        }
    }

    /// Length that row `j` would have fitted, by its error in a try of `h` seconds.
    fn fitting(&self, j: usize, h: f64) -> f64 {
        let power = 0.5 / j as f64;
        h * (CAUTION * libm::pow(AIM / self.ratios[j].max(f64::MIN_POSITIVE), power)).clamp(SHRINKING, GROWTH)
    }

    /// After a try of `h` seconds that did not fit: the next one is shorter. Returns its length.
    pub fn shrink(&mut self, h: f64) -> f64 {
        let length = if self.ratios[self.used].is_finite() { self.fitting(self.used, h) } else { h * SHRINKING };
        self.target = self.target.min(self.used).max(1);
        self.length = length.min(h * LEAST_SHRINKING);
        self.length
    }

    /// Takes row `j` into the table. Returns the error: the greatest difference of the last two columns, relative to 1 and the
    /// coordinate.
    fn extrapolate(&mut self, j: usize) -> f64 {
        let n = self.now.len();
        let mut factors = [0.0; ROWS];
        for (l, factor) in factors.iter_mut().enumerate().take(j) {
            let ratio = (j + 1) as f64 / (j - l) as f64;
            *factor = 1.0 / (ratio * ratio - 1.0);
        }
        let mut worst = 0.0_f64;
        let from = self.from.q.iter().chain(&self.from.v).map(|x| x.abs()).chain([f64::INFINITY; WORKS]);
        for (i, size) in from.enumerate() {
            let (mut new, mut change) = (self.now[i], 0.0);
            for (l, factor) in factors.iter().enumerate().take(j) {
                let old = std::mem::replace(&mut self.columns[l * n + i], new);
                change = (new - old) * factor;
                new += change;
            }
            self.columns[j * n + i] = new;
            self.way[i] = new;
            let error = change.abs() / (1.0 + size);
            worst = if error.is_nan() { f64::INFINITY } else { worst.max(error) };
        }
        worst
    }
}

/// Evaluations of row `j` (from 0) and those before it.
fn cost(j: usize) -> f64 {
    ((j + 1) * (j + 1) + 1) as f64
}

impl Rbx {
    /// Rates at the start of a piece, into `x.slope`; the state of the robot is that of the start. False if couplings do not hold.
    pub(super) fn first_rates(&mut self, m: &Model, x: &mut Extrapolation, p: &Piece) -> bool {
        x.from.copy_from(&self.state);
        let mut slope = std::mem::take(&mut x.slope);
        let fits = self.rates(m, p, true, &mut slope);
        x.slope = slope;
        fits
    }

    /// Rates in the present state.
    pub(super) fn rates(&mut self, m: &Model, p: &Piece, first: bool, out: &mut [f64]) -> bool {
        let (coordinates, rest) = out.split_at_mut(m.nq);
        let (qdd, powers) = rest.split_at_mut(m.nv);
        if !self.axes.resting.is_empty() {
            qdd.fill(0.0);
        }
        self.axes.write_smooth(m, &mut self.ws, self.state.as_ref());
        self.ws.frugal = !first && !self.axes.is_coupled();
        aba_hybrid(m, &mut self.ws, (&self.state.q, &self.state.v), p.gravity, qdd);
        let fits = self.axes.couple_smooth(m, &mut self.ws, self.state.as_ref(), CouplingStage { h: p.h, first }, qdd);
        coordinate_rates(m, &self.state.q, &self.state.v, coordinates);
        if p.shape.acts {
            powers.copy_from_slice(&self.axes.smooth_powers(m, self.state.as_ref()));
        } else {
            powers.fill(0.0);
        }
        powers[1] -= damping_power(&self.ws);
        fits
    }

    /// Tries a piece from `x.from`, whose rates are in `x.slope`. True if its error is within the bound; the way is in `x.way` then.
    pub(super) fn try_piece(&mut self, m: &Model, x: &mut Extrapolation, p: &Piece) -> bool {
        let bound = (p.accuracy * p.h).max(ROUNDING);
        let last = (x.target + 1).min(ROWS - 1);
        for j in 0..=last {
            x.used = j;
            if !self.row(m, x, (j, p)) {
                x.ratios[j] = f64::INFINITY;
                return false;
            }
            x.ratios[j] = x.extrapolate(j) / bound;
            if j > 0 && x.ratios[j] <= 1.0 {
                return true;
            }
        }
        false
    }

    /// Row `j` of the table: the explicit midpoint rule with 2 (j + 1) parts. False if a coupling does not hold in a node.
    fn row(&mut self, m: &Model, x: &mut Extrapolation, (j, p): (usize, &Piece)) -> bool {
        let parts = 2 * (j + 1);
        let part = p.h / parts as f64;
        x.before.fill(0.0);
        x.now.iter_mut().zip(&x.slope).for_each(|(now, slope)| *now = part * slope);
        x.strayed[j] = false;
        for _ in 1..parts {
            self.stand_at(m, &x.from, &x.now);
            let mut rates = std::mem::take(&mut x.rates);
            let fits = self.rates(m, p, false, &mut rates);
            x.rates = rates;
            if !fits {
                return false;
            }
            x.strayed[j] |= j > 0 && p.shape.bends && self.axes.strays(m, self.state.as_ref());
            x.before.iter_mut().zip(&x.rates).for_each(|(before, rate)| *before += 2.0 * part * rate);
            std::mem::swap(&mut x.before, &mut x.now);
        }
        true
    }

    /// Goes this way from a state; quaternions are four numbers.
    fn stand_at(&mut self, m: &Model, from: &State, way: &[f64]) {
        let add = |x: &mut [f64], from: &[f64], way: &[f64]| {
            x.iter_mut().zip(from.iter().zip(way)).for_each(|(x, (from, way))| *x = from + way);
        };
        add(&mut self.state.q, &from.q, &way[..m.nq]);
        add(&mut self.state.v, &from.v, &way[m.nq..]);
        if !m.eulers.is_empty() {
            self.state.read_angles(m);
        }
    }

    /// Goes to the end of a piece that was tried.
    pub(super) fn arrive(&mut self, m: &Model, x: &Extrapolation) {
        self.stand_at(m, &x.from, &x.way);
        normalize_all(m, &mut self.state.q);
        if !m.eulers.is_empty() {
            self.state.read_angles(m);
        }
    }
}
