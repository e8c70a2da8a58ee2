//! Links and joints.

use super::{G, engines, link, run, scene_file, support, weightless, world};
use realnoid::math::Vec3;
use realnoid::model::{Base, Model};
use realnoid::world::{AxisCommand, EngineKind, World};
use std::path::Path;
use std::sync::Arc;
use support::urdf::model;

/// Centre of mass of the last link after 2 s: MuJoCo's RK4 at 0.05 ms (facts A7).
const TIP: [f64; 3] = [0.305_835_067_9, 0.0, -1.763_134_268_5];

#[test]
fn a_chain_of_ten_hinges_swings_as_the_reference() {
    for engine in engines().into_iter().filter(|e| e.capabilities().joints) {
        let mut w = scene_file(Path::new("tests/engines/chain.yaml"), engine);
        run(&mut w, 2.0);
        let (pose, _) = link(&w, "link10");
        let tip = pose * nalgebra::Point3::new(0.1, 0.0, 0.0);
        let error = (tip.coords - Vec3::from(TIP)).norm();
        let allowed = if engine == EngineKind::Rbx { 1e-6 } else { 1e-3 };
        assert!(error < allowed, "{} {error}", engine.name());
        // Facts A7: 2.7e-7 m with sixteen substeps of rapier; 4e-5 m of Bullet.
        let drift = if engine.capabilities().reduced_coordinates { 0.0 } else { 1e-4 };
        assert!(w.joint_drift() <= drift, "{} {}", engine.name(), w.joint_drift());
    }
}

/// A rod of 2 kg, its centre 0.3 m from a horizontal axis, along x at 0.
fn pendulum(joint: &str, tag: &str) -> Arc<Model> {
    let text = format!(
        "<robot name='pendulum'><link name='base'/>\
         <link name='rod'><inertial><origin xyz='0.3 0 0'/><mass value='2'/>\
         <inertia ixx='0.001' ixy='0' ixz='0' iyy='0.06' iyz='0' izz='0.06'/></inertial></link>\
         <joint name='hinge' type='revolute'><parent link='base'/><child link='rod'/><origin xyz='0 0 1'/>\
         <axis xyz='0 -1 0'/>{joint}<realnoid>{tag}</realnoid></joint></robot>"
    );
    model(&text, Base::Fixed)
}

const WIDE: &str = "<limit lower='-3' upper='3' effort='100' velocity='20'/>";

#[test]
fn a_servo_holds_its_target() {
    for engine in engines().into_iter().filter(|e| e.capabilities().joints) {
        let m = pendulum(WIDE, "<drive mode='servo' max_torque='40' no_load_speed='10'/>");
        let mut w = world(&m, engine);
        w.set_commands(&[AxisCommand::servo(0.7)]).unwrap();
        run(&mut w, 2.0);
        let (q, v) = w.state().axis(&m, 0);
        // 40 time constants of the servo: what is left is the engine's.
        assert!((q - 0.7).abs() < 1e-5 && v.abs() < 1e-4, "{} {q} {v}", engine.name());
        let load = 2.0 * G * 0.3 * 0.7_f64.cos();
        assert!((w.efforts()[0] / load - 1.0).abs() < 1e-3, "{} {} {load}", engine.name(), w.efforts()[0]);
    }
}

#[test]
fn dry_friction_holds_without_creeping() {
    let m = pendulum(&format!("{WIDE}<dynamics friction='7' damping='0.2'/>"), "");
    for engine in engines().into_iter().filter(|e| e.capabilities().joints) {
        let mut w = world(&m, engine);
        run(&mut w, 2.0);
        // The load is 5.9 N·m. What an iteration needs to find that at first may be lost.
        let (q, _) = w.state().axis(&m, 0);
        assert!(q.abs() < 1e-5, "{} {q}", engine.name());
    }
}

/// A constant torque against damping ends at torque / damping.
#[test]
fn a_torque_against_damping() {
    let m =
        pendulum(&format!("{}<dynamics damping='0.5'/>", WIDE.replace("-3", "-1000").replace("='3'", "='1000'")), "");
    for engine in engines().into_iter().filter(|e| e.capabilities().joints) {
        let mut w = weightless(&m, engine);
        w.set_commands(&[AxisCommand::torque(2.0)]).unwrap();
        run(&mut w, 1.0);
        // I ω̇ = τ − d ω about the axis, I = 0.06 + 2 · 0.3².
        let should = 4.0 * (1.0 - (-0.5_f64 / 0.24).exp());
        let (_, v) = w.state().axis(&m, 0);
        // First order in the step: h d / 2 I = 2e-4 relative.
        assert!((v / should - 1.0).abs() < 5e-4, "{} {v} {should}", engine.name());
        assert!((w.efforts()[0] - 2.0).abs() < 1e-9, "{} {}", engine.name(), w.efforts()[0]);
    }
}

#[test]
fn a_stop_is_not_passed() {
    let m = pendulum("<limit lower='-0.5' upper='0.5' effort='100' velocity='20'/>", "");
    for engine in engines().into_iter().filter(|e| e.capabilities().joints) {
        let mut w = world(&m, engine);
        run(&mut w, 1.0);
        let (q, v) = w.state().axis(&m, 0);
        // It arrives with 4.6 rad/s: a row that looks at positions sees the stop up to v h = 0.9 mrad late.
        assert!((q + 0.5).abs() < 1e-4 && v.abs() < 1e-3, "{} {q} {v}", engine.name());
        assert!(w.stats().worst_stop_violation < 1e-3, "{} {}", engine.name(), w.stats().worst_stop_violation);
    }
}

fn humanoid() -> Arc<Model> {
    model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Fixed)
}

/// Servos on the legs, torques on the arms, that change every half second.
fn script(w: &mut World, at: usize) {
    let m = w.model().clone();
    let commands: Vec<AxisCommand> = (m.axes.iter().enumerate())
        .map(|(i, a)| {
            let swing = 0.3 * (((at / 500 + i) % 5) as f64 - 2.0) / 2.0;
            let target = swing.max(a.lower + 0.05).min(a.upper - 0.05);
            let arm = ["shoulder", "elbow", "wrist", "gripper", "neck"].iter().any(|part| a.name.contains(part));
            if arm { AxisCommand::torque(2.0 * swing) } else { AxisCommand::servo(target) }
        })
        .collect();
    w.set_commands(&commands).unwrap();
}

/// All three groups, driven by the same script for 5 s: finite, together, and where servos hold, where rbx is.
#[test]
fn the_humanoid_follows_a_script() {
    let m = humanoid();
    let mut reference = world(&m, EngineKind::Rbx);
    let others = engines().into_iter().filter(|e| *e != EngineKind::Rbx && e.capabilities().joints);
    let mut worlds: Vec<World> = others.map(|e| world(&m, e)).collect();
    for at in 0..5000 {
        for w in std::iter::once(&mut reference).chain(&mut worlds) {
            if at % 500 == 0 {
                script(w, at);
            }
            w.advance();
            assert_eq!(w.stats().diverged_steps, 0, "{} {at}", w.settings().engine.name());
        }
        if at % 500 == 499 {
            worlds.iter().for_each(|w| compare(&reference, w, at));
        }
    }
    for w in &worlds {
        let name = w.settings().engine.name();
        assert!(w.joint_drift() < 1e-3, "{name} {}", w.joint_drift());
        assert!(w.stats().worst_stop_violation < 0.05, "{name} {}", w.stats().worst_stop_violation);
    }
}

/// Servos of the legs have had ten time constants: they are at their targets to 1 mrad, or at the same place as rbx.
fn compare(reference: &World, w: &World, at: usize) {
    let m = w.model();
    for (i, a) in m.axes.iter().enumerate().filter(|(_, a)| ["hip", "knee", "ankle"].iter().any(|p| a.name.contains(p)))
    {
        let (is, should) = (w.state().axis(m, i).0, reference.state().axis(m, i).0);
        let name = w.settings().engine.name();
        assert!((is - should).abs() < 2e-3, "{name} {} at {at} ms: {is} {should}", a.name);
    }
}

const BREAKS: &str = "<robot name='r'><link name='base'/><link name='load'><inertial><mass value='1'/>\
    <inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial></link>\
    <joint name='hook' type='fixed'><parent link='base'/><child link='load'/><origin xyz='0 0 2'/>\
    <realnoid><constraint break_threshold='LIMIT'/></realnoid></joint></robot>";

#[test]
fn a_hook_breaks_under_its_load() {
    for engine in engines().into_iter().filter(|e| e.capabilities().breaking) {
        // 9.81 N hang on it.
        for (limit, breaks) in [("9.7", true), ("9.9", false)] {
            let mut w = world(&model(&BREAKS.replace("LIMIT", limit), Base::Fixed), engine);
            run(&mut w, 0.5);
            assert_eq!(!w.broken().is_empty(), breaks, "{} {limit} {:?}", engine.name(), w.broken());
            let z = link(&w, "load").0.translation.z;
            let fallen = if breaks { 0.5 * G * 0.25 } else { 0.0 };
            assert!((2.0 - z - fallen).abs() < 5e-3, "{} {limit} {z}", engine.name());
        }
    }
}

/// A rotor of 0.5 kg·m² on a link of 0.24 about the axis.
#[test]
fn a_rotor_counts() {
    let m = pendulum(WIDE, "<drive mode='torque' max_torque='40' rotor_inertia='0.5'/>");
    for engine in engines().into_iter().filter(|e| e.capabilities().rotor_inertia) {
        let mut w = weightless(&m, engine);
        w.set_commands(&[AxisCommand::torque(3.0)]).unwrap();
        run(&mut w, 0.5);
        let (_, v) = w.state().axis(&m, 0);
        let should = 3.0 * 0.5 / 0.74;
        assert!((v / should - 1.0).abs() < 1e-3, "{} {v} {should}", engine.name());
    }
}

/// Combined hinges, cardans and 3DOF joints of the humanoid swing freely, from random speeds, as in rbx.
#[test]
fn all_groups_swing_as_in_rbx() {
    let mut m = Model::clone(&humanoid());
    m.effects = realnoid::model::Effects { gravity: true, ..realnoid::model::Effects::NONE };
    let m = Arc::new(m);
    let mut rng = support::Random(5);
    let mut start = realnoid::engine::State::initial(&m);
    (0..m.axes.len()).for_each(|i| start.set_axis(&m, i, 0.3 * rng.unit(), 2.0 * rng.unit()));
    let end = |engine: EngineKind| {
        let mut w = world(&m, engine);
        w.set_initial_state(start.clone());
        run(&mut w, 0.25);
        w.state().clone()
    };
    let reference = end(EngineKind::Rbx);
    for engine in engines().into_iter().filter(|e| e.capabilities().joints) {
        let state = end(engine);
        for (i, a) in m.axes.iter().enumerate() {
            let (is, should) = (state.axis(&m, i).0, reference.axis(&m, i).0);
            assert!((is - should).abs() < 2e-3, "{} {}: {is} {should}", engine.name(), a.name);
        }
    }
}

/// Torques push H and B of the 3DOF joints to both ends of their ranges, while a servo holds P; then the other way round: they stay
/// there. At the pole, where H and B are one axis, only rbx can tell them apart.
#[test]
fn angles_of_3dof_joints_stop() {
    let m = humanoid();
    let ball = |name: &str| ["shoulder", "neck"].iter().any(|part| name.contains(part));
    for engine in engines().into_iter().filter(|e| e.capabilities().joints) {
        for (sign, pitch) in [(-1.0, false), (1.0, false), (1.0, true)] {
            let mut w = world(&m, engine);
            let command = |a: &realnoid::model::Axis| match ball(&a.name) {
                true if a.name.contains("pitch") == pitch => AxisCommand::torque(10.0 * sign),
                true => AxisCommand::servo(0.0),
                false => AxisCommand::torque(0.0),
            };
            w.set_commands(&m.axes.iter().map(command).collect::<Vec<_>>()).unwrap();
            run(&mut w, 1.5);
            for (i, a) in m.axes.iter().enumerate().filter(|(_, a)| ball(&a.name)) {
                let (q, _) = w.state().axis(&m, i);
                let beyond = (a.lower - q).max(q - a.upper);
                assert!(beyond < 0.02, "{} {} {q}: {} {}", engine.name(), a.name, a.lower, a.upper);
                let ends = a.name.contains("pitch") == pitch;
                assert!(!ends || beyond > -0.02, "{} {} {q} is not at its end", engine.name(), a.name);
            }
        }
    }
}
