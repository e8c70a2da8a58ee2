//! `docs/tags.md` says what the reader does.

use super::super::element::Domain;
use super::super::rules::{Attribute, Kind, Tag};
use super::super::shapes::SHAPES;
use super::{body, joint, link, robot};

const DOCUMENT: &str = include_str!("../../../docs/tags.md");

fn tags() -> Vec<Tag> {
    vec![
        link::BODY,
        body::SHAPE,
        body::PROXY,
        link::SURFACE,
        link::DAMPING,
        link::DEACTIVATE,
        link::MONITOR,
        joint::DRIVE,
        joint::CONSTRAINT,
        robot::JOINT_GROUP,
        robot::CHAIN,
        robot::SEPARATE_RIG,
    ]
}

fn section(name: &str) -> &'static str {
    let heading = format!("### `<{name}>`");
    let start = DOCUMENT.find(&heading).unwrap_or_else(|| panic!("no section {heading}")) + heading.len();
    let rest = &DOCUMENT[start..];
    &rest[..rest.find("\n#").unwrap_or(rest.len())]
}

fn range(kind: Kind) -> String {
    match kind {
        Kind::Number(Domain::AtLeast(least)) => format!("at least {least}"),
        Kind::Number(domain) | Kind::Vector(_, domain) => domain.words(),
        Kind::Numbers => "numbers".into(),
        Kind::Flag => "true, false".into(),
        Kind::Word(words) => words.join(", "),
        Kind::Text => "text".into(),
    }
}

fn assert_row(tag: &Tag, attribute: &Attribute) {
    let start = format!("| `{}` |", attribute.name);
    let found = section(tag.name).lines().find(|line| line.starts_with(&start));
    let row = found.unwrap_or_else(|| panic!("<{}> has no row {start}", tag.name));
    let cells: Vec<_> = row.trim_matches('|').split('|').map(str::trim).collect();
    assert_eq!(cells[2], range(attribute.kind), "{row}");
    assert_eq!(cells[3] == "required", attribute.required, "{row}");
}

#[test]
fn every_attribute_has_its_row() {
    for tag in tags() {
        tag.attributes.iter().for_each(|attribute| assert_row(&tag, attribute));
        let rows = section(tag.name).lines().filter(|line| line.starts_with("| `")).count();
        assert_eq!(rows, tag.attributes.len(), "rows of <{}>", tag.name);
    }
}

#[test]
fn every_name_is_documented() {
    for name in [link::NAMES, joint::NAMES, robot::NAMES].concat() {
        section(name);
    }
}

#[test]
fn every_shape_has_its_row() {
    for shape in SHAPES {
        let start = format!("| `<{}>` |", shape.name);
        let row = DOCUMENT.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("no row {start}"));
        for attribute in shape.attributes {
            assert!(row.contains(&format!("`{}`", attribute.name)), "{row} lacks {}", attribute.name);
        }
    }
}
