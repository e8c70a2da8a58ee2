//! What is simulated, as tables.

use super::super::load::Loaded;
use super::Unit;
use crate::model::{Axis, AxisKind, AxisSlot, JointType, Kind, LinkFrame, Listed, Model};
use crate::monitor::{LinkValues, link_values};

pub(super) fn tables(l: &Loaded, unit: Unit, effects: &[Listed]) -> String {
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
    text + &effects_table(effects)
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

/// What the scene calls for, with the reasons; what it does not, with what would; what is made on demand.
fn effects_table(effects: &[Listed]) -> String {
    let of = |which: &dyn Fn(&Listed) -> bool| effects.iter().filter(|e| which(e)).collect::<Vec<_>>();
    let rows = |some: Vec<&Listed>, by: &dyn Fn(&Listed) -> String| -> String {
        some.iter().map(|e| format!("  {:<21} {}\n", e.effect.name, by(e))).collect()
    };
    let on_demand = |e: &Listed| matches!(e.effect.kind, Kind::OnDemand(_));
    let reason = |e: &Listed| match (e.called_for, e.effect.kind) {
        (false, _) => "switched on; there is nothing for it to do".into(),
        (true, Kind::Derived(why)) => format!("{}; no switch: {why}", e.by),
        (true, _) => e.by.clone(),
    };
    let needs = |e: &Listed| e.by.trim_start_matches("nothing: ").to_owned();
    let switched_off = of(&Listed::is_switched_off);
    let mut text =
        format!("\neffects that this scene calls for, and what in it does\n{}", rows(of(&|e| e.on), &reason));
    if !switched_off.is_empty() {
        text += &format!("switched off\n{}", rows(switched_off, &|e| e.by.clone()));
    }
    let absent = of(&|e| !e.on && !e.is_switched_off() && !on_demand(e));
    text += &format!("not called for, not built; what would call for it\n{}", rows(absent, &needs));
    let who = |e: &Listed| if let Kind::OnDemand(who) = e.effect.kind { who.to_owned() } else { String::new() };
    text + &format!("made on demand, outside of the steps; for whom\n{}", rows(of(&on_demand), &who))
}
