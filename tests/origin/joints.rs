//! Axes, groups, ranges and drives.

use super::body::twin;
use super::reader::{TEXT, child, number, read};
use realnoid::description::*;
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI};

fn moving(d: &Description) -> impl Iterator<Item = &Joint> {
    d.joints.iter().filter(|j| j.kind != JointKind::Fixed)
}

fn find<'a>(d: &'a Description, name: &str) -> &'a Joint {
    d.joints.iter().find(|j| j.name == name).unwrap_or_else(|| panic!("no joint {name}"))
}

/// The joints of a group in the order H, P, B.
fn axes<'a>(d: &'a Description, group: &JointGroup) -> Vec<&'a Joint> {
    [&group.h, &group.p, &group.b].into_iter().flatten().map(|name| find(d, name)).collect()
}

#[test]
fn it_has_enough_axes_in_all_three_kinds_of_group() {
    let d = read();
    assert!(moving(&d).count() >= 30);
    for kind in [GroupKind::CombinedHinge, GroupKind::Cardan, GroupKind::ThreeDof] {
        assert!(d.groups.iter().any(|g| g.kind == kind), "{kind:?}");
    }
    let grouped: usize = d.groups.iter().map(|g| axes(&d, g).len()).sum();
    assert!(grouped < moving(&d).count(), "single hinges as well");
    for chain in &d.chains {
        assert!(d.groups.iter().any(|g| g.name == chain.root), "{}", chain.root);
        let anchor = chain.anchor.as_deref().unwrap();
        assert!(d.links.iter().any(|l| l.name == anchor), "{anchor}");
    }
}

#[test]
fn groups_are_built_as_their_type_says() {
    let d = read();
    let body: HashMap<_, _> = d.links.iter().map(|l| (l.name.as_str(), l.body.is_some())).collect();
    for group in &d.groups {
        let axes = axes(&d, group);
        assert!(axes.len() >= 2, "{}", group.name);
        for (inner, pair) in axes.windows(2).enumerate() {
            let shared = match group.kind {
                GroupKind::ThreeDof => true,
                GroupKind::Cardan => inner == 0,
                GroupKind::CombinedHinge => false,
            };
            assert_eq!(pair[0].child, pair[1].parent, "{}: an unbroken path", group.name);
            assert_eq!(body[pair[0].child.as_str()], !shared, "{}: mass of {}", group.name, pair[0].child);
            assert!(!shared || pair[1].origin == Origin::default(), "{}: one origin", group.name);
        }
    }
}

#[test]
fn yaw_pitch_and_roll_turn_about_z_y_and_x() {
    let d = read();
    for group in &d.groups {
        for (name, axis) in [(&group.h, [0.0, 0.0, 1.0]), (&group.p, [0.0, 1.0, 0.0]), (&group.b, [1.0, 0.0, 0.0])] {
            assert!(name.iter().all(|n| find(&d, n).axis == axis), "{}", group.name);
        }
    }
    for j in moving(&d) {
        let expected = match j.name.rsplit('_').next().unwrap() {
            "yaw" => [0.0, 0.0, 1.0],
            "roll" | "gripper" => [1.0, 0.0, 0.0],
            _ => [0.0, 1.0, 0.0],
        };
        assert_eq!(j.axis, expected, "{}", j.name);
        assert_eq!(j.origin.rpy, [0.0; 3], "{}", j.name);
    }
}

#[test]
fn ranges_hold_zero_and_stay_within_half_a_turn() {
    let d = read();
    for j in moving(&d) {
        let limit = j.limit.as_ref().unwrap();
        assert!(-PI < limit.lower && limit.lower < 0.0 && 0.0 < limit.upper && limit.upper < PI, "{}", j.name);
    }
    for group in d.groups.iter().filter(|g| g.kind == GroupKind::ThreeDof) {
        let limit = find(&d, group.p.as_ref().unwrap()).limit.as_ref().unwrap();
        assert!(-FRAC_PI_2 <= limit.lower && limit.upper <= FRAC_PI_2, "{}", group.name);
    }
}

#[test]
fn ranges_and_drives_are_mirrored() {
    let d = read();
    for j in moving(&d) {
        let Some(other) = twin(&j.name).map(|name| find(&d, &name)) else { continue };
        let (here, there) = (j.limit.as_ref().unwrap(), other.limit.as_ref().unwrap());
        let turned = if j.axis[1] == 1.0 { [there.lower, there.upper] } else { [-there.upper, -there.lower] };
        assert_eq!([here.lower, here.upper], turned, "{}", j.name);
        assert_eq!((here.effort, here.velocity), (there.effort, there.velocity), "{}", j.name);
        assert_eq!((j.damping, j.friction), (other.damping, other.friction), "{}", j.name);
    }
}

#[test]
fn drives_and_limits_say_the_same_and_drives_start_without_torque() {
    let document = roxmltree::Document::parse(TEXT).unwrap();
    for node in document.root_element().children().filter(|n| n.attribute("type") == Some("revolute")) {
        let limit = child(node, "limit").unwrap();
        let drive = child(child(node, "realnoid").unwrap(), "drive").unwrap();
        assert_eq!(number(drive, "max_torque"), number(limit, "effort"), "{node:?}");
        assert_eq!(number(drive, "no_load_speed"), number(limit, "velocity"), "{node:?}");
        assert_eq!(drive.attribute("mode"), Some("torque"), "{node:?}");
    }
}

#[test]
fn every_servo_can_hold_the_limbs_it_carries() {
    // The worst moment of gravity: everything beyond the axis, stretched out level. Torque must exceed it.
    let d = read();
    let (masses, _) = realnoid::mass::link_masses(&d);
    let poses = super::reader::zero_pose(&d);
    let parent: HashMap<_, _> = d.joints.iter().map(|j| (j.child.as_str(), j)).collect();
    for j in moving(&d) {
        let pivot = poses[j.child.as_str()].translation.vector;
        let beyond = d.links.iter().zip(&masses).filter(|(link, _)| {
            let mut at = link.name.as_str();
            while at != j.child && parent.contains_key(at) {
                at = &parent[at].parent;
            }
            at == j.child
        });
        let moment: f64 = beyond
            .map(|(link, m)| {
                let center = m.placed(&poses[link.name.as_str()]).center;
                9.80665 * m.mass * (center - pivot).norm()
            })
            .sum();
        let torque = j.limit.as_ref().unwrap().effort.unwrap();
        assert!(torque > moment, "{}: {torque} N·m against {moment:.1} N·m", j.name);
    }
}
