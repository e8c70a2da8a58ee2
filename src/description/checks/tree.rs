//! The links and joints must form one tree.

use super::super::element::Element;
use super::super::finding::{Finding, Place};
use super::super::report::Report;
use super::super::{Description, Joint, Position, suggest};
use super::place_of_link;
use std::collections::HashMap;

/// Roots named in the message about several roots.
const NAMED_ROOTS: usize = 5;

/// Links by index; only built if they form one tree.
pub(super) struct Tree {
    /// The joint above each link; `None` for the root.
    pub joint_above: Vec<Option<usize>>,
    /// The parent and the child link of each joint.
    pub ends: Vec<(usize, usize)>,
}

/// Unknown ends, two parents, cycles, no or several roots. `None` if one of them was found.
pub(super) fn check(d: &Description, robot: &Element, all_joints_read: bool, report: &mut Report) -> Option<Tree> {
    if d.links.is_empty() {
        let message = "the robot has no link".to_string();
        report.add(Finding::error("no-link", robot.place(report), message, "add <link name=\"…\"/>"));
        return None;
    }
    let mut index = HashMap::new();
    for (i, link) in d.links.iter().enumerate() {
        index.entry(link.name.as_str()).or_insert(i);
    }
    let ends: Vec<_> = d.joints.iter().map(|joint| ends(joint, d, &index, report)).collect();
    let joint_above = joints_above(d, &ends, report);
    let known = ends.iter().all(Option::is_some) && all_joints_read && index.len() == d.links.len();
    let ends: Vec<_> = ends.into_iter().collect::<Option<_>>()?;
    let joint_above = joint_above?;
    let acyclic = refuse_cycles(d, &ends, &joint_above, report);
    if known && acyclic {
        refuse_several_roots(d, &joint_above, report);
        return Some(Tree { joint_above, ends });
    }
    None
}

fn ends(joint: &Joint, d: &Description, index: &HashMap<&str, usize>, report: &mut Report) -> Option<(usize, usize)> {
    let mut find = |role: &str, name: &str, at: Position| {
        let found = index.get(name).copied();
        if found.is_none() {
            let place = Place { element: format!("joint '{}' <{role}>", joint.name), at };
            let message = format!("there is no link '{name}'");
            let known = d.links.iter().map(|l| l.name.as_str());
            let mend = match suggest::nearest(name, known) {
                Some(near) => format!("did you mean '{near}'?"),
                None => format!("name an existing link, or add <link name=\"{name}\">"),
            };
            report.add(Finding::error("unknown-link", place, message, mend));
        }
        found
    };
    let parent = find("parent", &joint.parent, joint.parent_at);
    let child = find("child", &joint.child, joint.child_at);
    Some((parent?, child?))
}

fn joints_above(d: &Description, ends: &[Option<(usize, usize)>], report: &mut Report) -> Option<Vec<Option<usize>>> {
    let mut above: Vec<Option<usize>> = vec![None; d.links.len()];
    let mut unique = true;
    for (i, joint) in d.joints.iter().enumerate() {
        let Some((_, child)) = ends[i] else { continue };
        let Some(first) = above[child] else {
            above[child] = Some(i);
            continue;
        };
        let first = &d.joints[first];
        let place = Place { element: format!("joint '{}' <child>", joint.name), at: joint.child_at };
        let message = format!(
            "link '{}' has two parents: '{}' by joint '{}' (line {}) and '{}' by joint '{}'",
            joint.child, first.parent, first.name, first.at.line, joint.parent, joint.name
        );
        let mend = "a URDF is a tree: keep one of the two joints, or give the second its own child link";
        report.add(Finding::error("two-parents", place, message, mend));
        unique = false;
    }
    unique.then_some(above)
}

/// Reports each cycle once, at the joint that comes first in the text.
fn refuse_cycles(d: &Description, ends: &[(usize, usize)], above: &[Option<usize>], report: &mut Report) -> bool {
    let mut acyclic = true;
    // 0 = not seen, otherwise the number of the walk that saw it.
    let mut seen = vec![0; d.links.len()];
    for start in 0..d.links.len() {
        let mut link = start;
        while seen[link] == 0 {
            seen[link] = start + 1;
            let Some(joint) = above[link] else { break };
            link = ends[joint].0;
        }
        if seen[link] == start + 1 && above[link].is_some() {
            report.add(cycle(d, link, ends, above));
            acyclic = false;
        }
    }
    acyclic
}

fn cycle(d: &Description, on_cycle: usize, ends: &[(usize, usize)], above: &[Option<usize>]) -> Finding {
    let mut joints = vec![];
    let mut link = on_cycle;
    while let Some(joint) = above[link] {
        joints.push(joint);
        link = ends[joint].0;
        if link == on_cycle {
            break;
        }
    }
    joints.reverse();
    let first = joints.iter().copied().min().unwrap_or(0);
    let turn = joints.iter().position(|j| *j == first).unwrap_or(0);
    joints.rotate_left(turn);
    let joint = &d.joints[first];
    let path: Vec<_> = joints.iter().map(|j| format!("-({})-> '{}'", d.joints[*j].name, d.joints[*j].child)).collect();
    let message = format!("these joints form a cycle: '{}' {}", joint.parent, path.join(" "));
    let place = Place { element: format!("joint '{}' <parent>", joint.name), at: joint.parent_at };
    let mend = "a URDF is a tree: take out one of these joints, or give it another child";
    Finding::error("cycle", place, message, mend)
}

fn refuse_several_roots(d: &Description, above: &[Option<usize>], report: &mut Report) {
    let roots: Vec<_> = d.links.iter().zip(above).filter(|(_, joint)| joint.is_none()).map(|(link, _)| link).collect();
    let [first, second, ..] = roots[..] else { return };
    let named: Vec<_> = roots.iter().take(NAMED_ROOTS).map(|l| format!("'{}'", l.name)).collect();
    let more = if roots.len() > NAMED_ROOTS { ", …" } else { "" };
    let message = format!("{} links have no parent: {}{more}; a robot has one root", roots.len(), named.join(", "));
    let mend = format!("connect '{}' by a joint (fixed, perhaps) to '{}', or take it out", second.name, first.name);
    report.add(Finding::error("several-roots", place_of_link(second), message, mend));
}
