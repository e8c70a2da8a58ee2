//! Which engines there are, and which of them this program was built with.

use super::{Engine, Rbx, State};
use crate::model::Model;

/// A dynamics engine, chosen at run time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EngineKind {
    /// Ours: reduced coordinates, every row in one solver.
    #[default]
    Rbx,
}

/// What an engine can do; what it cannot is told at load time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// A copy goes on with the same bits.
    pub exact_copy: bool,
}

impl EngineKind {
    /// What it can do.
    pub fn capabilities(self) -> Capabilities {
        match self {
            Self::Rbx => Capabilities { exact_copy: true },
        }
    }

    /// Names for `--engine` and the parameter `engine`.
    pub const NAMES: [(&'static str, Self); 1] = [("rbx", Self::Rbx)];

    /// By name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(n, _)| *n == name).map(|(_, kind)| *kind)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, kind)| *kind == self).map_or("", |(n, _)| n)
    }

    /// Builds the engine for a model, at a state of it.
    ///
    /// # Errors
    /// Says how to build the program so that it has this engine, or what the engine cannot take.
    pub fn build(self, m: &Model, state: &State) -> Result<Box<dyn Engine>, String> {
        match self {
            Self::Rbx => {
                let mut engine = Rbx::new(m);
                engine.restart(m, state);
                Ok(Box::new(engine))
            }
        }
    }

    /// Is it in this program?
    ///
    /// # Errors
    /// Says how to build the program so that it is.
    pub fn available(self) -> Result<(), String> {
        match self {
            Self::Rbx => Ok(()),
        }
    }
}
