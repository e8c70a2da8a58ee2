//! What drives and stops act on.

use super::super::case::{Case, GRID, Look, Truth, set};
use super::super::stage::{humanoid, robot};
use super::{DOWN, SECOND, WEIGHTLESS};
use crate::model::{Base, Model};
use crate::world::{AxisCommand, Integrator};
use std::f64::consts::TAU;

/// Ends of the humanoid's limbs.
const ENDS: [&str; 5] = ["head", "left_hand", "right_hand", "left_foot", "right_foot"];
/// How often a second the humanoid's commands go up and down.
const HERTZ: f64 = 0.8;
/// Of what a drive can: torque of its command.
const TORQUE: f64 = 0.1;
/// Of the range of an axis: swing of its target.
const SWING: f64 = 0.15;

fn ends() -> Vec<Look> {
    ENDS.iter().map(|link| Look::point(link, [0.0; 3])).collect()
}

fn torques(m: &Model, k: usize, commands: &mut [AxisCommand]) {
    for (i, (axis, command)) in m.axes.iter().zip(commands).enumerate() {
        let torque = TORQUE * axis.drive.max_torque * (TAU * HERTZ * GRID * k as f64 + i as f64).sin();
        *command = AxisCommand::torque(torque);
    }
}

/// From 0 towards the further end of the range and back.
fn targets(m: &Model, k: usize, commands: &mut [AxisCommand]) {
    let share = 0.5 * SWING * (1.0 - (TAU * HERTZ * GRID * k as f64).cos());
    for (axis, command) in m.axes.iter().zip(commands) {
        let range = if axis.upper >= -axis.lower { axis.upper } else { axis.lower };
        *command = AxisCommand::servo(share * range);
    }
}

pub(super) fn humanoid_torques() -> Case {
    Case {
        name: "humanoid_torques",
        shows: "The humanoid hangs on its stand; the torques of its drives go up and down 0.8 times a second, each with its own phase.",
        compared: "where head, hands and feet are, root of the mean square",
        unit: "m",
        size: 0.2,
        instants: SECOND,
        make: Box::new(|| humanoid(Base::Fixed, DOWN, &|_, _| Ok(()))),
        looks: ends(),
        truth: Truth::Own { integrator: Integrator::Rk4, steps_per_ms: 64 },
        orders: Some(torques),
        iterates: false,
        peer_differs: Some("it has no torque–speed line, and its dry friction and its stops are soft: it is left out"),
    }
}

pub(super) fn humanoid_servos() -> Case {
    Case {
        name: "humanoid_servos",
        shows: "The humanoid hangs on its stand; its servos follow a sine of 0.8 Hz in stairs of 40 ms.",
        compared: "where head, hands and feet are, root of the mean square",
        unit: "m",
        size: 0.1,
        instants: SECOND,
        make: Box::new(|| humanoid(Base::Fixed, DOWN, &|_, _| Ok(()))),
        looks: ends(),
        truth: Truth::Own { integrator: Integrator::ImplicitMidpoint, steps_per_ms: 64 },
        orders: Some(targets),
        iterates: false,
        peer_differs: Some("it has no such servo: it is left out"),
    }
}

/// A rod of 2 kg on a horizontal hinge; its centre is 0.3 m from it.
fn rod_urdf(limit: f64, drive: &str) -> String {
    format!(
        r#"<robot name="rod"><link name="base"/><link name="rod"><inertial><origin xyz="0.3 0 0"/><mass value="2"/>
        <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.06"/></inertial></link>
        <joint name="hinge" type="revolute"><parent link="base"/><child link="rod"/><origin xyz="0 0 1"/><axis xyz="0 -1 0"/>
        <limit lower="-{limit}" upper="{limit}" effort="100" velocity="100"/>{drive}</joint></robot>"#
    )
}

/// End of the rod, m.
const END: f64 = 0.6;

pub(super) fn servo_step() -> Case {
    let drive = r#"<realnoid><drive mode="servo" max_torque="40" no_load_speed="10"/></realnoid>"#;
    let text = rod_urdf(3.0, drive);
    Case {
        name: "servo_step",
        shows: "A servo lifts a rod of 2 kg by 0.7 rad in one step of its target, at first with all the torque and speed it has.",
        compared: "where the end of the rod is",
        unit: "m",
        size: 0.7 * END,
        instants: SECOND,
        make: Box::new(move || robot(&text, Base::Fixed, DOWN, &|_, _| Ok(()))),
        looks: vec![Look::point("rod", [END, 0.0, 0.0])],
        truth: Truth::Own { integrator: Integrator::ImplicitMidpoint, steps_per_ms: 512 },
        orders: Some(|_, _, commands| commands.fill(AxisCommand::servo(0.7))),
        iterates: false,
        peer_differs: Some("it has no such servo: it is left out"),
    }
}

pub(super) fn stop() -> Case {
    // So chosen that no step ends just at the stop.
    let (speed, limit) = (4.7, 0.5);
    let text = rod_urdf(limit, "");
    let value = move |t: &f64| {
        let angle = (speed * t).min(limit);
        vec![END * angle.cos(), 0.0, 1.0 + END * angle.sin()]
    };
    Case {
        name: "stop",
        shows: "A rod hits its hard stop at 4.7 rad/s, and rests there.",
        compared: "where the end of the rod is",
        unit: "m",
        size: limit * END,
        instants: SECOND,
        make: Box::new(move || robot(&text, Base::Fixed, WEIGHTLESS, &|m, s| set(m, s, "hinge", (0.0, speed)))),
        looks: vec![Look::point("rod", [END, 0.0, 0.0])],
        truth: Truth::Closed {
            words: "it turns steadily, then rests: a stop has no restitution",
            value: Box::new(move |times| times.iter().map(value).collect()),
        },
        orders: None,
        iterates: false,
        peer_differs: Some(
            "its stops are soft, with its default solref and solimp, and push the rod back, so that it leaves them again",
        ),
    }
}
