//! Taking bodies and links out of a world, and building it again (W-2, W-10, W-11).

use super::{Settings, World};
use crate::engine::{Engine, State, hanging_on, part_of, without};
use crate::model::Model;
use std::sync::Arc;

/// What can be said of a world as a whole (W-2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Condition {
    /// A copy that has not run yet.
    Copied,
    /// It runs.
    #[default]
    Normal,
    /// A link was taken out, and its joint with it: nothing moves until the world is built again or reset.
    JointConfigurationFault,
}

impl Condition {
    /// Its name in services and diagnostics.
    pub fn name(self) -> &'static str {
        match self {
            Self::Copied => "copied",
            Self::Normal => "normal",
            Self::JointConfigurationFault => "joint_configuration_fault",
        }
    }
}

/// What became of a world besides its state.
#[derive(Debug, Default)]
pub(super) struct History {
    /// The model and the initial state with all that has been taken out.
    whole: Option<(Arc<Model>, State)>,
    /// A joint went with a link.
    pub faulty: bool,
    copied: bool,
}

impl Clone for History {
    /// A copy knows that it is one.
    fn clone(&self) -> Self {
        Self { whole: self.whole.clone(), faulty: self.faulty, copied: true }
    }
}

impl World {
    /// What can be said of it as a whole.
    pub fn condition(&self) -> Condition {
        match (self.history.faulty, self.history.copied) {
            (true, _) => Condition::JointConfigurationFault,
            (_, true) => Condition::Copied,
            _ => Condition::Normal,
        }
    }

    pub(super) fn begin_to_run(&mut self) {
        self.history.copied = false;
    }

    /// Takes a robot or body of the scene, or a link with all that hangs on it, out of the world. Links and axes keep their
    /// places in the model; what is gone stands still, without mass, and nothing touches it. If a joint of a robot goes with it, the
    /// world stands still from here on: [`Condition::JointConfigurationFault`], until [`World::rebuild`] or a reset.
    ///
    /// # Errors
    /// Says why not; nothing changes then.
    pub fn remove(&mut self, name: &str) -> Result<(), String> {
        let (gone, faulty) = self.named(name)?;
        if let Some(other) = part_of(&self.model, &gone) {
            let other = &self.model.links[other].name;
            return Err(format!("'{name}' and link '{other}' are one body: take out the link that carries both"));
        }
        let (model, state) = without(&self.model, self.engine.state(), &gone);
        let (intact, initial) = without(&self.breaking.intact, &self.initial, &gone);
        let unmoved = self.unmoved.as_ref().map(|m| Arc::new(without(m, &self.initial, &gone).0));
        let model = Arc::new(model);
        let engine = self.built(&model, &state, &self.settings)?;
        let whole = || (self.breaking.intact.clone(), self.initial.clone());
        self.history.whole.get_or_insert_with(whole);
        self.history.faulty |= faulty;
        let same = Arc::ptr_eq(&self.breaking.intact, &self.model);
        self.breaking.intact = if same { model.clone() } else { Arc::new(intact) };
        (self.initial, self.unmoved) = (initial, unmoved);
        self.exchange(model, engine);
        self.warn_of_events();
        Ok(())
    }

    /// Builds the world again, at its initial state (W-11): of what is left, or with all that was ever taken out. Time goes on.
    ///
    /// # Errors
    /// The engine does not take it; nothing changes then.
    pub fn rebuild(&mut self, all: bool) -> Result<(), String> {
        let (model, initial) = match self.history.whole.as_ref().filter(|_| all) {
            Some((model, initial)) => (model.clone(), initial.clone()),
            None => (self.breaking.intact.clone(), self.initial.clone()),
        };
        let engine = self.built(&model, &initial, &self.settings)?;
        if all {
            self.history.whole = None;
        }
        self.breaking.broken.clear();
        self.breaking.intact = model.clone();
        (self.initial, self.unmoved) = (initial, None);
        self.exchange(model, engine);
        self.reset_state();
        self.warn_of_setup();
        Ok(())
    }

    /// An engine for a model in a state, with the present drives and ledgers.
    pub(super) fn built(&self, model: &Model, state: &State, settings: &Settings) -> Result<Box<dyn Engine>, String> {
        let mut engine = settings.engine.build(model, state)?;
        engine.prepare(model, settings.integrator);
        engine.books_mut().drives.copy_from_slice(&self.engine.books().drives);
        engine.books_mut().work = self.engine.books().work;
        Ok(engine)
    }

    fn exchange(&mut self, model: Arc<Model>, engine: Box<dyn Engine>) {
        self.engine = engine;
        self.take(model);
        self.update();
    }

    /// Which links go with a name, and whether a joint goes with them that is not wholly theirs.
    fn named(&self, name: &str) -> Result<(Vec<bool>, bool), String> {
        let m = &self.model;
        if name == m.name && !m.links.iter().any(|l| l.name == name) {
            return Err(format!("'{name}' is the first robot, whose axes this world is there for"));
        }
        let joined = m.joined.iter().find(|j| j.name == name).map(|j| j.root_link);
        let Some(link) = joined.or_else(|| m.links.iter().position(|l| l.name == name)) else {
            return Err(format!("there is no robot, body or link '{name}'"));
        };
        if m.links[link].removed {
            return Err(format!("'{name}' has been taken out already"));
        }
        if link == m.root_link {
            return Err(format!("'{name}' is the root link of the first robot, whose axes this world is there for"));
        }
        Ok((hanging_on(m, link), !m.is_root(link) && !m.links[link].fixed))
    }
}
