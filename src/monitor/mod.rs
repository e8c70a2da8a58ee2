//! What is shown of a running world: timing of the control loop.

mod timing;

pub use timing::{Percentiles, Timing};
