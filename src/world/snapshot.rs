//! What a world shows after an interval. All buffers are made once; writing a snapshot allocates nothing.

use super::{AxisCommand, ContactPoint, Order, Settings};
use crate::math::{Pose, Twist, Vec3};
use crate::model::Model;
use std::sync::Arc;

/// Contacts that a snapshot has room for.
pub const SHOWN_CONTACTS: usize = 256;

/// What acts on a link through its contacts, in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// N.
    pub force: Vec3,
    /// About the origin of the link, N·m.
    pub torque: Vec3,
}

/// The state of a world at one instant.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Control intervals since the start.
    pub interval: u64,
    /// Simulated time, ns.
    pub stamp_ns: i64,
    /// Per axis, rad or m, continuous (not wrapped).
    pub position: Vec<f64>,
    /// Per axis, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Per axis, N·m or N: the drive torque really applied in the last step.
    pub effort: Vec<f64>,
    /// Per axis: the inputs of its drive during the interval.
    pub commands: Vec<AxisCommand>,
    /// Settings during the interval.
    pub settings: Settings,
    /// What was done to the world, if this is not the end of an interval but shows the effect of an order.
    pub cause: Option<Arc<Order>>,
    /// Per link, in the order of `Model::links`: frame in the world.
    pub link_pose: Vec<Pose>,
    /// Per link: velocity of the link frame's origin, along the link's own axes.
    pub link_twist: Vec<Twist>,
    /// Per link: has the joint to its parent come apart? Its frame is then one of the world's.
    pub cut_off: Vec<bool>,
    /// Per link: has it been taken out of the world?
    pub removed: Vec<bool>,
    /// What can be said of the world as a whole.
    pub condition: super::Condition,
    /// Warnings that there have ever been ([`super::World::warnings`]).
    pub warnings: u64,
    /// The joints that have come apart.
    pub broken: Vec<super::Broken>,
    /// J.
    pub kinetic_energy: f64,
    /// J, zero with every centre of mass at the world's origin height.
    pub potential_energy: f64,
    /// The first [`SHOWN_CONTACTS`] contacts.
    pub contacts: Vec<ContactPoint>,
    /// How many there are beyond these.
    pub omitted_contacts: usize,
    /// Per link: sum of the forces of all its contacts in the last step.
    pub link_wrench: Vec<Wrench>,
    /// Counters.
    pub stats: super::Stats,
    /// False once the world has diverged and stands still.
    pub finite: bool,
}

impl Snapshot {
    /// Takes the contacts, and what they do to the links, whose poses are already here.
    pub(super) fn take_contacts(&mut self, m: &Model, contacts: &[ContactPoint]) {
        self.contacts.clear();
        self.contacts.extend(contacts.iter().take(SHOWN_CONTACTS));
        self.omitted_contacts = contacts.len() - self.contacts.len();
        self.link_wrench.fill(Wrench::default());
        for c in contacts {
            for (collider, force) in c.colliders.into_iter().zip([-c.force, c.force]) {
                let Some(link) = m.colliders[collider].link else { continue };
                let arm = c.point - self.link_pose[link].translation.vector;
                let w = &mut self.link_wrench[link];
                w.force += force;
                w.torque += arm.cross(&force);
            }
        }
    }
}
