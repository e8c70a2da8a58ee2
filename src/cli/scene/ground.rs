//! The ground, and what surfaces are like where nothing says otherwise.

use super::file::{Ground, SurfaceValues};
use super::limits::{plain, shown, within};
use crate::contact::Defaults;
use crate::description::MOST_FRICTION;
use crate::math::{Pose, Quat, Vec3};
use crate::model::{Collider, Surface};
use crate::shape::ContactForm;
use nalgebra::Translation3;
use serde::Deserialize;
use serde_json::Value;

/// Its name in lists of contacts.
const GROUND: &str = "ground";

/// What surfaces are like where nothing says otherwise.
///
/// # Errors
/// Names the value that is out of range.
pub(super) fn defaults(values: &SurfaceValues) -> Result<Defaults, String> {
    check(values)?;
    Ok(over(Defaults::default(), values))
}

/// What is given, the rest by default.
fn over(defaults: Defaults, own: &SurfaceValues) -> Defaults {
    let d = defaults.surface;
    let surface = Surface {
        friction: own.friction.unwrap_or(d.friction),
        rolling: own.rolling_friction.unwrap_or(d.rolling),
        spinning: own.spinning_friction.unwrap_or(d.spinning),
        restitution: own.restitution.unwrap_or(d.restitution),
    };
    Defaults { surface, margin: own.margin.unwrap_or(defaults.margin) }
}

fn check(v: &SurfaceValues) -> Result<(), String> {
    let ranged = [
        ("friction", v.friction, MOST_FRICTION),
        ("rolling_friction", v.rolling_friction, MOST_FRICTION),
        ("spinning_friction", v.spinning_friction, MOST_FRICTION),
        ("restitution", v.restitution, 1.0),
        ("margin", v.margin, f64::INFINITY),
    ];
    for (name, value, most) in ranged {
        if let Some(x) = value.filter(|x| !(x.is_finite() && *x >= 0.0 && *x <= most)) {
            let range = if most.is_finite() { format!("from 0 to {most}") } else { "0 or greater".into() };
            return Err(format!("{name} is {}; it must be {range}", shown(x)));
        }
    }
    Ok(())
}

/// `ground:` true, false, or what it is like.
pub(super) fn ground(value: &Value, defaults: Defaults) -> Result<Option<Collider>, String> {
    match value {
        Value::Bool(false) => Ok(None),
        Value::Bool(true) | Value::Null => Ok(Some(flat(defaults))),
        Value::Object(_) => {
            let given = Ground::deserialize(value).map_err(|e| plain(&e.to_string()))?;
            laid(&given, defaults).map(Some)
        }
        other => Err(format!("{other}: must be true, false, or what the ground is like")),
    }
}

/// z = 0, with the default surface.
pub(super) fn flat(defaults: Defaults) -> Collider {
    let Defaults { surface, margin } = defaults;
    Collider { name: GROUND.into(), link: None, pose: Pose::identity(), form: ContactForm::HalfSpace, surface, margin }
}

fn laid(g: &Ground, defaults: Defaults) -> Result<Collider, String> {
    let own = SurfaceValues {
        friction: g.friction,
        rolling_friction: g.rolling_friction,
        spinning_friction: g.spinning_friction,
        restitution: g.restitution,
        margin: g.margin,
    };
    check(&own)?;
    let Defaults { surface, margin } = over(defaults, &own);
    let height = g.height.unwrap_or(0.0);
    let normal = g.normal.map_or(Vec3::z(), Vec3::from);
    within("height", "m", &[height])?;
    if !(height.is_finite() && normal.norm().is_finite() && normal.norm() > 0.0) {
        return Err("height and normal must be finite, and the normal longer than 0".into());
    }
    // Upside down, any turn about a horizontal axis will do.
    let turn = Quat::rotation_between(&Vec3::z(), &normal).unwrap_or(Quat::new(Vec3::x() * std::f64::consts::PI));
    let pose = Pose::from_parts(Translation3::new(0.0, 0.0, height), turn);
    Ok(Collider { pose, surface, margin, ..flat(defaults) })
}
