//! ROS 2 messages as serde structs, fields in the order of their `.msg` files (CDR has no names).

mod diagnostic;
mod elements;
mod geometry;
mod joint_angles;
mod nav;
mod realnoid;
mod record;
mod sensor;
pub mod simulation;
mod standard;
mod tf2;
mod trigger;
mod visualization;

pub use diagnostic::{DiagnosticArray, DiagnosticStatus, KeyValue, Level};
pub use elements::{Element, ListElementsResponse, Warning, WarningsResponse};
pub use geometry::{
    Accel, PoseMessage, Quaternion, Transform, TransformStamped, Twist, TwistStamped, Vector3, Wrench, WrenchStamped,
};
pub use joint_angles::SetJointAnglesRequest;
pub use nav::Odometry;
pub use realnoid::{BodyState, BodyStates, JointMonitor, JointMonitors};
pub use record::{RecordRequest, RecordResponse};
pub use sensor::JointState;
pub use standard::{Clock, Float64MultiArray, Header, MultiArrayDimension, MultiArrayLayout, StringMessage, Time};
pub use tf2::TFMessage;
pub use trigger::{EmptyRequest, TriggerResponse};
pub use visualization::{Color, Marker, MarkerAction, MarkerArray, MarkerKind, Unused};

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
