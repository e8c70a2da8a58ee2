//! What a world consists of, and what it is to the engine (W-9, W-13).

use super::World;
use crate::engine::{constraint_name, shape_name};
use crate::math::Pose;
use crate::model::{AxisSlot, Joined, JointType, Model};

/// What an element is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// Does not move.
    StaticBody,
    /// No joint holds it.
    DynamicBody,
    /// Moves as part of a robot.
    Link,
    /// An axis.
    Joint,
}

/// A body, a link or a joint.
#[derive(Clone, Debug)]
pub struct Element {
    /// Name of the link, body or joint.
    pub name: String,
    /// What it is.
    pub kind: ElementKind,
    /// Robot or body of the scene to which it belongs.
    pub entity: String,
    /// Has it been taken out?
    pub removed: bool,
    /// Its collision shapes, as the engine has them.
    pub shapes: Vec<String>,
    /// What the engine has for the joint.
    pub constraint: String,
    /// kg; 0: static, or a joint.
    pub mass: f64,
    /// In the world, at start.
    pub initial_pose: Pose,
}

impl World {
    /// All links and bodies, what stands still in the world, and all joints.
    pub fn elements(&self) -> Vec<Element> {
        let m = &*self.model;
        let mut start = self.clone();
        start.reset();
        let links = (0..m.links.len()).map(|i| Element {
            name: m.links[i].name.clone(),
            kind: link_kind(m, i),
            entity: entity_of(m, i),
            removed: m.links[i].removed,
            shapes: self.shapes(|link| link == Some(i)),
            constraint: String::new(),
            mass: if m.links[i].frame.body() == 0 { 0.0 } else { m.links[i].mass },
            initial_pose: start.link_pose(i),
        });
        let standing = m.colliders.iter().filter(|c| c.link.is_none()).map(|c| Element {
            name: c.name.clone(),
            kind: ElementKind::StaticBody,
            entity: c.name.clone(),
            removed: false,
            shapes: vec![self.shape(c)],
            constraint: String::new(),
            mass: 0.0,
            initial_pose: c.pose,
        });
        links.chain(standing).chain((0..m.axes.len()).map(|axis| self.joint(axis, &start))).collect()
    }

    fn joint(&self, axis: usize, start: &Self) -> Element {
        let m = &*self.model;
        let (links, robot) = m.robot_of(axis);
        let carried =
            m.carried(axis).or_else(|| links.clone().find(|l| Some(m.links[*l].frame.body()) == m.carrier(axis)));
        let apart = matches!(m.axes[axis].slot, AxisSlot::Apart { .. });
        Element {
            name: m.axes[axis].name.clone(),
            kind: ElementKind::Joint,
            entity: robot.map_or_else(|| m.name.clone(), |i| m.joined[i].name.clone()),
            removed: apart && carried.is_none_or(|l| m.links[l].removed),
            shapes: vec![],
            constraint: match m.carrier(axis) {
                Some(body) => constraint_name(self.settings.engine, m.bodies[body].joint).into(),
                None => String::new(),
            },
            mass: 0.0,
            initial_pose: carried.map_or_else(Pose::identity, |l| start.link_pose(l)),
        }
    }

    fn shapes(&self, of: impl Fn(Option<usize>) -> bool) -> Vec<String> {
        self.model.colliders.iter().filter(|c| of(c.link)).map(|c| self.shape(c)).collect()
    }

    fn shape(&self, c: &crate::model::Collider) -> String {
        shape_name(self.settings.engine, &c.form).unwrap_or_else(|| c.form.name().to_owned())
    }
}

fn link_kind(m: &Model, link: usize) -> ElementKind {
    let body = m.links[link].frame.body();
    match body {
        0 => ElementKind::StaticBody,
        _ if m.bodies[body].joint == JointType::Floating && !has_axes(m, link) => ElementKind::DynamicBody,
        _ => ElementKind::Link,
    }
}

/// Is it a link of something with axes?
fn has_axes(m: &Model, link: usize) -> bool {
    match joined_with(m, link) {
        Some(j) => !j.axes.is_empty(),
        None => m.joined.first().map_or(m.axes.len(), |j| j.axes.start) > 0,
    }
}

/// The robot or body of the scene that a link belongs to.
fn entity_of(m: &Model, link: usize) -> String {
    joined_with(m, link).map_or(&m.name, |j| &j.name).clone()
}

/// What came with the scene and has the link; `None`: the robot itself.
fn joined_with(m: &Model, link: usize) -> Option<&Joined> {
    m.joined.iter().find(|j| j.links.contains(&link))
}
