//! B-18: the L scale of what one joint moves.

use super::properties::symmetric;
use super::{LinkBody, MassProperties};
use crate::description::{Description, JointKind};
use crate::math::Pose;
use std::collections::HashMap;

/// Multiplies, for the simulation, the inertia of each rigid whole (links joined by fixed joints) about its centre of
/// mass by L², where L belongs to the body nearest the root of the whole (J-6). The true properties stay.
///
/// A tensor added to one link adds the same to the whole, wherever the link is: so the nearest link takes all of it.
/// Returns the links whose own L scale does not count because another one does.
pub(super) fn apply(description: &Description, bodies: &mut [LinkBody]) -> Vec<usize> {
    let mut idle = vec![];
    for whole in wholes(description) {
        let heavy: Vec<&(usize, Pose, usize)> =
            whole.iter().filter(|(i, ..)| bodies[*i].properties.mass > 0.0).collect();
        let Some(&&(nearest, pose, _)) = heavy.iter().min_by_key(|(.., steps)| *steps) else { continue };
        let l = bodies[nearest].l_scale;
        idle.extend(heavy.iter().map(|(i, ..)| *i).filter(|i| ![l, 1.0].contains(&bodies[*i].l_scale)));
        if l != 1.0 {
            let parts: Vec<MassProperties> = heavy.iter().map(|(i, x, _)| bodies[*i].properties.placed(x)).collect();
            let more = MassProperties::sum(&parts).inertia * (l * l - 1.0);
            let r = pose.rotation.to_rotation_matrix().into_inner();
            bodies[nearest].simulated.inertia += symmetric(r.transpose() * more * r);
        }
    }
    idle
}

/// Links joined by fixed joints: index, frame in the frame of the whole's root, number of joints from there.
fn wholes(description: &Description) -> Vec<Vec<(usize, Pose, usize)>> {
    let above = description.joints_above();
    let mut wholes: HashMap<&str, Vec<(usize, Pose, usize)>> = HashMap::new();
    let mut roots = vec![];
    for (i, link) in description.links.iter().enumerate() {
        let (mut root, mut pose, mut steps) = (link.name.as_str(), Pose::identity(), 0);
        while let Some(joint) = above.get(root).filter(|j| j.kind == JointKind::Fixed && steps < above.len()) {
            pose = joint.origin.pose() * pose;
            root = joint.parent.as_str();
            steps += 1;
        }
        wholes
            .entry(root)
            .or_insert_with(|| {
                roots.push(root);
                vec![]
            })
            .push((i, pose, steps));
    }
    roots.iter().filter_map(|root| wholes.remove(root)).collect()
}
