//! What is shown: the values of links, and the timing of the control loop.

mod timing;
mod values;

pub use timing::{Percentiles, Timing};
pub use values::{LinkValues, joint_link_values, link_values};
