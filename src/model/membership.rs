//! Which joint's link a body belongs to (B-7).

use crate::description::{Description, JointKind};

/// A URDF link as a part of what one axis moves: the source's link (節), the bodies from one axis to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Membership {
    /// The joint that moves it: the name of its group if it has one, else of the URDF joint.
    pub joint: String,
    /// The URDF joint that moves it.
    pub axis: String,
    /// Is it the root of that link, the body that the axis itself carries?
    pub root: bool,
}

/// Per link of the description; `None`: fixed to the root of the robot.
pub(super) fn memberships(d: &Description) -> Vec<Option<Membership>> {
    let above = d.joints_above();
    let membership = |link: &str| {
        let path = std::iter::successors(above.get(link), |joint| above.get(joint.parent.as_str()));
        let (steps, moving) = path.take(d.joints.len()).enumerate().find(|(_, j)| j.kind != JointKind::Fixed)?;
        let joint = d.group_of(&moving.name).map_or(&moving.name, |group| &group.name).clone();
        Some(Membership { joint, axis: moving.name.clone(), root: steps == 0 })
    };
    d.links.iter().map(|link| membership(&link.name)).collect()
}
