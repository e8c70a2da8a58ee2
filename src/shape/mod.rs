//! Shapes: where they stand, how they scale, how far they reach.

mod bounds;
mod scale;

use crate::description::Origin;
use crate::math::{Pose, Vec3, from_roll_pitch_yaw};

pub use bounds::{Bounds, bounds};
pub use scale::{ScaleError, scaled};

/// The URDF origin as a rigid transform: coordinates in the placed frame → coordinates in the parent frame.
pub fn pose(origin: &Origin) -> Pose {
    Pose::from_parts(Vec3::from(origin.xyz).into(), from_roll_pitch_yaw(origin.rpy))
}
