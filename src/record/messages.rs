//! The recorded ROS 2 messages as serde structs, fields in the order of their `.msg` files (CDR has no names). Arrays and
//! strings are borrowed: a row allocates nothing. The ros room shares those that borrow nothing.

use crate::math::{self, Quat, Vec3};
use serde::{Deserialize, Serialize};

/// builtin_interfaces/Time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds.
    pub sec: i32,
    /// Rest, 0 … 999 999 999 ns.
    pub nanosec: u32,
}

impl Time {
    /// From nanoseconds; saturates at the ends of the 32-bit seconds of the message.
    pub fn from_ns(ns: i64) -> Self {
        const SECOND: i64 = 1_000_000_000;
        let seconds = ns.div_euclid(SECOND).clamp(i64::from(i32::MIN), i64::from(i32::MAX));
        Self { sec: seconds as i32, nanosec: ns.rem_euclid(SECOND) as u32 }
    }

    /// In nanoseconds.
    pub fn ns(&self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }
}

/// std_msgs/Header.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Header<'a> {
    /// Simulated time.
    pub stamp: Time,
    /// Frame of the data.
    pub frame_id: &'a str,
}

/// rosgraph_msgs/Clock.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Clock {
    /// Simulated time.
    pub clock: Time,
}

/// sensor_msgs/JointState; all arrays have the same length.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct JointState<'a> {
    /// Stamp; the frame is not used.
    pub header: Header<'a>,
    /// Axes.
    pub name: &'a [String],
    /// rad or m.
    pub position: &'a [f64],
    /// rad/s or m/s.
    pub velocity: &'a [f64],
    /// N·m or N.
    pub effort: &'a [f64],
}

/// geometry_msgs/Vector3, and geometry_msgs/Point, which has the same fields.
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

impl From<Quat> for Quaternion {
    fn from(rotation: Quat) -> Self {
        let q = rotation.coords;
        Self { x: q.x, y: q.y, z: q.z, w: q.w }
    }
}

/// geometry_msgs/Pose.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Pose {
    /// m.
    pub position: Vector3,
    /// Unit quaternion.
    pub orientation: Quaternion,
}

impl From<&math::Pose> for Pose {
    fn from(pose: &math::Pose) -> Self {
        Self { position: pose.translation.vector.into(), orientation: pose.rotation.into() }
    }
}

/// geometry_msgs/Twist.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Twist {
    /// m/s.
    pub linear: Vector3,
    /// rad/s.
    pub angular: Vector3,
}

impl From<&math::Twist> for Twist {
    fn from(twist: &math::Twist) -> Self {
        Self { linear: twist.linear.into(), angular: twist.angular.into() }
    }
}

/// geometry_msgs/PoseWithCovariance and geometry_msgs/TwistWithCovariance.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct WithCovariance<T> {
    /// Pose or twist.
    pub value: T,
    /// `float64[36]`, row by row; zero, as a simulated state is known exactly.
    pub covariance: [[f64; 6]; 6],
}

impl<T> WithCovariance<T> {
    /// A value without doubt.
    pub fn exact(value: T) -> Self {
        Self { value, covariance: [[0.0; 6]; 6] }
    }
}

/// nav_msgs/Odometry.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Odometry<'a> {
    /// Stamp, and the frame of the pose.
    pub header: Header<'a>,
    /// The moving frame, along whose axes the twist is.
    pub child_frame_id: &'a str,
    /// Child frame in the header's frame.
    pub pose: WithCovariance<Pose>,
    /// Velocity of the child frame's origin.
    pub twist: WithCovariance<Twist>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_splits_into_seconds_and_a_positive_rest() {
        assert_eq!(Time::from_ns(1_500_000_000), Time { sec: 1, nanosec: 500_000_000 });
        assert_eq!(Time::from_ns(-1), Time { sec: -1, nanosec: 999_999_999 });
        assert_eq!(Time::from_ns(i64::MAX).sec, i32::MAX);
    }
}
