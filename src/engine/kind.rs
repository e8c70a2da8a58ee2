//! Which engines there are, and which of them this program was built with.

use super::{Engine, Rapier, Rbx, State};
use crate::model::Model;

/// A dynamics engine, chosen at run time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EngineKind {
    /// Ours: reduced coordinates, every row in one solver.
    #[default]
    Rbx,
    /// rapier3d-f64: a body for each link, joints as rows of impulses, small substeps.
    Rapier,
    /// The source's own: a body for each link, sequential impulses. In programs that were built with the feature `bullet`.
    Bullet,
    /// PhysX 5.1, for free bodies only, in single precision. In programs that were built with the feature `physx`.
    Physx,
}

/// What an engine can do; what it cannot is told at load time ([`super::not_honoured`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// A copy goes on with the same bits.
    pub exact_copy: bool,
    /// It simulates links; else only bodies that no joint holds.
    pub joints: bool,
    /// Its joints cannot come apart by themselves: no drift.
    pub reduced_coordinates: bool,
    /// The chosen integrator is used; else it has its own.
    pub integrators: bool,
    /// Axes follow others (`<mimic>`).
    pub couplings: bool,
    /// Joints yield (`<constraint erp cfm>`); else they are hard.
    pub softness: bool,
    /// Inertia of rotors (`<drive rotor_inertia>`).
    pub rotor_inertia: bool,
    /// Joints come apart (`<constraint break_threshold>`).
    pub breaking: bool,
    /// Rolling and spinning friction (`<surface>`).
    pub rolling_friction: bool,
}

impl Capabilities {
    /// Of an engine that does it all.
    const ALL: Self = Self {
        exact_copy: true,
        joints: true,
        reduced_coordinates: true,
        integrators: true,
        couplings: true,
        softness: true,
        rotor_inertia: true,
        breaking: true,
        rolling_friction: true,
    };
}

impl EngineKind {
    /// What it can do.
    pub fn capabilities(self) -> Capabilities {
        let all = Capabilities::ALL;
        match self {
            Self::Rbx => all,
            Self::Rapier => Capabilities {
                reduced_coordinates: false,
                integrators: false,
                couplings: false,
                softness: false,
                ..all
            },
            // Bullet has no copy of a world: a copy starts without the impulses of the last step, and awake.
            Self::Bullet => Capabilities {
                exact_copy: false,
                reduced_coordinates: false,
                integrators: false,
                couplings: false,
                ..all
            },
            // A copy starts without PhysX's memory of the last contacts, and awake. Single precision: about 7 digits.
            Self::Physx => Capabilities {
                exact_copy: false,
                joints: false,
                reduced_coordinates: false,
                integrators: false,
                couplings: false,
                softness: false,
                rotor_inertia: false,
                breaking: false,
                ..all
            },
        }
    }

    /// Names for `--engine` and the parameter `engine`: all that are known, built in or not.
    pub const NAMES: [(&'static str, Self); 4] =
        [("rbx", Self::Rbx), ("rapier", Self::Rapier), ("bullet", Self::Bullet), ("physx", Self::Physx)];

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
        self.available()?;
        Ok(match self {
            Self::Rbx => {
                let mut engine = Rbx::new(m);
                engine.restart(m, state);
                Box::new(engine)
            }
            Self::Rapier => Box::new(Rapier::new(m, state)),
            #[cfg(feature = "bullet")]
            Self::Bullet => Box::new(super::bullet::Bullet::new(m, state)?),
            #[cfg(not(feature = "bullet"))]
            Self::Bullet => return Err(NO_BULLET.into()),
            #[cfg(feature = "physx")]
            Self::Physx => Box::new(super::physx::Physx::new(m, state)?),
            #[cfg(not(feature = "physx"))]
            Self::Physx => return Err(NO_PHYSX.into()),
        })
    }

    /// Is it in this program?
    ///
    /// # Errors
    /// Says how to build the program so that it is.
    pub fn available(self) -> Result<(), String> {
        match self {
            Self::Rbx | Self::Rapier => Ok(()),
            Self::Bullet if cfg!(feature = "bullet") => Ok(()),
            Self::Bullet => Err(NO_BULLET.into()),
            Self::Physx if cfg!(feature = "physx") => Ok(()),
            Self::Physx => Err(NO_PHYSX.into()),
        }
    }

    /// Those that are in this program.
    pub fn built() -> impl Iterator<Item = Self> {
        Self::NAMES.into_iter().map(|(_, kind)| kind).filter(|kind| kind.available().is_ok())
    }
}

/// How to get it.
const NO_BULLET: &str = "this program was built without the engine bullet; to have it: apt install libbullet-dev, then \
                         cargo build --release --features bullet";
/// How to get it.
const NO_PHYSX: &str = "this program was built without the engine physx; to have it: cargo build --release --features physx \
                        (with CXX=g++ outside of realnoid's folder; some 6 minutes of CPU the first time)";
