//! diagnostic_msgs.

use super::Header;
use serde::{Deserialize, Serialize};

/// Levels of a status.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// As it should be.
    Ok = 0,
    /// Somebody should look.
    Warn = 1,
    /// Does not work.
    Error = 2,
}

/// diagnostic_msgs/KeyValue.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct KeyValue {
    /// What.
    pub key: String,
    /// How much, with its unit in the key.
    pub value: String,
}

/// diagnostic_msgs/DiagnosticStatus.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// A [`Level`].
    pub level: u8,
    /// `node: part`.
    pub name: String,
    /// One sentence.
    pub message: String,
    /// Robot name.
    pub hardware_id: String,
    /// Figures.
    pub values: Vec<KeyValue>,
}

/// diagnostic_msgs/DiagnosticArray.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// Stamp.
    pub header: Header,
    /// Parts.
    pub status: Vec<DiagnosticStatus>,
}
