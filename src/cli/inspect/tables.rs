//! What is simulated, as tables.

use super::super::load::Loaded;
use super::Unit;
use crate::model::{Axis, AxisKind, AxisSlot, EFFECT_CAUSES, EFFECT_NAMES, Effects, JointType, LinkFrame, Model};
use crate::monitor::{LinkValues, link_values};

pub(super) fn tables(l: &Loaded, unit: Unit, effects: &Effects) -> String {
    let m = &l.model;
    let mut text = format!(
        "{}: {} links, {} axes, {} moving bodies, {} velocities, {:.3} kg\n\n",
        m.name,
        m.links.len(),
        m.axes.len(),
        m.bodies.len() - 1,
        m.nv,
        m.mass()
    );
    text += &format!(
        "{:<28} {:>9} {:>11}  {:<30} {:<30} {}\n",
        "link",
        "mass kg",
        format!("volume {}³", unit.name),
        format!("centre of mass {}", unit.name),
        "principal moments kg·m²",
        "L scale"
    );
    for (link, values) in m.links.iter().zip(link_values(m, &l.bodies)) {
        text += &link_row(&link.frame, &values, unit);
    }
    text += &format!(
        "\n{:<28} {:<8} {:>20} {:>11} {:>10} {:>9} {:>9}  {}\n",
        "axis", "joint", "range", "max torque", "max speed", "damping", "friction", "mode"
    );
    for axis in &m.axes {
        text += &axis_row(m, axis);
    }
    text + &effects_row(effects)
}

fn link_row(frame: &LinkFrame, v: &LinkValues, unit: Unit) -> String {
    let (name, mass) = (&v.frame, v.properties.mass);
    if mass == 0.0 {
        let kind = if matches!(frame, LinkFrame::InGroup { .. }) { "inside a joint group" } else { "a frame" };
        return format!("{name:<28} {:>9} {:>11}  {kind}\n", "-", "-");
    }
    let volume = v.volume.map_or("stated".into(), |m3| format!("{:.4e}", m3 * unit.per_metre.powi(3)));
    let (c, p) = (v.properties.center * unit.per_metre, v.principal_moments());
    format!(
        "{name:<28} {mass:>9.4} {volume:>11}  {:>9.4} {:>9.4} {:>9.4}  {:>9.3e} {:>9.3e} {:>9.3e}  {}\n",
        c.x + 0.0,
        c.y + 0.0,
        c.z + 0.0,
        p[0],
        p[1],
        p[2],
        v.l_scale
    )
}

fn axis_row(m: &Model, a: &Axis) -> String {
    let joint = match a.slot {
        AxisSlot::Apart { .. } => "apart",
        AxisSlot::Euler { .. } => "3dof",
        AxisSlot::Scalar { v, .. } if m.body_of(v).is_some_and(|body| m.bodies[body].joint == JointType::Universal) => {
            "cardan"
        }
        AxisSlot::Scalar { .. } if a.kind == AxisKind::Linear => "slide",
        AxisSlot::Scalar { .. } => "hinge",
    };
    let bound = |x: f64| if x.is_finite() { format!("{x:.4}") } else { "-".into() };
    format!(
        "{:<28} {joint:<8} {:>9} …{:>9} {:>11} {:>10} {:>9.3} {:>9.3}  {}\n",
        a.name,
        bound(a.lower),
        bound(a.upper),
        bound(a.drive.max_torque),
        bound(a.drive.max_speed),
        a.damping,
        a.friction,
        format!("{:?}", a.mode).to_lowercase()
    )
}

fn effects_row(e: &Effects) -> String {
    let list = |names: Vec<String>| if names.is_empty() { "none".into() } else { names.join(", ") };
    let of =
        |wanted: bool| EFFECT_NAMES.iter().zip(EFFECT_CAUSES).zip(e.as_array()).filter(move |(_, on)| *on == wanted);
    let called = of(true).map(|((name, _), _)| (*name).to_owned()).collect();
    let others = of(false).map(|((name, cause), _)| format!("{name} ({cause})")).collect();
    format!("\neffects that this scene calls for: {}\nnot called for, not built: {}\n", list(called), list(others))
}
