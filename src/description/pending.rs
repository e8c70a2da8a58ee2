//! What is read and checked, but has no effect on the simulation yet. Whoever makes an effect real deletes
//! its row here (and its mark in `docs/tags.md`).

use super::element::Element;
use super::finding::Finding;
use super::report::Report;

/// Code of the finding for a tag that is read and checked, but has no effect on the simulation yet.
pub const NOT_SIMULATED: &str = "not-simulated-yet";

/// A tag, or one attribute of it, that is not simulated yet.
pub(super) struct Pending {
    pub tag: &'static str,
    /// `None`: the whole tag.
    pub attribute: Option<&'static str>,
    /// What happens instead.
    pub instead: &'static str,
}

const fn tag(tag: &'static str, instead: &'static str) -> Pending {
    Pending { tag, attribute: None, instead }
}

const fn attribute(tag: &'static str, attribute: &'static str, instead: &'static str) -> Pending {
    Pending { tag, attribute: Some(attribute), instead }
}

/// The list.
pub(super) const PENDING: &[Pending] = &[
    tag("proxy", "there is no contact yet"),
    tag("surface", "there is no contact yet"),
    tag("deactivate", "bodies stay active"),
    attribute("chain", "self_collision", "there is no contact inside a chain yet"),
];

/// Adds a note for each row that `element`, an instance of the tag `name`, calls for; each row is told once.
pub(super) fn note(name: &str, element: &Element, report: &mut Report) {
    for row in PENDING.iter().filter(|row| row.tag == name) {
        let (place, what) = match row.attribute {
            None => (element.place(report), format!("<{name}>")),
            Some(attribute) if element.value(attribute).is_none() => continue,
            Some(attribute) => (element.place_of(attribute, report), format!("<{name} {attribute}>")),
        };
        let message = format!("{what} is read but not simulated yet: {}", row.instead);
        report.add_once(&what, Finding::note(NOT_SIMULATED, place, message, ""));
    }
}
