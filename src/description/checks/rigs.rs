//! `<separate_rig>`: its names, its anchor, and the reference warning of W-16 (J-4, J-7, tables 6-8 and 6-21).

use super::super::element::Element;
use super::super::finding::Finding;
use super::super::report::Report;
use super::super::tags::robot::RobotTags;
use super::super::{Description, JointGroup, SeparateRig, WORLD_ANCHOR};
use super::groups::must_exist;
use std::collections::HashMap;

/// All separate rigs.
pub(super) fn check(d: &Description, tags: &RobotTags, report: &mut Report) {
    let mut frames: HashMap<&str, String> = HashMap::from([(WORLD_ANCHOR, "the frame that does not move".into())]);
    frames.extend(d.links.iter().map(|l| (l.name.as_str(), format!("the link in line {}", l.at.line))));
    for (rig, element) in &tags.rigs {
        if let Some(other) = frames.insert(&rig.name, format!("the rig in line {}", rig.at.line)) {
            let message = format!("the frame '{}' is already there: {other}", rig.name);
            report.add(Finding::error("duplicate-name", element.place_of("name", report), message, "rename the rig"));
        }
        let groups = d.groups.iter().map(|g| g.name.as_str());
        must_exist("joint_group", &rig.group, groups, ("of", element), report);
        if let Some(group) = d.group(&rig.group) {
            warn_without_reference(rig, group, element, report);
            check_anchor(d, rig, element, report);
        }
    }
}

/// W-16: the position of a rig follows the link of P, else of B, else of H.
fn warn_without_reference(rig: &SeparateRig, group: &JointGroup, element: &Element, report: &mut Report) {
    if group.axes().any(|(letter, _)| letter != "e") {
        return;
    }
    let message = format!(
        "the group '{}' of the rig '{}' has none of h, p, b: no link gives the rig its position",
        group.name, rig.name
    );
    let mend = "it stays where the group is fixed; give the group a rotary axis, or take the rig out";
    report.add(Finding::warning("rig-without-reference", element.place_of("of", report), message, mend));
}

/// Table 6-8: only the rig of a chain's root has an anchor.
fn check_anchor(d: &Description, rig: &SeparateRig, element: &Element, report: &mut Report) {
    let Some(anchor) = &rig.anchor else { return };
    let links = d.links.iter().map(|l| l.name.as_str());
    must_exist("link", anchor, links, ("anchor", element), report);
    let first = |name: &str| d.first_joint(name).map(|joint| joint.name.as_str());
    let is_root = d.chains.iter().any(|chain| first(&chain.root) == first(&rig.group));
    if !is_root {
        let message = format!(
            "the rig '{}' has the anchor '{anchor}', but its group '{}' is not the root of a chain",
            rig.name, rig.group
        );
        let mend = format!("take the anchor out, or add <chain root=\"{}\"/>", rig.group);
        report.add(Finding::error("rig-anchor", element.place_of("anchor", report), message, mend));
    }
}
