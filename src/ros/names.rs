//! ROS names: namespaces, remaps, and topic names made from link names.

use ros2_client::Name;
use std::collections::HashSet;

/// A remap rule `[node:]from:=to`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remap {
    /// Only for this node.
    pub node: Option<String>,
    /// Matches a name after both are made absolute.
    pub from: String,
    /// Takes its place.
    pub to: String,
}

impl Remap {
    /// Reads a rule.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (left, to) = text.split_once(":=").ok_or("expected from:=to, as in -r joint_states:=robot/joint_states")?;
        let (node, from) = match left.split_once(':') {
            Some((node, from)) => (Some(node.to_string()), from),
            None => (None, left),
        };
        if from.is_empty() || to.is_empty() {
            return Err("neither side may be empty".into());
        }
        Ok(Self { node, from: from.into(), to: to.into() })
    }
}

/// Resolves the names of one node.
#[derive(Clone, Debug)]
pub struct Names {
    namespace: String,
    node: String,
    remaps: Vec<Remap>,
}

impl Names {
    /// Names of `node` in the absolute `namespace`.
    pub fn new(namespace: &str, node: &str, remaps: &[Remap]) -> Self {
        let mine = |r: &&Remap| r.node.as_ref().is_none_or(|n| n == node);
        Self { namespace: namespace.into(), node: node.into(), remaps: remaps.iter().filter(mine).cloned().collect() }
    }

    /// The absolute name for `name` after the first remap that matches. `Err` says what is wrong with it.
    pub fn resolve(&self, name: &str) -> Result<Name, String> {
        let absolute = self.expand(name);
        let matching = self.remaps.iter().find(|r| self.expand(&r.from) == absolute);
        let resolved = matching.map_or(absolute, |r| self.expand(&r.to));
        Name::parse(&resolved).map_err(|e| format!("'{resolved}' is no valid topic name: {e}"))
    }

    fn expand(&self, name: &str) -> String {
        match name.strip_prefix("~/") {
            _ if name.starts_with('/') => name.to_string(),
            Some(private) => join(&join(&self.namespace, &self.node), private),
            None => join(&self.namespace, name),
        }
    }
}

/// `namespace/name` with one slash.
pub fn join(namespace: &str, name: &str) -> String {
    format!("{}/{name}", namespace.trim_end_matches('/'))
}

/// Is this a name token: letters, digits, underscores, no leading digit, no double underscore?
pub fn check_token(token: &str) -> Result<(), String> {
    let first = token.chars().next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    let rest = token.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if first && rest && !token.contains("__") {
        return Ok(());
    }
    Err(format!("'{token}' is no ROS name: letters, digits and single underscores, not beginning with a digit"))
}

/// An absolute namespace without a slash at its end.
pub fn check_namespace(namespace: &str) -> Result<String, String> {
    let Some(tokens) = namespace.strip_prefix('/') else {
        return Err(format!("namespace '{namespace}' must start with /"));
    };
    if !tokens.is_empty() {
        tokens.trim_end_matches('/').split('/').try_for_each(check_token)?;
    }
    Ok(if tokens.is_empty() { "/".into() } else { namespace.trim_end_matches('/').into() })
}

/// A valid, unique topic token for each link name: what is not allowed becomes `_`.
pub fn topic_tokens<'a>(links: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let mut taken = HashSet::new();
    links
        .into_iter()
        .map(|link| {
            let token = topic_token(link);
            let unique = |n: &usize| if *n == 1 { token.clone() } else { format!("{token}_{n}") };
            let token = (1..).find(|n| !taken.contains(&unique(n))).map_or(token.clone(), |n| unique(&n));
            taken.insert(token.clone());
            token
        })
        .collect()
}

fn topic_token(link: &str) -> String {
    let mut token = String::new();
    for c in link.chars() {
        let c = if c.is_ascii_alphanumeric() { c } else { '_' };
        if !(c == '_' && token.ends_with('_')) {
            token.push(c);
        }
    }
    if token.starts_with(|c: char| c.is_ascii_digit()) || token.is_empty() {
        token.insert(0, '_');
    }
    token
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resolve(namespace: &str, rules: &[&str], name: &str) -> String {
        let rules: Vec<_> = rules.iter().map(|r| Remap::parse(r).unwrap()).collect();
        Names::new(namespace, "fd", &rules).resolve(name).unwrap().to_string()
    }

    #[test]
    fn a_namespace_moves_relative_names_only() {
        assert_eq!(resolve("/bench", &[], "joint_states"), "/bench/joint_states");
        assert_eq!(resolve("/bench", &[], "/clock"), "/clock");
        assert_eq!(resolve("/", &[], "twist/hand"), "/twist/hand");
        assert_eq!(resolve("/bench", &[], "~/x"), "/bench/fd/x");
    }

    #[test]
    fn the_first_matching_remap_applies() {
        assert_eq!(resolve("/", &["joint_states:=foo", "joint_states:=bar"], "joint_states"), "/foo");
        assert_eq!(resolve("/a", &["/a/joint_states:=/b/js"], "joint_states"), "/b/js");
        assert_eq!(resolve("/a", &["/tf:=tf"], "/tf"), "/a/tf");
        assert_eq!(resolve("/", &["other:joint_states:=foo", "fd:joint_states:=bar"], "joint_states"), "/bar");
    }

    #[test]
    fn link_names_become_valid_and_stay_apart() {
        let tokens = topic_tokens(["l-foot", "l.foot", "2nd", "l__foot", "torso", "Fuß"]);
        assert_eq!(tokens, ["l_foot", "l_foot_2", "_2nd", "l_foot_3", "torso", "Fu_"]);
        for token in tokens {
            check_token(&token).unwrap();
        }
    }

    #[test]
    fn namespaces() {
        assert_eq!(check_namespace("/").unwrap(), "/");
        assert_eq!(check_namespace("/a/b/").unwrap(), "/a/b");
        assert!(check_namespace("/a//b").is_err());
        assert!(check_namespace("a").is_err());
    }
}
