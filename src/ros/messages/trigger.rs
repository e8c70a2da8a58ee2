//! std_srvs/Trigger, and what other services have of it.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// A request without fields; on the wire it is one byte.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct EmptyRequest {
    /// Without meaning.
    pub structure_needs_at_least_one_member: u8,
}

/// The reply of std_srvs/srv/Trigger and of realnoid/srv/SetJointAngles.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TriggerResponse {
    /// Was it done?
    pub success: bool,
    /// Why not.
    pub message: String,
}

impl Message for EmptyRequest {}
impl Message for TriggerResponse {}

impl From<Result<(), String>> for TriggerResponse {
    fn from(result: Result<(), String>) -> Self {
        Self { success: result.is_ok(), message: result.err().unwrap_or_default() }
    }
}
