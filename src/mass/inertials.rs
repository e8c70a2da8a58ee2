//! Writing computed masses back into the URDF, for tools that do not know our tag.

use super::MassProperties;
use crate::description::Description;
use std::collections::HashMap;
use std::fmt::Write;
use std::ops::Range;

/// `text` with an exact `<inertial>` in each link that gets its mass from its `<body>` tag: put in where there is none,
/// in place of one that the tag overrules. `masses` is in the order of `description.links`.
///
/// Numbers are written with the digits that read back to the same bits (at most 17). Nothing else of the text changes;
/// a text that is no XML, which a description never comes from, is given back as it is.
pub fn with_inertials(text: &str, masses: &[MassProperties], description: &Description) -> String {
    let Ok(document) = roxmltree::Document::parse(text) else { return text.to_owned() };
    let by_name: HashMap<&str, &MassProperties> = description
        .links
        .iter()
        .zip(masses)
        .filter(|(link, mass)| link.body.is_some() && mass.mass > 0.0)
        .map(|(link, mass)| (link.name.as_str(), mass))
        .collect();
    let links = document.root_element().children().filter(|n| n.has_tag_name("link"));
    let mut out = String::with_capacity(text.len() + 400 * by_name.len());
    let mut copied = 0;
    for link in links {
        let Some(mass) = link.attribute("name").and_then(|name| by_name.get(name)) else { continue };
        for edit in edits(link, mass) {
            out.push_str(&text[copied..edit.range.start]);
            out.push_str(&edit.text);
            copied = edit.range.end;
        }
    }
    out.push_str(&text[copied..]);
    out
}

struct Edit {
    range: Range<usize>,
    text: String,
}

/// What changes in one link, in the order of the text. A link with a `<body>` tag has children, so it has a place
/// after its start tag.
fn edits(link: roxmltree::Node, mass: &MassProperties) -> Vec<Edit> {
    let mut written = link.children().filter(|n| n.has_tag_name("inertial")).map(|n| n.range());
    if let Some(first) = written.next() {
        let others = written.map(|range| Edit { range, text: String::new() });
        return std::iter::once(Edit { range: first, text: inertial(mass) }).chain(others).collect();
    }
    let start = link.first_child().map(|n| n.range().start);
    start.map(|at| Edit { range: at..at, text: format!("\n    {}", inertial(mass)) }).into_iter().collect()
}

fn inertial(mass: &MassProperties) -> String {
    let c = &mass.center;
    let i = &mass.inertia;
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "<inertial><origin xyz=\"{:?} {:?} {:?}\" rpy=\"0 0 0\"/><mass value=\"{:?}\"/>\
         <inertia ixx=\"{:?}\" ixy=\"{:?}\" ixz=\"{:?}\" iyy=\"{:?}\" iyz=\"{:?}\" izz=\"{:?}\"/></inertial>",
        c.x,
        c.y,
        c.z,
        mass.mass,
        i[(0, 0)],
        i[(0, 1)],
        i[(0, 2)],
        i[(1, 1)],
        i[(1, 2)],
        i[(2, 2)],
    );
    text
}
