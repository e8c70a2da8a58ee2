//! realnoid/ListElements and realnoid/Warnings.

use super::Time;
use crate::record::messages::Pose;
use crate::world;
use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// realnoid/Element.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Element {
    /// Name of the link, body or joint.
    pub name: String,
    /// 0 static body, 1 dynamic body, 2 link, 3 joint.
    pub kind: u8,
    /// Robot or body of the scene to which it belongs.
    pub entity: String,
    /// Has it been taken out?
    pub removed: bool,
    /// Collision shapes, as the engine has them.
    pub shapes: Vec<String>,
    /// What the engine has for the joint.
    pub constraint: String,
    /// kg.
    pub mass: f64,
    /// In the world, at start.
    pub initial_pose: Pose,
}

impl From<world::Element> for Element {
    fn from(e: world::Element) -> Self {
        Self {
            name: e.name,
            kind: e.kind as u8,
            entity: e.entity,
            removed: e.removed,
            shapes: e.shapes,
            constraint: e.constraint,
            mass: e.mass,
            initial_pose: (&e.initial_pose).into(),
        }
    }
}

/// realnoid/srv/ListElements, the reply.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ListElementsResponse {
    /// The engine in use.
    pub engine: String,
    /// Of the world (W-2).
    pub state: String,
    /// Links and bodies, then what stands still in the world, then joints.
    pub elements: Vec<Element>,
}

/// realnoid/Warning.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Warning {
    /// Simulated time.
    pub stamp: Time,
    /// Link, joint or axis; empty: the world.
    pub element: String,
    /// What it is about.
    pub kind: String,
    /// For people.
    pub text: String,
}

impl From<&world::Warning> for Warning {
    fn from(w: &world::Warning) -> Self {
        Self {
            stamp: Time::from_ns(w.stamp_ns),
            element: w.element.clone(),
            kind: w.kind.name().into(),
            text: w.text.clone().into_owned(),
        }
    }
}

/// realnoid/srv/Warnings, the reply.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct WarningsResponse {
    /// The oldest first.
    pub warnings: Vec<Warning>,
    /// Older ones that are not kept.
    pub omitted: u64,
}

impl Message for ListElementsResponse {}
impl Message for WarningsResponse {}
