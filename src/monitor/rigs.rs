//! Separate rigs as they stand (J-4).

use crate::math::Pose;
use crate::model::Rig;
use crate::world::Snapshot;
use nalgebra::Translation3;

/// A rig at one instant.
#[derive(Clone, Copy, Debug)]
pub struct RigValues {
    /// H, P, B of its group, rad; 0 where an axis is physically fixed.
    pub angles: [f64; 3],
    /// `X_WR`: its frame in the world.
    pub pose: Pose,
    /// `X_PR`: its frame in that of [`Rig::parent`].
    pub in_parent: Pose,
}

/// The angles of the group, turned about its axes on the link that carries it, at the origin of the reference link
/// (table 6-21).
pub fn rig_values(rig: &Rig, s: &Snapshot) -> RigValues {
    let angles = rig.axes.map(|axis| axis.map_or(0.0, |axis| s.position[axis]));
    let group = s.link_pose[rig.carrier] * rig.frame;
    let origin = rig.reference.map_or(group.translation.vector, |link| s.link_pose[link].translation.vector);
    let pose = Pose::from_parts(Translation3::from(origin), group.rotation * rig.rotation(angles));
    RigValues { angles, pose, in_parent: s.link_pose[rig.parent].inv_mul(&pose) }
}
