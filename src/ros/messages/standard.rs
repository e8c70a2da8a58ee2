//! builtin_interfaces, std_msgs and rosgraph_msgs.

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
        let sec = ns.div_euclid(1_000_000_000);
        let clamped = sec.clamp(i64::from(i32::MIN), i64::from(i32::MAX));
        Self { sec: clamped as i32, nanosec: ns.rem_euclid(1_000_000_000) as u32 }
    }
}

/// std_msgs/Header.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Header {
    /// Simulated time.
    pub stamp: Time,
    /// Frame of the data.
    pub frame_id: String,
}

/// rosgraph_msgs/Clock.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Clock {
    /// Simulated time.
    pub clock: Time,
}

/// std_msgs/String.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StringMessage {
    /// The text.
    pub data: String,
}

/// std_msgs/MultiArrayDimension.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct MultiArrayDimension {
    /// Label.
    pub label: String,
    /// Length.
    pub size: u32,
    /// Stride.
    pub stride: u32,
}

/// std_msgs/MultiArrayLayout; ignored in commands.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct MultiArrayLayout {
    /// Dimensions.
    pub dim: Vec<MultiArrayDimension>,
    /// Padding elements at the front.
    pub data_offset: u32,
}

/// std_msgs/Float64MultiArray.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Float64MultiArray {
    /// Layout.
    pub layout: MultiArrayLayout,
    /// Values.
    pub data: Vec<f64>,
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
