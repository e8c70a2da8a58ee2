//! What a scene calls for, and what switching parts off does to the motion.
#![allow(clippy::unwrap_used)] // a test may panic

use realnoid::cli::load::Source;
use realnoid::cli::scene::{Fault, Scene, Spare, assemble};
use realnoid::model::{Base, EFFECT_NAMES, EFFECTS, Kind, Model};
use realnoid::world::{AxisCommand, EngineKind, World};
use std::sync::Arc;

/// About z, or along it, with `inertia` about it: weight does not turn it.
fn robot(kind: &str, in_joint: &str, in_link: &str) -> String {
    format!(
        "<robot name='r'><link name='stand'/><link name='wheel'><inertial><mass value='1'/>\
         <inertia ixx='0.001' ixy='0' ixz='0' iyy='0.001' iyz='0' izz='0.001'/></inertial>{in_link}</link>\
         <joint name='axle' type='{kind}'><parent link='stand'/><child link='wheel'/><axis xyz='0 0 1'/>{in_joint}</joint></robot>"
    )
}

fn wheel(in_joint: &str) -> String {
    robot("continuous", in_joint, "")
}

fn drive(attributes: &str) -> String {
    wheel(&format!("<realnoid><drive {attributes}/></realnoid>"))
}

fn turned(limits: &str, constraint: &str) -> String {
    robot("revolute", &format!("{limits}<realnoid><constraint {constraint}/></realnoid>"), "")
}

const LIMIT: &str = "<limit lower='-1' upper='1' effort='1' velocity='9'/>";

/// Two wheels, the second of which follows; or three axes in one joint.
fn three(rest: &str) -> String {
    let link = |name: &str, mass: bool| match mass {
        true => format!(
            "<link name='{name}'><inertial><mass value='1'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>"
        ),
        false => format!("<link name='{name}'/>"),
    };
    let joint = |name: &str, ends: [&str; 2], axis: &str| {
        format!(
            "<joint name='{name}' type='revolute'><parent link='{}'/><child link='{}'/><axis xyz='{axis}'/>{LIMIT}</joint>",
            ends[0], ends[1]
        )
    };
    format!(
        "<robot name='r'>{}{}{}{}{}{}{}{rest}</robot>",
        link("a", false),
        link("b", false),
        link("c", false),
        link("d", true),
        joint("h", ["a", "b"], "0 0 1"),
        joint("p", ["b", "c"], "0 1 0"),
        joint("k", ["c", "d"], "1 0 0"),
    )
}

/// A ball of 1 kg and 0.1 m on the ground, or above it.
fn ball(surface: &str, rest: &str) -> String {
    format!(
        "version: 1\nground: {{friction: 1, restitution: 1}}\nbodies:\n  - {{name: ball, mass: 1, shape: {{sphere: {{radius: 0.1}}}}, \
         surface: {{{surface}}}, {rest}}}\n"
    )
}

const RESTS: &str = "pose: [0, 0, 0.1, 0, 0, 0, 1]";

fn alone(rest: &str) -> String {
    format!("version: 1\nbodies:\n  - {{name: ball, mass: 1, shape: {{sphere: {{radius: 0.1}}}}{rest}}}\n")
}

/// A scene from its text, or with the robot of a URDF text.
fn assembled(text: &str, off: &[&str]) -> Result<(Arc<Model>, World), String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.yaml");
    let scene = match text.starts_with('<') {
        true => "version: 1\nrobot: {urdf: robot.urdf}\n",
        false => text,
    };
    std::fs::write(&path, scene).unwrap();
    std::fs::write(folder.path().join("robot.urdf"), text).unwrap();
    let scene = Scene::read(Some(&path))?;
    let switch = |m: &mut Model| {
        assert!(off.iter().all(|name| m.effects.switch(name, false)), "{off:?}");
        Ok(())
    };
    let stand = (scene.base.unwrap_or(Base::Fixed), scene.robot.pose);
    let all = assemble(&scene, Source::default(), stand, Spare::Nobody, &switch).map_err(|fault| match fault {
        Fault::Robot(reason) | Fault::Scene(reason) => reason,
    })?;
    let model = Arc::new(all.model);
    let mut world = World::new(model.clone(), scene.settings)?;
    world.set_initial_state(all.initial);
    Ok((model, world))
}

/// (effect, a scene that calls for it and the name in the reason, one that does not)
fn table() -> Vec<(&'static str, (String, &'static str), String)> {
    let stops = |soft: &str| turned(LIMIT, soft);
    let plain = || wheel("");
    let group = "<realnoid version='1'><joint_group name='g' type='3dof' h='h' p='p' b='k'/></realnoid>";
    let follows = three("").replace("name='k' type='revolute'>", "name='k' type='revolute'><mimic joint='h'/>");
    let thrown = |surface: &str| ball(surface, RESTS);
    vec![
        ("gravity", (plain(), "wheel"), alone(", static: true")),
        ("velocity_products", (plain(), "wheel"), robot("prismatic", LIMIT, "")),
        ("damping", (wheel("<dynamics damping='0.1'/>"), "axle"), plain()),
        ("friction", (wheel("<dynamics friction='0.1'/>"), "axle"), plain()),
        ("joint_friction", (wheel("<dynamics friction='0.1'/>"), "axle"), drive("static_resistance='1'")),
        ("static_resistance", (drive("static_resistance='1'"), "axle"), drive("dynamic_resistance='1'")),
        ("dynamic_resistance", (drive("dynamic_resistance='1'"), "axle"), drive("static_resistance='1'")),
        ("limits", (stops(""), "axle"), plain()),
        ("soft_stops", (stops("stop_erp='0.2' stop_cfm='0.1'"), "axle"), stops("")),
        ("drives", (plain(), "axle"), alone("")),
        ("torque_speed_line", (drive("max_torque='1' no_load_speed='9'"), "axle"), drive("max_torque='1'")),
        (
            "short_brake",
            (drive("max_torque='1' no_load_speed='9' short_brake='true'"), "axle"),
            drive("max_torque='1' no_load_speed='9'"),
        ),
        ("servo", (drive("mode='servo'"), "axle"), drive("mode='torque'")),
        ("rotor_inertia", (drive("rotor_inertia='1e-5'"), "axle"), plain()),
        ("compliance", (stops("erp='0.2' cfm='1e-6'"), "wheel"), stops("")),
        ("mimic", (follows, "k"), three("")),
        ("poles", (three(group), "d"), three("")),
        ("breaking", (stops("break_threshold='5'"), "axle"), stops("")),
        (
            "body_damping",
            (robot("continuous", "", "<realnoid><damping linear='0.1' angular='0.1'/></realnoid>"), "wheel"),
            plain(),
        ),
        ("contact", (thrown(""), "2 shapes"), alone("")),
        ("contact_friction", (thrown(""), "ball"), thrown("friction: 0")),
        ("rolling_resistance", (thrown("rolling_friction: 0.01"), "ball"), thrown("")),
        ("spinning_friction", (thrown("spinning_friction: 0.01"), "ball"), thrown("")),
        ("restitution", (thrown("restitution: 0.5"), "ball"), thrown("")),
        ("continuous_detection", (thrown(""), "ball"), alone("")),
        ("pushing_apart", (thrown(""), "2 shapes"), alone("")),
        ("contact_books", (thrown(""), "2 shapes"), alone("")),
        ("energy_bound", (thrown(""), "2 shapes"), alone("")),
        ("deactivation", (alone(", deactivate: {linear: 0.1, angular: 0.1, after: 1}"), "ball"), alone("")),
        ("step_guard", (plain(), "wheel"), robot("prismatic", LIMIT, "")),
    ]
}

#[test]
fn each_effect_is_derived_from_the_scene() {
    let table = table();
    let in_steps = EFFECTS.iter().filter(|e| !matches!(e.kind, Kind::OnDemand(_))).map(|e| e.name);
    assert!(in_steps.eq(table.iter().map(|(name, ..)| *name)), "every effect is in the table");
    for (name, (with, named), without) in table {
        for (text, called_for) in [(&with, true), (&without, false)] {
            let (model, _) = assembled(text, &[]).unwrap_or_else(|reason| panic!("{name}: {reason}\n{text}"));
            let all = model.listed_effects();
            let listed = all.iter().find(|l| l.effect.name == name).unwrap();
            assert_eq!((listed.called_for, listed.on), (called_for, called_for), "{name}: {}\n{text}", listed.by);
            assert_eq!(
                listed.by.contains(named) && !listed.by.starts_with("nothing"),
                called_for,
                "{name}: {}",
                listed.by
            );
        }
        if EFFECT_NAMES.contains(&name) {
            let (model, _) = assembled(&with, &[name]).unwrap();
            let all = model.listed_effects();
            assert!(all.iter().find(|l| l.effect.name == name).unwrap().is_switched_off(), "{name}");
        }
    }
}

/// Angle and speed of the wheel after `seconds`, with a part and without it, from a speed and under a command.
fn wheels(text: &str, part: &str, (speed, command): (f64, AxisCommand), seconds: f64) -> [(f64, f64); 2] {
    [&[][..], &[part]].map(|off| {
        let (model, mut world) = assembled(text, off).unwrap();
        let mut state = world.state().clone();
        state.set_axis(&model, 0, 0.0, speed);
        world.set_initial_state(state);
        world.set_commands(&[command]).unwrap();
        while world.time() < seconds - 1e-9 {
            world.advance();
        }
        world.state().axis(&model, 0)
    })
}

/// Inertia of the wheel, kg·m².
const J: f64 = 1e-3;
/// What steps of 0.2 ms make of a decay of 10/s and of sums of some thousand terms, relative.
const NEAR: f64 = 1e-6;

fn near(is: f64, wanted: f64, what: &str) {
    assert!((is - wanted).abs() <= NEAR * (1.0 + wanted.abs()), "{what}: {is}, not {wanted}");
}

#[test]
fn without_the_line_the_torque_does_not_fall() {
    let (c, d, t) = (0.1, 50.0, 0.2);
    let text = drive(&format!("max_torque='{c}' no_load_speed='{d}'"));
    let [with, without] = wheels(&text, "torque_speed_line", (0.0, AxisCommand::torque(c)), t);
    near(with.1, d * (1.0 - (-c * t / (d * J)).exp()), "with it, exponential");
    near(without.1, c * t / J, "without, in proportion to time");
}

#[test]
fn without_the_short_brake_a_motor_runs_on() {
    let (c, d, t) = (0.1, 50.0, 0.2);
    let text = drive(&format!("max_torque='{c}' no_load_speed='{d}' short_brake='true'"));
    let [with, without] = wheels(&text, "short_brake", (5.0, AxisCommand::torque(0.0)), t);
    near(with.1, 5.0 * (-c * t / (d * J)).exp(), "with it, a decay");
    near(without.1, 5.0, "without, nothing");
}

#[test]
fn without_servos_nothing_holds() {
    let [with, without] = wheels(&wheel(""), "servo", (5.0, AxisCommand::servo(0.0)), 1.0);
    near(with.0, 0.0, "with it, held");
    near(without.0, 5.0, "without, on and on");
}

#[test]
fn each_resistance_goes_by_itself() {
    let t = 0.1;
    let dry = wheel("<dynamics friction='0.01'/>");
    let [with, without] = wheels(&dry, "joint_friction", (5.0, AxisCommand::IDLE), t);
    near(with.1, 5.0 - 0.01 * t / J, "dry friction");
    near(without.1, 5.0, "no dry friction");
    let drive = drive("static_resistance='0.03' dynamic_resistance='0.01'");
    let [with, without] = wheels(&drive, "dynamic_resistance", (5.0, AxisCommand::IDLE), t);
    near(with.1, 5.0 - 0.01 * t / J, "dynamic resistance");
    near(without.1, 5.0, "no dynamic resistance");
    let [with, without] = wheels(&drive, "static_resistance", (0.0, AxisCommand::torque(0.02)), t);
    assert_eq!(with, (0.0, 0.0), "held");
    near(without.1, (0.02 - 0.01) * t / J, "no static resistance");
}

#[test]
fn a_drive_that_is_set_later_has_no_resistance_that_is_off() {
    let (_, mut world) = assembled(&wheel(""), &["static_resistance", "dynamic_resistance"]).unwrap();
    let drive =
        realnoid::model::DriveLimits { static_resistance: 2.0, dynamic_resistance: 1.0, ..*world.drive(0).unwrap() };
    world.set_drive(0, drive).unwrap();
    let now = world.drive(0).unwrap();
    assert_eq!((now.static_resistance, now.dynamic_resistance), (0.0, 0.0));
}

#[test]
fn without_softness_a_stop_is_hard() {
    let text = turned(LIMIT, "stop_erp='0.9' stop_cfm='50'");
    let [with, without] = wheels(&text, "soft_stops", (5.0, AxisCommand::IDLE), 0.205);
    // A spring of 90 N·m/rad turns it back within 5 ms, from 0.0167 rad without its damper.
    assert!(with.0 > 1.001, "soft: {}", with.0);
    assert!(without.0 <= 1.0, "hard: {}", without.0);
}

/// Height, and velocity, of a body after some time, with a part and without it.
fn balls(text: &str, part: &str, engine: EngineKind, seconds: f64) -> [World; 2] {
    [&[][..], &[part]].map(|off| {
        let (_, mut world) = assembled(text, off).unwrap();
        let settings = realnoid::world::Settings { engine, ..*world.settings() };
        world.set_settings(settings).unwrap();
        while world.time() < seconds - 1e-9 {
            world.advance();
        }
        world
    })
}

/// Of the ball, along x and z, and its turns about y and z.
fn speeds(w: &World) -> [f64; 4] {
    let twist = w.new_snapshot().link_twist[w.model().links.len() - 1];
    let r = w.new_snapshot().link_pose[w.model().links.len() - 1].rotation;
    let (v, o) = (r * twist.linear, r * twist.angular);
    [v.x, v.z, o.y, o.z]
}

#[test]
fn contacts_lose_what_is_switched_off_in_every_engine() {
    let slides = ball("", &format!("{RESTS}, velocity: [1, 0, 0]"));
    let falls = ball("restitution: 0.5", "pose: [0, 0, 0.3, 0, 0, 0, 1]");
    for engine in EngineKind::built() {
        let [with, without] = balls(&slides, "contact_friction", engine, 0.5);
        // 5/7: a ball that slides and comes to roll; engines with impulses in proportion come near it.
        let (with, without) = (speeds(&with)[0], speeds(&without)[0]);
        assert!((with - 5.0 / 7.0).abs() < 0.02, "{engine:?} rolls: {with}");
        assert!((without - 1.0).abs() < 1e-5, "{engine:?} slides on: {without}");
        // It touches after 0.202 s with 1.98 m/s, and is on its way up at 0.25 s.
        let [with, without] = balls(&falls, "restitution", engine, 0.25);
        let (with, without) = (speeds(&with)[1], speeds(&without)[1]);
        assert!(with > 0.3, "{engine:?} bounces: {with}");
        assert!(without.abs() < 0.05, "{engine:?} stays: {without}");
    }
}

#[test]
fn rolling_and_spinning_friction_go_by_themselves() {
    let g = 9.80665;
    let rolls = ball("rolling_friction: 0.01", &format!("{RESTS}, velocity: [1, 0, 0], angular_velocity: [0, 10, 0]"));
    let [with, without] = balls(&rolls, "rolling_resistance", EngineKind::Rbx, 0.5);
    // Torque 0.01 N against the roll of 7/5 m r².
    near(speeds(&with)[0], 1.0 - 0.5 * 0.01 * g / (1.4 * 0.1), "it slows down");
    near(speeds(&without)[0], 1.0, "it rolls on");
    let spins = ball("spinning_friction: 0.001", &format!("{RESTS}, angular_velocity: [0, 0, 10]"));
    let [with, without] = balls(&spins, "spinning_friction", EngineKind::Rbx, 0.5);
    near(speeds(&with)[3], 10.0 - 0.5 * 0.001 * g / (0.4 * 0.01), "it turns slower");
    near(speeds(&without)[3], 10.0, "it turns on");
}

#[test]
fn without_continuous_detection_no_step_is_divided() {
    let fast = ball("", "pose: [0, 0, 2, 0, 0, 0, 1], velocity: [0, 0, -2000]");
    let [with, without] = balls(&fast, "continuous_detection", EngineKind::Rbx, 0.005);
    assert!(with.stats().divided_steps > 0);
    assert_eq!((without.stats().divided_steps, without.stats().fast_pieces), (0, 0));
}

#[test]
fn a_world_in_which_nothing_is_switched_off_has_the_model_that_it_was_given() {
    let (model, world) = assembled(&ball("restitution: 0.5", RESTS), &[]).unwrap();
    assert!(Arc::ptr_eq(&model, world.model()), "no copy is made for nothing");
    let (model, world) = assembled(&ball("restitution: 0.5", RESTS), &["restitution"]).unwrap();
    assert!(
        !Arc::ptr_eq(&model, world.model()) && world.model().colliders.iter().all(|c| c.surface.restitution == 0.0)
    );
}
