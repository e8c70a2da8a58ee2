//! Elements and attributes of the standard part that carry no meaning here.

use super::element::Element;
use super::finding::Finding;
use super::report::Report;
use super::{suggest, xml};

/// Names under which xacro's own elements appear.
const XACRO: &str = "xacro";

/// Tells about child elements that are not in `known`: once per kind, as a note, or as a warning where the
/// name looks misspelt; an xacro element is an error, because the robot is not complete without it.
pub(super) fn children(element: &Element, known: &[&'static str], report: &mut Report) {
    for child in element.children() {
        if child.is_plain() && known.contains(&child.tag()) {
            continue;
        }
        let finding = if is_xacro(&child) {
            let message = format!("<xacro:{}> has not been expanded: this is xacro, not yet URDF", child.tag());
            Finding::error("xacro-not-expanded", child.place(report), message, super::RUN_XACRO)
        } else if child.is_plain() && child.tag() == super::tags::REALNOID {
            let message = format!("<realnoid> means nothing inside <{}>", element.tag());
            let mend = "put it directly inside <robot>, <link> or <joint>";
            Finding::error("misplaced-tag", child.place(report), message, mend)
        } else {
            ignored(element, &child, known, report)
        };
        let key = if finding.code == "xacro-not-expanded" { String::new() } else { qualified(&child) };
        report.add_once(&key, finding);
    }
}

fn ignored(element: &Element, child: &Element, known: &[&'static str], report: &Report) -> Finding {
    let name = qualified(child);
    let message = format!("<{name}> inside <{}> is ignored: it means nothing to the dynamics", element.tag());
    let namespace = child.node.tag_name().namespace().unwrap_or_default();
    if namespace.starts_with(xml::UNDECLARED) {
        let mend = format!("declare the prefix: <robot xmlns:{}=\"…\">, or take the element out", prefix(child));
        return Finding::warning("undeclared-prefix", child.place(report), message, mend);
    }
    match suggest::nearest(child.tag(), known.iter().copied()).filter(|_| child.is_plain()) {
        Some(near) => {
            let mend = format!("did you mean <{near}>?");
            Finding::warning("ignored-element", child.place(report), message, mend)
        }
        None => Finding::note("ignored-element", child.place(report), message, ""),
    }
}

/// Tells about attributes that are not in `known`, once per kind: a note, or a warning where the name looks
/// misspelt. Attributes of foreign namespaces are theirs.
pub(super) fn attributes(element: &Element, known: &[&'static str], report: &mut Report) {
    for attribute in element.node.attributes() {
        let name = attribute.name();
        if attribute.namespace().is_some() || known.contains(&name) {
            continue;
        }
        let mut place = element.place(report);
        place.at = report.position(attribute.range_qname());
        let message = format!("<{}> has no attribute `{name}` in URDF: it is ignored", element.tag());
        let finding = match suggest::nearest(name, known.iter().copied()) {
            Some(near) => Finding::warning("ignored-attribute", place, message, format!("did you mean `{near}`?")),
            None => Finding::note("ignored-attribute", place, message, ""),
        };
        report.add_once(&format!("{} {name}", element.tag()), finding);
    }
}

fn is_xacro(element: &Element) -> bool {
    element.node.tag_name().namespace().is_some_and(|namespace| namespace.contains(XACRO)) && !element.is_plain()
}

fn qualified(element: &Element) -> String {
    match prefix(element) {
        "" => element.tag().to_string(),
        prefix => format!("{prefix}:{}", element.tag()),
    }
}

/// The prefix as the text has it.
fn prefix<'a>(element: &Element<'a>) -> &'a str {
    let text = &element.node.document().input_text()[element.node.range()];
    let name = text[1..].split([' ', '\t', '\r', '\n', '>', '/']).next().unwrap_or_default();
    name.split_once(':').map_or("", |(prefix, _)| prefix)
}
