//! Joints that come apart while the world runs (J-18).

use super::World;
use crate::engine::{BreakWatch, StepSettings, come_apart};
use crate::model::Model;
use std::sync::Arc;

/// A joint that has come apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// Name of the URDF joint whose threshold it was.
    pub joint: Arc<str>,
    /// Simulated time at the end of the step, s.
    pub time: f64,
    /// What went through the joint, averaged over that step, N.
    pub force: f64,
}

impl std::fmt::Display for Broken {
    /// When, and under what.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "came apart at {:.6} s, when {:.6} N went through it", self.time, self.force)
    }
}

/// What a world keeps of its joints that break.
#[derive(Clone, Debug)]
pub(super) struct Breaking {
    /// The model with all its joints, as a reset gives it back.
    pub intact: Arc<Model>,
    /// `None`: nothing can break.
    watch: Option<BreakWatch>,
    /// In the order of time.
    pub broken: Vec<Broken>,
}

impl Breaking {
    pub fn new(model: &Arc<Model>) -> Self {
        Self { intact: model.clone(), watch: BreakWatch::new(model), broken: vec![] }
    }
}

impl World {
    /// The joints that have come apart since the last reset, in the order of time.
    pub fn broken(&self) -> &[Broken] {
        &self.breaking.broken
    }

    /// Before a step.
    pub(super) fn watch_joints(&mut self) {
        if let Some(watch) = self.breaking.watch.as_mut().filter(|_| self.effects.breaking) {
            watch.begin(&self.model, self.engine.state());
        }
    }

    /// After a step that ended at `time` (s): joints that carried more than their threshold come apart. Allocates if, and
    /// only if, one does.
    pub(super) fn break_joints(&mut self, step: &StepSettings, time: f64) {
        let Some(watch) = self.breaking.watch.as_mut().filter(|_| self.effects.breaking) else { return };
        let overloads = watch.end(&self.model, self.engine.state(), step, self.engine.received());
        if overloads.is_empty() {
            return;
        }
        let m = self.model.clone();
        let overloads: Vec<Broken> = (overloads.iter())
            .map(|o| Broken { joint: m.breakables[o.breakable].joint.as_str().into(), time, force: o.force })
            .collect();
        let (mut model, mut state) = (Model::clone(&m), self.engine.state().clone());
        for broken in overloads {
            let joint = model.breakables.iter().find(|b| *b.joint == *broken.joint);
            if let Some(body) = joint.map(|b| b.body) {
                (model, state) = come_apart(&model, &state, body);
            }
            self.breaking.broken.push(broken);
        }
        let rotors = self.rotor_energy();
        self.engine.refit(&model, state, step.integrator);
        self.take(Arc::new(model));
        // The rotor of an axis that is apart turns on where nobody looks.
        self.engine.books_mut().work.losses += rotors - self.rotor_energy();
    }

    /// Goes back to the model with all its joints.
    pub(super) fn mend_joints(&mut self) {
        if self.breaking.broken.is_empty() {
            return;
        }
        self.breaking.broken.clear();
        self.unmoved = None;
        let intact = self.breaking.intact.clone();
        self.engine.refit(&intact, self.initial.clone(), self.settings.integrator);
        self.take(intact);
    }

    pub(super) fn take(&mut self, model: Arc<Model>) {
        self.kinematics = crate::dynamics::Kinematics::new(&model);
        self.breaking.watch = BreakWatch::new(&model);
        self.model = model;
    }
}
