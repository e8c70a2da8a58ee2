//! The environment variables of ROS 2: domain and discovery range.

use std::fmt;

/// Highest domain whose ports fit in 16 bits.
const LAST_DOMAIN: u16 = 232;
/// Up to here (and from 215 on) Linux does not use the domain's ports for other connections.
const LAST_SAFE_DOMAIN: u16 = 101;

/// How far the node can be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiscoveryRange {
    /// Nowhere.
    Off,
    /// On this host.
    Localhost,
    /// In the local network.
    Subnet,
}

impl fmt::Display for DiscoveryRange {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Off => "off",
            Self::Localhost => "localhost",
            Self::Subnet => "subnet",
        })
    }
}

/// What the environment says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Environment {
    /// `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// `ROS_AUTOMATIC_DISCOVERY_RANGE`, or localhost by the older `ROS_LOCALHOST_ONLY`.
    pub range: DiscoveryRange,
    /// What is set and has no effect.
    pub warnings: Vec<String>,
}

impl Environment {
    /// Reads the variables of this process. `Err` names the variable, its value and what is accepted.
    pub fn read() -> Result<Self, String> {
        Self::from(|name| std::env::var(name).ok())
    }

    fn from(variable: impl Fn(&str) -> Option<String>) -> Result<Self, String> {
        let set = |name| variable(name).filter(|text| !text.is_empty());
        let domain = set("ROS_DOMAIN_ID").map_or(Ok(0), |text| domain(&text))?;
        let named_range =
            set("ROS_AUTOMATIC_DISCOVERY_RANGE").map_or(Ok(DiscoveryRange::Subnet), |text| range(&text))?;
        let localhost_only = set("ROS_LOCALHOST_ONLY").map_or(Ok(false), |text| flag("ROS_LOCALHOST_ONLY", &text))?;
        let range = if localhost_only { DiscoveryRange::Localhost } else { named_range };
        let mut warnings = vec![];
        if domain > LAST_SAFE_DOMAIN {
            warnings
                .push(format!("ROS_DOMAIN_ID={domain}: above {LAST_SAFE_DOMAIN}, other programs may use its ports"));
        }
        if set("ROS_STATIC_PEERS").is_some() {
            warnings.push("ROS_STATIC_PEERS is set; this node does not support it".into());
        }
        if let Some(rmw) = set("RMW_IMPLEMENTATION").filter(|rmw| !rmw.starts_with("rmw_fastrtps")) {
            warnings.push(format!(
                "RMW_IMPLEMENTATION={rmw}: topics work with any DDS, parameter services with rmw_fastrtps only"
            ));
        }
        Ok(Self { domain, range, warnings })
    }
}

fn domain(text: &str) -> Result<u16, String> {
    let number = text.trim().parse::<u16>().ok().filter(|d| *d <= LAST_DOMAIN);
    number.ok_or_else(|| format!("ROS_DOMAIN_ID='{text}' is not a whole number from 0 to {LAST_DOMAIN}"))
}

fn range(text: &str) -> Result<DiscoveryRange, String> {
    match text.to_ascii_uppercase().as_str() {
        "OFF" => Ok(DiscoveryRange::Off),
        "LOCALHOST" => Ok(DiscoveryRange::Localhost),
        "SUBNET" | "SYSTEM_DEFAULT" => Ok(DiscoveryRange::Subnet),
        _ => Err(format!("ROS_AUTOMATIC_DISCOVERY_RANGE='{text}' is none of OFF, LOCALHOST, SUBNET, SYSTEM_DEFAULT")),
    }
}

fn flag(name: &str, text: &str) -> Result<bool, String> {
    match text {
        "1" => Ok(true),
        "0" => Ok(false),
        _ => Err(format!("{name}='{text}' is neither 0 nor 1")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(variables: &[(&str, &str)]) -> Result<Environment, String> {
        Environment::from(|name| variables.iter().find(|(n, _)| *n == name).map(|(_, v)| v.to_string()))
    }

    #[test]
    fn nothing_set_means_domain_0_in_the_subnet() {
        let e = read(&[]).unwrap();
        assert_eq!((e.domain, e.range, e.warnings.len()), (0, DiscoveryRange::Subnet, 0));
    }

    #[test]
    fn localhost_only_wins_over_the_range() {
        let e = read(&[("ROS_LOCALHOST_ONLY", "1"), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")]).unwrap();
        assert_eq!(e.range, DiscoveryRange::Localhost);
        let e = read(&[("ROS_LOCALHOST_ONLY", "0"), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")]).unwrap();
        assert_eq!(e.range, DiscoveryRange::Off);
    }

    #[test]
    fn bad_values_are_named() {
        for (name, value) in [
            ("ROS_DOMAIN_ID", "233"),
            ("ROS_DOMAIN_ID", "-1"),
            ("ROS_DOMAIN_ID", "seven"),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", "WORLD"),
            ("ROS_LOCALHOST_ONLY", "yes"),
        ] {
            let error = read(&[(name, value)]).unwrap_err();
            assert!(error.contains(name) && error.contains(value), "{error}");
        }
    }

    #[test]
    fn what_has_no_effect_is_said() {
        assert_eq!(read(&[("ROS_DOMAIN_ID", "150"), ("ROS_STATIC_PEERS", "10.0.0.1")]).unwrap().warnings.len(), 2);
    }
}
