//! Engines behind one seam. `rbx` is ours; others join it here.

pub mod actuation;
mod apart;
mod breaking;
#[cfg(feature = "bullet")]
pub mod bullet;
mod coupled;
mod euler;
mod forest;
mod guard;
mod honour;
mod kind;
pub mod maximal;
mod midpoint;
mod outline;
mod paid;
mod pairs;
#[cfg(feature = "physx")]
pub mod physx;
mod rapier;
mod rbx;
mod rk4;
mod seam;
mod sleep;

pub use apart::come_apart;
pub use breaking::{BreakWatch, Overload};
pub use honour::{Shortfall, by_kind, not_honoured, shape_name, shortfalls, unused_integrator};
pub use kind::{Capabilities, EngineKind};
pub use rapier::Rapier;
pub use rbx::{Integrator, Rbx, State, StepReport, StepSettings};
pub use seam::Engine;
