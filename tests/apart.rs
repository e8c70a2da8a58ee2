//! What is left when a joint has come apart (J-18): models, states, links, bits.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::dynamics::{Kinematics, energy, kinematics, link_pose, link_twist, momentum};
use realnoid::engine::{State, come_apart};
use realnoid::math::{V3, Vec3};
use realnoid::model::{AxisSlot, Base, JointType, LinkFrame, Model};
use realnoid::world::{AxisCommand, Integrator, Settings, Side, Snapshot, World};
use std::sync::Arc;
use support::urdf::{joint, link, model, robot};
use support::{ALL, Random, state, tree};

const G: f64 = 9.80665;
const BELOW: &str = "0 0 -0.2";
const MASS: f64 = 3.0;
const SOFT: &str = "erp='0.3' cfm='2e-4'";

fn world(m: &Arc<Model>) -> World {
    let integrator = Integrator::SemiImplicitEuler;
    let settings =
        Settings { integrator, control_interval_ns: 1_000_000, steps_per_interval: 1, ..Settings::default() };
    World::new(m.clone(), settings).unwrap()
}

fn run(w: &mut World, steps: usize) {
    (0..steps).for_each(|_| w.advance());
    assert_eq!(w.stats().diverged_steps, 0);
}

/// Random trees of every joint: each body's frame and twist, the momentum and the energy are those of before.
#[test]
fn momentum_and_energy_are_kept_at_the_instant() {
    let g = [0.3, -0.2, -G];
    for seed in 0..60 {
        let mut rng = Random(seed);
        let joints: Vec<JointType> = (0..9).map(|_| ALL[rng.next() as usize % ALL.len()]).collect();
        let m = tree(&joints, seed.is_multiple_of(2), seed);
        let (q, v) = state(&m, &mut rng, 2.0);
        let s = State { q, v, angles: vec![] };
        let see = |m: &Model, s: &State| {
            let mut k = Kinematics::new(m);
            kinematics(m, &mut k, &s.q, &s.v);
            (energy(m, &k, g), momentum(m, &k), k)
        };
        let (e0, p0, k0) = see(&m, &s);
        for body in 1..m.bodies.len() {
            let (left, after) = come_apart(&m, &s, body);
            let (e1, p1, k1) = see(&left, &after);
            let near =
                |a: f64, b: f64, scale: f64| assert!((a - b).abs() < 1e-12 * scale, "seed {seed} body {body}: {a} {b}");
            near(e0.kinetic, e1.kinetic, e0.kinetic);
            near(e0.potential, e1.potential, e0.potential.abs().max(m.mass() * G));
            near(0.0, (p0.linear - p1.linear).norm(), p0.linear.norm());
            near(0.0, (p0.angular - p1.angular).norm(), p0.angular.norm());
            for i in 0..m.bodies.len() {
                let gap = |a: V3<f64>, b: V3<f64>| (Vec3::from(a) - Vec3::from(b)).norm();
                near(0.0, gap(k0.p[i], k1.p[i]), 10.0);
                near(0.0, gap(k0.w[i], k1.w[i]) + gap(k0.v[i], k1.v[i]), 100.0);
            }
        }
    }
}

/// A robot with every kind of joint, each with a threshold: of several axes in one group the least counts.
fn menagerie() -> String {
    let t = "break_threshold='1e6'";
    let soft = format!("{SOFT} {t}");
    let mut parts: Vec<String> =
        ["base", "thigh", "shin", "sole", "arm", "hand", "tail", "tip"].map(|n| link(n, 1.0, "0.02 0.01 -0.2")).into();
    parts.extend(["l1", "l2", "c1", "s1"].map(|n| link(n, 0.0, "")));
    let down = ("0 0 -0.4", "0 1 0");
    parts.extend([
        joint("h", "continuous", ("base", "l1"), ("0 0.1 0", "0 0 1"), "break_threshold='2e6'"),
        joint("p", "revolute", ("l1", "l2"), ("0 0 0", "0 1 0"), t),
        joint("b", "continuous", ("l2", "thigh"), ("0 0 0", "1 0 0"), ""),
        joint("knee", "continuous", ("thigh", "shin"), down, t),
        joint("weld", "fixed", ("shin", "sole"), down, t),
        joint("ch", "continuous", ("base", "c1"), ("0 -0.1 0", "0 0 1"), t),
        joint("cp", "continuous", ("c1", "arm"), ("0 0 0", "0 1 0"), ""),
        joint("slide", "prismatic", ("arm", "hand"), down, t),
        joint("sh", "continuous", ("base", "s1"), ("0.1 0 0", "0 0 1"), &soft),
        joint("sp", "continuous", ("s1", "tail"), ("0 0 0", "0 1 0"), ""),
        joint("soft", "continuous", ("tail", "tip"), down, &soft),
        "<realnoid version='1'><joint_group name='g' type='3dof' h='h' p='p' b='b'/>\
         <joint_group name='c' type='cardan' h='ch' p='cp'/><joint_group name='s' type='cardan' h='sh' p='sp'/></realnoid>"
            .into(),
    ]);
    robot(&parts)
}

fn any_state(m: &Model, seed: u64) -> State {
    let mut rng = Random(seed);
    let mut s = State::initial(m);
    if m.base == Base::Free {
        let r = rng.rotation();
        s.set_base_pose(m, [0.1, 0.2, 0.3], [r.i, r.j, r.k, r.w]);
        s.set_base_twist(m, rng.vec3(1.0), rng.vec3(1.0));
    }
    for axis in 0..m.axes.len() {
        s.set_axis(m, axis, rng.unit(), 0.0);
    }
    for axis in 0..m.axes.len() {
        let (q, _) = s.axis(m, axis);
        s.set_axis(m, axis, q, rng.unit());
    }
    for soft in m.softs.iter().filter(|s| s.softness.cfm > 0.0) {
        (s.q[soft.q], s.v[soft.v]) = (0.01 * rng.unit(), 0.1 * rng.unit());
    }
    s
}

/// Joints of the menagerie come apart one after the other, in several orders: after each of them every link is where it
/// was, moves as it did, and every axis keeps its position; those that hold keep their speed.
#[test]
fn links_and_axes_stay_where_they_are() {
    for base in [Base::Fixed, Base::Free] {
        let whole = model(&menagerie(), base);
        assert_eq!(whole.breakables.len(), 7);
        assert_eq!(whole.breakables[0].joint, "p", "the least of the group");
        for seed in 0..20 {
            let (mut m, mut s) = (Model::clone(&whole), any_state(&whole, seed));
            let mut rng = Random(seed);
            while !m.breakables.is_empty() {
                let body = m.breakables[rng.next() as usize % m.breakables.len()].body;
                let (left, after) = come_apart(&m, &s, body);
                compare(&m, &s, &left, &after);
                assert_eq!(left.breakables.len(), m.breakables.len() - 1);
                (m, s) = (left, after);
            }
            // The thigh, shin, sole, arm, hand, tail and tip float; nothing else moves.
            let floating = 7 + usize::from(base == Base::Free);
            assert_eq!((m.bodies.len() - 1, m.nv), (floating, 6 * floating));
            assert!(m.eulers.is_empty() && m.softs.is_empty() && s.angles.is_empty());
        }
    }
}

fn compare(m: &Model, s: &State, left: &Model, after: &State) {
    assert_eq!((after.q.len(), after.v.len(), after.angles.len()), (left.nq, left.nv, left.eulers.len()));
    assert!(left.bodies.iter().enumerate().skip(1).all(|(i, b)| b.parent < i));
    let [mut k0, mut k1] = [Kinematics::new(m), Kinematics::new(left)];
    kinematics(m, &mut k0, &s.q, &s.v);
    kinematics(left, &mut k1, &after.q, &after.v);
    for i in 0..m.links.len() {
        let (a, b) = (link_pose(m, &k0, &s.q, &s.angles, i), link_pose(left, &k1, &after.q, &after.angles, i));
        let gap = (a.translation.vector - b.translation.vector).norm() + (a.rotation.coords - b.rotation.coords).norm();
        let name = &m.links[i].name;
        assert!(gap < 1e-13 || (a.rotation.coords + b.rotation.coords).norm() < 1e-13, "{name}: {gap}");
        let inside = |m: &Model| m.links[i].mass == 0.0 && matches!(m.links[i].frame, LinkFrame::OnBody { .. });
        if m.links[i].mass > 0.0 || !inside(left) {
            let (a, b) = (
                link_twist(m, &k0, (&s.q, &s.v), &s.angles, i),
                link_twist(left, &k1, (&after.q, &after.v), &after.angles, i),
            );
            let gap = (a.angular - b.angular).norm() + (a.linear - b.linear).norm();
            assert!(gap < 1e-12, "{name}: {gap}");
        }
    }
    for axis in 0..m.axes.len() {
        let (a, b) = (s.axis(m, axis), after.axis(left, axis));
        assert_eq!(a.0, b.0, "{}", m.axes[axis].name);
        let apart = matches!(left.axes[axis].slot, AxisSlot::Apart { .. });
        assert_eq!(if apart { 0.0 } else { a.1 }, b.1, "{}", m.axes[axis].name);
    }
}

fn bits(s: &Snapshot) -> Vec<u64> {
    let poses = s.link_pose.iter().flat_map(|p| p.translation.vector.iter().chain(p.rotation.coords.iter()));
    let twists = s.link_twist.iter().flat_map(|t| t.angular.iter().chain(t.linear.iter()));
    s.position.iter().chain(&s.velocity).chain(&s.effort).chain(poses).chain(twists).map(|x| x.to_bits()).collect()
}

/// The menagerie flails until it comes apart: clones made before and after go on with the same bits, reset makes it whole
/// again and a second run has the bits of the first.
#[test]
fn clones_and_runs_after_a_reset_have_the_same_bits() {
    for base in [Base::Fixed, Base::Free] {
        let mut m = Model::clone(&model(&menagerie(), base));
        m.breakables.iter_mut().enumerate().for_each(|(n, b)| b.threshold = 40.0 + 10.0 * n as f64);
        m.axes.iter_mut().for_each(|a| a.friction = 0.05);
        m.effects.friction = true;
        let m = Arc::new(m);
        let start = any_state(&m, 7);
        let mut w = world(&m);
        w.set_initial_state(start);
        let commands: Vec<AxisCommand> = (0..m.axes.len())
            .map(|a| if a % 2 == 0 { AxisCommand::servo(0.5) } else { AxisCommand::torque(8.0) })
            .collect();
        w.set_commands(&commands).unwrap();
        let mut early = w.clone();
        run(&mut w, 300);
        assert!(w.broken().len() >= 2, "{base:?}: {:?}", w.broken());
        let mut late = w.clone();
        run(&mut early, 300);
        assert_eq!(bits(&w.new_snapshot()), bits(&early.new_snapshot()));
        assert_eq!(w.broken(), early.broken());
        run(&mut w, 200);
        run(&mut late, 200);
        let end = bits(&w.new_snapshot());
        assert_eq!(end, bits(&late.new_snapshot()));
        assert!(!w.remember(), "an initial state is one of the whole robot");
        w.reset();
        assert!(w.broken().is_empty() && w.model().nv == m.nv && w.remember());
        w.set_commands(&commands).unwrap();
        run(&mut w, 500);
        assert_eq!(end, bits(&w.new_snapshot()));
    }
}

/// Massless links between two axes are taken out with what hung on them; their axes keep their positions.
#[test]
fn massless_links_stay_with_what_carried_them() {
    let tag = "break_threshold='1'";
    let m = model(
        &robot(&[
            link("base", 1.0, BELOW),
            link("upper", 1.0, BELOW),
            link("l1", 0.0, ""),
            link("bob", MASS, BELOW),
            joint("first", "continuous", ("base", "upper"), ("0 0 -0.4", "0 1 0"), ""),
            joint("h", "continuous", ("upper", "l1"), ("0 0 -0.4", "1 0 0"), ""),
            joint("p", "continuous", ("l1", "bob"), ("0 0 0", "0 1 0"), tag),
        ]),
        Base::Fixed,
    );
    let mut w = world(&m);
    let mut s = State::initial(&m);
    s.set_axis(&m, 1, 0.3, 0.0);
    w.set_initial_state(s);
    run(&mut w, 1);
    assert_eq!(w.broken().len(), 1);
    let (h, _) = w.state().axis(w.model(), 1);
    run(&mut w, 400);
    assert_eq!((w.model().nv, w.state().axis(w.model(), 1)), (1 + 6, (h, 0.0)));
    // The frame stays where it was on the upper link.
    let s = w.new_snapshot();
    let x_ul = s.link_pose[1].inv_mul(&s.link_pose[2]);
    assert!((x_ul.rotation.scaled_axis() - Vec3::new(h, 0.0, 0.0)).norm() < 1e-12);
    assert!((x_ul.translation.vector - Vec3::new(0.0, 0.0, -0.4)).norm() < 1e-12);
    assert_eq!(s.cut_off, [false, false, false, true]);
}

/// A fixed base that has been moved goes back by a reset also when a joint broke since; remembered, it stays where it is.
#[test]
fn a_moved_base_and_a_broken_joint_both_go_back() {
    let m = model(
        &robot(&[
            link("base", 1.0, BELOW),
            link("arm", 1.0, BELOW),
            link("hand", 1.0, BELOW),
            joint("h", "revolute", ("base", "arm"), ("0 0 -0.4", "0 1 0"), ""),
            joint("weld", "fixed", ("arm", "hand"), ("0 0 -0.4", "0 1 0"), "break_threshold='1'"),
        ]),
        Base::Fixed,
    );
    let mut w = world(&m);
    let start = bits(&w.new_snapshot());
    w.set_joint_angle(0, 0.5, Side::Root).unwrap();
    run(&mut w, 5);
    assert_eq!(w.broken().len(), 1);
    // Once more, with the hand off.
    w.set_joint_angle(0, 0.7, Side::Root).unwrap();
    run(&mut w, 5);
    w.reset();
    assert_eq!(bits(&w.new_snapshot()), start);
    w.set_joint_angle(0, 0.5, Side::Root).unwrap();
    assert!(w.remember());
    let remembered = bits(&w.new_snapshot());
    assert_ne!(remembered, start);
    run(&mut w, 5);
    assert_eq!(w.broken().len(), 1);
    w.reset();
    assert_eq!(bits(&w.new_snapshot()), remembered);
}
