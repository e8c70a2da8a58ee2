//! sensor_msgs.

use super::Header;
use serde::{Deserialize, Serialize};

/// sensor_msgs/JointState; every array is empty or as long as `name`. `N` is a list of strings, possibly shared.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct JointState<N = Vec<String>> {
    /// Stamp; the frame is not used.
    pub header: Header,
    /// Axes.
    pub name: N,
    /// rad or m.
    pub position: Vec<f64>,
    /// rad/s or m/s.
    pub velocity: Vec<f64>,
    /// N·m or N.
    pub effort: Vec<f64>,
}
