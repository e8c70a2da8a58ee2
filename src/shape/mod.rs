//! Shapes: where they stand, how they scale, how far they reach.

mod bounds;
mod scale;

pub use bounds::{Bounds, bounds};
pub use scale::{ScaleError, scaled};
