//! Message definitions, by which a bag explains itself to readers that do not know ROS.

use super::definitions::{FIELDS, HASHES};
use std::fmt::Write;

/// A message type with a topic of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageType {
    /// `package/Name`.
    name: &'static str,
    /// REP-2016 hash of the type description.
    pub hash: &'static str,
}

impl MessageType {
    /// By `package/Name`; `None` for types that cannot be recorded, because their definition is not here.
    pub fn by_name(name: &str) -> Option<Self> {
        HASHES.iter().find(|(n, _)| *n == name).map(|(name, hash)| Self { name, hash })
    }

    /// `package/msg/Name`.
    pub fn full_name(&self) -> String {
        self.name.replace('/', "/msg/")
    }

    /// The definition in the form `ros2msg`: the fields, then those of every type contained, each behind a line of `=`.
    pub fn definition(&self) -> String {
        let mut text = fields(self.name).to_owned();
        let mut contained = Vec::new();
        collect(self.name, &mut contained);
        for name in contained {
            // Writing to a string cannot fail.
            let _ = write!(text, "{}\nMSG: {name}\n{}", "=".repeat(80), fields(&name));
        }
        text
    }
}

fn fields(name: &str) -> &'static str {
    FIELDS.iter().find(|(n, _)| *n == name).map_or("", |(_, fields)| fields)
}

/// The types in the fields of `name`, as `package/Name`.
fn contained(name: &str) -> impl Iterator<Item = String> {
    let package = name.split('/').next().unwrap_or_default();
    let words = fields(name).lines().filter_map(|line| line.split_whitespace().next());
    let types = words.map(|word| word.split(['[', '=', '#']).next().unwrap_or_default());
    types.filter_map(move |kind| match kind.chars().next() {
        _ if kind.contains('/') => Some(kind.to_owned()),
        Some(first) if first.is_ascii_uppercase() => Some(format!("{package}/{kind}")),
        _ => None,
    })
}

fn collect(name: &str, found: &mut Vec<String>) {
    for inner in contained(name) {
        if !found.contains(&inner) {
            found.push(inner.clone());
            collect(&inner, found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_that_a_definition_names_is_known_and_there_once() {
        for (name, _) in HASHES {
            let kind = MessageType::by_name(name).unwrap();
            let text = kind.definition();
            assert!(!fields(name).is_empty(), "{name}");
            let mut inner = vec![];
            collect(name, &mut inner);
            for contained in &inner {
                assert!(!fields(contained).is_empty(), "{name}: {contained}");
                assert_eq!(text.matches(&format!("\nMSG: {contained}\n")).count(), 1, "{name}: {contained}");
            }
            assert_eq!(text.matches("\nMSG: ").count(), inner.len(), "{name}");
        }
    }

    #[test]
    fn types_of_the_same_package_and_arrays_are_found() {
        let mut found = vec![];
        collect("realnoid/JointMonitors", &mut found);
        assert!(found.contains(&"realnoid/JointMonitor".to_owned()) && found.contains(&"std_msgs/Header".to_owned()));
        assert_eq!(MessageType::by_name("nobody/Knows"), None);
    }
}
