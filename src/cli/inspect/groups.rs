//! Groups, chains and rigs, for programs.

use crate::description::{Description, GroupKind, JointGroup};
use crate::model::Model;
use serde_json::{Value, json};

/// J-2, J-5: the groups with their axes, and whether they are valid; `faults` are those of the axes.
pub(super) fn groups(d: &Description, m: &Model, faults: &[Vec<String>]) -> Value {
    d.groups.iter().map(|group| group_json(m, group, faults)).collect()
}

fn group_json(m: &Model, group: &JointGroup, faults: &[Vec<String>]) -> Value {
    let moving: Vec<usize> = group.axes().filter_map(|(_, name)| m.axis(name)).collect();
    let of_axis = |axis: usize| faults[axis].iter().map(move |fault| format!("{}: {fault}", m.axes[axis].name));
    let mut told: Vec<String> = moving.iter().flat_map(|axis| of_axis(*axis)).collect();
    if moving.is_empty() {
        told.push("every axis is physically fixed".into());
    }
    let joint = |name: &Option<String>| json!(name.as_deref().filter(|n| m.axis(n).is_some()));
    json!({
        "name": group.name,
        "type": match group.kind {
            GroupKind::CombinedHinge => "combined_hinge",
            GroupKind::Cardan => "cardan",
            GroupKind::ThreeDof => "3dof",
        },
        "h": joint(&group.h),
        "p": joint(&group.p),
        "b": joint(&group.b),
        "e": joint(&group.e),
        "valid": told.is_empty(),
        "faults": told,
    })
}

/// J-3, J-7, J-9.
pub(super) fn chains(m: &Model) -> Value {
    let chain = |c: &crate::model::LinkChain| {
        json!({
            "root": c.root,
            "joint": c.joint,
            "anchor": c.anchor,
            "self_collision": c.self_collision,
            "links": c.links.iter().map(|i| &m.links[*i].name).collect::<Vec<_>>(),
        })
    };
    m.chains.iter().map(chain).collect()
}

/// J-4.
pub(super) fn rigs(m: &Model) -> Value {
    let rig = |r: &crate::model::Rig| {
        json!({
            "name": r.name,
            "group": r.group,
            "axes": r.axes.map(|axis| axis.map(|a| m.axes[a].name.clone())),
            "parent": m.links[r.parent].name,
            "anchored": r.anchored,
            "reference": r.reference.map(|link| &m.links[link].name),
        })
    };
    m.rigs.iter().map(rig).collect()
}
