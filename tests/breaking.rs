//! Joints that come apart (J-18 break threshold): when, with what force, and what is left.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;
mod touching;

use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::{AxisSlot, Base, Breakable, Model};
use realnoid::shape::ContactForm;
use realnoid::world::{Integrator, Settings, World};
use std::sync::Arc;
use support::urdf::{group, joint, link, load_text, model, robot};

const G: f64 = 9.80665;
const H: f64 = 1e-3;

fn settings(h: f64) -> Settings {
    Settings {
        integrator: Integrator::SemiImplicitEuler,
        control_interval_ns: (h * 1e9).round() as i64,
        steps_per_interval: 1,
        ..Settings::default()
    }
}

fn world(m: &Arc<Model>) -> World {
    World::new(m.clone(), settings(H)).unwrap()
}

fn midpoint(m: &Arc<Model>) -> World {
    World::new(m.clone(), Settings { integrator: Integrator::ImplicitMidpoint, ..settings(H) }).unwrap()
}

type MakeWorld = fn(&Arc<Model>) -> World;
const WORLDS: [MakeWorld; 2] = [world, midpoint];

fn run(w: &mut World, steps: usize) {
    (0..steps).for_each(|_| w.advance());
    assert_eq!(w.stats().diverged_steps, 0);
}

const BELOW: &str = "0 0 -0.2";
const MASS: f64 = 3.0;
const SOFT: &str = "erp='0.3' cfm='2e-4'";

/// A weight on a stand by each kind of joint, at rest when it hangs; the tag is at the first joint.
fn hanging(kind: &str, tag: &str) -> String {
    let ends = ("stand", "bob");
    let at = "0 0 1";
    let mut parts = vec![link("stand", 0.0, ""), link("bob", MASS, BELOW)];
    let groups = |parts: &mut Vec<String>, last: &str| {
        parts.push(link("l1", 0.0, ""));
        parts.push(joint("h", "continuous", ("stand", "l1"), (at, "0 0 1"), tag));
        parts.push(joint("p", "revolute", ("l1", last), ("0 0 0", "0 1 0"), ""));
    };
    match kind {
        "hinge" => parts.push(joint("h", "continuous", ends, (at, "0 1 0"), tag)),
        "slide" => parts.push(joint("h", "prismatic", ends, (at, "1 0 0"), tag)),
        "fixed" => parts.push(joint("h", "fixed", ends, (at, "1 0 0"), tag)),
        "cardan" => {
            groups(&mut parts, "bob");
            parts.push(group(kind, "h='h' p='p'"));
        }
        _ => {
            groups(&mut parts, "l2");
            parts.push(link("l2", 0.0, ""));
            parts.push(joint("b", "continuous", ("l2", "bob"), ("0 0 0", "1 0 0"), ""));
            parts.push(group(kind, "h='h' p='p' b='b'"));
        }
    }
    robot(&parts)
}

const KINDS: [&str; 5] = ["hinge", "slide", "fixed", "cardan", "3dof"];

/// At 0.999 of its threshold a joint holds, at 1.001 it comes apart; hard and soft, every kind.
#[test]
fn a_joint_holds_its_threshold_and_no_more() {
    for (kind, world) in KINDS.iter().flat_map(|kind| WORLDS.map(|world| (kind, world))) {
        for soft in ["", SOFT] {
            let with = |ratio: f64| {
                let tag = format!("{soft} break_threshold='{:.17}'", MASS * G / ratio);
                let m = model(&hanging(kind, &tag), Base::Fixed);
                let mut w = world(&m);
                w.set_initial_state(settled(&m));
                run(&mut w, 1000);
                w
            };
            assert!(with(0.999).broken().is_empty(), "{kind} {soft}");
            let w = with(1.001);
            let [broken] = w.broken() else { panic!("{kind} {soft}: {:?}", w.broken()) };
            assert_eq!(&*broken.joint, "h");
            assert!((broken.force / (MASS * G) - 1.0).abs() < 1e-9, "{kind} {soft}: {broken:?}");
            assert_eq!(broken.time, H, "{kind} {soft}");
        }
    }
}

/// The state at rest; a soft joint sags into it.
fn settled(m: &Model) -> State {
    let mut m = m.clone();
    m.effects.breaking = false;
    let mut w = world(&Arc::new(m));
    run(&mut w, 3000);
    w.state().clone()
}

/// What came off falls by ½ g t² with the midpoint rule; semi-implicit Euler moves with the speed at the end of each step and
/// adds ½ g t h.
#[test]
fn what_came_off_falls() {
    for (kind, ahead) in KINDS.iter().flat_map(|kind| [(kind, 1.0), (kind, 0.0)]) {
        let world = if ahead > 0.0 { world } else { midpoint };
        let m = model(&hanging(kind, "break_threshold='1'"), Base::Fixed);
        let mut w = world(&m);
        let z = |w: &World| w.new_snapshot().link_pose[1].translation.z;
        w.advance();
        assert_eq!((w.broken().len(), w.model().nv, w.model().bodies.len()), (1, 6, 2), "{kind}");
        let start = z(&w);
        let positions = w.new_snapshot().position;
        for n in 1..=500_u32 {
            run(&mut w, 1);
            let t = f64::from(n) * H;
            let fallen = start - z(&w);
            let exact = 0.5 * G * (t * t + ahead * t * H);
            assert!((fallen - exact).abs() < 1e-12, "{kind} {t}: {fallen} {exact}");
        }
        for (axis, position) in positions.iter().enumerate() {
            assert!(matches!(w.model().axes[axis].slot, AxisSlot::Apart { .. }), "{kind} axis {axis}");
            assert_eq!(w.state().axis(w.model(), axis), (*position, 0.0), "{kind}");
            assert!(position.abs() < 1e-15, "{kind}");
        }
    }
}

/// Where bodies touch, what came off falls onto the ground and lies there.
#[test]
fn what_came_off_lies_on_the_ground() {
    let radius = 0.25;
    for (kind, world) in KINDS.iter().flat_map(|kind| WORLDS.map(|world| (kind, world))) {
        let mut m = Model::clone(&model(&hanging(kind, "break_threshold='1'"), Base::Fixed));
        let ball = touching::on_link(&m, "bob", ContactForm::Ball { radius }, touching::surface(0.5));
        m.set_colliders(vec![touching::ground(0.5), ball]);
        let mut w = world(&Arc::new(m));
        run(&mut w, 2000);
        let z = w.new_snapshot().link_pose[1].translation.z;
        assert_eq!(w.broken().len(), 1, "{kind}");
        assert!((z - radius).abs() < 1e-6, "{kind}: {z}");
    }
}

/// The effect switched off, everything holds.
#[test]
fn breaking_off_holds() {
    for kind in KINDS {
        let mut m = Model::clone(&model(&hanging(kind, "break_threshold='1'"), Base::Fixed));
        assert!(m.effects.breaking && m.effects.switch("breaking", false));
        let mut w = world(&Arc::new(m));
        run(&mut w, 300);
        assert!(w.broken().is_empty());
        assert!((w.new_snapshot().link_pose[1].translation.z - 1.0).abs() < 1e-12, "{kind}");
    }
}

/// An arm swings into its stop: the blow breaks its joint, the swing alone does not.
#[test]
fn a_blow_at_a_stop_breaks() {
    let (speed, threshold, length) = (4.0, 100.0, 0.2);
    let centripetal = MASS * length * speed * speed;
    assert!(centripetal < threshold && threshold < MASS * length * speed / H);
    let tag = format!("break_threshold='{threshold}'");
    let text = robot(&[
        link("stand", 0.0, ""),
        link("arm", MASS, "0.2 0 0"),
        joint("h", "revolute", ("stand", "arm"), ("0 0 1", "0 0 1"), &tag),
    ]);
    let swing = |limits: bool| {
        let mut m = Model::clone(&model(&text, Base::Fixed));
        (m.effects.gravity, m.effects.limits) = (false, limits);
        let m = Arc::new(m);
        let mut w = world(&m);
        let mut start = State::initial(&m);
        start.set_axis(&m, 0, 0.0, speed);
        w.set_initial_state(start);
        run(&mut w, 600);
        w
    };
    assert!(swing(false).broken().is_empty());
    let w = swing(true);
    let [broken] = w.broken() else { panic!("{:?}", w.broken()) };
    // The blow takes all momentum of the arm in one step or in two.
    let blow = MASS * length * speed / H;
    assert!(broken.force > threshold && broken.force < blow + 2.0 * centripetal, "{broken:?} {blow}");
    assert!((broken.time - 1.5 / speed).abs() < 2.5 * H, "{broken:?}");
    let (position, _) = w.state().axis(w.model(), 0);
    assert!((position - 1.5).abs() < speed * H, "{position}");
}

/// A free base that turns: its arm comes off when m ω² r passes the threshold, and total momentum and energy stay.
#[test]
fn a_turning_free_base_loses_its_arm() {
    let text = |threshold: f64| {
        let heavy = |name: &str| {
            format!(
                "<link name='{name}'><inertial><mass value='{MASS}'/>\
                 <inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>"
            )
        };
        let tag = format!("break_threshold='{threshold:.17}'");
        robot(&[heavy("base"), heavy("arm"), joint("h", "fixed", ("base", "arm"), ("1 0 0", "1 0 0"), &tag)])
    };
    let (speed, radius) = (2.0, 0.5);
    let force = MASS * speed * speed * radius;
    let spin = |ratio: f64| {
        let m = model(&text(force / ratio), Base::Free);
        let mut w = World::new(m.clone(), Settings { gravity: [0.0; 3], ..settings(1e-5) }).unwrap();
        let mut s = State::initial(&m);
        s.set_base_pose(&m, [-radius, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]);
        s.set_base_twist(&m, Vec3::new(0.0, 0.0, speed), Vec3::new(0.0, -speed * radius, 0.0));
        w.set_initial_state(s);
        w
    };
    let mut holds = spin(0.999);
    run(&mut holds, 1000);
    assert!(holds.broken().is_empty());
    let mut w = spin(1.001);
    let (e0, p0) = (w.energy(), w.momentum());
    run(&mut w, 1);
    assert_eq!(w.broken().len(), 1);
    // Both parts now move apart at ω r.
    run(&mut w, 1000);
    let (e, p) = (w.energy(), w.momentum());
    // The one step before the break is of first order in h: ω h = 2e-5.
    assert!(
        (e.kinetic - e0.kinetic).abs() < 1e-4 * e0.kinetic
            && (p.angular - p0.angular).norm() < 1e-4 * p0.angular.norm()
    );
    assert!((p.linear - p0.linear).norm() < 1e-4 * MASS * speed * radius);
    let s = w.new_snapshot();
    let gap = s.link_pose[1].translation.vector - s.link_pose[0].translation.vector;
    let expected = (1.0_f64 + (2.0 * speed * radius * 0.01).powi(2)).sqrt();
    assert!((gap.norm() - expected).abs() < 1e-4, "{} {expected}", gap.norm());
}

/// A chain that hangs by three joints, all of them overloaded in the same step, comes apart at all of them.
#[test]
fn several_joints_break_in_one_step() {
    let tag = "break_threshold='5'";
    let mut parts = vec![link("stand", 0.0, "")];
    for (n, parent) in [(1, "stand"), (2, "k1"), (3, "k2"), (4, "k3")] {
        parts.push(link(&format!("k{n}"), 1.0, BELOW));
        let tag = if n == 3 { "" } else { tag };
        parts.push(joint(&format!("j{n}"), "continuous", (parent, &format!("k{n}")), ("0 0 -0.4", "0 1 0"), tag));
    }
    let m = model(&robot(&parts), Base::Fixed);
    let mut w = world(&m);
    run(&mut w, 1);
    let names: Vec<&str> = w.broken().iter().map(|b| &*b.joint).collect();
    assert_eq!(names, ["j1", "j2", "j4"]);
    for (broken, weight) in w.broken().iter().zip([4.0, 3.0, 1.0]) {
        assert!((broken.force - weight * G).abs() < 1e-9, "{broken:?}");
    }
    // Three pieces; the one in the middle still has its hinge.
    assert_eq!(w.model().nv, 6 + 6 + 1 + 6);
    assert!(matches!(w.model().axes[2].slot, AxisSlot::Scalar { .. }));
    let s = w.new_snapshot();
    assert_eq!(s.cut_off, [false, true, true, false, true]);
    run(&mut w, 500);
    let fallen = w.new_snapshot();
    for link in 1..5 {
        let dz = s.link_pose[link].translation.z - fallen.link_pose[link].translation.z;
        assert!((dz - G * H * H * 500.0 * 501.0 / 2.0).abs() < 1e-9, "link {link}: {dz}");
    }
}

/// What would be left without inertia is refused when it is loaded, with the name of the joint.
#[test]
fn a_break_that_cannot_be_simulated_is_refused() {
    let text = hanging("hinge", "break_threshold='10'");
    let start = text.find("ixx").unwrap();
    let end = start + text[start..].find("/>").unwrap();
    let point = text.replace(&text[start..end], "ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'");
    let report = load_text(&point, Base::Fixed).err().unwrap();
    assert!(report.contains("singular-break") && report.contains("joint 'h'"), "{report}");
    load_text(&point.replace("break_threshold='10'", ""), Base::Fixed).unwrap();
}

/// A threshold costs nothing to a world that has none: no watch, no body more.
#[test]
fn a_scene_without_thresholds_has_no_breakables() {
    for kind in KINDS {
        let (with, without) =
            (model(&hanging(kind, "break_threshold='5'"), Base::Fixed), model(&hanging(kind, ""), Base::Fixed));
        let [Breakable { body, joint, threshold }] = &with.breakables[..] else { panic!("{kind}") };
        assert_eq!((*body, joint.as_str(), *threshold), (1, "h", 5.0));
        assert!(without.breakables.is_empty() && !without.effects.breaking);
        // A fixed joint that may break is a coordinate that is held.
        assert_eq!(with.nv - without.nv, usize::from(kind == "fixed"), "{kind}");
    }
}
