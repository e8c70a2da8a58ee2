//! A model and its state as MuJoCo has them: the same bodies, joints and start.

use super::case::{Case, Seat};
use crate::engine::State;
use crate::math::{M3, Mat3, Pose, Quat, Vec3};
use crate::model::{Body, Collider, JointType, LinkFrame, Model};
use crate::shape::ContactForm;
use crate::world::World;
use nalgebra::Rotation3;
use serde_json::{Value, json};
use std::fmt::Write;

/// What the script needs to run a case: model text, state at start, what is looked at.
///
/// # Errors
/// What of the case MuJoCo cannot have.
pub(super) fn request(case: &Case, world: &World) -> Result<Value, String> {
    let (m, s) = (world.model(), world.state());
    let (qpos, qvel) = start(m, s)?;
    let looks: Result<Vec<Value>, String> = case.seats(m)?.iter().map(|seat| look(m, seat)).collect();
    Ok(json!({
        "name": case.name,
        "mjcf": text(m, world.settings().gravity)?,
        "qpos": qpos,
        "qvel": qvel,
        "looks": looks?,
        "instants": case.instants,
    }))
}

fn text(m: &Model, gravity: [f64; 3]) -> Result<String, String> {
    let mut text = format!(
        "<mujoco><compiler angle=\"radian\" autolimits=\"true\" inertiafromgeom=\"false\"/>\
         <option gravity=\"{}\" cone=\"elliptic\"/><worldbody>",
        numbers(&gravity)
    );
    for c in m.colliders.iter().filter(|c| m.seat_of(c).0 == 0) {
        text += &geom(m, c)?;
    }
    for child in children(m, 0) {
        body(m, child, &mut text)?;
    }
    Ok(text + "</worldbody></mujoco>")
}

fn children(m: &Model, parent: usize) -> impl Iterator<Item = usize> + '_ {
    (1..m.bodies.len()).filter(move |i| m.bodies[*i].parent == parent)
}

/// A body with all that it carries.
fn body(m: &Model, i: usize, text: &mut String) -> Result<(), String> {
    let b = &m.bodies[i];
    let _ = write!(
        text,
        "<body name=\"b{i}\" pos=\"{}\" quat=\"{}\">",
        numbers(&[b.tree_p.x, b.tree_p.y, b.tree_p.z]),
        quat(&turn(&b.tree_r))
    );
    *text += &joint(m, b);
    *text += &inertial(b);
    for c in m.colliders.iter().filter(|c| m.seat_of(c).0 == i) {
        *text += &geom(m, c)?;
    }
    for child in children(m, i) {
        body(m, child, text)?;
    }
    *text += "</body>";
    Ok(())
}

fn joint(m: &Model, b: &Body) -> String {
    let range = |v: usize| {
        let axis = m.axes.iter().find(|a| matches!(a.slot, crate::model::AxisSlot::Scalar { v: at, .. } if at == v));
        let limited = axis.filter(|a| a.lower.is_finite() && a.upper.is_finite());
        limited.map_or(String::new(), |a| format!(" range=\"{} {}\"", a.lower, a.upper))
    };
    let one = |kind: &str, axis: &str, v: usize| format!("<joint type=\"{kind}\" axis=\"{axis}\"{}/>", range(v));
    match b.joint {
        JointType::Revolute => one("hinge", "0 0 1", b.v),
        JointType::Prismatic => one("slide", "0 0 1", b.v),
        JointType::Universal => one("hinge", "1 0 0", b.v) + &one("hinge", "0 0 1", b.v + 1),
        JointType::Spherical => "<joint type=\"ball\"/>".into(),
        JointType::Floating => "<freejoint/>".into(),
    }
}

fn inertial(b: &Body) -> String {
    let (c, i) = (Vec3::from(b.mc) / b.mass, b.inertia);
    let origin = Mat3::new(i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz);
    let center = origin - (Mat3::identity() * c.norm_squared() - c * c.transpose()) * b.mass;
    let full = [center.m11, center.m22, center.m33, center.m12, center.m13, center.m23];
    format!("<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>", numbers(c.as_slice()), b.mass, numbers(&full))
}

/// What stands in the world has priority: its friction counts, as with ours that of bodies is 1. A pair that bounces is a spring with
/// the damping ratio of the restitution, e = exp(−π ζ / √(1 − ζ²)), and MuJoCo's default time constant.
fn geom(m: &Model, c: &Collider) -> Result<String, String> {
    let pose = m.seat_of(c).1;
    let shape = match &c.form {
        ContactForm::HalfSpace => "type=\"plane\" size=\"0 0 1\" priority=\"1\"".into(),
        ContactForm::Ball { radius } => format!("type=\"sphere\" size=\"{radius}\""),
        ContactForm::Cuboid { half } => format!("type=\"box\" size=\"{}\"", numbers(half)),
        other => return Err(format!("no such shape there: {other:?}")),
    };
    let bounce = m.colliders.iter().map(|c| c.surface.restitution).fold(1.0, f64::min);
    let solref = if bounce > 0.0 {
        let log = bounce.ln();
        format!(" solref=\"0.02 {}\"", -log / (std::f64::consts::PI.powi(2) + log * log).sqrt())
    } else {
        String::new()
    };
    Ok(format!(
        "<geom {shape} pos=\"{}\" quat=\"{}\" friction=\"{} 0.005 0.0001\"{solref}/>",
        numbers(pose.translation.vector.as_slice()),
        quat(&pose.rotation),
        c.surface.friction
    ))
}

/// Coordinates and velocities: theirs are ours but for the linear velocity of what floats, which is along the world's axes there and comes first.
fn start(m: &Model, s: &State) -> Result<(Vec<f64>, Vec<f64>), String> {
    let (mut qpos, mut qvel) = (vec![], vec![]);
    // Bodies are nested there: depth first.
    let mut order = vec![];
    let mut open: Vec<usize> = children(m, 0).collect();
    open.reverse();
    while let Some(i) = open.pop() {
        order.push(i);
        let mut next: Vec<usize> = children(m, i).collect();
        next.reverse();
        open.extend(next);
    }
    for b in order.into_iter().map(|i| &m.bodies[i]) {
        let (q, v) = (&s.q[b.q..b.q + b.joint.nq()], &s.v[b.v..b.v + b.joint.nv()]);
        qpos.extend_from_slice(q);
        if b.joint != JointType::Floating {
            qvel.extend_from_slice(v);
            continue;
        }
        if turn(&b.tree_r).angle() > 0.0 || Vec3::from(b.tree_p) != Vec3::zeros() {
            return Err("what floats does not start at the origin of the world".into());
        }
        let rotation = Quat::from_quaternion(nalgebra::Quaternion::new(q[3], q[4], q[5], q[6]));
        let linear = rotation * Vec3::new(v[3], v[4], v[5]);
        qvel.extend(linear.iter().chain(&v[..3]));
    }
    Ok((qpos, qvel))
}

/// A point or a turn on a body there.
fn look(m: &Model, seat: &Seat) -> Result<Value, String> {
    let of = |link: usize| match &m.links[link].frame {
        LinkFrame::OnBody { body, offset } if *body > 0 => Ok((format!("b{body}"), *offset)),
        _ => Err(format!("link '{}' does not move there", m.links[link].name)),
    };
    match seat {
        Seat::Point(link, at) => {
            let (body, offset): (String, Pose) = of(*link)?;
            let point = offset * nalgebra::Point3::from(*at);
            Ok(json!({"body": body, "point": point.coords.as_slice()}))
        }
        Seat::Turn(link) => {
            let (body, offset) = of(*link)?;
            match offset.rotation.angle() == 0.0 {
                true => Ok(json!({"body": body})),
                false => Err("the frame of a link is turned against that of its body".into()),
            }
        }
    }
}

fn turn(r: &M3<f64>) -> Quat {
    let matrix = Mat3::from_rows(&[
        Vec3::from(r.r[0]).transpose(),
        Vec3::from(r.r[1]).transpose(),
        Vec3::from(r.r[2]).transpose(),
    ]);
    Quat::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix))
}

/// w, x, y, z.
fn quat(q: &Quat) -> String {
    numbers(&[q.w, q.i, q.j, q.k])
}

fn numbers(x: &[f64]) -> String {
    x.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}
