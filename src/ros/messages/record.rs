//! realnoid/srv/Record.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// Starts or stops recording.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RecordRequest {
    /// True: start; false: stop.
    pub start: bool,
    /// A folder that does not exist yet; empty: one named after the present time.
    pub folder: String,
}

/// What came of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RecordResponse {
    /// Was it done?
    pub success: bool,
    /// Why not; or what was written.
    pub message: String,
    /// The bag.
    pub folder: String,
}

impl Message for RecordRequest {}
impl Message for RecordResponse {}
