//! Engines behind one seam. `rbx` is ours; others join it here.

mod apart;
mod breaking;
mod guard;
mod midpoint;
mod rbx;
mod rk4;

pub use apart::come_apart;
pub use breaking::{BreakWatch, Overload};
pub use rbx::{Integrator, Rbx, State, StepReport, StepSettings};

/// Names for `--engine` and the parameter `engine`.
pub const ENGINE_NAMES: [&str; 1] = ["rbx"];
