//! What the forces of joints (drives, friction, stops, springs) make of the accelerations from one step to the next.
//!
//! With `M̂ a = τ − c` in both, and the inertia held, accelerations change by `M̂⁻¹ δτ − M̂⁻¹ δc`: by what joints do, and by what the state
//! does through velocity products and gravity. A joint that is locked has a change of its acceleration instead of one of its force.

use crate::dynamics::{BallIn, DofIn, Workspace, aba_hybrid};
use crate::math::V3;
use crate::model::{JointType, Model};

/// The forces of joints, step by step. Makes its memory once.
#[derive(Clone, Debug)]
pub struct Driven {
    now: Free,
    last: Free,
    /// Spherical joints: first velocity coordinate, index.
    balls: Vec<(usize, usize)>,
    ws: Workspace<f64>,
    still: Vec<f64>,
    /// Per velocity coordinate: change of its acceleration by the joints, as [`Driven::explain`] found it; else 0.
    change: Vec<f64>,
}

/// A pass of the dynamics before couplings and contacts act.
#[derive(Clone, Debug)]
struct Free {
    /// Accelerations (nv).
    qdd: Vec<f64>,
    /// Forces of the joints along the velocity coordinates (nv), N·m or N.
    forces: Vec<f64>,
}

impl Driven {
    /// Room for this model.
    pub fn new(m: &Model) -> Self {
        let free = Free { qdd: vec![0.0; m.nv], forces: vec![0.0; m.nv] };
        let balls = m.bodies.iter().filter(|b| b.joint == JointType::Spherical).map(|b| (b.v, b.ball)).collect();
        let mut ws = Workspace::new(m);
        ws.active.reserve(m.bodies.len());
        Self { now: free.clone(), last: free, balls, ws, still: vec![0.0; m.nv], change: vec![0.0; m.nv] }
    }

    /// Accelerations (nv) of the last pass and of that of the step before.
    pub fn free(&self) -> (&[f64], &[f64]) {
        (&self.now.qdd, &self.last.qdd)
    }

    /// Per velocity coordinate: what [`Driven::explain`] found, 0 before.
    pub fn change(&self) -> &[f64] {
        &self.change
    }

    /// Notes a pass: its inputs and reactions are in the workspace.
    pub(super) fn note(&mut self, ws: &Workspace<f64>, qdd: &[f64]) {
        self.now.qdd.copy_from_slice(qdd);
        let inputs = ws.dofs.iter().zip(&ws.reaction).zip(qdd);
        for (force, ((d, reaction), a)) in self.now.forces.iter_mut().zip(inputs) {
            *force = if d.free == 0.0 { *reaction } else { d.tau - d.diagonal * a };
        }
        for (v, ball) in &self.balls {
            put(&mut self.now.forces, *v, total(&ws.ball_in[*ball], at(qdd, *v)));
        }
    }

    /// Finds what the joints changed since the step before, with the inputs of the pass in `ws` and the inertia at `q` (nq).
    pub fn explain(&mut self, m: &Model, ws: &Workspace<f64>, q: &[f64]) {
        let last = self.last.qdd.iter().zip(&self.last.forces);
        for ((to, d), (a, force)) in self.ws.dofs.iter_mut().zip(&ws.dofs).zip(last) {
            *to = DofIn { tau: d.tau - d.diagonal * a - force, acceleration: d.acceleration - a, ..*d };
        }
        for (v, ball) in &self.balls {
            let (to, w) = (&mut self.ws.ball_in[*ball], at(&self.last.qdd, *v));
            to.clone_from(&ws.ball_in[*ball]);
            to.tau = to.tau - to.inertia.mv(w) - at(&self.last.forces, *v);
            for lock in &mut to.lock[..to.locks] {
                lock.acceleration -= lock.gradient.dot(w);
            }
        }
        self.ws.active.clone_from(&ws.active);
        aba_hybrid(m, &mut self.ws, (q, &self.still), [0.0; 3], &mut self.change);
    }

    /// The present step becomes the one before.
    pub fn end_step(&mut self) {
        std::mem::swap(&mut self.now, &mut self.last);
        self.change.fill(0.0);
    }
}

/// What a spherical joint did to its child while that had this angular acceleration.
fn total(ball: &BallIn<f64>, a: V3<f64>) -> V3<f64> {
    let sliding = ball.tau - ball.inertia.mv(a);
    ball.lock[..ball.locks].iter().fold(sliding, |sum, lock| lock.gradient.mad(lock.reaction, sum))
}

fn at(x: &[f64], v: usize) -> V3<f64> {
    V3::new(x[v], x[v + 1], x[v + 2])
}

fn put(x: &mut [f64], v: usize, value: V3<f64>) {
    (x[v], x[v + 1], x[v + 2]) = (value.x, value.y, value.z);
}
