//! The `<constraint>` of a cardan or 3DOF group: its axes are one joint, with one softness.

use super::super::finding::{Finding, Place};
use super::super::report::Report;
use super::super::{Constraint, Description, GroupKind, Joint, JointGroup, JointKind};

type Value = fn(&Constraint) -> Option<f64>;
const VALUES: [(&str, Value); 2] = [("erp", |c| c.erp), ("cfm", |c| c.cfm)];

/// Warns of values that an earlier axis of the same group overrules.
pub(super) fn check(d: &Description, report: &mut Report) {
    for group in &d.groups {
        let axes = one_joint(d, group);
        for (name, value) in VALUES {
            let mut given = axes.iter().filter_map(|j| Some((*j, value(j.constraint.as_ref()?)?)));
            let Some((first, counts)) = given.next() else { continue };
            for (joint, ignored) in given.filter(|(_, x)| *x != counts) {
                overruled(group, (name, ignored, joint), (counts, first), report);
            }
        }
    }
}

/// The axes that share one joint, from the root outwards: those of a whole 3DOF, else h and p. Others are hinges.
fn one_joint<'a>(d: &'a Description, group: &'a JointGroup) -> Vec<&'a Joint> {
    let moving = |name: &'a Option<String>| {
        let joint = d.joints.iter().find(|j| Some(&j.name) == name.as_ref())?;
        (joint.kind != JointKind::Fixed).then_some(joint)
    };
    match (group.kind, moving(&group.h), moving(&group.p), moving(&group.b)) {
        (GroupKind::ThreeDof, Some(h), Some(p), Some(b)) => vec![h, p, b],
        (GroupKind::ThreeDof | GroupKind::Cardan, Some(h), Some(p), _) => vec![h, p],
        _ => vec![],
    }
}

fn overruled(
    group: &JointGroup,
    (name, ignored, joint): (&str, f64, &Joint),
    (counts, first): (f64, &Joint),
    report: &mut Report,
) {
    let at = joint.constraint.as_ref().map_or(joint.at, |c| c.at);
    let place = Place { element: format!("joint '{}' <constraint>", joint.name), at };
    let message = format!(
        "{name} {ignored} has no effect: the axes of group '{}' are one joint, and {name} {counts} of '{}' counts",
        group.name, first.name
    );
    let mend = "give the same value at both axes, or at one of them only";
    report.add(Finding::warning("overruled-constraint", place, message, mend));
}
