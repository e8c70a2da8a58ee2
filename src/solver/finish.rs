//! The direct finish: where the iteration has not converged, Newton's method on the exact law of every row (semismooth: a
//! contact is open, sticks or slides, a bounded row is at a bound or free, as the last impulses and velocities say).
//!
//! A sliding contact has two unknowns, its normal impulse and a turn of the direction: its impulse is `x_n (1, μ e)` with a
//! unit vector e, so its equations are `u_n = 0` and `e⊥·u_t = 0`, whose derivative with respect to the turn is that of
//! the velocities plus `−u_t·e / |x_t|`. Discs at their rim follow the normal impulse likewise.

use super::dense::{Cholesky, Lu, dot, padded};
use super::inner::Inner;
use super::products::Products;
use super::rows::{FINISH_ROWS, Kind, NEARLY, Rows};
use super::way::{Way, length, shorten};
use crate::math::{Lane, Lanes4, wide};

/// Linearisations in one finish of many rows.
const TRIES: usize = 3;
/// Smaller problems may try again for as long as this many rows would take, because they can get all the way.
const LARGE: usize = 40;
/// Most linearisations: with 3 of them, 10 of 100 hard random problems stay unsolved (8 contacts on 12 directions, from
/// nothing), with 10 less than 1; the mean is then 2.0 instead of 1.8.
pub(super) const MANY: usize = 10;
/// Softness of the linearised problem, relative to a row's own mobility: internal forces that nothing determines (a box on
/// four corners) are the least ones. It is not in the residual: what Newton solves is exact.
const SOFT: f64 = 1e-10;
/// A residual that is nearly the wanted one is not worth another try if the last one left more than this share of it.
const LEFT: f64 = 0.3;
/// Sweeps from where it started after the first try that did not help; after the n-th, n times as many.
const SWEEPS: u32 = 5;
/// An impulse within this share of its cone sticks in the first try: the velocities of the last solution would call for slipping that
/// the new one need not have.
const INSIDE: f64 = 1.0 - 1e-6;

/// No unknown, no row.
const NONE: usize = usize::MAX;

/// Memory of the finish.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// `Y Yᵀ + R` of all rows, [`padded`].
    a: Vec<f64>,
    products: Products,
    unknowns: Vec<Unknown>,
    /// Per row.
    links: Vec<Link>,
    /// `A` times the impulse of each unknown.
    moved: Vec<f64>,
    /// What the unknowns do to the equations; where nothing slides, [`padded`].
    matrix: Vec<f64>,
    velocity: Vec<f64>,
    /// Right-hand side.
    right: Vec<f64>,
    lu: Lu,
    cholesky: Cholesky,
    /// Is it the first try?
    first: bool,
    /// Changes of the unknowns.
    found: Vec<f64>,
    /// Impulses before a try, and the best.
    kept: Vec<f64>,
    best: Vec<f64>,
}

/// An unknown of the linearised problem, and the equation that belongs to it: a velocity is 0.
#[derive(Clone, Copy, Debug)]
struct Unknown {
    row: usize,
    /// Of the velocities of `row` and of the one after it.
    along: [f64; 2],
    /// Added to its derivative.
    stiffness: f64,
}

/// How the impulse of a row changes: `factor` times an unknown, and `ratio` times the change of another row.
#[derive(Clone, Copy, Debug)]
struct Link {
    unknown: usize,
    factor: f64,
    follows: usize,
    ratio: f64,
}

const FIXED: Link = Link { unknown: NONE, factor: 0.0, follows: NONE, ratio: 0.0 };

impl Scratch {
    /// Room for this many, so that a finish allocates nothing.
    pub fn make_room(&mut self, rows: usize, width: usize) {
        if rows > FINISH_ROWS || rows <= self.links.len() {
            return;
        }
        self.products.make_room(rows, width);
        self.lu.make_room(rows);
        self.cholesky.make_room(rows);
        self.found.reserve(rows - self.found.len().min(rows));
        self.unknowns.reserve(rows - self.unknowns.len().min(rows));
        self.links.resize(rows, FIXED);
        for v in [&mut self.velocity, &mut self.right, &mut self.kept, &mut self.best] {
            v.resize(rows, 0.0);
        }
        for v in [&mut self.a, &mut self.moved, &mut self.matrix] {
            v.resize(rows * padded(rows), 0.0);
        }
    }

    /// The unknown that a row's impulse is.
    fn plain(&mut self, row: usize) {
        self.links[row] = Link { unknown: self.unknowns.len(), factor: 1.0, ..FIXED };
        self.unknowns.push(Unknown { row, along: [1.0, 0.0], stiffness: 0.0 });
    }

    /// The turn of the direction of two rows.
    fn turn(&mut self, row: usize, e: [f64; 2], stiffness: f64) {
        for (n, factor) in [-e[1], e[0]].into_iter().enumerate() {
            let link = &mut self.links[row + n];
            (link.unknown, link.factor) = (self.unknowns.len(), factor);
        }
        self.unknowns.push(Unknown { row, along: [-e[1], e[0]], stiffness });
    }

    fn follow(&mut self, row: usize, normal: usize, ratio: f64) {
        self.links[row] = Link { follows: normal, ratio, ..FIXED };
    }

    /// Unknowns that move a row, and how much.
    #[inline(always)]
    fn moves(&self, row: usize) -> [(usize, f64); 2] {
        let link = &self.links[row];
        let followed = if link.follows == NONE { NONE } else { self.links[link.follows].unknown };
        [(link.unknown, link.factor), (followed, link.ratio)]
    }

    /// Solves the linearised problem of n rows for the unknowns, refined once: so the softness only counts where nothing
    /// else does.
    fn solve(&mut self, n: usize) {
        wide!(Self::solve_any::<Lanes4>, Scratch::solve_any::<crate::math::X4<false>>, (this: &mut Scratch = self, n: usize = n));
    }

    #[inline(always)]
    fn solve_any<L: Lane>(&mut self, n: usize) {
        let (count, wide) = (self.unknowns.len(), padded(n));
        if self.links[..n].iter().all(|l| l.follows == NONE) {
            return self.solve_symmetric::<L>(n);
        }
        self.moved[..count * n].fill(0.0);
        for row in 0..n {
            for (unknown, factor) in self.moves(row) {
                if unknown != NONE {
                    let (to, from) =
                        (&mut self.moved[unknown * n..unknown * n + n], &self.a[row * wide..row * wide + n]);
                    for (to, a) in to.iter_mut().zip(from) {
                        *to += factor * a;
                    }
                }
            }
        }
        let (unknowns, moved, velocity) = (&self.unknowns, &self.moved, &self.velocity);
        let along = |u: &Unknown, v: &[f64]| {
            let second = if u.along[1] == 0.0 { 0.0 } else { u.along[1] * v[u.row + 1] };
            u.along[0] * v[u.row] + second
        };
        for (i, u) in unknowns.iter().enumerate() {
            let row = &mut self.matrix[i * count..i * count + count];
            for (to, v) in row.iter_mut().zip(moved.chunks_exact(n)) {
                *to = along(u, v);
            }
            row[i] += u.stiffness;
        }
        let (matrix, a) = (&self.matrix[..count * count], &self.a);
        self.lu.factorise(count, matrix, |i| SOFT * a[unknowns[i].row * (wide + 1)]);
        self.lu.solve::<L>(|i| -along(&unknowns[i], velocity));
        self.lu.refine::<L>(|i, x| -along(&unknowns[i], velocity) - dot::<L>(&matrix[i * count..i * count + count], x));
        self.found.clear();
        self.found.extend_from_slice(self.lu.solution());
    }

    /// The same where nothing slides: the matrix is a part of `Y Yᵀ + R`.
    #[inline(always)]
    fn solve_symmetric<L: Lane>(&mut self, n: usize) {
        let (count, unknowns) = (self.unknowns.len(), &self.unknowns);
        // All rows are unknowns, in their order.
        let whole = count == n;
        let (from, wide) = (padded(n), padded(count));
        if !whole {
            for (row, i) in self.matrix.chunks_exact_mut(wide).zip(unknowns) {
                let from = &self.a[i.row * from..i.row * from + n];
                for (to, k) in row.iter_mut().zip(unknowns) {
                    *to = from[k.row];
                }
            }
        }
        let matrix = if whole { &self.a[..n * wide] } else { &self.matrix[..count * wide] };
        let right = &mut self.right[..count];
        for (right, unknown) in right.iter_mut().zip(unknowns) {
            *right = -self.velocity[unknown.row];
        }
        self.cholesky.factorise::<L>(count, matrix, SOFT);
        self.cholesky.solve::<L>(right);
        self.found.clear();
        self.found.extend_from_slice(self.cholesky.solution());
        for (right, row) in right.iter_mut().zip(matrix.chunks_exact(wide)) {
            *right -= dot::<L>(&row[..count], &self.found);
        }
        self.cholesky.solve::<L>(right);
        for (x, more) in self.found.iter_mut().zip(self.cholesky.solution()) {
            *x += more;
        }
    }
}

impl Rows {
    /// Improves the impulses to a residual of `wanted`; returns the residual, which
    /// never grows, and the number of tries: at most `tries`.
    pub(super) fn finish(&mut self, mut residual: f64, wanted: f64, tries: usize) -> (f64, u32) {
        let mut s = std::mem::take(&mut self.finish);
        self.fill(&mut s.a, &mut s.products);
        let size = self.rows.len().max(1);
        let most = (TRIES * LARGE.pow(3) / size.pow(3)).clamp(TRIES, MANY).min(tries);
        let (mut tries, mut there) = (0, true);
        self.keep(&mut s.best);
        while residual > wanted && tries < most {
            tries += 1;
            let before = residual;
            self.keep(&mut s.kept);
            s.first = tries == 1;
            self.newton(&mut s);
            let mut better = self.lower(&mut residual);
            if !better {
                // Where the step had only the wrong contacts open, one sweep shows it.
                self.sweep();
                self.measure();
                better = self.lower(&mut residual);
            }
            if !better {
                self.restore(&s.kept);
                (0..SWEEPS * tries as u32).for_each(|_| _ = self.sweep());
                self.measure();
                better = self.lower(&mut residual);
            }
            there = better;
            if better {
                self.keep(&mut s.best);
            }
            if residual > LEFT * before && residual <= NEARLY * wanted {
                break;
            }
        }
        if !there {
            self.restore(&s.best);
        }
        self.finish = s;
        (residual, tries as u32)
    }

    fn keep(&self, to: &mut [f64]) {
        for (to, row) in to.iter_mut().zip(&self.rows) {
            *to = row.impulse;
        }
    }

    fn restore(&mut self, from: &[f64]) {
        for (row, from) in self.rows.iter_mut().zip(from) {
            row.impulse = *from;
        }
        self.gather();
    }

    /// Takes over the residual if it is less than this one.
    fn lower(&self, residual: &mut f64) -> bool {
        let now = self.residual();
        let less = now < *residual;
        if less {
            *residual = now;
        }
        less
    }

    /// One step of Newton's method, from the impulses and the w that are there. It solves for impulses, not for their changes: what
    /// nothing determines (a box on four corners) is then least, far from the rims of the cones, and does not depend on what
    /// was before.
    fn newton(&mut self, s: &mut Scratch) {
        s.unknowns.clear();
        s.links.fill(FIXED);
        for k in 0..self.blocks.len() {
            self.linearise(k, s);
        }
        for (row, x) in self.rows.iter_mut().enumerate() {
            if s.moves(row).iter().any(|(unknown, _)| *unknown != NONE) {
                x.impulse = 0.0;
            }
        }
        self.gather();
        for b in &self.blocks {
            for n in 0..b.rows {
                s.velocity[b.first + n] = if b.is_off() { 0.0 } else { self.velocity(b, n) };
            }
        }
        s.solve(self.rows.len());
        let found = &s.found;
        for row in 0..self.rows.len() {
            let by = |(unknown, factor): (usize, f64)| if unknown == NONE { 0.0 } else { factor * found[unknown] };
            self.rows[row].impulse += s.moves(row).into_iter().map(by).sum::<f64>();
        }
        self.clip();
        self.gather();
    }

    /// Decides what a block does, puts its impulses there, and adds its unknowns.
    fn linearise(&mut self, block: usize, s: &mut Scratch) {
        let b = &self.blocks[block];
        let (inner, first, count) = (b.inner, b.first, b.rows);
        let x: [f64; 3] = std::array::from_fn(|n| if n < count { self.rows[first + n].impulse } else { 0.0 });
        let u: [f64; 3] = std::array::from_fn(|n| if n < count { self.velocity(b, n) } else { 0.0 });
        match (inner, b.kind) {
            (Inner::Single(h), Kind::Bounds { lower, upper }) => match x[0] - u[0] / h {
                to if to < lower => self.rows[first].impulse = lower,
                to if to > upper => self.rows[first].impulse = upper,
                _ => s.plain(first),
            },
            (Inner::Cone(inner), Kind::Cone { friction }) => {
                let [normal, tangent] = inner.diagonal();
                if s.first && x[0] > 0.0 && length([x[1], x[2]]) < INSIDE * friction * x[0] {
                    return (first..first + 3).for_each(|row| s.plain(row));
                }
                let pressed = x[0] - u[0] / normal;
                if pressed <= 0.0 {
                    self.rows[first..first + 3].iter_mut().for_each(|r| r.impulse = 0.0);
                    return;
                }
                s.plain(first);
                let way = Way::of([x[1], x[2]], [u[1], u[2]], 2.0 / tangent, friction * pressed);
                self.slide(s, &way, (first + 1, 2), (first, friction));
            }
            (inner, Kind::Disc { ratio, normal }) if inner.trace() > 0.0 => {
                let radius = ratio * self.rows[normal].impulse.max(0.0);
                let way = Way::of([x[0], x[1]], [u[0], u[1]], count as f64 / inner.trace(), radius);
                self.slide(s, &way, (first, count), (normal, ratio));
            }
            _ => {}
        }
    }

    /// Rows of a disc whose radius is the impulse of another row times a ratio.
    fn slide(&mut self, s: &mut Scratch, way: &Way, (first, count): (usize, usize), (normal, ratio): (usize, f64)) {
        match *way {
            Way::Inside => (first..first + count).for_each(|row| s.plain(row)),
            Way::Rim { direction, stiffness } => {
                let radius = ratio * self.rows[normal].impulse.max(0.0);
                for (row, e) in (first..first + count).zip(direction) {
                    self.rows[row].impulse = radius * e;
                    s.follow(row, normal, ratio * e);
                }
                if count == 2 && stiffness.is_finite() {
                    s.turn(first, direction, stiffness);
                }
            }
        }
    }

    /// Puts the impulses back within their bounds.
    fn clip(&mut self) {
        for b in &self.blocks {
            let rows = &mut self.rows;
            let first = b.first;
            match b.kind {
                Kind::Bounds { lower, upper } => rows[first].impulse = rows[first].impulse.max(lower).min(upper),
                Kind::Cone { friction } => {
                    rows[first].impulse = rows[first].impulse.max(0.0);
                    let radius = friction * rows[first].impulse;
                    shorten(&mut rows[first + 1..first + 3], radius);
                }
                Kind::Disc { ratio, normal } => {
                    let radius = ratio * rows[normal].impulse.max(0.0);
                    shorten(&mut rows[first..first + b.rows], radius);
                }
            }
        }
    }
}
