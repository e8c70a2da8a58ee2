//! Which engines there are, and which of them this program was built with.

use super::{Engine, Rbx, State};
use crate::model::Model;

/// A dynamics engine, chosen at run time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EngineKind {
    /// Ours: reduced coordinates, every row in one solver.
    #[default]
    Rbx,
    /// The source's own: maximal coordinates, sequential impulses. In programs that were built with the feature `bullet`.
    Bullet,
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
            // Bullet has no copy of a world: impulses that it starts the contacts of the next step from are lost.
            Self::Bullet => Capabilities { exact_copy: false },
        }
    }

    /// Names for `--engine` and the parameter `engine`.
    pub const NAMES: [(&'static str, Self); 2] = [("rbx", Self::Rbx), ("bullet", Self::Bullet)];

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
            #[cfg(feature = "bullet")]
            Self::Bullet => Ok(Box::new(super::bullet::Bullet::new(m, state)?)),
            #[cfg(not(feature = "bullet"))]
            Self::Bullet => Err(NO_BULLET.into()),
        }
    }

    /// Is it in this program?
    ///
    /// # Errors
    /// Says how to build the program so that it is.
    pub fn available(self) -> Result<(), String> {
        match self {
            Self::Rbx => Ok(()),
            Self::Bullet if cfg!(feature = "bullet") => Ok(()),
            Self::Bullet => Err(NO_BULLET.into()),
        }
    }
}

/// How to get it.
const NO_BULLET: &str = "this program was built without the engine bullet; to have it: apt install libbullet-dev, then \
                         cargo build --release --features bullet";
