//! Do the accelerations of a step change so fast that an explicit rule would make energy of it?
//!
//! Between two evaluations that are h apart accelerations change by h · J · a, where J is their Jacobian: the ratio of the change to the
//! acceleration estimates h |λ| of the fastest motion, as codes for stiff equations detect stiffness (Hairer, Wanner: *Solving Ordinary
//! Differential Equations II*, 1996, §IV.2). Velocity products of light limbs that whirl, and light links between heavy ones, are such
//! motions: Euler's rule makes energy of them at every step, RK4 beyond its region of stability.
//!
//! What drives, friction and stops change is not of that kind: their laws are implicit in the step. Before Euler's rule gives a step away it takes
//! that out ([`Driven`]).

use super::forest::Forest;
use crate::model::Model;
use crate::solver::Driven;
use std::ops::Range;

/// What moves the velocities by less than this share of 1 rad/s or m/s and themselves is no whirl.
const NOTHING: f64 = 1e-6;

/// Per step.
const FADES: f64 = 0.99;

/// A step is not resolved if accelerations in it differ by more than this times the velocity, or 1 rad/s or m/s, over the step.
const STEEP: f64 = 0.1;

/// The same where bodies touch. A blow turns the velocity products once, what whirls does so step by step: so often in a row they must change.
const STEEP_IN_TOUCH: f64 = 1.0;
const IN_A_ROW: u32 = 2;

/// What RK4 looks at: changes of accelerations from one evaluation to the next.
#[derive(Clone, Debug)]
pub(super) struct Whirl {
    last: Vec<f64>,
    /// Of `last` against the one before it.
    change: f64,
}

impl Whirl {
    pub fn new(nv: usize) -> Self {
        Self { last: vec![0.0; nv], change: 0.0 }
    }

    /// Notes the first of three evaluations.
    pub fn note(&mut self, qdd: &[f64]) {
        self.last.copy_from_slice(qdd);
        self.change = 0.0;
    }

    /// Notes the second evaluation.
    pub fn follow(&mut self, qdd: &[f64]) {
        self.change = self.difference(qdd);
        self.last.copy_from_slice(qdd);
    }

    /// The third of three evaluations: has the change grown to more than `least` of that from the first to the second, or is the step steep?
    pub fn turns(&self, qdd: &[f64], v: &[f64], (h, least): (f64, f64)) -> bool {
        let change = self.difference(qdd);
        let steep = || self.last.iter().zip(qdd).zip(v).any(|((last, now), v)| is_steep(now - last, *v, h));
        h * change > NOTHING * (1.0 + largest(v)) && (change > least * self.change || steep())
    }

    fn difference(&self, qdd: &[f64]) -> f64 {
        self.last.iter().zip(qdd).fold(0.0, |most: f64, (last, now)| most.max((now - last).abs()))
    }
}

/// What Euler's rule looks at: changes of the accelerations of each tree on the world from one step to the next.
#[derive(Clone, Debug)]
pub(super) struct Trees {
    /// Of each body; of the world one past the last.
    of_body: Vec<usize>,
    /// Velocity coordinates that follow each other in one tree, and that tree.
    runs: Vec<(Range<usize>, usize)>,
    trees: Vec<Tree>,
    /// Accelerations of the step before (nv).
    last: Vec<f64>,
    known: bool,
}

/// What Euler's rule looks at in a step; all of length nv.
pub(super) struct Seen<'a> {
    qdd: &'a [f64],
    v: &'a [f64],
    /// Accelerations without contacts, which make them jump, now and in the step before; `None` if nothing can touch.
    free: Option<(&'a [f64], &'a [f64])>,
    /// Changes that joints have made.
    driven: &'a [f64],
}

impl<'a> Seen<'a> {
    pub fn new((qdd, v): (&'a [f64], &'a [f64]), driven: &'a Driven, touches: bool) -> Self {
        Self { qdd, v, free: touches.then(|| driven.free()), driven: driven.change() }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Tree {
    /// The greatest change of an acceleration in it since the step before.
    change: f64,
    /// The greatest of such changes without contacts over 1 and the velocity, 1/s.
    rate: f64,
    /// Its greatest acceleration now.
    now: f64,
    /// Does a contact act on it now?
    touched: bool,
    past: Past,
}

/// What a tree keeps from step to step.
#[derive(Clone, Copy, Debug, Default)]
struct Past {
    /// The greatest acceleration of the last hundred steps or so: that of a swing is 0 twice in its period.
    size: f64,
    /// Did a contact act on it in the last step?
    touched: bool,
    /// Steps in a row that moved a velocity by more than `STEEP_IN_TOUCH`.
    steep: u32,
}

impl Trees {
    pub fn new(m: &Model) -> Self {
        let forest = Forest::of(m);
        let mut runs: Vec<(Range<usize>, usize)> = vec![];
        for (body, b) in m.bodies.iter().enumerate().skip(1) {
            let (at, tree) = (b.v..b.v + b.joint.nv(), forest.of_body[body]);
            match runs.last_mut() {
                Some((run, same)) if *same == tree && run.end == at.start => run.end = at.end,
                _ => runs.push((at, tree)),
            }
        }
        let trees = vec![Tree::default(); forest.count];
        Self { of_body: forest.of_body, runs, trees, last: vec![0.0; m.nv], known: false }
    }

    pub fn forget(&mut self) {
        self.known = false;
        self.trees.fill(Tree::default());
    }

    /// A contact acts on this body in the present step.
    pub fn touch(&mut self, body: usize) {
        if let Some(tree) = self.trees.get_mut(self.of_body[body]) {
            tree.touched = true;
        }
    }

    /// Is the change of accelerations since the step before, `h` ago, in a tree that nothing touches more than `least` of those that there
    /// have been, or is the step steep in any?
    pub fn grow(&mut self, seen: &Seen, (h, least): (f64, f64)) -> bool {
        self.look(seen);
        let speed = |tree: usize| {
            self.runs
                .iter()
                .filter(|run| run.1 == tree)
                .fold(0.0, |most: f64, run| most.max(largest(&seen.v[run.0.clone()])))
        };
        self.known
            && self.trees.iter().enumerate().any(|(i, tree)| {
                tree.is_steep(h) || (tree.grows(least) && h * tree.change > NOTHING * (1.0 + speed(i)))
            })
    }

    fn look(&mut self, seen: &Seen) {
        for tree in &mut self.trees {
            (tree.change, tree.rate, tree.now) = (0.0, 0.0, 0.0);
        }
        for (at, tree) in &self.runs {
            let tree = &mut self.trees[*tree];
            let (driven, v) = (&seen.driven[at.clone()], &seen.v[at.clone()]);
            let (now, last) = seen.free.unwrap_or((seen.qdd, &self.last));
            tree.look_free((&now[at.clone()], &last[at.clone()]), driven, v);
            if !tree.touched {
                tree.look((&seen.qdd[at.clone()], &self.last[at.clone()]), driven);
            }
        }
    }

    /// The present step of `h` with the accelerations `qdd` becomes the one before.
    pub fn end_step(&mut self, qdd: &[f64], h: f64) {
        for tree in &mut self.trees {
            tree.end_step(h, self.known);
        }
        self.last.copy_from_slice(qdd);
        self.known = true;
    }
}

impl Tree {
    /// Notes accelerations without contacts, now and in the step before.
    fn look_free(&mut self, (now, last): (&[f64], &[f64]), driven: &[f64], v: &[f64]) {
        for (((now, last), driven), v) in now.iter().zip(last).zip(driven).zip(v) {
            let rate = (now - last - driven).abs() / (1.0 + v.abs());
            self.rate = if rate > self.rate { rate } else { self.rate };
        }
    }

    /// Notes accelerations, now and in the step before.
    fn look(&mut self, (now, last): (&[f64], &[f64]), driven: &[f64]) {
        for ((now, last), driven) in now.iter().zip(last).zip(driven) {
            let change = (now - last - driven).abs();
            self.change = if change > self.change { change } else { self.change };
            self.now = if now.abs() > self.now { now.abs() } else { self.now };
        }
    }

    /// Does a contact act on it, or did in the last step?
    fn jumps(&self) -> bool {
        self.touched || self.past.touched
    }

    fn grows(&self, least: f64) -> bool {
        !self.jumps() && self.change > least * self.past.size
    }

    fn is_steep(&self, h: f64) -> bool {
        match self.jumps() {
            true => h * self.rate > STEEP_IN_TOUCH && self.past.steep + 1 >= IN_A_ROW,
            false => h * self.rate > STEEP,
        }
    }

    /// Of the first step nothing is `known` to compare it with.
    fn end_step(&mut self, h: f64, known: bool) {
        let steep = if known && h * self.rate > STEEP_IN_TOUCH { (self.past.steep + 1).min(IN_A_ROW) } else { 0 };
        let size = if self.touched { 0.0 } else { self.now.max(FADES * self.past.size) };
        *self = Self { past: Past { size, touched: self.touched, steep }, ..Self::default() };
    }
}

/// Does the change move a velocity by more than a share `STEEP` of itself?
fn is_steep(change: f64, v: f64, h: f64) -> bool {
    h * change.abs() > STEEP * (1.0 + v.abs())
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}
