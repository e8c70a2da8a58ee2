//! What hangs on joints, without friction and drives.

use super::super::case::{Case, G, Look, Truth, set, turned};
use super::super::closed::slow_precession;
use super::super::stage::robot;
use super::{DOWN, SECOND};
use crate::math::{Quat, Vec3};
use crate::model::Base;
use std::fmt::Write;

/// Length of a link of a chain, m.
const LINK: f64 = 0.2;
/// By so much the axes of hinges are rolled, there and back, rad.
const ROLL: f64 = std::f64::consts::FRAC_PI_6;

/// Rods of 1 kg and 0.2 m on hinges.
fn chain_urdf(n: usize) -> String {
    let mut text = String::from("<robot name=\"chain\"><link name=\"link0\"/>");
    let across = LINK * LINK / 12.0;
    for i in 1..=n {
        let (roll, x) = (if i % 2 == 1 { ROLL } else { -ROLL }, if i == 1 { 0.0 } else { LINK });
        let _ = write!(
            text,
            "<link name=\"link{i}\"><inertial><origin xyz=\"{half} 0 0\"/><mass value=\"1\"/><inertia ixx=\"0.0001\" ixy=\"0\" \
             ixz=\"0\" iyy=\"{across}\" iyz=\"0\" izz=\"{across}\"/></inertial></link><joint name=\"joint{i}\" \
             type=\"continuous\"><parent link=\"link{before}\"/><child link=\"link{i}\"/><origin xyz=\"{x} 0 0\" rpy=\"{roll} \
             0 0\"/><axis xyz=\"0 1 0\"/></joint>",
            half = 0.5 * LINK,
            before = i - 1
        );
    }
    text + "</robot>"
}

pub(super) fn chain(name: &'static str, n: usize) -> Case {
    let text = chain_urdf(n);
    Case {
        name,
        shows: "Rods of 1 kg and 0.2 m on hinges, their axes rolled by 30° there and back, fall from the horizontal and whirl; \
                after about 2 s the motion is chaotic.",
        compared: "where the tip is",
        unit: "m",
        size: n as f64 * LINK,
        instants: 2 * SECOND,
        make: Box::new(move || robot(&text, Base::Fixed, DOWN, &|_, _| Ok(()))),
        looks: vec![Look::point(&format!("link{n}"), [LINK, 0.0, 0.0])],
        truth: Truth::Exact { steps: 32 },
        orders: None,
        iterates: false,
        peer_differs: None,
    }
}

/// A body on a 3DOF joint 1 m above the origin, its centre of mass at `x` (m) on its axis of symmetry.
fn ball_urdf((mass, x): (f64, f64), (along, across): (f64, f64)) -> String {
    format!(
        r#"<robot name="ball"><link name="base"/><link name="h_link"/><link name="p_link"/>
        <link name="body"><inertial><origin xyz="{x} 0 0"/><mass value="{mass}"/>
        <inertia ixx="{along}" ixy="0" ixz="0" iyy="{across}" iyz="0" izz="{across}"/></inertial></link>
        <joint name="h" type="continuous"><parent link="base"/><child link="h_link"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/></joint>
        <joint name="p" type="revolute"><parent link="h_link"/><child link="p_link"/><axis xyz="0 1 0"/>
        <limit lower="-1.5" upper="1.5" effort="100" velocity="100"/></joint>
        <joint name="b" type="continuous"><parent link="p_link"/><child link="body"/><axis xyz="1 0 0"/></joint>
        <realnoid version="1"><joint_group name="joint" type="3dof" h="h" p="p" b="b"/></realnoid></robot>"#
    )
}

pub(super) fn conical_pendulum() -> Case {
    // Mass, kg; distance of its centre, m; moments about its centre along and across its axis, kg·m²; pitch below the horizontal, rad.
    let (mass, x, along, across, pitch) = (1.0, 0.5, 0.001, 0.02, std::f64::consts::FRAC_PI_3);
    let text = ball_urdf((mass, x), (along, across));
    // The whole turns about the vertical; (I1 − I3) Ω² sin(pitch) = m g x, which is Ω² = g / (L cos θ) for a point.
    let rate = (mass * G * x / ((across + mass * x * x - along) * pitch.sin())).sqrt();
    let tip = 1.0;
    let value = move |t: &f64| {
        let (r, a) = (tip * pitch.cos(), rate * t);
        vec![r * a.cos(), r * a.sin(), 1.0 - tip * pitch.sin()]
    };
    Case {
        name: "conical_pendulum",
        shows: "A rod on a 3DOF joint goes round in a cone of 30° about the vertical.",
        compared: "where its end is, 1 m from the joint",
        unit: "m",
        size: tip * pitch.cos(),
        instants: 4 * SECOND,
        make: Box::new(move || {
            robot(&text, Base::Fixed, DOWN, &|m, s| {
                set(m, s, "p", (pitch, 0.0))?;
                set(m, s, "h", (0.0, rate))
            })
        }),
        looks: vec![Look::point("body", [tip, 0.0, 0.0])],
        truth: Truth::Closed {
            words: "a circle with Ω² = m g l / ((I1 − I3) cos θ)",
            value: Box::new(move |times| times.iter().map(value).collect()),
        },
        orders: None,
        iterates: false,
        peer_differs: None,
    }
}

pub(super) fn heavy_top() -> Case {
    let (mass, x, along, across, pitch) = (1.0, 0.1, 0.005, 0.003, -std::f64::consts::FRAC_PI_3);
    let text = ball_urdf((mass, x), (along, across));
    // About its own axis, rad/s. The axis stands up by −pitch, so cosθ = sin(−pitch).
    let (spin, cos) = (60.0, (-pitch).sin());
    let round = slow_precession(across + mass * x * x, along * spin, mass * G * x, cos);
    let own = spin - round * cos;
    let value = move |t: &f64| {
        let about = |axis, angle| Quat::from_axis_angle(&axis, angle);
        let q = about(Vec3::z_axis(), round * t) * about(Vec3::y_axis(), pitch) * about(Vec3::x_axis(), own * t);
        turned(&q)
    };
    Case {
        name: "heavy_top",
        shows: "A symmetric top on a 3DOF joint spins at 60 rad/s, 30° off the vertical, and precesses steadily.",
        compared: "how the top is turned",
        unit: "rad",
        size: 1.0,
        instants: 2 * SECOND,
        make: Box::new(move || {
            robot(&text, Base::Fixed, DOWN, &|m, s| {
                set(m, s, "p", (pitch, 0.0))?;
                set(m, s, "h", (0.0, round))?;
                set(m, s, "b", (0.0, own))
            })
        }),
        looks: vec![Look::Turn { link: "body".into() }],
        truth: Truth::Closed {
            words: "steady precession, I1 cosθ Ω² − I3 ω3 Ω + m g l = 0",
            value: Box::new(move |times| times.iter().map(value).collect()),
        },
        orders: None,
        iterates: false,
        peer_differs: None,
    }
}
