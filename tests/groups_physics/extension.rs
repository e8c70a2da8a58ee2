//! The linear axis e: force against inertia, servo, stops, bounds of force and speed, in all three kinds of groups.

use crate::limbs::{WIDE, advance, axes, joint, model, settings, world};
use realnoid::model::{Base, Model};
use realnoid::world::{AxisCommand, Integrator, Mode, World};
use std::sync::Arc;

const KINDS: [&str; 3] = ["3dof", "cardan", "combined_hinge"];
/// kg, and the bounds of the linear drive: N, m/s, m.
const MASS: f64 = 2.0;
const FORCE: f64 = 60.0;
const SPEED: f64 = 0.4;
const RANGE: f64 = 0.3;
const G: f64 = 9.80665;

/// h, p, b, e; every centre of mass is on the axis of b, so that a force along e turns nothing. `pointing` is the rpy of the
/// group, `grouped` says whether there is a tag at all.
fn arm(kind: &str, pointing: &str, grouped: bool) -> Arc<Model> {
    let body = |name: &str, mass: f64| {
        format!(
            "<link name='{name}'><inertial><origin xyz='0.1 0 0'/><mass value='{mass}'/>\
             <inertia ixx='0.01' ixy='0' ixz='0' iyy='0.02' iyz='0' izz='0.03'/></inertial></link>"
        )
    };
    let own = |name: &str| if kind == "combined_hinge" { body(name, 0.5) } else { format!("<link name='{name}'/>") };
    let apart = if kind == "3dof" { "" } else { "xyz='0.05 0 0'" };
    let tag =
        format!("<realnoid version='1'><joint_group name='wrist' type='{kind}' h='h' p='p' b='b' e='e'/></realnoid>");
    let slide = format!(
        "<limit lower='0' upper='{RANGE}' effort='{FORCE}' velocity='{SPEED}'/><realnoid><drive mode='torque'/></realnoid>"
    );
    let slide = if grouped { slide } else { slide.replace("<realnoid><drive mode='torque'/></realnoid>", "") };
    let text = [
        format!("<robot name='arm'>{}", if grouped { tag.as_str() } else { "" }),
        ["<link name='base'/>".to_string(), own("l1"), own("l2"), body("limb", 1.0), body("shaft", MASS)].concat(),
        joint("h", "revolute", ("base", "l1"), "0 0 1", &format!("xyz='0 0 1' rpy='{pointing}'"), WIDE),
        joint("p", "revolute", ("l1", "l2"), "0 1 0", if kind == "combined_hinge" { apart } else { "" }, WIDE),
        joint("b", "revolute", ("l2", "limb"), "1 0 0", apart, WIDE),
        joint("e", "prismatic", ("limb", "shaft"), "1 0 0", "xyz='0.2 0 0'", &slide),
        "</robot>".into(),
    ];
    model(&text.concat(), Base::Fixed)
}

fn with(command: AxisCommand) -> [AxisCommand; 4] {
    [AxisCommand::IDLE, AxisCommand::IDLE, AxisCommand::IDLE, command]
}

fn weightless(m: &Arc<Model>) -> Arc<Model> {
    let mut m = Model::clone(m);
    m.effects.gravity = false;
    Arc::new(m)
}

/// x = F t² / 2 m, at any attitude of the group: exact for RK4, and h, p, b stay where they are.
#[test]
fn a_force_accelerates_the_mass() {
    for kind in KINDS {
        let m = weightless(&arm(kind, "0.3 -0.4 0.5", true));
        assert_eq!(m.axes[3].kind, realnoid::model::AxisKind::Linear);
        // Not at a stop, which the first step would leave by the default integrator.
        let start = [(0.4, 0.0), (-0.6, 0.0), (0.7, 0.0), (0.02, 0.0)];
        let mut w = world(&m, settings(Integrator::Rk4, 0.001), &start);
        w.set_commands(&with(AxisCommand::torque(4.0))).unwrap();
        advance(&mut w, 300);
        let (now, t) = (axes(&w), 0.3);
        assert!((now[3].0 - 0.02 - 4.0 / MASS * t * t / 2.0).abs() <= 1e-12, "{kind}: {now:?}");
        assert!((now[3].1 - 4.0 / MASS * t).abs() <= 1e-12, "{kind}: {now:?}");
        assert!((0..3).all(|k| (now[k].0 - start[k].0).abs() <= 1e-12), "{kind}: nothing turns: {now:?}");
        assert_eq!(w.new_snapshot().effort[3], 4.0);
    }
}

/// The force is bounded by `<limit effort>`: it takes t = sqrt(2 m x / F) to the stop, and rests there.
#[test]
fn force_is_bounded_and_the_stop_holds() {
    for kind in KINDS {
        let m = weightless(&arm(kind, "0 0 0", true));
        let h = 0.001;
        let mut w = world(&m, settings(Integrator::SemiImplicitEuler, h), &[(0.0, 0.0); 4]);
        w.set_commands(&with(AxisCommand::torque(10.0 * FORCE))).unwrap();
        let mut steps = 0;
        while axes(&w)[3].0 < RANGE - 1e-12 && steps < 1000 {
            w.advance();
            assert_eq!(w.new_snapshot().effort[3], FORCE, "{kind}");
            assert!(axes(&w)[3].0 <= RANGE + 1e-12);
            steps += 1;
        }
        let arrival = (2.0 * MASS * RANGE / FORCE).sqrt();
        assert!((f64::from(steps) * h - arrival).abs() <= 2.0 * h, "{kind}: after {steps} steps, {arrival} s");
        advance(&mut w, 500);
        let (q, v) = axes(&w)[3];
        assert!((q - RANGE).abs() <= 1e-12 && v.abs() <= 1e-12, "{kind}: rests at the stop: {q} {v}");
    }
}

/// Hanging straight down, a servo lifts the mass not faster than its speed, and then holds m g.
#[test]
fn a_servo_lifts_and_holds() {
    for kind in KINDS {
        // The group points down: x of the limb is −z of the world.
        let m = arm(kind, "0 1.5707963267948966 0", true);
        let mut w = world(
            &m,
            settings(Integrator::SemiImplicitEuler, 0.001),
            &[(0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.25, 0.0)],
        );
        w.set_commands(&with(AxisCommand::servo(0.05))).unwrap();
        let mut fastest = 0.0f64;
        for _ in 0..3000 {
            w.advance();
            fastest = fastest.max(axes(&w)[3].1.abs());
        }
        let shown = w.new_snapshot();
        assert!((shown.position[3] - 0.05).abs() <= 1e-9, "{kind}: {}", shown.position[3]);
        assert!((shown.effort[3] + MASS * G).abs() <= 1e-6, "{kind}: holds the weight: {}", shown.effort[3]);
        assert!(fastest <= SPEED * (1.0 + 1e-9) && fastest > 0.5 * SPEED, "{kind}: {fastest}");
        // Too weak, it sinks to the stop.
        let weak = AxisCommand { torque: 0.5 * MASS * G, ..AxisCommand::servo(0.05) };
        w.set_commands(&with(weak)).unwrap();
        advance(&mut w, 2000);
        assert!((axes(&w)[3].0 - RANGE).abs() <= 1e-9, "{kind}: {:?}", axes(&w));
        assert!((w.new_snapshot().effort[3] + 0.5 * MASS * G).abs() <= 1e-9);
    }
}

#[test]
fn the_mode_of_the_tag_is_that_of_the_axis() {
    let m = arm("3dof", "0 0 0", true);
    assert_eq!((m.axes[3].mode, m.axes[0].mode), (Mode::Torque, Mode::Idle));
    assert_eq!((m.axes[3].drive.max_torque, m.axes[3].lower, m.axes[3].upper), (FORCE, 0.0, RANGE));
}

/// With and without the tag, under torques and a force on all four axes, the robot moves alike; RK4 at 0.5 ms.
#[test]
fn a_group_with_e_moves_as_its_joints() {
    let run = |kind: &str, grouped: bool| -> (Vec<(f64, f64)>, World) {
        let mut m = Model::clone(&arm(kind, "0.2 0.3 -0.1", grouped));
        m.effects.limits = false;
        let start = [(0.3, 0.5), (0.4, -0.7), (-0.2, 0.9), (0.1, 0.2)];
        let mut w = world(&Arc::new(m), settings(Integrator::Rk4, 0.0005), &start);
        w.set_commands(&[0.8, -1.1, 0.4, 7.0].map(AxisCommand::torque)).unwrap();
        advance(&mut w, 600);
        assert_eq!(w.stats().fallback_steps, 0);
        (axes(&w), w)
    };
    for kind in KINDS {
        let ((group, w), (chain, _)) = (run(kind, true), run(kind, false));
        assert!(group[1].0.abs() < 1.3, "away from the pole: {group:?}");
        assert_eq!(w.model().eulers.len(), usize::from(kind == "3dof"));
        for (a, b) in group.iter().zip(&chain) {
            assert!((a.0 - b.0).abs() <= 1e-9 && (a.1 - b.1).abs() <= 1e-8, "{kind}: {a:?} {b:?}");
        }
    }
}

/// J-6: axes that are not named, or whose joint is fixed, do not move; what is left is a hinge, a cross or a chain of hinges,
/// and moves as the same joints without a tag.
#[test]
fn groups_with_fixed_axes_move_as_their_joints() {
    let text = crate::limbs::body("3dof", ["0 0 0.2", "0 0 0", "0 0 0"], "");
    let fixed =
        |name: &str| text.replace(&format!("name='{name}' type='revolute'"), &format!("name='{name}' type='fixed'"));
    let unnamed = |name: &str| {
        let named = format!("{name}='{name}'");
        if name != "p" {
            return fixed(name).replace(&named, "");
        }
        let pitch = text.find("<joint name='p'").unwrap();
        let end = pitch + text[pitch..].find("</joint>").unwrap() + "</joint>".len();
        let without = text.replace(&text[pitch..end], "").replace("<link name='l2'/>", "").replace(&named, "");
        without.replace("<parent link='l2'/>", "<parent link='l1'/>")
    };
    for name in ["h", "p", "b"] {
        for text in [fixed(name), unnamed(name)] {
            let bare = text.find("<realnoid").unwrap()..text.find("</realnoid>").unwrap() + "</realnoid>".len();
            let (mut without, start) = (text.clone(), [(0.2, 0.3), (0.3, -0.6), (0.4, 0.5), (0.1, 0.1)]);
            without.replace_range(bare, "");
            let run = |text: &str| {
                let mut w = world(&model(text, Base::Fixed), settings(Integrator::Rk4, 0.0005), &start);
                assert_eq!((w.model().axes.len(), w.model().eulers.len()), (4, 0));
                advance(&mut w, 400);
                axes(&w)
            };
            for (a, b) in run(&text).iter().zip(run(&without)) {
                assert!((a.0 - b.0).abs() <= 1e-9 && (a.1 - b.1).abs() <= 1e-8, "{name}: {a:?} {b:?}");
            }
        }
    }
}
