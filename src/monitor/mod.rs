//! What is shown: the values of links and rigs, whether joints are valid, and the timing of the control loop.

mod rigs;
mod timing;
mod validity;
mod values;

pub use rigs::{RigValues, rig_values};
pub use timing::{Percentiles, Timing};
pub use validity::axis_faults;
pub use values::{LinkValues, joint_link_values, link_values};
