//! nav_msgs.

use super::{Header, Shared, Twist};
use crate::record::messages::{Pose, WithCovariance};
use serde::Serialize;

/// nav_msgs/Odometry.
#[derive(Clone, Debug, Serialize)]
pub struct Odometry {
    /// Stamp, and the frame of the pose.
    pub header: Header,
    /// The moving frame, along whose axes the twist is.
    pub child_frame_id: Shared<String>,
    /// Child frame in the header's frame.
    pub pose: WithCovariance<Pose>,
    /// Velocity of the child frame's origin.
    pub twist: WithCovariance<Twist>,
}
