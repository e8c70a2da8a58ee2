//! What is shown: the values of links and rigs, whether joints are valid, the timing of the control loop, and colliders
//! as lines.

mod rigs;
mod timing;
mod validity;
mod values;
mod wireframe;

pub use rigs::{RigValues, rig_values};
pub use timing::{Percentiles, Timing};
pub use validity::axis_faults;
pub use values::{LinkValues, joint_link_values, link_values};
pub use wireframe::{normals, wireframe};
