//! Axes as the joints that they make up (J-2): a group, or an axis that stands alone.

use super::{AxisKind, Model};
use crate::description::Description;

/// A joint group, or an axis that is in none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JointSet {
    /// Name of the group, or of the lone axis.
    pub name: String,
    /// Indices into `Model::axes` of H, P, B and E. A lone axis that turns is H, one that slides E.
    pub axes: [Option<usize>; 4],
}

/// The joints of a checked description whose axes are in `m`, in the order of their first axes.
pub(super) fn joint_sets(d: &Description, m: &Model) -> Vec<JointSet> {
    let mut sets: Vec<JointSet> = vec![];
    for (i, axis) in m.axes.iter().enumerate() {
        if sets.iter().any(|set| set.axes.contains(&Some(i))) {
            continue;
        }
        let set = match d.group_of(&axis.name) {
            Some(group) => {
                let named = |name: &Option<String>| name.as_deref().and_then(|name| m.axis(name));
                let axes = [&group.h, &group.p, &group.b, &group.e].map(named);
                JointSet { name: group.name.clone(), axes }
            }
            None if axis.kind == AxisKind::Rotary => {
                JointSet { name: axis.name.clone(), axes: [Some(i), None, None, None] }
            }
            None => JointSet { name: axis.name.clone(), axes: [None, None, None, Some(i)] },
        };
        sets.push(set);
    }
    sets
}
