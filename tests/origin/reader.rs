//! The embedded humanoid: its text, its description, and where its links stand.

use realnoid::description::{self, Description};
use realnoid::math::Pose;
use roxmltree::Node;
use std::collections::HashMap;

pub const TEXT: &str = include_str!("../../urdf/origin.urdf");

/// The description; nothing about it may be suspicious.
pub fn read() -> Description {
    let reading = description::read(TEXT, "origin.urdf");
    let suspicious: Vec<_> = reading.findings.iter().filter(|f| f.severity > description::Severity::Note).collect();
    assert!(suspicious.is_empty(), "{suspicious:?}");
    reading.description.unwrap()
}

pub fn number(node: Node, attribute: &str) -> f64 {
    node.attribute(attribute).unwrap_or_else(|| panic!("{attribute} of {node:?}")).parse().unwrap()
}

pub fn child<'a, 'i>(node: Node<'a, 'i>, tag: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|n| n.has_tag_name(tag))
}

pub fn all<'a, 'i: 'a>(node: Node<'a, 'i>, tag: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |n| n.has_tag_name(tag))
}

/// Frame of every link in the frame of `base_link`, all axes at zero.
pub fn zero_pose(description: &Description) -> HashMap<&str, Pose> {
    let mut poses = HashMap::from([("base_link", Pose::identity())]);
    while poses.len() < description.links.len() {
        let before = poses.len();
        for j in &description.joints {
            if let Some(parent) = poses.get(j.parent.as_str()) {
                poses.insert(&j.child, parent * j.origin.pose());
            }
        }
        assert!(poses.len() > before, "links that no joint connects to base_link");
    }
    poses
}
