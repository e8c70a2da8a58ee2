//! geometry_msgs.

use super::Header;
use crate::math::Pose;
pub use crate::record::messages::{Pose as PoseMessage, Quaternion, Twist, Vector3};
use serde::{Deserialize, Serialize};

/// geometry_msgs/TwistStamped: of the origin of a link, along the axes of `header.frame_id`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TwistStamped {
    /// Stamp and frame.
    pub header: Header,
    /// The twist.
    pub twist: Twist,
}

/// geometry_msgs/Accel.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Accel {
    /// m/s².
    pub linear: Vector3,
    /// rad/s².
    pub angular: Vector3,
}

/// geometry_msgs/Wrench.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Wrench {
    /// N.
    pub force: Vector3,
    /// N·m.
    pub torque: Vector3,
}

/// geometry_msgs/WrenchStamped: at the origin of a link, along the axes of `header.frame_id`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WrenchStamped {
    /// Stamp and frame.
    pub header: Header,
    /// The wrench.
    pub wrench: Wrench,
}

/// geometry_msgs/Transform.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Transform {
    /// m.
    pub translation: Vector3,
    /// Unit quaternion.
    pub rotation: Quaternion,
}

impl From<Pose> for Transform {
    fn from(pose: Pose) -> Self {
        Self { translation: pose.translation.vector.into(), rotation: pose.rotation.into() }
    }
}

/// geometry_msgs/TransformStamped.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TransformStamped {
    /// Stamp and parent frame.
    pub header: Header,
    /// Child frame.
    pub child_frame_id: String,
    /// Child frame in the parent frame.
    pub transform: Transform,
}
