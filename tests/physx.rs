//! The engine physx: free bodies in single precision. Tolerances are from theory: of the rule (semi-implicit Euler), of
//! rounding (6e-8 of a number in each of n steps), or those that all engines have (tests/engines.rs).
#![cfg(feature = "physx")]
#![allow(clippy::unwrap_used)] // a test may panic

use realnoid::cli::load::Source;
use realnoid::cli::scene::{Scene, Spare, assemble};
use realnoid::engine::{EngineKind, State, shortfalls};
use realnoid::math::{Pose, Twist, Vec3};
use realnoid::model::Base;
use realnoid::world::{Settings, World};
use std::fmt::Write as _;
use std::io::Write as _;
use std::sync::Arc;

const G: f64 = 9.80665;
/// Half a unit in the last place of 1 in single precision.
const ROUNDING: f64 = 6e-8;
/// How many of them the speed of turning gets in a step, at worst: PhysX takes ω through √I and back through √I⁻¹, each of them
/// R·D·Rᵀ with an R made of a quaternion (3 for R, 2 for the products, twice; 2 for the vector; twice).
const TURNING: f64 = 20.0;
const BOX: &str = "mass: 3, shape: {box: {size: [0.4, 0.4, 0.2]}}";

/// The scene of a text; the step is 1 ms unless it says otherwise.
fn scene(text: &str) -> World {
    let mut file = tempfile::Builder::new().suffix(".yaml").tempfile().unwrap();
    write!(file, "version: 1\n{text}").unwrap();
    let scene = Scene::read(Some(file.path())).unwrap();
    let stand = (scene.base.unwrap_or(Base::Fixed), scene.robot.pose);
    let all = assemble(&scene, Source::default(), stand, Spare::Nobody, &|m| scene.switch_effects(m));
    let all = all.unwrap_or_else(|_| panic!("{text} cannot be put together"));
    let settings = Settings { engine: EngineKind::Physx, steps_per_interval: 1, ..scene.settings };
    let mut w = World::new(Arc::new(all.model), settings).unwrap();
    w.set_initial_state(all.initial);
    w
}

fn run(w: &mut World, seconds: f64) {
    let intervals = (seconds / (w.settings().control_interval_ns as f64 * 1e-9)).round() as usize;
    (0..intervals).for_each(|_| w.advance());
    assert_eq!(w.stats().diverged_steps, 0);
}

fn index(w: &World, name: &str) -> usize {
    w.model().links.iter().position(|l| l.name == name).unwrap_or_else(|| panic!("no link {name}"))
}

/// Pose in the world, and twist in its own frame, of a link.
fn link(w: &World, name: &str) -> (Pose, Twist) {
    let s = w.new_snapshot();
    (s.link_pose[index(w, name)], s.link_twist[index(w, name)])
}

fn height(w: &World, name: &str) -> f64 {
    link(w, name).0.translation.z
}

fn speed(w: &World, name: &str) -> f64 {
    link(w, name).1.linear.norm()
}

fn advance_all(w: &mut World, steps: usize) -> State {
    (0..steps).for_each(|_| w.advance());
    w.state().clone()
}

fn farthest(a: &State, b: &State) -> f64 {
    a.q.iter().zip(&b.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn a_body_falls() {
    let mut w = scene(&format!("bodies:\n  - {{name: a, {BOX}, pose: [0, 0, 9, 0, 0, 0, 1]}}\n"));
    run(&mut w, 1.0);
    // Semi-implicit Euler is g t h/2 below the parabola; at worst a thousand roundings of 9.8 m/s (half of that on the mean)
    // and of 9 m.
    let rounded = 1000.0 * 9.0 * ROUNDING;
    let (z, v) = (height(&w, "a") - (9.0 - 0.5 * G * (1.0 + 1e-3)), link(&w, "a").1.linear.z + G);
    assert!(z.abs() < 1.5 * rounded, "{z}");
    assert!(v.abs() < 1.1 * rounded, "{v}");
}

/// v(t) of a box that slides with μ = 0.4 · 0.5, along its axes and askew.
#[test]
fn a_box_slides_to_rest() {
    for way in [[1.0, 0.0], [0.8, 0.6]] {
        let [x, y] = way;
        let text = format!(
            "ground: {{friction: 0.4}}\nbodies:\n  - {{name: a, {BOX}, surface: {{friction: 0.5}}, \
             pose: [0, 0, 0.1, 0, 0, 0, 1], velocity: [{x}, {y}, 0]}}\n"
        );
        let mut w = scene(&text);
        for at in 1..=5 {
            run(&mut w, 0.1);
            let should = 1.0 - 0.2 * G * 0.1 * f64::from(at);
            println!("t = 0.{at} s: v = {:.6} m/s, exact {should:.6}", speed(&w, "a"));
            // What friction takes in one step.
            assert!((speed(&w, "a") - should).abs() < 0.2 * G * 1e-3, "{way:?} {at} {}", speed(&w, "a"));
        }
        // On the ground, which is the second collider.
        let force: Vec3 = w.contacts().iter().map(|c| Vec3::from(c.force)).sum();
        let weight = 3.0 * G;
        let off = (force.z + weight).abs().max((force.xy().norm() - 0.2 * weight).abs());
        // As all engines (tests/engines.rs).
        assert!(off < 1e-2 * weight, "{force}");
        run(&mut w, 0.1);
        assert!(speed(&w, "a") < 1e-4, "{}", speed(&w, "a"));
        // And it stays: no more than that speed in the next second.
        let there = link(&w, "a").0.translation.vector;
        run(&mut w, 1.0);
        let crept = (link(&w, "a").0.translation.vector - there).norm();
        println!("crept {crept:e} m in 1 s");
        assert!(crept < 1e-4, "{crept}");
    }
}

/// Restitution 0.5 on a ground of 1: a quarter of the height.
#[test]
fn a_ball_bounces() {
    let mut w = scene(
        "ground: {restitution: 1}\nbodies:\n  - {name: a, mass: 1, shape: {sphere: {radius: 0.1}}, \
         surface: {restitution: 0.5}, pose: [0, 0, 1.1, 0, 0, 0, 1]}\n",
    );
    run(&mut w, (2.0 / G).sqrt() + 0.01);
    let mut top: f64 = 0.0;
    for _ in 0..450 {
        w.advance();
        top = top.max(height(&w, "a") - 0.1);
    }
    println!("rebound {top} m of 0.25");
    // The impact comes within a step of 1 ms: v h = 4.4 mm below, of which the speed there makes a half.
    assert!((top - 0.25).abs() < 3e-3, "{top}");
}

#[test]
fn a_tower_stands_and_its_floors_carry_what_lies_above() {
    let floors: String = (0..10).fold(String::new(), |mut all, i| {
        writeln!(all, "  - {{name: b{i}, {BOX}, pose: [0, 0, {}, 0, 0, 0, 1]}}", 0.1 + 0.2 * f64::from(i)).unwrap();
        all
    });
    let mut w = scene(&format!("ground: true\nbodies:\n{floors}"));
    run(&mut w, 2.0);
    for i in 0..10 {
        let at = link(&w, &format!("b{i}")).0.translation;
        let off = (at.z - 0.1 - 0.2 * f64::from(i)).abs().max(at.x.hypot(at.y));
        println!("floor {i}: {off:e} m");
        assert!(off < 1e-3, "floor {i}: {off}");
        let above = f64::from(10 - i) * 3.0 * G;
        let here = |z: f64| (z - 0.2 * f64::from(i)).abs() < 0.05;
        let carried: f64 = w.contacts().iter().filter(|c| here(c.point.z)).map(|c| c.force.z.abs()).sum();
        assert!((carried / above - 1.0).abs() < 1e-2, "floor {i} carries {carried} of {above}");
    }
    assert!(w.stats().worst_penetration < 1e-3, "{}", w.stats().worst_penetration);
}

/// A torque-free body that tumbles keeps energy and momentum.
#[test]
fn a_free_body_keeps_its_energy_and_momentum() {
    let shape = "mass: 2, inertia: [0.02, 0, 0, 0.03, 0, 0.045], shape: {sphere: {radius: 0.1}}";
    let mut w = scene(&format!(
        "world: {{gravity: [0, 0, 0]}}\nbodies:\n  - {{name: a, {shape}, angular_velocity: [0.1, 10, 0.1]}}\n"
    ));
    let (energy, l) = (w.energy().kinetic, w.momentum().angular);
    run(&mut w, 10.0);
    let (lost, now) = ((w.energy().kinetic / energy - 1.0).abs(), w.momentum().angular);
    let (longer, turned) = ((now.norm() / l.norm() - 1.0).abs(), now.angle(&l));
    println!("10 s: energy {lost:e}, |L| {longer:e}, L turned by {turned:e} rad");
    // 10000 steps; where L points, a first-order rule errs by what a body turns in a step.
    let rounded = 10_000.0 * TURNING * ROUNDING;
    assert!(lost < 2.0 * rounded && longer < rounded && turned < 0.01, "{lost} {longer} {turned}");
}

/// What starts inside the ground comes out, and does not jump: less than 0.1 m/s is left of the way out.
#[test]
fn what_starts_inside_comes_out_gently() {
    let mut w = scene(&format!("ground: true\nbodies:\n  - {{name: a, {BOX}, pose: [0, 0, 0.09, 0, 0, 0, 1]}}\n"));
    let mut top: f64 = 0.0;
    for _ in 0..300 {
        run(&mut w, 0.001);
        top = top.max(height(&w, "a") - 0.1);
    }
    println!("jumped {top:e} m");
    assert!(top < 0.1 * 0.1 / (2.0 * G), "{top}");
    assert!((height(&w, "a") - 0.1).abs() < 1e-4, "{}", height(&w, "a"));
    // The end of the first step is the first that counts: PhysX drives apart with 3 m/s at most.
    let worst = w.stats().worst_penetration;
    assert!(worst < 0.01 && worst > 0.01 - 0.003 - 1e-4, "{worst}");
}

/// A ball rolls to rest by rolling friction: it loses 5/7 · g · c / r per second.
#[test]
fn a_ball_rolls_to_rest() {
    let mut w = scene(
        "ground: true\nbodies:\n  - {name: a, mass: 1, shape: {sphere: {radius: 0.1}}, \
         surface: {friction: 1, rolling_friction: 0.002}, pose: [0, 0, 0.1, 0, 0, 0, 1], \
         velocity: [1, 0, 0], angular_velocity: [0, 10, 0]}\n",
    );
    run(&mut w, 1.0);
    let (pose, twist) = link(&w, "a");
    let (v, should) = ((pose.rotation * twist.linear).x, 1.0 - 5.0 / 7.0 * G * 0.002 / 0.1);
    assert!((v - should).abs() < 1e-2, "{v} {should}");
}

/// v (1 − d)^t, also beyond what PhysX takes for the fastest by itself (100 rad/s).
#[test]
fn bodies_are_damped_and_no_speed_is_cut() {
    let mut w = scene(
        "world: {gravity: [0, 0, 0]}\nbodies:\n  - {name: a, mass: 1, shape: {sphere: {radius: 0.1}}, \
         damping: {linear: 0.3, angular: 0.6}, velocity: [2000, 0, 0], angular_velocity: [0, 0, 1000]}\n",
    );
    run(&mut w, 1.0);
    let twist = link(&w, "a").1;
    let allowed = 1000.0 * ROUNDING;
    assert!((twist.linear.norm() / (2000.0 * 0.7) - 1.0).abs() < allowed, "{}", twist.linear.norm());
    assert!((twist.angular.z / (1000.0 * 0.4) - 1.0).abs() < TURNING * allowed, "{}", twist.angular.z);
}

/// Asleep after what the model says, woken by a touch; and never if it does not say so.
#[test]
fn bodies_sleep_when_the_model_says_so() {
    let body = |name: &str, at: f64, more: &str| {
        format!("  - {{name: {name}, {BOX}, pose: [{at}, 0, 0.1, 0, 0, 0, 1]{more}}}\n")
    };
    let sleepy = ", deactivate: {linear: 0.05, angular: 0.05, after: 0.3}";
    let text = format!("ground: true\nbodies:\n{}{}", body("a", 0.0, sleepy), body("b", 2.0, ""));
    let mut w = scene(&text);
    run(&mut w, 0.25);
    run(&mut w, 0.75);
    let at = w.state().q.clone();
    run(&mut w, 0.1);
    assert_eq!(w.state().q[..7], at[..7], "asleep");
    let weight: f64 = w.contacts().iter().map(|c| c.force.z.abs()).sum();
    assert!((weight / (6.0 * G) - 1.0).abs() < 1e-2, "what sleeps presses on the ground, too: {weight}");
    let settings = Settings { gravity: [3.0, 0.0, -G], ..*w.settings() };
    w.set_settings(settings).unwrap();
    w.advance();
    let mut ground = scene(&text.replace("ground: true", "ground: {friction: 0.1}"));
    run(&mut ground, 1.0);
    let settings = Settings { gravity: [3.0, 0.0, -G], ..*ground.settings() };
    ground.set_settings(settings).unwrap();
    run(&mut ground, 0.1);
    let gone = (3.0 - 0.1 * G) * 0.1;
    assert!((speed(&ground, "a") / gone - 1.0).abs() < 0.05, "gravity wakes: {}", speed(&ground, "a"));
}

/// What hits a body that sleeps wakes it.
#[test]
fn a_touch_wakes() {
    let text = format!(
        "ground: {{friction: 0.1}}\nbodies:\n  - {{name: a, {BOX}, pose: [0, 0, 0.1, 0, 0, 0, 1], \
         deactivate: {{linear: 0.05, angular: 0.05, after: 0.1}}}}\n  \
         - {{name: b, {BOX}, pose: [-3, 0, 0.1, 0, 0, 0, 1], velocity: [8, 0, 0]}}\n"
    );
    let mut w = scene(&text);
    run(&mut w, 0.3);
    assert_eq!(speed(&w, "a"), 0.0);
    run(&mut w, 0.3);
    assert!(speed(&w, "a") > 1.0, "{}", speed(&w, "a"));
}

/// More passes than PhysX makes in one step.
#[test]
fn many_passes_are_made() {
    let text = format!("ground: true\nbodies:\n  - {{name: a, {BOX}, pose: [0, 0, 0.2, 0, 0, 0, 1]}}\n");
    let mut w = scene(&text);
    w.set_settings(Settings { solver_iterations: 600, ..*w.settings() }).unwrap();
    run(&mut w, 1.0);
    assert!((height(&w, "a") - 0.1).abs() < 1e-4);
    let force: f64 = w.contacts().iter().map(|c| c.force.z.abs()).sum();
    assert!((force / (3.0 * G) - 1.0).abs() < 1e-2, "{force}");
}

const CROWD: &str = "ground: {friction: 0.7}\nbodies:\n  - {name: a, mass: 1, shape: {box: {size: [0.2, 0.3, 0.1]}}, \
    pose: [0, 0, 0.4, 0.6, 0, 0, 0.8], angular_velocity: [1, 2, 3]}\n  - {name: b, mass: 1, shape: {sphere: {radius: 0.1}}, \
    pose: [0.1, 0, 0.8, 0, 0, 0, 1]}\n";

/// A copy forgets contacts of the last step: it stays near, but not to the bit.
#[test]
fn a_copy_goes_on_nearby() {
    let mut w = scene(CROWD);
    // Still in flight: nothing is lost.
    run(&mut w, 0.05);
    let mut copy = w.clone();
    assert_eq!(w.state(), copy.state());
    assert_eq!(advance_all(&mut w, 20), advance_all(&mut copy, 20));
    run(&mut w, 0.4);
    let mut copy = w.clone();
    let apart = farthest(&advance_all(&mut w, 50), &advance_all(&mut copy, 50));
    println!("copy after 50 ms: {apart:e}");
    // Of 0.5 m/s at most, in 50 ms.
    assert!(apart < 5e-3, "{apart}");
}

#[test]
fn the_same_again_also_beside_others_and_in_threads() {
    let alone = advance_all(&mut scene(CROWD), 800);
    let (mut a, mut b) = (scene(CROWD), scene(&CROWD.replace("0.7", "0.2")));
    for _ in 0..800 {
        a.advance();
        b.advance();
    }
    assert_eq!(*a.state(), alone);
    assert_ne!(*b.state(), alone);
    let threads: Vec<_> = (0..4).map(|_| std::thread::spawn(|| advance_all(&mut scene(CROWD), 800))).collect();
    for thread in threads {
        assert_eq!(thread.join().unwrap(), alone);
    }
    // A reset world is the same again, too.
    a.reset();
    assert_eq!(advance_all(&mut a, 800), alone);
}

/// The robot stands where it is and nothing touches it; that is told once.
#[test]
fn links_are_left_out_and_told() {
    let urdf = std::env::current_dir().unwrap().join("urdf/origin.urdf");
    let robot = format!("robot: {{urdf: {}, base: free, pose: [0, 0, 2, 0, 0, 0, 1]}}\n", urdf.display());
    let text = format!("ground: true\nbodies:\n  - {{name: a, {BOX}, pose: [0, 0, 2, 0, 0, 0, 1]}}\n{robot}");
    let mut w = scene(&text);
    let m = w.model().clone();
    let before = w.new_snapshot();
    let at = index(&w, "a");
    run(&mut w, 1.0);
    let after = w.new_snapshot();
    for i in (0..m.links.len()).filter(|i| *i != at) {
        assert!((after.link_pose[i].translation.vector - before.link_pose[i].translation.vector).norm() < 1e-12);
        assert_eq!(after.link_twist[i].linear.norm() + after.link_twist[i].angular.norm(), 0.0);
    }
    assert!((height(&w, "a") - 0.1).abs() < 1e-4, "it falls through the robot: {}", height(&w, "a"));
    let told = shortfalls(EngineKind::Physx, &m);
    let kinds = realnoid::engine::by_kind(told.iter(), |s| s);
    let links: Vec<_> = kinds.iter().filter(|(s, _)| s.item == "<joint>").collect();
    assert_eq!(links.len(), 1, "{kinds:?}");
    assert_eq!(links[0].1 + 1, m.axes.len());
}

/// States that are not finite, or beyond single precision, are not taken, and reported.
#[test]
fn nonsense_is_told_and_not_taken() {
    let w = scene(CROWD);
    let m = w.model().clone();
    let good = w.state().clone();
    for (at, nonsense) in [(0, f64::NAN), (1, f64::INFINITY), (2, 1e300), (3, f64::NAN)] {
        let mut bad = good.clone();
        bad.q[at] = nonsense;
        assert!(EngineKind::Physx.build(&m, &bad).is_err(), "{at} {nonsense}");
        let mut bad = good.clone();
        bad.v[at] = nonsense;
        assert!(EngineKind::Physx.build(&m, &bad).is_err(), "{at} {nonsense}");
    }
    // It flies out of what single precision holds.
    for v in [1e14, 3e14] {
        let mut fast = good.clone();
        fast.v[..6].fill(v);
        let mut engine = EngineKind::Physx.build(&m, &fast).unwrap();
        let settings = realnoid::engine::StepSettings { h: 1.0, ..step(&w) };
        let diverged = (0..100).any(|_| engine.step(&m, &[], &settings).diverged);
        assert!(diverged, "{v}");
        assert!(engine.state().q.iter().chain(&engine.state().v).all(|x| x.is_finite()));
        // And takes another state afterwards.
        engine.restart(&m, &good);
        assert!(!engine.step(&m, &[], &step(&w)).diverged);
    }
}

fn step(w: &World) -> realnoid::engine::StepSettings {
    let s = w.settings();
    realnoid::engine::StepSettings {
        h: 1e-3,
        gravity: s.gravity,
        passes: s.solver_iterations,
        effects: w.model().effects,
        integrator: s.integrator,
        accuracy: s.accuracy,
    }
}

#[test]
fn microseconds_of_a_step() {
    for (name, text, seconds) in [
        (
            "a box on a plane",
            format!("ground: true\nbodies:\n  - {{name: a, {BOX}, pose: [0, 0, 0.1, 0, 0, 0, 1]}}\n"),
            5.0,
        ),
        ("a ball and a box that fall", CROWD.to_string(), 5.0),
    ] {
        let mut w = scene(&text);
        run(&mut w, 0.1);
        let start = std::time::Instant::now();
        run(&mut w, seconds);
        println!("{name}: {:.1} µs per step", start.elapsed().as_secs_f64() * 1e3 / seconds);
    }
}
