//! A body of a scene as a robot of one link: its shapes and checks are those of a URDF.

use super::file::Body;
use super::limits::within;
use super::pose;
use crate::math::{Pose, Vec3};
use serde_json::{Map, Value};

/// A checked entry; what its shape and tags say is checked by the reader of URDFs.
#[derive(Clone, Debug)]
pub(super) struct BodyEntry {
    /// Where it is said, for messages.
    pub place: String,
    /// Name of the link.
    pub name: String,
    /// In the world.
    pub pose: Pose,
    /// Of the centre of mass (m/s), and angular (rad/s).
    pub velocity: (Vec3, Vec3),
    /// Both are along the body's own axes.
    pub own_axes: bool,
    /// It never moves.
    pub fixed: bool,
    /// kg, where the mass is given and the inertia is not.
    pub mass: Option<f64>,
    specific_gravity: f64,
    shape: String,
    /// All other tags.
    rest: String,
    inertial: String,
}

impl BodyEntry {
    /// # Errors
    /// Names the place and the value that makes no sense.
    pub fn new(b: Body, place: String) -> Result<Self, String> {
        Self::read(&b, place.clone()).map_err(|reason| format!("{place}: {reason}"))
    }

    fn read(b: &Body, place: String) -> Result<Self, String> {
        let own_axes = match b.frame.as_deref() {
            None | Some("world") => false,
            Some("body") => true,
            Some(other) => return Err(format!("frame '{other}' does not exist; choose one of: world, body")),
        };
        let specific_gravity = weight(b)?;
        let fixed = b.fixed || b.specific_gravity == Some(0.0);
        let velocity = (Vec3::from(b.velocity.unwrap_or_default()), Vec3::from(b.angular_velocity.unwrap_or_default()));
        within("velocity", "m/s", velocity.0.as_slice())?;
        within("angular_velocity", "rad/s", velocity.1.as_slice())?;
        if fixed && (velocity.0 != Vec3::zeros() || velocity.1 != Vec3::zeros()) {
            return Err("a static body has no velocity; leave it out".into());
        }
        let shape = shape(&b.shape).map_err(|reason| format!("shape: {reason}"))?;
        let proxy = b.proxy.as_ref().map(shape_of_proxy).transpose()?;
        let mut rest = [("surface", &b.surface), ("damping", &b.damping), ("deactivate", &b.deactivate)]
            .into_iter()
            .filter(|(_, given)| !given.is_empty())
            .map(|(tag, given)| Ok(format!("<{tag}{}/>", attributes(given.iter())?)))
            .collect::<Result<String, String>>()?;
        if let Some(frame) = &b.monitor {
            rest += &format!("<monitor frame=\"{}\"/>", escaped(frame));
        }
        let collides = proxy.or(b.inertia.is_some().then(|| shape.clone()));
        rest += &collides.map_or(String::new(), |s| format!("<proxy{s}</proxy>"));
        Ok(Self {
            pose: b.pose.map_or(Ok(Pose::identity()), pose).map_err(|reason| format!("pose: {reason}"))?,
            place,
            name: b.name.clone(),
            velocity,
            own_axes,
            fixed,
            mass: b.mass.filter(|_| b.inertia.is_none() && !fixed),
            specific_gravity,
            shape,
            rest,
            inertial: inertial(b)?,
        })
    }

    /// The URDF of the body; its mass is `scale` times that of its specific gravity.
    pub fn urdf(&self, scale: f64) -> String {
        let gravity = self.specific_gravity * scale;
        let body = match self.inertial.is_empty() {
            true => format!("<body specific_gravity=\"{gravity}\"><shape{}</shape></body>", self.shape),
            false => String::new(),
        };
        let (name, inertial, rest) = (escaped(&self.name), &self.inertial, &self.rest);
        format!(
            "<robot name=\"{name}\"><link name=\"{name}\">{inertial}<realnoid>{body}{rest}</realnoid></link></robot>"
        )
    }
}

/// The specific gravity to begin with.
fn weight(b: &Body) -> Result<f64, String> {
    if let Some(mass) = b.mass.filter(|m| !(m.is_finite() && *m > 0.0)) {
        return Err(format!("mass is {mass} kg; it must be greater than 0"));
    }
    match (b.mass, b.specific_gravity, b.fixed) {
        (Some(_), Some(_), _) => Err("mass and specific_gravity are both given; leave one of them out".into()),
        (None, None, false) => Err("give it a mass (kg) or a specific_gravity, or make it static: true".into()),
        (None, Some(gravity), _) => Ok(gravity),
        (Some(_), None, false) => Ok(1.0),
        (_, None, true) => Ok(0.0),
    }
}

fn inertial(b: &Body) -> Result<String, String> {
    let (Some(i), Some(mass), false) = (b.inertia, b.mass, b.fixed) else {
        return match (b.inertia.is_some() || b.center.is_some(), b.fixed) {
            (true, false) => Err("inertia needs mass, and center needs both".into()),
            _ => Ok(String::new()),
        };
    };
    let c = b.center.unwrap_or_default();
    let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    let tensor: String = names.iter().zip(i).map(|(name, x)| format!(" {name}=\"{x}\"")).collect();
    Ok(format!(
        "<inertial><origin xyz=\"{} {} {}\"/><mass value=\"{mass}\"/><inertia{tensor}/></inertial>",
        c[0], c[1], c[2]
    ))
}

fn shape_of_proxy(proxy: &Map<String, Value>) -> Result<String, String> {
    shape(proxy).map_err(|reason| format!("proxy: {reason}"))
}

/// `sphere: {radius: 0.1}, scale: [1, 1, 2]` as the rest of an open tag and what stands in it.
fn shape(words: &Map<String, Value>) -> Result<String, String> {
    let inside = |(key, value): &(&String, &Value)| value.is_object() && *key != "origin";
    let shapes: Vec<_> = words.iter().filter(inside).collect();
    let [(name, given)] = shapes[..] else {
        return Err(format!("needs one shape, as in {{sphere: {{radius: 0.1}}}}; there are {}", shapes.len()));
    };
    let own = attributes(words.iter().filter(|(key, value)| *key != "origin" && !value.is_object()))?;
    let element = |name: &String, value: &Value| -> Result<String, String> {
        let empty = Map::new();
        Ok(format!("<{}{}/>", word(name)?, attributes(value.as_object().unwrap_or(&empty).iter())?))
    };
    let origin = words.get_key_value("origin").map(|(k, v)| element(k, v)).transpose()?.unwrap_or_default();
    Ok(format!("{own}>{origin}{}", element(name, given)?))
}

fn attributes<'a>(given: impl Iterator<Item = (&'a String, &'a Value)>) -> Result<String, String> {
    given.map(|(key, value)| Ok(format!(" {}=\"{}\"", word(key)?, escaped(&text(key, value)?)))).collect()
}

/// A value as it stands in XML; lists are separated by blanks.
fn text(key: &str, value: &Value) -> Result<String, String> {
    match value {
        Value::String(s) => {
            let numbers: Vec<f64> = s.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            within(key, "", &numbers).map(|()| s.clone())
        }
        Value::Number(n) => within(key, "", &[n.as_f64().unwrap_or_default()]).map(|()| n.to_string()),
        Value::Bool(b) => Ok(b.to_string()),
        Value::Array(list) => {
            let parts: Result<Vec<String>, String> = list.iter().map(|v| text(key, v)).collect();
            Ok(parts?.join(" "))
        }
        _ => Err(format!("{key}: must be a number, a word or a list")),
    }
}

/// Names of tags and attributes have these characters alone.
fn word(name: &str) -> Result<&str, String> {
    let sound = !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase() || c == '_');
    if sound { Ok(name) } else { Err(format!("'{name}' is no shape and no attribute")) }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
