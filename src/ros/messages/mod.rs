//! ROS 2 messages as serde structs, fields in the order of their `.msg` files (CDR has no names).

mod diagnostic;
mod geometry;
mod sensor;
mod standard;
mod tf2;

pub use diagnostic::{DiagnosticArray, DiagnosticStatus, KeyValue, Level};
pub use geometry::{Quaternion, Transform, TransformStamped, Twist, TwistStamped, Vector3, Wrench, WrenchStamped};
pub use sensor::JointState;
pub use standard::{Clock, Float64MultiArray, Header, MultiArrayDimension, MultiArrayLayout, StringMessage, Time};
pub use tf2::TFMessage;

use serde::{Serialize, Serializer};
use std::sync::Arc;

/// A field that is the same in every message of a publisher: shared instead of copied a thousand times a second.
#[derive(Clone, Debug)]
pub struct Shared<T>(Arc<T>);

impl<T> Shared<T> {
    /// Shares `value`.
    pub fn new(value: T) -> Self {
        Self(Arc::new(value))
    }
}

impl<T: Serialize> Serialize for Shared<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}
