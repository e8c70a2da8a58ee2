//! Scenes: several robots, bodies and the ground in one world.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "support/urdf.rs"]
mod urdf;

use realnoid::cli::load::Source;
use realnoid::cli::scene::{Assembly, Fault, Scene, Spare, assemble, inside};
use realnoid::engine::State;
use realnoid::math::{Pose, Vec3};
use realnoid::model::{Base, JointType, LinkFrame, Model};
use realnoid::record::{CsvWriter, Sample};
use realnoid::world::{AxisCommand, Integrator, Settings, Side, World};
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use urdf::{group, joint, link, model, robot};

/// A robot with a 3DOF group, a hinge, a soft fixed joint and a follower; a base of its own.
fn limb(base: Base) -> Model {
    let parts = [
        link("root", 3.0, "0 0 0.1"),
        link("a", 0.0, ""),
        link("b", 0.0, ""),
        link("arm", 2.0, "0.2 0 0"),
        link("hand", 0.5, "0.1 0 0"),
        link("finger", 0.2, "0.05 0 0"),
        joint("h", "revolute", ("root", "a"), ("0 0 0.3", "0 0 1"), ""),
        joint("p", "revolute", ("a", "b"), ("0 0 0", "0 1 0"), ""),
        joint("r", "revolute", ("b", "arm"), ("0 0 0", "1 0 0"), ""),
        joint("wrist", "continuous", ("arm", "hand"), ("0.4 0 0", "0 1 0"), ""),
        joint("tip", "fixed", ("hand", "finger"), ("0.2 0 0", "0 1 0"), "erp='0.2' cfm='1e-4'"),
        group("3dof", "h='h' p='p' b='r'"),
    ];
    Model::clone(&model(&robot(&parts), base))
}

/// Away from rest and from symmetry.
fn moved(m: &Model, seed: f64) -> State {
    let mut s = State::initial(m);
    for axis in 0..m.axes.len() {
        s.set_axis(m, axis, 0.2 + 0.1 * axis as f64 * seed, 0.5 * seed);
    }
    s.set_base_pose(m, [seed, -1.0, 2.0], [0.0, 0.1 * seed, 0.0, 1.0]);
    s.set_base_twist(m, [0.3, 0.2, 0.1 * seed].into(), [0.1, 0.0, -0.2].into());
    s
}

fn settings(integrator: Integrator) -> Settings {
    Settings { integrator, steps_per_interval: 1, ..Settings::default() }
}

fn run(m: &Model, s: &State, integrator: Integrator, intervals: usize) -> World {
    let mut w = World::new(Arc::new(m.clone()), settings(integrator)).unwrap();
    w.set_initial_state(s.clone());
    let torques: Vec<_> = (0..m.axes.len()).map(|i| AxisCommand::torque(0.1 * i as f64)).collect();
    w.set_commands(&torques).unwrap();
    (0..intervals).for_each(|_| w.advance());
    w
}

/// Robots that do not touch move as if they were alone: bit for bit with the Euler rule, whose passes do not look at the others,
/// within the tolerance of the common iteration (1e-8 per step) with the midpoint rule.
#[test]
fn joined_robots_move_as_if_alone() {
    for (integrator, steps) in [(Integrator::SemiImplicitEuler, 300), (Integrator::ImplicitMidpoint, 300)] {
        let (one, other) = (limb(Base::Free), limb(Base::Fixed));
        let (s, t) = (moved(&one, 1.0), moved(&other, -0.7));
        let (mut m, mut both) = (one.clone(), s.clone());
        m.join(other.clone(), "second");
        both.join(&t);
        // All commands but those of the second robot's index.
        let mut alone = run(&one, &s, integrator, 0);
        let mut beside = run(&other, &t, integrator, 0);
        let mut together = run(&m, &both, integrator, 0);
        let commands: Vec<_> = alone.commands().iter().chain(beside.commands()).copied().collect();
        together.set_commands(&commands).unwrap();
        for _ in 0..steps {
            [&mut alone, &mut beside, &mut together].into_iter().for_each(World::advance);
        }
        let apart: Vec<f64> = alone.state().q.iter().chain(&beside.state().q).copied().collect();
        let allowed = if integrator == Integrator::SemiImplicitEuler { 0.0 } else { 1e-8 * steps as f64 };
        for (x, y) in apart.iter().zip(&together.state().q) {
            assert!((x - y).abs() <= allowed, "{integrator:?}: {x} {y}");
        }
        let energies = [&alone, &beside, &together].map(|w| w.energy().kinetic);
        assert!((energies[0] + energies[1] - energies[2]).abs() <= 1e-12 * energies[2] + 1e-6 * allowed.signum());
    }
}

/// Every index of the joined model points to what it pointed to before.
#[test]
fn indices_point_to_their_own() {
    let (one, other) = (limb(Base::Free), limb(Base::Free));
    let mut m = one.clone();
    m.join(other.clone(), "second");
    assert_eq!((m.nq, m.nv, m.balls), (2 * one.nq, 2 * one.nv, 2 * one.balls));
    assert_eq!(m.axis("second/wrist"), Some(one.axes.len() + one.axis("wrist").unwrap()));
    for (i, body) in m.bodies.iter().enumerate().skip(1) {
        assert!(body.parent < i);
        let own = if i < one.bodies.len() { i } else { i - (one.bodies.len() - 1) };
        assert_eq!((body.joint, body.mass), (other.bodies[own].joint, other.bodies[own].mass));
    }
    for (axis, (a, b)) in m.axes.iter().zip(one.axes.iter().chain(&other.axes)).enumerate() {
        assert!(a.name.ends_with(&b.name));
        let (carrier, own) = (m.carrier(axis).unwrap(), one.carrier(axis % one.axes.len()).unwrap());
        assert_eq!(m.bodies[carrier].mass, one.bodies[own].mass, "{}", a.name);
    }
    let hand = m.links.iter().position(|l| l.name == "second/hand").unwrap();
    assert_eq!(m.links[m.links[hand].parent.unwrap()].name, "second/arm");
    assert_eq!(m.links[hand].membership.as_ref().unwrap().joint, "second/wrist");
    assert_eq!(m.floating().map(|(name, _)| name).collect::<Vec<_>>(), ["base", "second"]);
    assert!(m.softs.iter().all(|s| m.body_of(s.v).is_some()) && m.softs.len() == 2 * one.softs.len());
}

/// The base behind a joint moves; a neighbour on the same world does not.
#[test]
fn moving_a_base_leaves_the_neighbour_where_it_is() {
    let (one, other) = (limb(Base::Fixed), limb(Base::Fixed));
    let mut m = one.clone();
    m.join(other, "second");
    let mut w = World::new(Arc::new(m), settings(Integrator::SemiImplicitEuler)).unwrap();
    let before = w.new_snapshot();
    let n = one.links.len();
    w.set_joint_angle(one.axis("wrist").unwrap(), 0.4, Side::Root).unwrap();
    let after = w.new_snapshot();
    assert_eq!(before.link_pose[n..], after.link_pose[n..]);
    assert_ne!(before.link_pose[0], after.link_pose[0]);
    w.set_joint_angle(one.axes.len() + one.axis("wrist").unwrap(), 0.4, Side::Root).unwrap();
    let last = w.new_snapshot();
    assert_eq!(last.link_pose[..n], after.link_pose[..n]);
    assert_ne!(last.link_pose[n], after.link_pose[n]);
}

/// The scene in a folder of its own.
fn scene(text: &str) -> Result<Assembly, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.yaml");
    std::fs::File::create(&path).unwrap().write_all(text.as_bytes()).unwrap();
    let leg = include_str!("../urdf/leg.urdf");
    std::fs::write(folder.path().join("leg.urdf"), leg).unwrap();
    let scene = Scene::read(Some(&path))?;
    let stand = (scene.base.unwrap_or(Base::Fixed), scene.robot.pose);
    assemble(&scene, Source::default(), stand, Spare::Nobody, &|m| scene.switch_effects(m)).map_err(|fault| match fault
    {
        Fault::Robot(report) => report,
        Fault::Scene(reason) => reason,
    })
}

#[test]
fn faults_name_the_line_and_the_place() {
    let ball = "shape: {sphere: {radius: 0.1}}";
    for (text, said) in [
        ("bodies:\n  - name: a\n    shap: {}\n", vec!["line 4", "shap"]),
        (&format!("bodies:\n  - {{name: a, {ball}}}\n"), vec!["line 3", "bodies[0] 'a'", "mass"]),
        (&format!("bodies:\n  - {{name: a, {ball}, mass: -1}}\n"), vec!["line 3", "mass is -1"]),
        (&format!("bodies:\n  - {{name: a, {ball}, mass: 1, specific_gravity: 1}}\n"), vec!["both"]),
        (
            &format!("bodies:\n  - {{name: a, {ball}, mass: 1}}\n  - {{name: a, {ball}, mass: 1}}\n"),
            vec!["line 4", "taken"],
        ),
        (&format!("bodies:\n  - {{name: a/b, {ball}, mass: 1}}\n"), vec!["without blanks and slashes"]),
        (&format!("bodies:\n  - {{name: a, {ball}, mass: 1, frame: robot}}\n"), vec!["frame 'robot'", "world, body"]),
        (
            &format!("bodies:\n  - {{name: a, {ball}, mass: 1, inertia: [1, 0, 0, 1, 0, -1]}}\n"),
            vec!["bodies[0] 'a'", "inertia"],
        ),
        (&format!("bodies:\n  - {{name: a, {ball}, static: true, velocity: [1, 0, 0]}}\n"), vec!["static", "velocity"]),
        ("bodies:\n  - {name: a, mass: 1, shape: {sphere: {radios: 1}}}\n", vec!["line 3", "bodies[0] 'a'", "radios"]),
        ("bodies:\n  - {name: a, mass: 1, shape: {spere: {radius: 1}}}\n", vec!["bodies[0] 'a'", "spere"]),
        ("bodies:\n  - {name: a, mass: 1, shape: {sphere: {radius: -1}}}\n", vec!["bodies[0] 'a'", "radius"]),
        ("bodies:\n  - {name: a, mass: 1, shape: {radius: 1}}\n", vec!["needs one shape"]),
        (&format!("bodies:\n  - {{name: a, {ball}, mass: 1, surface: {{frction: 1}}}}\n"), vec!["frction"]),
        (
            &format!("bodies:\n  - {{name: a, {ball}, mass: 1, damping: {{linear: 2}}}}\n"),
            vec!["linear", "from 0 to 1"],
        ),
        ("ground: {friction: -1}\n", vec!["line 2", "ground", "friction is -1"]),
        ("ground: {fricton: 1}\n", vec!["ground", "fricton"]),
        ("ground: 3\n", vec!["ground", "true, false"]),
        ("defaults: {surface: {restitution: 2}}\n", vec!["defaults", "restitution is 2", "from 0 to 1"]),
        ("robots:\n  - {name: r}\n", vec!["line 3", "robots[0] 'r'", "urdf"]),
        ("robots:\n  - {name: r, urdf: nowhere.urdf}\n", vec!["robots[0] 'r'", "nowhere.urdf"]),
        ("robots:\n  - {name: r, urdf: leg.urdf, set: {elbow: 1}}\n", vec!["robots[0] 'r'", "elbow", "knee_pitch"]),
        ("robots:\n  - {name: r, urdf: leg.urdf, twist: [0, 0, 0, 1, 0, 0]}\n", vec!["robots[0] 'r'", "twist", "free"]),
        ("robot: {name: r}\n", vec!["line 2: robot", "name"]),
        ("robot: {urdf: nowhere.urdf}\n", vec!["scene.yaml", "line 2: robot", "nowhere.urdf"]),
        (
            "robot: {urdf: leg.urdf, set: {knee_pitch: 1e300}}\n",
            vec!["line 2: robot", "knee_pitch is 1e300", "1000000"],
        ),
        ("world: {gravity: [0, 0, .nan]}\n", vec!["line 2: world", "gravity z"]),
        ("world: {control_interval: 1e-30}\n", vec!["line 2: world", "1e-30 s", "0.000001"]),
        ("world: {effects: {gravty: true}}\n", vec!["line 2: world", "gravty", "gravity"]),
        ("world: {steps_per_interval: -1}\n", vec!["line 2", "whole number"]),
        ("ground: {friction: 1e308}\n", vec!["line 2: ground", "friction is 1e308", "from 0 to 1000000"]),
        ("ground: {height: 1e30}\n", vec!["line 2: ground", "height is 1e30 m"]),
        ("ground: {friction: .nan}\n", vec!["line 2", "finite number"]),
        ("ground: true\nground: false\n", vec!["line 3", "duplicate", "ground"]),
        ("ground: true\n", vec!["scene.yaml", "nothing to simulate", "bodies"]),
        (
            &format!("bodies:\n  - {{name: a, {ball}, mass: 1, pose: [0, 0, 1e30, 0, 0, 0, 1]}}\n"),
            vec!["line 3", "1e30 m"],
        ),
        (&format!("bodies:\n  - {{name: a, {ball}, mass: 1, velocity: [0, 1e9, 0]}}\n"), vec!["velocity is 1e9 m/s"]),
        (
            &format!("bodies:\n  - {{name: a, {ball}, mass: 1, surface: {{friction: 2e6}}}}\n"),
            vec!["friction", "2000000"],
        ),
        (
            &format!("bodies:\n  - {{name: a, {ball}, mass: 1, inertia: [1.0e-30, 0, 0, 1, 0, 1]}}\n"),
            vec!["line 3", "inertia about an axis", "gyration"],
        ),
        ("bodies:\n  - {name: a, mass: 1, shape: {sphere: {radius: 1e30}}}\n", vec!["line 3", "radius is 1e30"]),
        (
            "bodies:\n  - {name: t, static: true, shape: {terrain: {size: [4, 4, 1], filename: nowhere.png}}}\n",
            vec!["line 3", "does not collide", "nowhere.png"],
        ),
    ] {
        let reason = scene(&format!("version: 1\n{text}")).err().unwrap_or_else(|| panic!("accepted: {text}"));
        for part in said {
            assert!(reason.contains(part), "'{part}' is missing in: {reason}\n{text}");
        }
    }
}

#[test]
fn an_empty_file_is_told() {
    for text in ["", "\n \n"] {
        assert!(scene(text).err().unwrap().contains("the file is empty; a scene begins with version: 1"));
    }
}

/// Bodies, robots and the ground, by the names of what collides; not what only touches, and at most so many.
#[test]
fn what_starts_inside_something_is_told() {
    let ball = |name: &str, z: f64| {
        format!("  - {{name: {name}, mass: 1, shape: {{sphere: {{radius: 0.1}}}}, pose: [0, 0, {z}, 0, 0, 0, 1]}}\n")
    };
    let told = |balls: &[f64]| {
        let bodies: String = balls.iter().enumerate().map(|(i, z)| ball(&format!("b{i}"), *z)).collect();
        let all = scene(&format!("version: 1\nground: true\nbodies:\n{bodies}")).unwrap();
        inside(&all.model, &all.initial)
    };
    assert_eq!(told(&[0.1, 0.3, 1.0]), Vec::<String>::new());
    let two = told(&[0.05, 0.21]);
    assert!(two.len() == 2 && two[0].starts_with("'b0' and 'ground' start 50.000 mm inside"), "{two:?}");
    assert!(two[1].starts_with("'b0' and 'b1' start 40.000 mm inside"), "{two:?}");
    let many = told(&[1.0; 5]);
    assert!(many.len() == 6 && many[5].starts_with("5 more pairs"), "{many:?}");
}

const BODIES: &str = "version: 1
robot: {urdf: leg.urdf}
robots: [{name: other, urdf: leg.urdf, base: free, pose: [0, 2, 1, 0, 0, 0, 1], twist: [0, 0, 1, 0.5, 0, 0], set: {knee_pitch: 0.5}}]
bodies:
  - {name: egg, mass: 0.7, shape: {sphere: {radius: 0.1}, scale: [1, 1, 2], origin: {xyz: [0, 0, 0.3]}}, pose: [1, 0, 1, 0, 0, 0.6, 0.8],
     velocity: [1, 2, 3], angular_velocity: [0, 0, 2]}
  - {name: brick, mass: 2, inertia: [0.1, 0, 0, 0.2, 0, 0.25], shape: {box: {size: [0.1, 0.1, 0.1]}}, frame: body, velocity: [1, 0, 0],
     pose: [2, 0, 1, 0, 0, 0.6, 0.8]}
  - {name: stone, static: true, shape: {box: {size: [1, 1, 1]}}, pose: [4, 0, 0, 0, 0, 0, 1]}
ground: {height: -5, normal: [0, 0, 2], friction: 0.4}
";

#[test]
fn bodies_weigh_and_move_as_the_scene_says() {
    let all = scene(BODIES).unwrap();
    let m = &all.model;
    let body = |name: &str| {
        let link = m.links.iter().find(|l| l.name == name).unwrap();
        let LinkFrame::OnBody { body, .. } = link.frame else { panic!() };
        (&m.bodies[body], body)
    };
    let (egg, _) = body("egg");
    assert!((egg.mass - 0.7).abs() <= 1e-15 && (egg.mc.z - 0.7 * 0.3).abs() <= 1e-15);
    // An ellipsoid 0.1, 0.1, 0.2: I_z = m (a² + b²)/5.
    assert!((egg.inertia.zz - 0.7 * 0.02 / 5.0).abs() <= 1e-15);
    assert_eq!(egg.joint, JointType::Floating);
    // Both velocities are those of the centre of mass along the world's axes.
    let mut w = World::new(Arc::new(m.clone()), Settings::default()).unwrap();
    w.set_initial_state(all.initial.clone());
    let twist = |w: &World, name: &str| {
        let i = m.links.iter().position(|l| l.name == name).unwrap();
        let s = w.new_snapshot();
        (s.link_pose[i].rotation * s.link_twist[i].linear, s.link_pose[i].rotation * s.link_twist[i].angular)
    };
    let (v, turn) = twist(&w, "egg");
    assert!((v - nalgebra::Vector3::new(1.0, 2.0, 3.0)).norm() <= 1e-14 && (turn.z - 2.0).abs() <= 1e-14);
    // A quarter of a turn and a bit about Z: cos = 0.8² − 0.6².
    let (v, _) = twist(&w, "brick");
    assert!((v.x - 0.28).abs() <= 1e-14 && (v.y - 0.96).abs() <= 1e-14);
    let before = w.state().clone();
    (0..50).for_each(|_| w.advance());
    assert_ne!(before, *w.state());
    w.reset();
    assert_eq!(before, *w.state(), "reset gives the initial velocities back (B-8 B … D)");
    assert_eq!(body("stone").1, 0);
    let ground = m.colliders.last().unwrap();
    assert_eq!(
        (ground.name.as_str(), ground.surface.friction, ground.pose),
        ("ground", 0.4, Pose::translation(0.0, 0.0, -5.0))
    );
    let names: Vec<&str> = m.colliders.iter().map(|c| c.name.as_str()).collect();
    assert!(names.contains(&"egg") && names.contains(&"stone") && names.contains(&"other/foot"), "{names:?}");
    assert!(m.effects.contact);
}

#[test]
fn columns_of_what_joins_come_after_those_of_the_first() {
    let all = scene(BODIES).unwrap();
    let mut w = World::new(Arc::new(all.model), Settings::default()).unwrap();
    w.set_initial_state(all.initial);
    let mut text = vec![];
    let mut csv = CsvWriter::new(&mut text, w.model()).unwrap();
    csv.row(&Sample::new(&w)).unwrap();
    csv.finish().unwrap();
    let text = String::from_utf8(text).unwrap();
    let mut lines = text.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let (names, row) = (lines.next().unwrap(), lines.next().unwrap());
    assert_eq!(names.len(), row.len());
    let at = |name: &str| names.iter().position(|n| *n == name).unwrap_or_else(|| panic!("{name} in {names:?}"));
    assert_eq!(names[..2], ["time", "hip_pitch.position"]);
    assert!(
        at("ankle_pitch.effort") < at("other/hip_pitch.position") && at("other/ankle_pitch.effort") < at("other.x")
    );
    assert!(at("other.vz") < at("egg.x") && at("egg.vz") < at("brick.x") && at("brick.vz") + 1 == at("energy.kinetic"));
    assert!(!names.contains(&"stone.x") && !names.contains(&"base.x"), "what stands still has no columns");
    let value = |name: &str| row[at(name)].parse::<f64>().unwrap();
    assert_eq!((value("other.y"), value("other.wz"), value("other/knee_pitch.position")), (2.0, 1.0, 0.5));
}

#[test]
fn a_root_of_specific_gravity_0_is_static_whatever_holds_it() {
    let text = "<robot name='wall'><link name='wall'><realnoid><body specific_gravity='0'><shape><box size='1 1 1'/></shape>\
                </body></realnoid></link></robot>";
    for base in [Base::Fixed, Base::Free] {
        let m = model(text, base);
        assert_eq!((m.base, m.nv), (Base::Fixed, 0));
    }
}

/// The source's own example (figure 6-1). The ball flies off in front of the foot with at most the speed of an elastic hit by
/// a foot of infinite mass, and the ledger closes but for what the contacts take.
#[test]
fn the_leg_kicks_the_ball() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/config/leg_and_ball.yaml"));
    let scene = Scene::read(Some(path)).unwrap();
    let stand = (scene.base.unwrap(), scene.robot.pose);
    let Ok(all) = assemble(&scene, Source::default(), stand, Spare::Nobody, &|m| scene.switch_effects(m)) else {
        panic!()
    };
    let mut w = World::new(Arc::new(all.model), scene.settings).unwrap();
    w.set_initial_state(all.initial);
    let m = w.model().clone();
    let find = |name: &str| m.links.iter().position(|l| l.name == name).unwrap();
    let (ball, foot) = (find("ball"), find("foot"));
    let mut s = w.new_snapshot();
    let start = s.link_pose[ball].translation.x;
    let (mut fastest_foot, mut fastest_ball, mut kicked, mut on_the_ground) = (0.0_f64, 0.0_f64, false, 0);
    let total = |w: &World| w.energy().kinetic + w.energy().potential;
    let (energy, mut highest) = (total(&w), f64::NEG_INFINITY);
    for _ in 0..900 {
        w.advance();
        w.write_snapshot(&mut s);
        let toe = s.link_pose[foot].rotation
            * (s.link_twist[foot].linear + s.link_twist[foot].angular.cross(&Vec3::new(0.17, 0.0, -0.06)));
        fastest_foot = fastest_foot.max(toe.norm());
        fastest_ball = fastest_ball.max((s.link_pose[ball].rotation * s.link_twist[ball].linear).x);
        let touching =
            |a: &str, b: &str| s.contacts.iter().any(|c| c.colliders.map(|i| m.colliders[i].name.as_str()) == [a, b]);
        kicked |= touching("foot", "ball") && s.link_wrench[foot].force.x < 0.0 && s.link_wrench[ball].force.x > 0.0;
        on_the_ground += u32::from(touching("ball", "ground"));
        highest = highest.max(total(&w) - energy - w.work().drives);
    }
    assert!(kicked && on_the_ground > 100, "{kicked} {on_the_ground}");
    assert!(
        s.link_pose[ball].translation.x > start + 0.2 && fastest_ball > 0.3,
        "{} {fastest_ball}",
        s.link_pose[ball].translation.x
    );
    assert!(fastest_ball <= (1.0 + 0.3) * fastest_foot, "{fastest_ball} {fastest_foot}");
    assert!(highest <= 1e-3, "energy out of nothing: {highest} J");
    assert!(w.stats().worst_penetration < 3e-3 && w.stats().diverged_steps == 0, "{:?}", w.stats());
}
