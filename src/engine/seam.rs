//! What the world asks of an engine.

use super::{EngineKind, Integrator, Rbx, State, StepReport, StepSettings};
use crate::dynamics::Kinematics;
use crate::math::V3;
use crate::model::Model;
use crate::solver::{AxisCommand, Books, ContactPoint};

/// Moves the bodies of a [`Model`] in time. All of them speak in the model's coordinates, SI units, Z up.
pub trait Engine: std::fmt::Debug + Send + Sync {
    /// Which one it is.
    fn kind(&self) -> EngineKind;

    /// Makes the memory that steps with this integrator need, so that they make none.
    fn prepare(&mut self, m: &Model, integrator: Integrator);

    /// One step. A state that is not finite is not taken. Allocates nothing where the engine is ours to say so.
    fn step(&mut self, m: &Model, commands: &[AxisCommand], s: &StepSettings) -> StepReport;

    /// The state, in the model's coordinates.
    fn state(&self) -> &State;

    /// Takes over a state; the steps before it are forgotten, what was changed of the drives stays.
    fn restart(&mut self, m: &Model, state: &State);

    /// Takes over a state between two steps, as if a hand had moved it: ledgers and counters go on, what rests wakes.
    fn place(&mut self, m: &Model, state: &State);

    /// Goes on with another model of the same axes and links in this state: joints have come apart, or are whole again.
    fn refit(&mut self, m: &Model, state: State, integrator: Integrator);

    /// What stands on the world has been moved with it.
    fn moved(&mut self, m: &Model);

    /// What rests comes back into the computation.
    fn wake(&mut self, m: &Model);

    /// Where the bodies are and how they move.
    fn poses(&mut self, m: &Model, k: &mut Kinematics);

    /// Can anything touch?
    fn has_contacts(&self) -> bool;

    /// Shows the contacts of the last step that carry something, at these poses.
    fn contacts(&self, k: &Kinematics, show: &mut dyn FnMut(ContactPoint));

    /// The deepest penetration since the start, with these poses as the last ones, m.
    fn worst_penetration(&self, k: &Kinematics) -> f64;

    /// Per body: force of its contacts, averaged over the last step, along the world's axes, N; empty if nothing can touch.
    fn received(&self) -> &[V3<f64>];

    /// Its drives, and what became of them.
    fn books(&self) -> &Books;

    /// The same, to change drives and to book what happens between steps.
    fn books_mut(&mut self) -> &mut Books;

    /// By how much the two sides of a joint have come apart at most since the start, m; 0 by construction in reduced coordinates.
    fn joint_drift(&self) -> f64 {
        0.0
    }

    /// A copy. It goes on with the same bits if [`super::Capabilities`] say so.
    fn copy(&self) -> Box<dyn Engine>;
}

impl Clone for Box<dyn Engine> {
    fn clone(&self) -> Self {
        self.copy()
    }
}

impl Engine for Rbx {
    fn kind(&self) -> EngineKind {
        EngineKind::Rbx
    }

    fn prepare(&mut self, m: &Model, integrator: Integrator) {
        Self::prepare(self, m, integrator);
    }

    fn step(&mut self, m: &Model, commands: &[AxisCommand], s: &StepSettings) -> StepReport {
        Self::step(self, m, commands, s)
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restart(&mut self, m: &Model, state: &State) {
        Self::restart(self, m, state);
    }

    fn place(&mut self, m: &Model, state: &State) {
        self.state.copy_from(state);
        self.wake(m);
    }

    fn refit(&mut self, m: &Model, state: State, integrator: Integrator) {
        Self::refit(self, m, state, integrator);
    }

    fn moved(&mut self, m: &Model) {
        Self::moved(self);
        self.wake(m);
    }

    fn wake(&mut self, m: &Model) {
        Self::wake(self, m);
    }

    fn poses(&mut self, m: &Model, k: &mut Kinematics) {
        Self::poses(self, m, k);
    }

    fn has_contacts(&self) -> bool {
        self.axes.contacts().is_some()
    }

    fn contacts(&self, k: &Kinematics, show: &mut dyn FnMut(ContactPoint)) {
        self.axes.contacts().into_iter().flat_map(|c| c.shown(k)).for_each(show);
    }

    fn worst_penetration(&self, k: &Kinematics) -> f64 {
        self.axes.contacts().map_or(0.0, |c| c.worst.max(c.depth(k)))
    }

    fn received(&self) -> &[V3<f64>] {
        self.axes.contacts().map_or(&[], |c| c.received())
    }

    fn books(&self) -> &Books {
        &self.axes.books
    }

    fn books_mut(&mut self) -> &mut Books {
        &mut self.axes.books
    }

    fn copy(&self) -> Box<dyn Engine> {
        Box::new(self.clone())
    }
}
