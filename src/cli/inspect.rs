//! `realnoid inspect`: what is simulated, in numbers.

use super::args::InspectArgs;
use super::base_by_name;
use super::load::{Loaded, load};
use crate::mass::MassProperties;
use crate::model::{Axis, AxisKind, AxisSlot, EFFECT_NAMES, Effects, LinkFrame, Model};
use serde_json::{Value, json};
use std::process::ExitCode;

/// Prints tables, or JSON.
pub fn run(args: &InspectArgs) -> ExitCode {
    let loaded = match load(args.urdf.as_deref(), base_by_name(&args.base)) {
        Ok(loaded) => loaded,
        Err(report) => {
            eprint!("{report}");
            return ExitCode::FAILURE;
        }
    };
    let text = match (args.urdf_with_inertials, args.json) {
        (true, _) => loaded.published,
        (_, true) => format!("{:#}\n", as_json(&loaded)),
        _ => as_tables(&loaded),
    };
    super::say(&text)
}

fn as_json(l: &Loaded) -> Value {
    let m = &l.model;
    let links: Vec<Value> = m.links.iter().zip(&l.masses).map(|(link, mass)| {
        let i = &mass.inertia;
        json!({
            "name": link.name,
            "mass": mass.mass,
            "center_of_mass": mass.center.as_slice(),
            "inertia": {"ixx": i[(0, 0)], "ixy": i[(0, 1)], "ixz": i[(0, 2)], "iyy": i[(1, 1)], "iyz": i[(1, 2)], "izz": i[(2, 2)]},
            "principal_moments": mass.principal().moments.as_slice(),
        })
    }).collect();
    let bound = |x: f64| if x.is_finite() { json!(x) } else { Value::Null };
    let axes: Vec<Value> = m
        .axes
        .iter()
        .map(|a| {
            json!({
                "name": a.name,
                "kind": if a.kind == AxisKind::Linear { "linear" } else { "rotary" },
                "group": if matches!(a.slot, AxisSlot::Euler { .. }) { json!("3dof") } else { Value::Null },
                "lower": bound(a.lower),
                "upper": bound(a.upper),
                "max_torque": bound(a.max_torque),
                "max_speed": bound(a.max_speed),
                "damping": a.damping,
                "friction": a.friction,
                "mode": format!("{:?}", a.mode).to_lowercase(),
            })
        })
        .collect();
    let effects: serde_json::Map<String, Value> =
        EFFECT_NAMES.iter().zip(m.effects.as_array()).map(|(n, on)| ((*n).to_owned(), json!(on))).collect();
    json!({"name": m.name, "mass": m.mass(), "bodies": m.bodies.len() - 1, "velocities": m.nv, "links": links,
           "axes": axes, "effects": effects})
}

fn as_tables(l: &Loaded) -> String {
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
    text += &format!("{:<28} {:>9}  {:<27} {}\n", "link", "mass kg", "centre of mass m", "principal moments kg·m²");
    for (link, mass) in m.links.iter().zip(&l.masses) {
        text += &link_row(&link.name, mass, &link.frame);
    }
    text += &format!(
        "\n{:<28} {:<8} {:>20} {:>11} {:>10} {:>9} {:>9}  {}\n",
        "axis", "joint", "range", "max torque", "max speed", "damping", "friction", "mode"
    );
    for axis in &m.axes {
        text += &axis_row(m, axis);
    }
    text + &effects_row(&m.effects)
}

fn link_row(name: &str, mass: &MassProperties, frame: &LinkFrame) -> String {
    if mass.mass == 0.0 {
        let kind = if matches!(frame, LinkFrame::InGroup { .. }) { "inside a joint group" } else { "a frame" };
        return format!("{name:<28} {:>9}  {kind}\n", "-");
    }
    let (c, p) = (&mass.center, mass.principal().moments);
    format!(
        "{name:<28} {:>9.4}  {:>8.4} {:>8.4} {:>8.4}  {:>9.3e} {:>9.3e} {:>9.3e}\n",
        mass.mass, c.x, c.y, c.z, p[0], p[1], p[2]
    )
}

fn axis_row(m: &Model, a: &Axis) -> String {
    let joint = match a.slot {
        AxisSlot::Euler { .. } => "3dof",
        AxisSlot::Scalar { v, .. }
            if m.bodies.iter().skip(1).any(|b| b.joint.nv() == 2 && (b.v..b.v + 2).contains(&v)) =>
        {
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
        bound(a.max_torque),
        bound(a.max_speed),
        a.damping,
        a.friction,
        format!("{:?}", a.mode).to_lowercase()
    )
}

fn effects_row(e: &Effects) -> String {
    let of = |wanted: bool| {
        let names: Vec<&str> =
            EFFECT_NAMES.iter().zip(e.as_array()).filter(|(_, on)| *on == wanted).map(|(n, _)| *n).collect();
        if names.is_empty() { "none".into() } else { names.join(", ") }
    };
    format!("\neffects that this scene calls for: {}; not called for, not built: {}\n", of(true), of(false))
}
