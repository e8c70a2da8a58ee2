//! Do the accelerations of a step change so fast that an explicit rule would make energy of it?
//!
//! Between two evaluations that are h apart accelerations change by h · J · a, where J is their Jacobian: the ratio of the change to the
//! acceleration estimates h |λ| of the fastest motion, as codes for stiff equations detect stiffness (Hairer, Wanner: *Solving Ordinary
//! Differential Equations II*, 1996, §IV.2). Velocity products of light limbs that whirl, and light links between heavy ones, are such
//! motions: Euler's rule makes energy of them at every step, RK4 beyond its region of stability.

/// What moves the velocities by less than this share of 1 rad/s or m/s and themselves is no whirl.
const NOTHING: f64 = 1e-6;

/// Per step.
const FADES: f64 = 0.99;

/// A step is not resolved if accelerations in it differ by more than this times the velocity, or 1 rad/s or m/s, over the step.
const STEEP: f64 = 0.1;

/// Changes of accelerations from one evaluation to the next.
#[derive(Clone, Debug)]
pub(super) struct Whirl {
    last: Vec<f64>,
    /// Of `last` against the one before it.
    change: f64,
    /// The greatest of the last hundred or so: that of a swing is 0 twice in its period.
    size: f64,
    known: bool,
}

impl Whirl {
    pub fn new(nv: usize) -> Self {
        Self { last: vec![0.0; nv], change: 0.0, size: 0.0, known: false }
    }

    pub fn forget(&mut self) {
        (self.known, self.size) = (false, 0.0);
    }

    /// Notes accelerations without looking at them.
    pub fn note(&mut self, qdd: &[f64]) {
        self.last.copy_from_slice(qdd);
        (self.change, self.known) = (0.0, true);
        self.size = largest(qdd).max(FADES * self.size);
    }

    /// Accelerations a step `h` after those that were noted last, at velocities `v`: is the change more than `least` of those that there have
    /// been, or is the step steep?
    pub fn grows(&self, qdd: &[f64], v: &[f64], (h, least): (f64, f64)) -> bool {
        let change = self.difference(qdd);
        let counts = self.known && h * change > NOTHING * (1.0 + largest(v));
        counts && (change > least * self.size || self.steep(qdd, v, h))
    }

    /// The third of three evaluations: has the change grown to more than `least` of that from the first to the second, or is the step steep?
    pub fn turns(&self, qdd: &[f64], v: &[f64], (h, least): (f64, f64)) -> bool {
        let change = self.difference(qdd);
        h * change > NOTHING * (1.0 + largest(v)) && (change > least * self.change || self.steep(qdd, v, h))
    }

    /// Does the change move a velocity by more than a share `STEEP` of itself?
    fn steep(&self, qdd: &[f64], v: &[f64], h: f64) -> bool {
        let pairs = self.last.iter().zip(qdd).zip(v);
        pairs.into_iter().any(|((last, now), v)| h * (now - last).abs() > STEEP * (1.0 + v.abs()))
    }

    /// Notes the second evaluation.
    pub fn follow(&mut self, qdd: &[f64]) {
        self.change = self.difference(qdd);
        self.last.copy_from_slice(qdd);
    }

    fn difference(&self, qdd: &[f64]) -> f64 {
        self.last.iter().zip(qdd).fold(0.0, |most: f64, (last, now)| most.max((now - last).abs()))
    }
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}
