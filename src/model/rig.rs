//! Separate rigs (J-4): frames outside the tree of links that mirror the angles of a group.

use super::Model;
use crate::description::{Description, Joint, SeparateRig};
use crate::math::{Pose, Quat, Vec3, sin_cos};
use nalgebra::Quaternion;

/// A frame that mirrors a group. The group's frame G is that of its first joint, on the link that carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Name of the frame.
    pub name: String,
    /// Name of the group.
    pub group: String,
    /// Axes H, P, B; `None`: physically fixed.
    pub axes: [Option<usize>; 3],
    /// Direction of H, P, B at zero, in G.
    pub directions: [Vec3; 3],
    /// Index of the link that carries the group.
    pub carrier: usize,
    /// `X_CG`: G in the frame of the carrier.
    pub frame: Pose,
    /// Link at whose origin the rig stands (table 6-21); `None`: at the origin of G.
    pub reference: Option<usize>,
    /// Link under which the frame is shown: its anchor, else the carrier.
    pub parent: usize,
    /// Does the tag name an anchor (table 6-8)?
    pub anchored: bool,
}

impl Rig {
    /// Rotation of the rig in G at these angles of H, P, B (rad): each turns about its own axis as that stands after those
    /// before it. For axes along z, y, x it is Rz(h) Ry(p) Rx(b).
    pub fn rotation(&self, hpb: [f64; 3]) -> Quat {
        let turns = self.directions.iter().zip(hpb).map(|(axis, angle)| turn(axis, angle));
        turns.fold(Quat::identity(), |all, one| all * one)
    }
}

/// A turn about a unit vector.
fn turn(axis: &Vec3, angle: f64) -> Quat {
    let (s, c) = sin_cos(0.5 * angle);
    Quat::new_unchecked(Quaternion::from_parts(c, axis * s))
}

/// The rigs of a checked description; `m` has its links and axes.
pub(super) fn rigs(d: &Description, m: &Model) -> Vec<Rig> {
    d.rigs.iter().filter_map(|rig| build(d, m, rig)).collect()
}

fn build(d: &Description, m: &Model, tag: &SeparateRig) -> Option<Rig> {
    let group = d.group(&tag.group)?;
    let first = d.first_joint(&tag.group)?;
    let link = |name: &str| m.links.iter().position(|l| l.name == name);
    let joints = [&group.h, &group.p, &group.b].map(|name| name.as_deref().and_then(|n| d.joint(n)));
    let carrier = link(&first.parent)?;
    let [h, p, b] = joints;
    Some(Rig {
        name: tag.name.clone(),
        group: tag.group.clone(),
        axes: joints.map(|joint| m.axis(&joint?.name)),
        directions: directions(joints),
        carrier,
        frame: first.origin.pose(),
        reference: p.or(b).or(h).and_then(|joint| link(&joint.child)),
        parent: tag.anchor.as_deref().map_or(Some(carrier), link)?,
        anchored: tag.anchor.is_some(),
    })
}

/// Axes at zero in the frame of the first joint; whatever stands for a missing one never turns.
fn directions(joints: [Option<&Joint>; 3]) -> [Vec3; 3] {
    let mut frame: Option<Quat> = None;
    joints.map(|joint| {
        let Some(joint) = joint else { return Vec3::z() };
        let here = frame.map_or(Quat::identity(), |frame| frame * joint.origin.rotation());
        frame = Some(here);
        here * Vec3::from(joint.axis)
    })
}
