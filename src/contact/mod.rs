//! Where bodies touch, or are about to: colliders → broad phase → narrow phase → [`Touch`]es.
//!
//! invariant: this room alone names parry.

mod broad;
mod climb;
mod collect;
mod detector;
mod exclude;
mod feature;
mod forms;
mod manifold;
mod nearest;
mod part;
mod plane;
mod polytope;
mod raw;
mod reach;
mod round;
mod solid;
mod surface;
mod touch;
mod vector;

pub use collect::{Defaults, colliders};
pub use detector::Detector;
pub use exclude::{OVERLAP, Overlap, excluded};
pub use reach::{Reach, hull_mesh};
pub use touch::{Normal, Placed, Touch};
