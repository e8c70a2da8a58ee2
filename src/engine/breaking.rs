//! Joints that break (J-18): who carries too much.

use super::{Integrator, State, StepSettings};
use crate::dynamics::{JointForces, Outside, Scheme};
use crate::math::V3;
use crate::model::Model;

/// A joint that carried more than its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overload {
    /// Index into `Model::breakables`.
    pub breakable: usize,
    /// Magnitude of the force through the joint, averaged over the step, N.
    pub force: f64,
}

/// Watches the joints with a break threshold. Makes its memory once.
#[derive(Clone, Debug)]
pub struct BreakWatch {
    forces: JointForces,
    overloads: Vec<Overload>,
}

impl BreakWatch {
    /// Room for this model; `None` if none of its joints breaks.
    pub fn new(m: &Model) -> Option<Self> {
        (!m.breakables.is_empty())
            .then(|| Self { forces: JointForces::new(m), overloads: Vec::with_capacity(m.breakables.len()) })
    }

    /// Takes the state before a step.
    pub fn begin(&mut self, m: &Model, state: &State) {
        self.forces.begin(m, &state.q, &state.v);
    }

    /// The joints that carried more than their threshold in the step `s` that led to this state, from the root outwards.
    /// `contacts` are the forces on each body in it, averaged, along the world's axes, N.
    pub fn end(&mut self, m: &Model, state: &State, s: &StepSettings, contacts: &[V3<f64>]) -> &[Overload] {
        let scheme = match s.integrator {
            Integrator::SemiImplicitEuler => Scheme::Start,
            Integrator::ImplicitMidpoint | Integrator::Rk4 | Integrator::Extrapolation => Scheme::Middle,
        };
        let damping = s.effects.body_damping.then_some((s.h, scheme));
        self.forces.end(m, (&state.q, &state.v), &Outside { contacts, damping });
        self.overloads.clear();
        for (breakable, joint) in m.breakables.iter().enumerate() {
            let f = self.forces.force(joint.body, s.gravity, s.h);
            let force = f.dot(f).sqrt();
            if force > joint.threshold {
                self.overloads.push(Overload { breakable, force });
            }
        }
        &self.overloads
    }
}
