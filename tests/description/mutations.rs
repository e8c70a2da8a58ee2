//! No mutation of a text makes the reader panic, or the two readers disagree.

use super::*;
use proptest::prelude::*;

/// A text that holds every tag, to be mutated.
fn sample() -> String {
    let (_, group) = broken("group_origin");
    let link = r#"<visual><origin xyz="0 0 1"/><geometry><box size="1 2 3"/></geometry><material name="m"/></visual>
        <realnoid><body specific_gravity="1.05" dimension="2d" thickness="0.01" zero_exponent="-9"><shape scale="1 -2 1" polygonise="true" segments="8"><cylinder radius="1" length="2" slice="0 1" fillet="0.1"/></shape>
        <shape><terrain size="1 1 1" columns="2" heights="0 1 0 1"/></shape><shape><quad a="0 0 0" b="1 0 0" c="1 1 0" d="0 1 0"/></shape></body>
        <proxy><capsule radius="0.07" length="0.3"/></proxy><surface friction="0.8"/><monitor frame="body"/></realnoid>"#;
    let joint = r#"<realnoid><drive mode="servo" max_torque="120"/><constraint erp="0.2"/></realnoid>"#;
    let group =
        group.replacen("</link>", &format!("{link}</link>"), 1).replacen("</joint>", &format!("{joint}</joint>"), 1);
    group.replace("0 0 -0.05", "0 0 0")
}

/// Cuts, doubles or overwrites a piece of the text at character boundaries.
fn mutate(text: &str, at: usize, length: usize, insert: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let start = at % (characters.len() + 1);
    let end = (start + length).min(characters.len());
    characters[..start].iter().collect::<String>() + insert + &characters[end..].iter().collect::<String>()
}

const PIECES: &[&str] = &[
    "",
    "\"",
    "<",
    ">",
    "/>",
    "</link>",
    "<link name=\"x\"/>",
    "nan",
    "-",
    "1e999",
    "0",
    " ",
    "é",
    "&amp;",
    "&",
    "x:",
    "<!--",
    "-->",
    "<realnoid>",
    "link",
    "joint",
    "\u{0}",
    "]]>",
    "version=\"1.2\"",
    "<!DOCTYPE a>",
    "<?xml?>",
    "e",
    "pelvis",
    "=\"\"",
    "\n",
];

/// What an attribute may be overwritten with.
const VALUES: &[&str] = &[
    "",
    " ",
    "0",
    "-0",
    "1e-3",
    "+1",
    ".5",
    "1.",
    "1e400",
    "-1",
    "infinity",
    "0x1",
    "1_000",
    "1 2 3",
    " 0 0\t1 ",
    "0 0 0",
    "1 2",
    "1 2 3 4",
    "hip_yaw",
    "thigh",
    "é",
    "a b",
    " thigh",
    "a&amp;b",
    "&lt;",
    "&quot;",
    "&#10;",
    "&#x1F916;",
    "true",
    "fixed",
    "continuous",
    "prismatic",
    "floating",
    "3dof",
    "cardan",
    "combined_hinge",
    "2d",
    "1",
];

/// Overwrites the value of the n-th attribute.
fn set_attribute(text: &str, n: usize, value: &str) -> String {
    let starts: Vec<_> = text.match_indices("=\"").map(|(at, _)| at + 2).collect();
    let start = starts[n % starts.len()];
    let end = start + text[start..].find('"').unwrap();
    format!("{}{value}{}", &text[..start], &text[end..])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]
    #[test]
    fn no_attribute_value_makes_the_two_readers_disagree(
        edits in prop::collection::vec((any::<usize>(), prop::sample::select(VALUES)), 1..4)
    ) {
        let text = edits.iter().fold(sample(), |text, (n, value)| set_attribute(&text, *n, value));
        let reading = read(&text, "mutated.urdf");
        prop_assert!(reading.findings.iter().all(|f| f.code != "readers-disagree"), "{}", render(&reading.findings, "m", &text, false));
        let sound = reading.findings.iter().all(|f| f.severity < Severity::Error);
        prop_assert_eq!(reading.description.is_some(), sound);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn no_mutation_makes_the_reader_panic(
        edits in prop::collection::vec((any::<usize>(), 0usize..60, prop::sample::select(PIECES)), 1..4)
    ) {
        let text = edits.iter().fold(sample(), |text, (at, length, piece)| mutate(&text, *at, *length, piece));
        let reading = read(&text, "mutated.urdf");
        prop_assert!(reading.findings.iter().all(|f| f.code != "readers-disagree"), "{text}");
        prop_assert!(reading.findings.iter().all(|f| f.at.start <= f.at.end && f.at.end <= text.len()));
        let sound = reading.findings.iter().all(|f| f.severity < Severity::Error);
        prop_assert_eq!(reading.description.is_some(), sound);
        let report = render(&reading.findings, "mutated.urdf", &text, false);
        prop_assert!(report.ends_with('\n'));
    }
}
