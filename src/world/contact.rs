//! What the world shows of its contacts.

use super::World;
use crate::math::Vec3;

/// One contact at the end of a control interval, in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactPoint {
    /// Indices into `Model::colliders`.
    pub colliders: [usize; 2],
    /// Half-way between the two surfaces, m.
    pub point: Vec3,
    /// Unit, from the first collider to the second.
    pub normal: Vec3,
    /// By how much the two overlap, m; below 0: how far they are apart.
    pub depth: f64,
    /// On the second collider, averaged over the last step, N.
    pub force: Vec3,
}

impl World {
    /// The contacts that carried something in the last step, ordered by their colliders.
    pub fn contacts(&self) -> &[ContactPoint] {
        &self.contacts
    }

    /// Writes the list; allocates only where there are more contacts than ever before.
    pub(super) fn show_contacts(&mut self) {
        self.contacts.clear();
        let contacts = &mut self.contacts;
        self.engine.contacts(&self.kinematics, &mut |c| {
            contacts.push(ContactPoint {
                colliders: c.colliders,
                point: c.point.into(),
                normal: c.normal.into(),
                depth: c.depth,
                force: c.force.into(),
            });
        });
        self.stats.worst_penetration = self.engine.worst_penetration(&self.kinematics);
    }
}
