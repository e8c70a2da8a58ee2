//! Contact problems made by hand: rows of rigid bodies that are not part of a model, in factor space.

use crate::support::Random;
use nalgebra::{DMatrix, DVector};
use realnoid::solver::{Kind, Rows};

/// Responses, free velocities and kinds of a problem.
pub struct Problem {
    /// One row per row.
    pub y: DMatrix<f64>,
    pub bias: DVector<f64>,
    pub kinds: Vec<(Kind, usize)>,
}

type V = nalgebra::Vector3<f64>;

impl Problem {
    pub fn new(width: usize) -> Self {
        Self { y: DMatrix::zeros(0, width), bias: DVector::zeros(0), kinds: vec![] }
    }

    /// Any rows at all: contacts, discs on some of them and bounded rows, of this rank. The free velocity and the gaps are such that
    /// standing still is allowed, so there is an answer.
    pub fn random((contacts, others): (usize, usize), rank: usize, gaps: bool, rng: &mut Random) -> Self {
        let mut p = Self::new(rank);
        let motion = DVector::from_fn(rank, |_, _| rng.unit());
        let row = |rng: &mut Random| DVector::from_fn(rank, |_, _| rng.unit());
        for _ in 0..others {
            let y = row(rng);
            let limit = 0.5 * rng.unit().abs();
            let kind = match rng.next() % 3 {
                0 => Kind::Bounds { lower: 0.0, upper: f64::INFINITY },
                1 => Kind::Bounds { lower: -limit, upper: limit },
                _ => Kind::EQUALITY,
            };
            p.add(kind, &[(y.clone(), y.dot(&motion))]);
        }
        for _ in 0..contacts {
            let friction = if rng.next().is_multiple_of(8) { 0.0 } else { 1.2 * rng.unit().abs() };
            let gap = if gaps && rng.next().is_multiple_of(2) { 0.3 * rng.unit().abs() } else { 0.0 };
            let rows: Vec<_> = (0..3).map(|_| row(rng)).collect();
            let normal = p.y.nrows();
            let bias = |k: usize| rows[k].dot(&motion) + if k == 0 { gap } else { 0.0 };
            p.add(Kind::Cone { friction }, &[0, 1, 2].map(|k| (rows[k].clone(), bias(k))));
            for count in [1, 2] {
                if rng.next().is_multiple_of(4) {
                    let rows: Vec<_> = (0..count).map(|_| row(rng)).collect();
                    let rows: Vec<_> = rows.iter().map(|y| (y.clone(), y.dot(&motion))).collect();
                    p.add(Kind::Disc { ratio: 0.2 * rng.unit().abs(), normal }, &rows);
                }
            }
        }
        p
    }

    pub fn add(&mut self, kind: Kind, rows: &[(DVector<f64>, f64)]) {
        for (y, bias) in rows {
            let n = self.y.nrows();
            self.y = std::mem::replace(&mut self.y, DMatrix::zeros(0, 0)).insert_row(n, 0.0);
            self.y.row_mut(n).copy_from(&y.transpose());
            self.bias = std::mem::replace(&mut self.bias, DVector::zeros(0)).push(*bias);
        }
        self.kinds.push((kind, rows.len()));
    }

    /// Seals this into rows; `rows` may hold another problem, which goes.
    pub fn write(&self, rows: &mut Rows) {
        rows.truncate(0);
        let ids: Vec<u32> = (0..self.y.ncols().div_ceil(4) as u32).collect();
        let mut first = 0;
        for (kind, count) in &self.kinds {
            let block = rows.add(*kind, *count, &ids);
            for n in 0..*count {
                for j in 0..self.y.ncols() {
                    rows.response(block, n).1[j] = self.y[(first + n, j)];
                }
                rows.row(block, n).bias = self.bias[first + n];
            }
            rows.seal(block);
            first += count;
        }
    }

    pub fn rows(&self) -> Rows {
        let mut rows = Rows::new(self.y.ncols().next_multiple_of(4));
        self.write(&mut rows);
        rows
    }

    /// Velocities with these impulses.
    pub fn velocity(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.bias + &self.y * (self.y.transpose() * x)
    }

    /// The largest violation of Coulomb's law and of the bounds, checked by itself: as a share of `scale` in velocities, and of
    /// the impulses that make such a velocity.
    pub fn violation(&self, x: &DVector<f64>) -> f64 {
        let (u, mut worst, mut first) = (self.velocity(x), 0.0f64, 0);
        for (kind, count) in &self.kinds {
            let own = (first..first + count).map(|k| self.y.row(k).norm_squared()).fold(0.0, f64::max);
            match *kind {
                Kind::Bounds { lower, upper } => {
                    let to = (x[first] - u[first] / own).clamp(lower, upper);
                    worst = worst.max((x[first] - to).abs() * own);
                }
                Kind::Cone { friction } => {
                    worst = worst.max((x[first] * own).min(u[first]).abs());
                    worst = worst.max(rim(
                        &[x[first + 1], x[first + 2]],
                        &[u[first + 1], u[first + 2]],
                        friction * x[first],
                        own,
                    ));
                }
                Kind::Disc { ratio, normal } => {
                    let (x2, u2) = (x.as_slice(), u.as_slice());
                    worst =
                        worst.max(rim(&x2[first..first + count], &u2[first..first + count], ratio * x[normal], own));
                }
            }
            first += count;
        }
        worst
    }

    /// A contact at a point of a box (normal up), with the world or with a box below it.
    pub fn stack_contact(&mut self, (upper, lower): (&Brick, Option<&Brick>), at: V, friction: f64, bias: [f64; 3]) {
        let rows = [V::z(), V::x(), V::y()].map(|d| {
            let mut y = DVector::zeros(self.y.ncols());
            upper.write(&mut y, at, d);
            if let Some(lower) = lower {
                lower.write(&mut y, at, -d);
            }
            y
        });
        let [a, b, c] = rows;
        self.add(Kind::Cone { friction }, &[(a, bias[0]), (b, bias[1]), (c, bias[2])]);
    }
}

/// A free box: its place in w is that of `M^(1/2) v`.
pub struct Brick {
    pub column: usize,
    pub mass: f64,
    pub inertia: V,
    pub center: V,
}

impl Brick {
    pub fn new(index: usize, mass: f64, half: V, center: V) -> Self {
        let s = half.component_mul(&half) * 4.0 / 12.0 * mass;
        Self { column: 6 * index, mass, inertia: V::new(s.y + s.z, s.x + s.z, s.x + s.y), center }
    }

    /// Adds the velocity of a point along d.
    pub fn write(&self, y: &mut DVector<f64>, at: V, d: V) {
        let turn = (at - self.center).cross(&d);
        for k in 0..3 {
            y[self.column + k] += d[k] / self.mass.sqrt();
            y[self.column + 3 + k] += turn[k] / self.inertia[k].sqrt();
        }
    }

    /// Adds the rate of turning about d.
    pub fn write_turn(&self, y: &mut DVector<f64>, d: V) {
        for k in 0..3 {
            y[self.column + 3 + k] += d[k] / self.inertia[k].sqrt();
        }
    }
}

/// How far x is from a disc of this radius on whose rim it has to be against u.
fn rim(x: &[f64], u: &[f64], radius: f64, own: f64) -> f64 {
    let to: Vec<f64> = x.iter().zip(u).map(|(x, u)| x - u / own).collect();
    let size = to.iter().map(|t| t * t).sum::<f64>().sqrt();
    let shrink = if size > radius { radius.max(0.0) / size } else { 1.0 };
    x.iter().zip(&to).map(|(x, t)| (x - t * shrink).powi(2)).sum::<f64>().sqrt() * own
}

pub fn impulses(rows: &Rows) -> DVector<f64> {
    DVector::from_iterator(rows.rows().len(), rows.rows().iter().map(|r| r.impulse))
}
