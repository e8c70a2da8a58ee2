//! Engines behind one seam. `rbx` is ours; others join it here.

mod coupled;
mod guard;
mod midpoint;
mod rbx;
mod rk4;

pub use rbx::{Integrator, Rbx, State, StepReport, StepSettings};

/// Names for `--engine` and the parameter `engine`.
pub const ENGINE_NAMES: [&str; 1] = ["rbx"];
