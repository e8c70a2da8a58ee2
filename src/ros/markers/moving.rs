//! Markers that are made anew each time: boxes around shapes, and contacts.

use super::kinds::{Kind, MarkerSettings};
use super::marker::{Label, color};
use crate::contact::Reach;
use crate::math::{Pose, Vec3};
use crate::model::Model;
use crate::ros::messages::{Color, Marker};
use crate::ros::tf::WORLD;
use crate::shape::Bounds;
use crate::world::Snapshot;

/// Length of a contact's normal, m.
const NORMAL: f64 = 0.05;
/// Length of a force, m/N.
const FORCE: f64 = 0.001;
/// Radius of a contact point, m.
const POINT: f64 = 0.005;

const BOX: Color = color(0.5, 0.5, 0.5);
const TOUCH: Color = color(1.0, 0.1, 0.1);
const ACROSS: Color = color(0.2, 0.6, 1.0);
const PUSH: Color = color(1.0, 0.8, 0.0);

/// What of each collider is needed for its box.
pub struct Boxes(Vec<Boxed>);

struct Boxed {
    id: usize,
    link: Option<usize>,
    pose: Pose,
    reach: Reach,
}

impl Boxes {
    /// Of all that has one.
    pub fn new(m: &Model) -> Self {
        let one = |(id, c): (usize, &crate::model::Collider)| {
            Some(Boxed { id, link: c.link, pose: c.pose, reach: Reach::of(&c.form, c.margin)? })
        };
        Self(m.colliders.iter().enumerate().filter_map(one).collect())
    }

    /// As they are now.
    pub fn show(&self, snapshot: &Snapshot, all: &mut Vec<Marker>) {
        for b in &self.0 {
            let x_ws = b.link.map_or(b.pose, |link| snapshot.link_pose[link] * b.pose);
            let label = Label { ns: Kind::Aabbs.name(), id: b.id, frame: WORLD };
            all.push(label.lines(&Pose::identity(), &edges(&b.reach.bounds(&x_ws)), BOX));
        }
    }
}

/// The twelve edges of a box.
fn edges(b: &Bounds) -> Vec<Vec3> {
    let corner = |i: usize| Vec3::from_fn(|axis, _| if i >> axis & 1 == 1 { b.max[axis] } else { b.min[axis] });
    let along =
        |axis: usize| (0..8).filter(move |i| i >> axis & 1 == 0).map(move |i| [corner(i), corner(i | 1 << axis)]);
    (0..3).flat_map(along).flatten().collect()
}

/// The contacts of now; where there are none any more (`before`: there were), their markers go.
pub fn contacts(snapshot: &Snapshot, settings: &MarkerSettings, before: &mut bool, all: &mut Vec<Marker>) {
    let label = |id| Label { ns: Kind::Contacts.name(), id, frame: WORLD };
    let c = &snapshot.contacts;
    let some = settings.shows(Kind::Contacts) && !c.is_empty();
    if some {
        let points: Vec<Vec3> = c.iter().map(|c| c.point).collect();
        let lines = |along: fn(&crate::world::ContactPoint) -> Vec3| -> Vec<Vec3> {
            c.iter().flat_map(|c| [c.point, c.point + along(c)]).collect()
        };
        let identity = Pose::identity();
        all.push(label(0).balls(&points, POINT, TOUCH));
        all.push(label(1).lines(&identity, &lines(|c| c.normal * NORMAL), ACROSS));
        all.push(label(2).lines(&identity, &lines(|c| c.force * FORCE), PUSH));
    } else if *before {
        all.extend((0..3).map(|id| label(id).deleted()));
    }
    *before = some;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::ContactPoint;

    #[test]
    fn a_box_has_twelve_edges_along_the_axes() {
        let edges = edges(&Bounds { min: Vec3::new(0.0, 1.0, 2.0), max: Vec3::new(1.0, 3.0, 5.0) });
        assert_eq!(edges.len(), 24);
        let lengths: f64 = edges.chunks(2).map(|e| (e[1] - e[0]).norm()).sum();
        assert_eq!(lengths, 4.0 * (1.0 + 2.0 + 3.0));
    }

    #[test]
    fn contacts_that_have_ended_are_taken_away_once() {
        let settings = MarkerSettings::new(10.0, &["contacts".into()], 0.0, [1.0; 4]);
        let touching = Snapshot {
            contacts: vec![ContactPoint { force: Vec3::z() * 10.0, ..Default::default() }],
            ..Snapshot::default()
        };
        let (mut before, mut all) = (false, vec![]);
        contacts(&touching, &settings, &mut before, &mut all);
        assert_eq!((all.len(), before, all[2].action), (3, true, 0));
        for gone in [3, 0] {
            all.clear();
            contacts(&Snapshot::default(), &settings, &mut before, &mut all);
            assert_eq!(all.len(), gone);
            assert!(all.iter().all(|m| m.action == 2));
        }
    }
}
