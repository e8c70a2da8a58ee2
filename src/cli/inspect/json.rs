//! What is simulated, for programs.

use super::super::load::Loaded;
use super::groups;
use crate::description::{Description, Link, PlacedShape};
use crate::mass::{LinkBody, Method};
use crate::math::{Mat3, Pose};
use crate::model::{Axis, AxisKind, AxisSlot, Kind, LinkInfo, Listed};
use crate::monitor::{LinkValues, axis_faults, joint_link_values, link_values};
use crate::shape::collision_shapes;
use serde_json::{Value, json};

/// SI units, links in their own frames; `principal_axes[i]` is the axis of `principal_moments[i]`, `shapes` tells how the mass
/// of each shape was found. `links` are those of the URDF, `joint_links` what each axis moves as one body.
pub(super) fn json(l: &Loaded, effects: &[Listed]) -> Value {
    let m = &l.model;
    let values = link_values(m, &l.bodies);
    let links = l.description.links.iter().zip(&m.links).zip(l.bodies.iter().zip(&values));
    let mut links: Vec<Value> =
        links.map(|((read, link), (body, values))| link_json(read, link, body, values)).collect();
    for (i, link) in links.iter_mut().enumerate() {
        link["chain"] = json!(m.chain_of(i).map(|chain| &chain.root));
    }
    let faults = axis_faults(m);
    let joint_links: Vec<Value> =
        joint_link_values(m, &l.bodies).iter().map(|v| joint_link(&l.description, v)).collect();
    let switched = effects.iter().filter(|e| e.effect.kind == Kind::Switched);
    let switches: serde_json::Map<String, Value> = switched.map(|e| (e.effect.name.to_owned(), json!(e.on))).collect();
    json!({"name": m.name, "mass": m.mass(), "bodies": m.bodies.len() - 1, "velocities": m.nv, "links": links,
           "joint_links": joint_links, "axes": m.axes.iter().zip(&faults).map(axis).collect::<Vec<_>>(),
           "groups": groups::groups(&l.description, m, &faults), "chains": groups::chains(m), "rigs": groups::rigs(m),
           "effects": switches, "all_effects": effects.iter().map(effect).collect::<Vec<_>>()})
}

/// Of `kind` switched, derived or on_demand; `by`: what calls for it, or would.
pub fn effect(e: &Listed) -> Value {
    let (kind, why) = match e.effect.kind {
        Kind::Switched => ("switched", ""),
        Kind::Derived(why) => ("derived", why),
        Kind::OnDemand(who) => ("on_demand", who),
    };
    json!({"name": e.effect.name, "what": e.effect.what, "kind": kind, "why": why, "called_for": e.called_for,
           "by": e.by, "on": e.on})
}

fn link_json(read: &Link, link: &LinkInfo, body: &LinkBody, values: &LinkValues) -> Value {
    let mut json = weight(values);
    let (source, shapes) = collision_shapes(read);
    json["name"] = json!(link.name);
    json["shapes"] = body.methods.iter().map(|m| method(*m)).collect();
    let member = link.membership.as_ref().map(|m| json!({"joint": m.joint, "axis": m.axis, "root": m.root}));
    json["member_of"] = member.unwrap_or(Value::Null);
    json["collision"] = json!({"from": format!("{source:?}").to_lowercase(), "shapes": shapes.len()});
    json
}

fn joint_link(description: &Description, values: &LinkValues) -> Value {
    let mut json = weight(values);
    json["joint"] = json!(values.membership.as_ref().map(|m| &m.joint));
    json["axis"] = json!(values.membership.as_ref().map(|m| &m.axis));
    json["frame"] = json!(values.frame);
    json["links"] = json!(values.members);
    let seats = values.seats.iter().map(|(i, pose)| (&description.links[*i], pose));
    json["collision"] =
        seats.flat_map(|(link, pose)| collision_shapes(link).1.iter().map(move |s| placed(s, pose))).collect();
    json
}

/// A shape that collides, in the frame of the joint's link (J-8).
fn placed(shape: &PlacedShape, x_lk: &Pose) -> Value {
    let pose = x_lk * shape.origin.pose();
    let q = pose.rotation.coords;
    json!({
        "kind": shape.geometry.kind(),
        "position": pose.translation.vector.as_slice(),
        "orientation": [q.x, q.y, q.z, q.w],
    })
}

fn axis((a, faults): (&Axis, &Vec<String>)) -> Value {
    let bound = |x: f64| if x.is_finite() { json!(x) } else { Value::Null };
    json!({
        "name": a.name,
        "kind": if a.kind == AxisKind::Linear { "linear" } else { "rotary" },
        "group": if matches!(a.slot, AxisSlot::Euler { .. }) { json!("3dof") } else { Value::Null },
        "lower": bound(a.lower),
        "upper": bound(a.upper),
        "max_torque": bound(a.drive.max_torque),
        "max_speed": bound(a.drive.max_speed),
        "damping": a.damping,
        "friction": a.friction,
        "mode": format!("{:?}", a.mode).to_lowercase(),
        "valid": faults.is_empty(),
        "faults": faults,
    })
}

/// Mass properties of one link (B-10, J-19).
fn weight(v: &LinkValues) -> Value {
    let p = &v.properties;
    let principal = p.principal();
    json!({
        "volume": v.volume,
        "mass": p.mass,
        "center_of_mass": p.center.as_slice(),
        "inertia": tensor(&p.inertia),
        "inertia_at_origin": tensor(&v.inertia_at_origin()),
        "principal_moments": v.principal_moments().as_slice(),
        "principal_axes": (0..3).map(|i| principal.axes.column(i).as_slice().to_vec()).collect::<Vec<_>>(),
        "l_scale": v.l_scale,
    })
}

fn method(method: Method) -> Value {
    match method {
        Method::Formula => json!({"mass_by": "formula"}),
        Method::Quadrature => json!({"mass_by": "quadrature"}),
        Method::Polygons(triangles) => json!({"mass_by": "polygons", "triangles": triangles}),
    }
}

fn tensor(i: &Mat3) -> Value {
    json!({"ixx": i[(0, 0)], "ixy": i[(0, 1)], "ixz": i[(0, 2)], "iyy": i[(1, 1)], "iyz": i[(1, 2)], "izz": i[(2, 2)]})
}
