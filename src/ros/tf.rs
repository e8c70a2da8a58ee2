//! Frames: parent link → child link, world → root, and separate rigs.

use super::messages::{Header, TFMessage, Time, TransformStamped};
use crate::math::Pose;
use crate::model::{Base, Model, Rig};
use crate::monitor::rig_values;
use crate::world::Snapshot;

/// Name of the frame that does not move.
pub const WORLD: &str = "world";

/// The tree of frames.
#[derive(Clone, Debug)]
pub struct Frames {
    /// In the order of `Model::links`.
    links: Vec<Frame>,
    rigs: Vec<Rig>,
}

#[derive(Clone, Debug)]
struct Frame {
    name: String,
    parent: Option<usize>,
    fixed: bool,
}

impl Frames {
    /// Frames of the links and rigs of `model`.
    pub fn new(model: &Model) -> Self {
        let frame = |(i, l): (usize, &crate::model::LinkInfo)| Frame {
            name: l.name.clone(),
            parent: l.parent,
            fixed: l.fixed || model.roots().any(|root| root == (i, Base::Fixed)),
        };
        Self { links: model.links.iter().enumerate().map(frame).collect(), rigs: model.rigs.clone() }
    }

    /// Frames whose place in their parent never changes.
    pub fn fixed(&self, snapshot: &Snapshot) -> TFMessage {
        self.message(snapshot, true)
    }

    /// Frames that move, where they are now.
    pub fn moving(&self, snapshot: &Snapshot) -> TFMessage {
        let mut message = self.message(snapshot, false);
        message.transforms.extend(self.rigs.iter().map(|rig| TransformStamped {
            header: Header { stamp: Time::from_ns(snapshot.stamp_ns), frame_id: self.links[rig.parent].name.clone() },
            child_frame_id: rig.name.clone(),
            transform: rig_values(rig, snapshot).in_parent.into(),
        }));
        message
    }

    fn message(&self, snapshot: &Snapshot, fixed: bool) -> TFMessage {
        let stamp = Time::from_ns(snapshot.stamp_ns);
        let there = |link: usize| !snapshot.removed.get(link).is_some_and(|removed| *removed);
        let asked = self.links.iter().enumerate().filter(|(link, f)| f.fixed == fixed && there(*link));
        let transforms = asked.map(|(link, frame)| {
            let (parent, x_pc) = self.in_parent(link, snapshot);
            TransformStamped {
                header: Header { stamp, frame_id: parent.into() },
                child_frame_id: frame.name.clone(),
                transform: x_pc.into(),
            }
        });
        TFMessage { transforms: transforms.collect() }
    }

    /// Name of the parent and pose in it. The parent of a link that has come off is the world.
    fn in_parent(&self, link: usize, snapshot: &Snapshot) -> (&str, Pose) {
        let x_wc = &snapshot.link_pose[link];
        let cut_off = snapshot.cut_off.get(link).is_some_and(|cut_off| *cut_off);
        match self.links[link].parent.filter(|_| !cut_off) {
            Some(parent) => (&self.links[parent].name, snapshot.link_pose[parent].inv_mul(x_wc)),
            None => (WORLD, *x_wc),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn transforms_are_relative_to_the_parent_and_parted_by_motion() {
        let frame = |name: &str, parent, fixed| Frame { name: name.into(), parent, fixed };
        let links = vec![frame("root", None, true), frame("arm", Some(0), false), frame("tool", Some(1), true)];
        let frames = Frames { links, rigs: vec![] };
        let at = |x, turn| Pose::new(Vec3::new(x, 0.0, 0.0), Vec3::new(0.0, 0.0, turn));
        let quarter = std::f64::consts::FRAC_PI_2;
        let tool = at(1.0, quarter) * at(2.0, 0.0);
        let snapshot = Snapshot { link_pose: vec![at(0.0, 0.0), at(1.0, quarter), tool], ..Snapshot::default() };
        let moving = frames.moving(&snapshot).transforms;
        assert_eq!(moving.len(), 1);
        assert_eq!((moving[0].header.frame_id.as_str(), moving[0].child_frame_id.as_str()), ("root", "arm"));
        assert!((moving[0].transform.rotation.w - (quarter / 2.0).cos()).abs() < 1e-15);
        assert!((moving[0].transform.rotation.z - (quarter / 2.0).sin()).abs() < 1e-15);
        let fixed = frames.fixed(&snapshot).transforms;
        assert_eq!(fixed[0].header.frame_id, WORLD);
        assert!((fixed[1].transform.translation.x - 2.0).abs() < 1e-15);
        let cut = Snapshot { cut_off: vec![false, true, false], ..snapshot };
        let moving = frames.moving(&cut).transforms;
        assert_eq!((moving[0].header.frame_id.as_str(), moving[0].transform.translation.x), (WORLD, 1.0));
    }
}
