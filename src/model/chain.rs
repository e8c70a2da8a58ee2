//! Chains of links (J-3, J-7, J-9).

use super::Model;
use crate::description::{Description, Joint};
use std::collections::HashMap;

/// The links from a root joint outwards, up to where another chain begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkChain {
    /// The joint or group at its root.
    pub root: String,
    /// The URDF joint at its root.
    pub joint: String,
    /// Link on which it hangs, or `world`, if the URDF says so.
    pub anchor: Option<String>,
    /// J-9: may its links collide with each other?
    pub self_collision: bool,
    /// Its links, ascending.
    pub links: Vec<usize>,
}

impl Model {
    /// The chain that a link belongs to.
    pub fn chain_of(&self, link: usize) -> Option<&LinkChain> {
        self.chains.iter().find(|chain| chain.links.binary_search(&link).is_ok())
    }
}

/// The chains of a checked description.
pub(super) fn chains(d: &Description) -> Vec<LinkChain> {
    let above = d.joints_above();
    let mut chains: Vec<LinkChain> = (d.chains.iter())
        .filter_map(|chain| {
            Some(LinkChain {
                root: chain.root.clone(),
                joint: d.first_joint(&chain.root)?.name.clone(),
                anchor: chain.anchor.clone(),
                self_collision: chain.self_collision,
                links: vec![],
            })
        })
        .collect();
    for (i, link) in d.links.iter().enumerate() {
        if let Some(chain) = nearest(&above, &link.name, &chains) {
            chains[chain].links.push(i);
        }
    }
    chains
}

/// The chain whose root is the first one on the way from a link to the root of the robot.
fn nearest(above: &HashMap<&str, &Joint>, link: &str, chains: &[LinkChain]) -> Option<usize> {
    let mut path = std::iter::successors(above.get(link), |joint| above.get(joint.parent.as_str()));
    path.find_map(|joint| chains.iter().position(|chain| chain.joint == joint.name))
}
