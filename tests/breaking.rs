//! Joints that come apart (J-18 break threshold): when, with what force, and what is left.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::cli::load::{Source, load};
use realnoid::dynamics::{Kinematics, energy, kinematics, link_pose, link_twist, momentum};
use realnoid::engine::{State, come_apart};
use realnoid::math::{V3, Vec3};
use realnoid::model::{AxisSlot, Base, Breakable, JointType, LinkFrame, Model};
use realnoid::world::{AxisCommand, Integrator, Settings, Snapshot, World};
use std::io::Write;
use std::sync::Arc;
use support::{ALL, Random, state, tree};

const G: f64 = 9.80665;
const H: f64 = 1e-3;

fn load_text(text: &str, base: Base) -> Result<Arc<Model>, String> {
    let mut file = tempfile::Builder::new().suffix(".urdf").tempfile().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    load(Source { urdf: Some(file.path()), packages: &[] }, base).map(|loaded| loaded.model)
}

fn model(text: &str, base: Base) -> Arc<Model> {
    load_text(text, base).unwrap_or_else(|report| panic!("{report}\n{text}"))
}

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

fn link(name: &str, mass: f64, center: &str) -> String {
    if mass == 0.0 {
        return format!("<link name='{name}'/>");
    }
    format!(
        "<link name='{name}'><inertial><origin xyz='{center}' rpy='0.1 0.2 0.3'/><mass value='{mass}'/>\
         <inertia ixx='0.04' ixy='0.001' ixz='0.002' iyy='0.05' iyz='-0.001' izz='0.02'/></inertial></link>"
    )
}

/// `origin` and `axis` as URDF has them; `tag` are attributes of a `<constraint>`.
fn joint(name: &str, kind: &str, (parent, child): (&str, &str), (origin, axis): (&str, &str), tag: &str) -> String {
    let tag = if tag.is_empty() { String::new() } else { format!("<realnoid><constraint {tag}/></realnoid>") };
    let limit = if kind == "revolute" { "<limit lower='-1.5' upper='1.5'/>" } else { "" };
    format!(
        "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/><origin xyz='{origin}'/>\
         <axis xyz='{axis}'/>{limit}{tag}</joint>"
    )
}

fn robot(parts: &[String]) -> String {
    format!("<robot name='r'>{}</robot>", parts.concat())
}

fn group(kind: &str, axes: &str) -> String {
    format!("<realnoid version='1'><joint_group name='g' type='{kind}' {axes}/></realnoid>")
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

/// Random trees of every joint: each body's frame and twist, the momentum and the energy are those of before.
#[test]
fn momentum_and_energy_are_kept_at_the_instant() {
    let g = [0.3, -0.2, -G];
    for seed in 0..60 {
        let mut rng = Random(seed);
        let joints: Vec<JointType> = (0..9).map(|_| ALL[rng.next() as usize % ALL.len()]).collect();
        let m = tree(&joints, seed % 2 == 0, seed);
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
