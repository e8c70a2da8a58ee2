//! Parameter files: YAML as `rcl` reads it, with the line of everything that is wrong.
//!
//! ```yaml
//! /**:                       # any node; also a node name, a full name, or namespaces around names, with * and **
//!   ros__parameters:
//!     time_scale: 0.5
//! ```

use super::parameters::Values;
use ros2_client::ParameterValue as V;
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_saphyr::Spanned;
use std::fmt;
use std::path::Path;

const PARAMETERS: &str = "ros__parameters";

/// Sets what the file says for the node `full_name`, later sections over earlier ones. Unknown parameters are an error
/// in a section that names the node, and a warning in one that a wildcard addresses to it. `Err` names file and line.
pub fn read(path: &Path, full_name: &str, values: &mut Values, warnings: &mut Vec<String>) -> Result<(), String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    apply(&path.display().to_string(), &text, full_name, values, warnings)
}

fn apply(
    file: &str,
    text: &str,
    full_name: &str,
    values: &mut Values,
    warnings: &mut Vec<String>,
) -> Result<(), String> {
    let root: Spanned<Yaml> =
        serde_saphyr::from_str(text).map_err(|e| format!("{file}: {}", e.to_string().trim_end()))?;
    let mut sections = vec![];
    collect_sections("", &root, file, &mut sections)?;
    for section in sections.iter().filter(|s| matches(&s.pattern, full_name)) {
        let mut leaves = vec![];
        flatten("", &section.parameters, &mut leaves);
        for (name, node) in leaves {
            let at = |reason: String| format!("{file}:{}: {reason}", node.referenced.line());
            if section.pattern.contains('*') && values.get(&name).is_none() {
                warnings
                    .push(at(format!("parameter '{name}' in section '{}' is not one of this node's", section.pattern)));
                continue;
            }
            let value = node.value.to_value().map_err(|e| at(format!("parameter '{name}': {e}")))?;
            values.set_at_start(&name, value).map_err(at)?;
        }
    }
    Ok(())
}

/// The value of a `-p` argument, which is YAML, too.
pub fn scalar(text: &str) -> Result<V, String> {
    let yaml: Yaml = serde_saphyr::from_str(text).map_err(|e| e.to_string())?;
    yaml.to_value()
}

struct Section {
    pattern: String,
    parameters: Spanned<Yaml>,
}

fn collect_sections(prefix: &str, node: &Spanned<Yaml>, file: &str, into: &mut Vec<Section>) -> Result<(), String> {
    let Yaml::Map(entries) = &node.value else {
        let line = node.referenced.line();
        return Err(format!("{file}:{line}: expected a node name, a namespace or {PARAMETERS} with entries below it"));
    };
    for (key, value) in entries {
        if key.value == PARAMETERS && !prefix.is_empty() {
            into.push(Section { pattern: prefix.into(), parameters: value.clone() });
        } else if key.value == PARAMETERS {
            let line = key.referenced.line();
            return Err(format!("{file}:{line}: {PARAMETERS} needs a node name above it, as in /**:"));
        } else {
            collect_sections(&super::names::join(prefix, key.value.trim_start_matches('/')), value, file, into)?;
        }
    }
    Ok(())
}

/// `*` stands for one token, `**` for any number of tokens, also none.
fn matches(pattern: &str, full_name: &str) -> bool {
    fn tokens(name: &str) -> Vec<&str> {
        name.split('/').filter(|t| !t.is_empty()).collect()
    }
    fn fits(pattern: &[&str], name: &[&str]) -> bool {
        match (pattern, name) {
            ([], []) => true,
            (["**", rest @ ..], _) => fits(rest, name) || (!name.is_empty() && fits(pattern, &name[1..])),
            ([p, rest @ ..], [n, others @ ..]) if *p == "*" || p == n => fits(rest, others),
            _ => false,
        }
    }
    fits(&tokens(pattern), &tokens(full_name))
}

/// Nested maps are dotted names.
fn flatten<'a>(prefix: &str, node: &'a Spanned<Yaml>, into: &mut Vec<(String, &'a Spanned<Yaml>)>) {
    let Yaml::Map(entries) = &node.value else {
        into.push((prefix.into(), node));
        return;
    };
    for (key, value) in entries {
        let name = if prefix.is_empty() { key.value.clone() } else { format!("{prefix}.{}", key.value) };
        flatten(&name, value, into);
    }
}

/// Any YAML, with places.
#[derive(Clone, Debug)]
enum Yaml {
    Null,
    Bool(bool),
    Integer(i64),
    Double(f64),
    Text(String),
    List(Vec<Yaml>),
    Map(Vec<(Spanned<String>, Spanned<Yaml>)>),
}

impl Yaml {
    fn to_value(&self) -> Result<V, String> {
        Ok(match self {
            Self::Null => return Err("has no value".into()),
            Self::Map(_) => return Err("expected a value, found a map".into()),
            Self::Bool(b) => V::Boolean(*b),
            Self::Integer(i) => V::Integer(*i),
            Self::Double(d) => V::Double(*d),
            Self::Text(s) => V::String(s.clone()),
            Self::List(items) => list(items)?,
        })
    }

    fn number(&self) -> Option<f64> {
        match self {
            Self::Integer(i) => Some(*i as f64),
            Self::Double(d) => Some(*d),
            _ => None,
        }
    }
}

fn list(items: &[Yaml]) -> Result<V, String> {
    let all = |f: &dyn Fn(&Yaml) -> Option<V>| items.iter().all(|i| f(i).is_some());
    if all(&|y| matches!(y, Yaml::Integer(_)).then_some(V::NotSet)) {
        return Ok(V::IntegerArray(
            items.iter().filter_map(|y| if let Yaml::Integer(i) = y { Some(*i) } else { None }).collect(),
        ));
    }
    if all(&|y| y.number().map(V::Double)) {
        return Ok(V::DoubleArray(items.iter().filter_map(Yaml::number).collect()));
    }
    if all(&|y| matches!(y, Yaml::Text(_)).then_some(V::NotSet)) {
        return Ok(V::StringArray(
            items.iter().filter_map(|y| if let Yaml::Text(s) = y { Some(s.clone()) } else { None }).collect(),
        ));
    }
    if all(&|y| matches!(y, Yaml::Bool(_)).then_some(V::NotSet)) {
        return Ok(V::BooleanArray(
            items.iter().filter_map(|y| if let Yaml::Bool(b) = y { Some(*b) } else { None }).collect(),
        ));
    }
    Err("a list must hold values of one type".into())
}

impl<'de> Deserialize<'de> for Yaml {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(YamlVisitor)
    }
}

struct YamlVisitor;

impl<'de> Visitor<'de> for YamlVisitor {
    type Value = Yaml;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a YAML value")
    }
    fn visit_unit<E>(self) -> Result<Yaml, E> {
        Ok(Yaml::Null)
    }
    fn visit_none<E>(self) -> Result<Yaml, E> {
        Ok(Yaml::Null)
    }
    fn visit_some<D: Deserializer<'de>>(self, d: D) -> Result<Yaml, D::Error> {
        Yaml::deserialize(d)
    }
    fn visit_bool<E>(self, b: bool) -> Result<Yaml, E> {
        Ok(Yaml::Bool(b))
    }
    fn visit_i64<E>(self, i: i64) -> Result<Yaml, E> {
        Ok(Yaml::Integer(i))
    }
    fn visit_u64<E: serde::de::Error>(self, u: u64) -> Result<Yaml, E> {
        i64::try_from(u).map(Yaml::Integer).map_err(|_| E::custom(format!("{u} does not fit in 64 bits with sign")))
    }
    fn visit_f64<E>(self, d: f64) -> Result<Yaml, E> {
        Ok(Yaml::Double(d))
    }
    fn visit_str<E>(self, s: &str) -> Result<Yaml, E> {
        Ok(Yaml::Text(s.into()))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Yaml, A::Error> {
        let mut items = vec![];
        while let Some(item) = seq.next_element()? {
            items.push(item);
        }
        Ok(Yaml::List(items))
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Yaml, A::Error> {
        let mut entries = vec![];
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Yaml::Map(entries))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_as(full_name: &str, text: &str) -> Result<(Values, Vec<String>), String> {
        let (mut values, mut warnings) = (Values::default(), vec![]);
        apply("p.yaml", text, full_name, &mut values, &mut warnings).map(|()| (values, warnings))
    }

    #[test]
    fn sections_are_matched_as_ros_does() {
        for (pattern, name, fits) in [
            ("/**", "/fd", true),
            ("/**", "/a/b/fd", true),
            ("/*", "/fd", true),
            ("/*", "/a/fd", false),
            ("/fd", "/fd", true),
            ("/fd", "/a/fd", false),
            ("/**/fd", "/fd", true),
            ("/**/fd", "/a/b/fd", true),
            ("/a/*", "/a/fd", true),
            ("/a/**", "/b/fd", false),
        ] {
            assert_eq!(matches(pattern, name), fits, "{pattern} {name}");
        }
    }

    #[test]
    fn later_sections_win_and_namespaces_nest() {
        let text = "/**:\n  ros__parameters:\n    tf_rate: 1\n    time_scale: 2.0\n/bench:\n  fd:\n    ros__parameters:\n      tf_rate: 3\n";
        assert_eq!(read_as("/bench/fd", text).unwrap().0.tf_rate(), 3.0);
        assert_eq!(read_as("/fd", text).unwrap().0.tf_rate(), 1.0);
        assert_eq!(read_as("/bench/fd", text).unwrap().0.pace().settings.time_scale, 2.0);
    }

    #[test]
    fn errors_name_file_and_line() {
        let text = "fd:\n  ros__parameters:\n    tf_rate: 1\n    speed: 2\n";
        let error = read_as("/fd", text).unwrap_err();
        assert!(error.starts_with("p.yaml:4: there is no parameter 'speed'"), "{error}");
        let error = read_as("/fd", "fd:\n  ros__parameters:\n    gravity: [0, 1]\n").unwrap_err();
        assert!(error.starts_with("p.yaml:3: parameter 'gravity' = [0.0, 1.0] is out of range"), "{error}");
        let error = read_as("/fd", "ros__parameters:\n  tf_rate: 1\n").unwrap_err();
        assert!(error.starts_with("p.yaml:1: ros__parameters needs a node name"), "{error}");
        let error = read_as("/fd", "fd:\n  tf_rate: 1\n").unwrap_err();
        assert!(error.starts_with("p.yaml:2: expected a node name"), "{error}");
        assert!(read_as("/fd", "fd: [").unwrap_err().contains("p.yaml"));
        assert!(read_as("/fd", "fd:\n  ros__parameters:\n    tf_rate:\n").unwrap_err().contains("has no value"));
    }

    #[test]
    fn unknown_names_in_wildcard_sections_are_warnings() {
        let (_, warnings) = read_as("/fd", "/**:\n  ros__parameters:\n    robot: {speed: 2}\n").unwrap();
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].starts_with("p.yaml:3: parameter 'robot.speed'"), "{warnings:?}");
    }

    #[test]
    fn quoted_numbers_stay_text() {
        assert_eq!(scalar("'1'").unwrap(), V::String("1".into()));
        assert_eq!(scalar("1").unwrap(), V::Integer(1));
        assert_eq!(scalar("1e-3").unwrap(), V::Double(1e-3));
        assert!(scalar("[1, a]").is_err());
    }
}
