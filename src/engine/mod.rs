//! Engines behind one seam. `rbx` is ours; others join it here.

mod apart;
mod breaking;
mod coupled;
mod euler;
mod forest;
mod guard;
mod honour;
mod midpoint;
mod paid;
mod rbx;
mod rk4;
mod sleep;

pub use apart::come_apart;
pub use breaking::{BreakWatch, Overload};
pub use honour::not_honoured;
pub use rbx::{Integrator, Rbx, State, StepReport, StepSettings};

/// Names for `--engine` and the parameter `engine`.
pub const ENGINE_NAMES: [&str; 1] = ["rbx"];
