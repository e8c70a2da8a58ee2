//! builtin_interfaces, std_msgs and rosgraph_msgs.

pub use crate::record::messages::{Clock, Time};

use serde::{Deserialize, Serialize};

/// std_msgs/Header.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Header {
    /// Simulated time.
    pub stamp: Time,
    /// Frame of the data.
    pub frame_id: String,
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
