//! Where bodies touch, or are about to: colliders → broad phase → narrow phase → [`Touch`]es.
//!
//! invariant: this room alone names parry.

mod detector;
mod touch;

pub use detector::Detector;
pub use touch::{Normal, Placed, Touch};
