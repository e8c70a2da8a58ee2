//! Engines behind one seam. `rbx` is ours; others join it here.

pub mod actuation;
mod apart;
mod breaking;
#[cfg(feature = "bullet")]
pub mod bullet;
mod coupled;
mod euler;
mod extrapolation;
mod forest;
mod guard;
mod honour;
mod integrator;
mod kind;
pub mod maximal;
mod midpoint;
mod outline;
mod paid;
mod pairs;
#[cfg(feature = "physx")]
pub mod physx;
mod pieces;
#[cfg(any(feature = "bullet", feature = "physx"))]
mod principal;
mod rapier;
mod rbx;
mod removal;
mod rk4;
mod rolling;
mod seam;
mod sleep;
mod whirl;

pub use apart::come_apart;
pub use breaking::{BreakWatch, Overload};
pub use honour::{Shortfall, by_kind, constraint_name, not_honoured, shape_name, shortfalls, unused_integrator};
pub use integrator::Integrator;
pub use kind::{Capabilities, EngineKind};
pub use rapier::Rapier;
pub use rbx::{Rbx, State, StepReport, StepSettings};
pub use removal::{hanging_on, part_of, without};
pub use seam::Engine;
