//! What an engine cannot honour is told, never silently dropped (E-2).

use crate::description::{Description, Finding, Severity};

/// What stands in the text of a joint and has no effect in the engine of this name: a warning for each kind of item, with the
/// engine, the joints and the item.
pub fn not_honoured(engine: &str, d: &Description) -> Vec<Finding> {
    let mut found: Vec<(&'static str, Finding, usize)> = vec![];
    let limits = d.joints.iter().filter_map(|joint| Some((joint, joint.limit.as_ref()?)));
    for (joint, limit) in limits {
        for item in &limit.beyond {
            if let Some((_, _, others)) = found.iter_mut().find(|(known, ..)| known == item) {
                *others += 1;
                continue;
            }
            let finding = Finding {
                severity: Severity::Warning,
                code: "not-honoured",
                message: format!("the engine {engine} does not honour <limit {item}> of joint '{}'", joint.name),
                element: format!("joint '{}' <limit>", joint.name),
                at: limit.at,
                mend: "leave it to the controller, which plans the motion".into(),
            };
            found.push((item, finding, 0));
        }
    }
    let told = |(_, mut finding, others): (_, Finding, usize)| {
        if others > 0 {
            finding.message.push_str(&format!(", nor of {others} other{}", if others == 1 { "" } else { "s" }));
        }
        finding
    };
    found.into_iter().map(told).collect()
}
