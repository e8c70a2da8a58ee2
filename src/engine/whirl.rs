//! Do the accelerations of a step change so fast that an explicit rule would make energy of it?
//!
//! Between two evaluations that are h apart accelerations change by h · J · a, where J is their Jacobian: the ratio of the change to the
//! acceleration estimates h |λ| of the fastest motion, as codes for stiff equations detect stiffness (Hairer, Wanner: *Solving Ordinary
//! Differential Equations II*, 1996, §IV.2). Velocity products of light limbs that whirl, and light links between heavy ones, are such
//! motions: Euler's rule makes energy of them at every step, RK4 beyond its region of stability.

use super::forest::Forest;
use crate::model::Model;

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
    /// Of each velocity coordinate (nv).
    of: Vec<usize>,
    trees: Vec<Tree>,
    /// Accelerations of the step before (nv).
    last: Vec<f64>,
    /// The same without contacts, which make them jump.
    free: Vec<f64>,
    known: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Tree {
    /// The greatest change of an acceleration in it since the step before.
    change: f64,
    /// The greatest share of a velocity that such a change without contacts moves it by.
    moves: f64,
    /// Its greatest velocity, and its greatest acceleration now.
    speed: f64,
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
        let mut of = vec![0; m.nv];
        for (body, b) in m.bodies.iter().enumerate().skip(1) {
            of[b.v..b.v + b.joint.nv()].fill(forest.of_body[body]);
        }
        let trees = vec![Tree::default(); forest.count];
        Self { of_body: forest.of_body, of, trees, last: vec![0.0; m.nv], free: vec![0.0; m.nv], known: false }
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

    /// Notes accelerations `qdd`, a step `h` after those before them, at velocities `v`; without contacts they would be `free`, which is empty
    /// if nothing can touch. Is the change in a tree that nothing touches more than `least` of those that there have been, or is the
    /// step steep in any?
    pub fn grow(&mut self, (qdd, free): (&[f64], &[f64]), v: &[f64], (h, least): (f64, f64)) -> bool {
        let free = if free.is_empty() { qdd } else { free };
        for (i, v) in v.iter().enumerate() {
            let tree = &mut self.trees[self.of[i]];
            tree.change = tree.change.max((qdd[i] - self.last[i]).abs());
            tree.moves = tree.moves.max(h * (free[i] - self.free[i]).abs() / (1.0 + v.abs()));
            (tree.speed, tree.now) = (tree.speed.max(v.abs()), tree.now.max(qdd[i].abs()));
        }
        self.last.copy_from_slice(qdd);
        self.free.copy_from_slice(free);
        let known = std::mem::replace(&mut self.known, true);
        self.trees.iter_mut().fold(false, |any, tree| tree.grows(known, (h, least)) || any)
    }
}

impl Tree {
    /// Ends a step; of the first one nothing is known to compare it with.
    fn grows(&mut self, known: bool, (h, least): (f64, f64)) -> bool {
        let steep = if known && self.moves > STEEP_IN_TOUCH { self.past.steep.saturating_add(1) } else { 0 };
        let grows = if self.touched || self.past.touched {
            steep >= IN_A_ROW
        } else {
            let counts = h * self.change > NOTHING * (1.0 + self.speed);
            self.moves > STEEP || (counts && self.change > least * self.past.size)
        };
        let size = if self.touched { 0.0 } else { self.now.max(FADES * self.past.size) };
        *self = Self { past: Past { size, touched: self.touched, steep }, ..Self::default() };
        known && grows
    }
}

/// Does the change move a velocity by more than a share `STEEP` of itself?
fn is_steep(change: f64, v: f64, h: f64) -> bool {
    h * change.abs() > STEEP * (1.0 + v.abs())
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}
