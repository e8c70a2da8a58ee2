//! realnoid: messages of our own, as in `msg/` of this repository. Names are the same in every message: shared.

use super::{Header, Shared, Twist, Wrench};
use crate::record::messages::Pose;
use serde::Serialize;

/// realnoid/JointMonitor; what a joint does not have is NaN.
#[derive(Clone, Debug, Serialize)]
pub struct JointMonitor {
    /// Group or lone axis.
    pub name: Shared<String>,
    /// H, P, B in rad, E in m.
    pub position: [f64; 4],
    /// rad/s, m/s.
    pub velocity: [f64; 4],
    /// N·m, N.
    pub effort: [f64; 4],
}

/// realnoid/JointMonitors.
#[derive(Clone, Debug, Serialize)]
pub struct JointMonitors {
    /// Stamp; the frame is not used.
    pub header: Header,
    /// All joints.
    pub joints: Vec<JointMonitor>,
}

/// realnoid/BodyState.
#[derive(Clone, Debug, Serialize)]
pub struct BodyState {
    /// Link.
    pub name: Shared<String>,
    /// Along whose axes twist and wrench are.
    pub frame_id: Shared<String>,
    /// Link frame in the world.
    pub pose: Pose,
    /// Of the origin of the link frame.
    pub twist: Twist,
    /// About the origin of the link frame.
    pub wrench: Wrench,
}

/// realnoid/BodyStates.
#[derive(Clone, Debug, Serialize)]
pub struct BodyStates {
    /// Stamp, world.
    pub header: Header,
    /// Monitored links.
    pub bodies: Vec<BodyState>,
}
