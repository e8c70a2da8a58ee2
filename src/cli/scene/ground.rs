//! The ground, and what surfaces are like where nothing says otherwise.

use super::file::{Ground, SurfaceValues};
use crate::description::{self, Description};
use crate::math::{Pose, Quat, Vec3};
use crate::model::{Collider, Surface};
use crate::shape::ContactForm;
use nalgebra::Translation3;
use serde::Deserialize;
use serde_json::Value;

/// Its name in lists of contacts.
const GROUND: &str = "ground";

/// What surfaces are like where nothing says otherwise.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceDefaults(SurfaceValues);

impl SurfaceDefaults {
    /// # Errors
    /// Names the value that is out of range.
    pub(super) fn new(values: &SurfaceValues) -> Result<Self, String> {
        check(values).map_err(|reason| format!("defaults: surface: {reason}"))?;
        Ok(Self(*values))
    }

    /// Fills in what the `<surface>` tags leave open.
    pub fn fill(&self, d: &mut Description) {
        let given = self.0;
        for link in &mut d.links {
            let open = || description::Surface {
                at: link.at,
                friction: None,
                rolling_friction: None,
                spinning_friction: None,
                restitution: None,
                margin: None,
            };
            let s = link.surface.get_or_insert_with(open);
            s.friction = s.friction.or(given.friction);
            s.rolling_friction = s.rolling_friction.or(given.rolling_friction);
            s.spinning_friction = s.spinning_friction.or(given.spinning_friction);
            s.restitution = s.restitution.or(given.restitution);
            s.margin = s.margin.or(given.margin);
        }
    }

    fn over(&self, own: &SurfaceValues) -> (Surface, f64) {
        let (d, basic) = (self.0, Surface::default());
        let pick = |own: Option<f64>, default: Option<f64>, basic: f64| own.or(default).unwrap_or(basic);
        let surface = Surface {
            friction: pick(own.friction, d.friction, basic.friction),
            rolling: pick(own.rolling_friction, d.rolling_friction, basic.rolling),
            spinning: pick(own.spinning_friction, d.spinning_friction, basic.spinning),
            restitution: pick(own.restitution, d.restitution, basic.restitution),
        };
        (surface, pick(own.margin, d.margin, 0.0))
    }
}

fn check(v: &SurfaceValues) -> Result<(), String> {
    let ranged = [
        ("friction", v.friction, f64::INFINITY),
        ("rolling_friction", v.rolling_friction, f64::INFINITY),
        ("spinning_friction", v.spinning_friction, f64::INFINITY),
        ("restitution", v.restitution, 1.0),
        ("margin", v.margin, f64::INFINITY),
    ];
    for (name, value, most) in ranged {
        if let Some(x) = value.filter(|x| !(x.is_finite() && *x >= 0.0 && *x <= most)) {
            let range = if most.is_finite() { format!("from 0 to {most}") } else { "0 or greater".into() };
            return Err(format!("{name} is {x}; it must be {range}"));
        }
    }
    Ok(())
}

/// `ground:` true, false, or what it is like.
pub(super) fn ground(value: &Value, defaults: &SurfaceDefaults) -> Result<Option<Collider>, String> {
    match value {
        Value::Bool(false) => Ok(None),
        Value::Bool(true) | Value::Null => Ok(Some(flat(defaults))),
        Value::Object(_) => {
            let given = Ground::deserialize(value).map_err(|e| e.to_string())?;
            laid(&given, defaults).map(Some)
        }
        other => Err(format!("{other}: must be true, false, or what the ground is like")),
    }
}

/// z = 0, with the default surface.
pub(super) fn flat(defaults: &SurfaceDefaults) -> Collider {
    let (surface, margin) = defaults.over(&SurfaceValues::default());
    Collider { name: GROUND.into(), link: None, pose: Pose::identity(), form: ContactForm::HalfSpace, surface, margin }
}

fn laid(g: &Ground, defaults: &SurfaceDefaults) -> Result<Collider, String> {
    let own = SurfaceValues {
        friction: g.friction,
        rolling_friction: g.rolling_friction,
        spinning_friction: g.spinning_friction,
        restitution: g.restitution,
        margin: g.margin,
    };
    check(&own)?;
    let (surface, margin) = defaults.over(&own);
    let height = g.height.unwrap_or(0.0);
    let normal = g.normal.map_or(Vec3::z(), Vec3::from);
    if !(height.is_finite() && normal.norm().is_finite() && normal.norm() > 0.0) {
        return Err("height and normal must be finite, and the normal longer than 0".into());
    }
    // Upside down, any turn about a horizontal axis will do.
    let turn = Quat::rotation_between(&Vec3::z(), &normal).unwrap_or(Quat::new(Vec3::x() * std::f64::consts::PI));
    let pose = Pose::from_parts(Translation3::new(0.0, 0.0, height), turn);
    Ok(Collider { pose, surface, margin, ..flat(defaults) })
}
