//! Frames: parent link → child link, and world → root.

use super::messages::{Header, TFMessage, Time, TransformStamped};
use crate::model::{Base, Model};
use crate::world::Snapshot;

/// Name of the frame that does not move.
pub const WORLD: &str = "world";

/// Frames whose transforms never change (`fixed`), or those that do, as `snapshot` has them.
pub fn frames(model: &Model, snapshot: &Snapshot, fixed: bool) -> TFMessage {
    let stamp = Time::from_ns(snapshot.stamp_ns);
    let transforms = (0..model.links.len())
        .filter(|&i| is_fixed(model, i) == fixed)
        .map(|i| TransformStamped {
            header: Header { stamp, frame_id: parent_frame(model, i).into() },
            child_frame_id: model.links[i].name.clone(),
            transform: pose_in_parent(model, snapshot, i).into(),
        })
        .collect();
    TFMessage { transforms }
}

fn is_fixed(model: &Model, link: usize) -> bool {
    match model.links[link].parent {
        Some(_) => model.links[link].fixed,
        None => model.base == Base::Fixed,
    }
}

fn parent_frame(model: &Model, link: usize) -> &str {
    model.links[link].parent.map_or(WORLD, |parent| &model.links[parent].name)
}

fn pose_in_parent(model: &Model, snapshot: &Snapshot, link: usize) -> crate::math::Pose {
    let x_wc = snapshot.link_pose[link];
    model.links[link].parent.map_or(x_wc, |parent| snapshot.link_pose[parent].inv_mul(&x_wc))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Pose, Vec3};
    use crate::model::LinkInfo;

    #[test]
    fn transforms_are_relative_to_the_parent_and_parted_by_motion() {
        let link = |name: &str, parent, fixed| LinkInfo { name: name.into(), parent, fixed, monitor: None };
        let model = Model {
            name: "r".into(),
            axes: vec![],
            links: vec![link("root", None, false), link("arm", Some(0), false), link("tool", Some(1), true)],
            base: Base::Fixed,
        };
        let at = |x, turn| Pose::new(Vec3::new(x, 0.0, 0.0), Vec3::new(0.0, 0.0, turn));
        let half = std::f64::consts::FRAC_PI_2;
        let tool = at(1.0, half) * at(2.0, 0.0);
        let snapshot = Snapshot { link_pose: vec![at(0.0, 0.0), at(1.0, half), tool], ..Snapshot::default() };
        let moving = frames(&model, &snapshot, false).transforms;
        assert_eq!(moving.len(), 1);
        assert_eq!((moving[0].header.frame_id.as_str(), moving[0].child_frame_id.as_str()), ("root", "arm"));
        assert!((moving[0].transform.rotation.w - (half / 2.0).cos()).abs() < 1e-15);
        assert!((moving[0].transform.rotation.z - (half / 2.0).sin()).abs() < 1e-15);
        let fixed = frames(&model, &snapshot, true).transforms;
        assert_eq!(fixed[0].header.frame_id, WORLD);
        assert!((fixed[1].transform.translation.x - 2.0).abs() < 1e-15);
    }
}
