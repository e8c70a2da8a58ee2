//! tf2_msgs.

use super::TransformStamped;
use serde::{Deserialize, Serialize};

/// tf2_msgs/TFMessage.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TFMessage {
    /// Frames.
    pub transforms: Vec<TransformStamped>,
}
