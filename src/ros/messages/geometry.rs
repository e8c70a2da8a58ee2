//! geometry_msgs.

use super::Header;
use crate::math::{Pose, Vec3};
use serde::{Deserialize, Serialize};

/// geometry_msgs/Vector3.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector3 {
    /// First component.
    pub x: f64,
    /// Second component.
    pub y: f64,
    /// Third component.
    pub z: f64,
}

impl From<Vec3> for Vector3 {
    fn from(v: Vec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

/// geometry_msgs/Quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// First imaginary part.
    pub x: f64,
    /// Second imaginary part.
    pub y: f64,
    /// Third imaginary part.
    pub z: f64,
    /// Real part.
    pub w: f64,
}

/// geometry_msgs/Twist.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Twist {
    /// m/s.
    pub linear: Vector3,
    /// rad/s.
    pub angular: Vector3,
}

/// geometry_msgs/TwistStamped: of the origin of a link, along the axes of `header.frame_id`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TwistStamped {
    /// Stamp and frame.
    pub header: Header,
    /// The twist.
    pub twist: Twist,
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
        let q = pose.rotation.coords;
        Self { translation: pose.translation.vector.into(), rotation: Quaternion { x: q.x, y: q.y, z: q.z, w: q.w } }
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
