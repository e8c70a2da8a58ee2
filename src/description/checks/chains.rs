//! `<chain>`: its root is a whole joint, it hangs on its anchor, and no link is in two chains unseen (J-3, J-7).

use super::super::element::Element;
use super::super::finding::Finding;
use super::super::report::Report;
use super::super::tags::robot::RobotTags;
use super::super::{Chain, Description, Joint, JointKind, WORLD_ANCHOR};
use super::groups::must_exist;
use std::collections::HashMap;

/// A chain with the joint at which it begins.
struct Head<'d> {
    chain: &'d Chain,
    element: &'d Element<'d>,
    joint: &'d Joint,
}

/// All chains; what hangs on what is checked only if the links form a tree.
pub(super) fn check(d: &Description, tags: &RobotTags, is_tree: bool, report: &mut Report) {
    let before = report.len();
    let mut heads = vec![];
    for (chain, element) in &tags.chains {
        let joints = d.joints.iter().map(|j| j.name.as_str());
        let roots = joints.chain(d.groups.iter().map(|g| g.name.as_str()));
        must_exist("joint or joint_group", &chain.root, roots, ("root", element), report);
        if let Some(anchor) = &chain.anchor {
            let links = d.links.iter().map(|l| l.name.as_str());
            must_exist("link", anchor, links.chain([WORLD_ANCHOR]), ("anchor", element), report);
        }
        refuse_part_of_group(d, chain, element, report);
        heads.extend(d.first_joint(&chain.root).map(|joint| Head { chain, element, joint }));
    }
    if report.len() > before || !is_tree {
        return;
    }
    let above = d.joints_above();
    for (i, head) in heads.iter().enumerate() {
        refuse_wrong_anchor(d, &above, head, report);
        if let Some(same) = heads[..i].iter().find(|other| other.joint.name == head.joint.name) {
            let message =
                format!("the chain of '{}' has the same root as that in line {}", head.chain.root, same.chain.at.line);
            let mend = "keep one of the two";
            report.add(Finding::error("chain-twice", head.element.place_of("root", report), message, mend));
        } else {
            refuse_unseen_nesting(&above, head, &heads, report);
        }
    }
}

/// A group is one joint: no chain begins inside.
fn refuse_part_of_group(d: &Description, chain: &Chain, element: &Element, report: &mut Report) {
    let Some(group) = d.group_of(&chain.root).filter(|_| d.group(&chain.root).is_none()) else { return };
    let Some((letter, _)) = group.axes().skip(1).find(|(_, name)| *name == chain.root) else { return };
    let message = format!("'{}' is the axis {letter} of the group '{}': no chain begins there", chain.root, group.name);
    let mend = format!("write root=\"{}\"", group.name);
    report.add(Finding::error("chain-inside-group", element.place_of("root", report), message, mend));
}

/// The link from which a link is never apart, nearest the root of the robot.
fn rigid_root<'d>(above: &HashMap<&'d str, &'d Joint>, link: &'d str) -> &'d str {
    let fixed = |link: &&'d str| above.get(link).filter(|j| j.kind == JointKind::Fixed).map(|j| j.parent.as_str());
    std::iter::successors(Some(link), fixed).last().unwrap_or(link)
}

/// J-7: the link on which the root hangs is the anchor or rigidly fixed to it.
fn refuse_wrong_anchor<'d>(
    d: &'d Description,
    above: &HashMap<&'d str, &'d Joint>,
    head: &Head<'d>,
    report: &mut Report,
) {
    let Some(anchor) = head.chain.anchor.as_deref() else { return };
    let carrier = head.joint.parent.as_str();
    let carried_by = rigid_root(above, carrier);
    let is_link = d.links.iter().any(|link| link.name == anchor);
    let (fits, expected) = if is_link {
        (rigid_root(above, anchor) == carried_by, format!("the anchor '{anchor}'"))
    } else {
        (!above.contains_key(carried_by), "the anchor 'world', the base of the robot".to_string())
    };
    if fits {
        return;
    }
    let message = format!(
        "the root '{}' hangs on the link '{carrier}' (joint '{}', line {}), which is not fixed to {expected}",
        head.chain.root, head.joint.name, head.joint.at.line
    );
    let mend = format!("write anchor=\"{carrier}\", or hang '{}' on the anchor", head.joint.name);
    report.add(Finding::error("chain-anchor", head.element.place_of("anchor", report), message, mend));
}

/// A chain that begins inside another one ends that one there: only where its anchor says that it is meant.
fn refuse_unseen_nesting(above: &HashMap<&str, &Joint>, head: &Head, heads: &[Head], report: &mut Report) {
    if head.chain.anchor.is_some() {
        return;
    }
    let mut path = std::iter::successors(above.get(head.joint.parent.as_str()), |j| above.get(j.parent.as_str()));
    let Some(outer) = path.find_map(|joint| heads.iter().find(|other| other.joint.name == joint.name)) else { return };
    let message = format!(
        "the root '{}' is inside the chain of '{}' (line {}): to which of the two do the links beyond it belong?",
        head.chain.root, outer.chain.root, outer.chain.at.line
    );
    let mend = format!("write anchor=\"{}\", and they belong to this chain; or take it out", head.joint.parent);
    report.add(Finding::error("chain-in-chain", head.element.place_of("root", report), message, mend));
}
