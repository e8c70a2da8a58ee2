//! Links that fixed joints hold together, as one rigid body.

use super::super::{Description, JointKind};
use super::inertias::tensor;
use super::tree::Tree;
use crate::math::{Mat3, Pose, Vec3};

/// Mass properties of one rigid body in the frame of its first link.
#[derive(Clone, Copy)]
pub(super) struct Rigid {
    /// kg.
    pub mass: f64,
    /// First moment, kg·m.
    moment: Vec3,
    /// About the centre of mass, kg·m²; about the frame's origin while it is summed.
    pub inertia: Mat3,
}

/// For each link the body it is part of; `None` where a `<body>` tag gives mass that is not known here, or
/// where there is no mass.
pub(super) fn merge(d: &Description, tree: &Tree) -> Vec<Option<Rigid>> {
    let homes: Vec<_> = (0..d.links.len()).map(|link| home(d, tree, link)).collect();
    let nothing = Rigid { mass: 0.0, moment: Vec3::zeros(), inertia: Mat3::zeros() };
    let mut bodies = vec![Some(nothing); d.links.len()];
    for (link, (first, pose)) in d.links.iter().zip(&homes) {
        if link.body.is_some() {
            bodies[*first] = None;
        } else if let (Some(body), Some(inertial)) = (&mut bodies[*first], &link.inertial) {
            let center = *pose * inertial.origin.pose();
            let rotation = center.rotation.to_rotation_matrix();
            let position = center.translation.vector;
            let about_center = rotation * tensor(inertial.inertia) * rotation.transpose();
            body.mass += inertial.mass;
            body.moment += inertial.mass * position;
            body.inertia += about_center + inertial.mass * steiner(position);
        }
    }
    let whole = |home: &(usize, Pose)| bodies[home.0].filter(|b| b.mass > 0.0).map(about_center);
    homes.iter().map(whole).collect()
}

/// The link at the root of the rigid body that `link` is part of, and the pose of `link` in its frame.
fn home(d: &Description, tree: &Tree, link: usize) -> (usize, Pose) {
    let (mut first, mut pose) = (link, Pose::identity());
    while let Some(joint) = tree.joint_above[first].filter(|j| d.joints[*j].kind == JointKind::Fixed) {
        pose = d.joints[joint].origin.pose() * pose;
        first = tree.ends[joint].0;
    }
    (first, pose)
}

/// Inertia of a unit mass at `r` about the origin.
fn steiner(r: Vec3) -> Mat3 {
    Mat3::identity() * r.norm_squared() - r * r.transpose()
}

fn about_center(body: Rigid) -> Rigid {
    let center = body.moment / body.mass;
    Rigid { inertia: body.inertia - body.mass * steiner(center), ..body }
}
