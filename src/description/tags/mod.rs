//! Our element `<realnoid>`: what may stand in it inside `<link>`, `<joint>` and `<robot>`.

pub(super) mod body;
#[cfg(test)]
mod documented;
pub(super) mod joint;
pub(super) mod link;
pub(super) mod robot;

use super::element::Element;
use super::finding::Finding;
use super::report::Report;
use super::suggest;

/// The name of our element.
pub(super) const REALNOID: &str = "realnoid";

/// All tags inside the `<realnoid>` elements of `owner`. `allowed` may stand there, those that are not in
/// `repeatable` only once; everything else is reported and left out.
pub(super) fn collect<'a>(
    owner: &Element<'a>,
    allowed: &[&'static str],
    repeatable: &[&str],
    report: &mut Report,
) -> Vec<Element<'a>> {
    let mut collected: Vec<Element<'a>> = vec![];
    for element in owner.all(REALNOID).flat_map(|r| r.children().collect::<Vec<_>>()) {
        let tag = element.tag();
        let earlier = collected.iter().find(|e| e.tag() == tag);
        if !element.is_plain() || !allowed.contains(&tag) {
            report.add(unknown_tag(owner, &element, allowed, report));
        } else if let Some(earlier) = earlier.filter(|_| !repeatable.contains(&tag)) {
            let message = format!("a second <{tag}>; the first one is in line {}", earlier.place(report).at.line);
            report.add(Finding::error("duplicate-tag", element.place(report), message, "keep one of them"));
        } else {
            collected.push(element);
        }
    }
    collected
}

fn unknown_tag(owner: &Element, element: &Element, allowed: &[&'static str], report: &Report) -> Finding {
    let tag = element.tag();
    let homes = [("link", link::NAMES), ("joint", joint::NAMES), ("robot", robot::NAMES)];
    let home = homes.iter().find(|(_, names)| names.contains(&tag));
    let message = format!("<{tag}> is not known in the <realnoid> of a {}", owner.tag());
    let mend = match home {
        Some((home, _)) => format!("it belongs into the <realnoid> of a {home}"),
        None => suggest::mend(tag, allowed.iter().copied(), "known tags here"),
    };
    Finding::error("unknown-tag", element.place(report), message, mend)
}

/// Attributes on `<realnoid>` itself: none inside a link or joint.
pub(super) fn refuse_attributes(owner: &Element, report: &mut Report) {
    for realnoid in owner.all(REALNOID) {
        for attribute in realnoid.node.attributes() {
            let mut place = realnoid.place(report);
            place.at = report.position(attribute.range_qname());
            let message = format!("<realnoid> inside a {} has no attribute `{}`", owner.tag(), attribute.name());
            let mend = "take it out; `version` stands on the <realnoid> inside <robot>";
            report.add(Finding::error("unknown-attribute", place, message, mend));
        }
    }
}
