//! realnoid/SetJointAngles.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// realnoid/srv/SetJointAngles, the request.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SetJointAnglesRequest {
    /// Axes, in the order in which they are set.
    pub name: Vec<String>,
    /// rad or m.
    pub position: Vec<f64>,
    /// [`Self::TIP`] or [`Self::ROOT`].
    pub side: u8,
}

impl SetJointAnglesRequest {
    /// What hangs on the joint moves.
    pub const TIP: u8 = 0;
    /// The chain behind it moves.
    pub const ROOT: u8 = 1;
}

impl Message for SetJointAnglesRequest {}
