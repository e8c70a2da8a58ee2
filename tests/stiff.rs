//! Hard cases: stiff servos at long steps, huge torques, huge inertia ratios, long chains, random everything.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::dynamics::{Kinematics, kinematics};
use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::{Effects, JointType, Model};
use realnoid::world::{AxisCommand, Settings, World};
use std::sync::Arc;
use support::{ALL, Random, scale, state, tree};

fn world(m: &Model, h: f64) -> World {
    let settings =
        Settings { control_interval_ns: (h * 1e9).round() as i64, steps_per_interval: 1, ..Settings::default() };
    World::new(Arc::new(m.clone()), settings).unwrap()
}

fn run(w: &mut World, seconds: f64) {
    let steps = (seconds / (w.settings().control_interval_ns as f64 * 1e-9)).round() as usize;
    (0..steps).for_each(|_| w.advance());
}

fn total(w: &World) -> f64 {
    let e = w.energy();
    e.kinetic + e.potential
}

/// Servos of 100, 500 and 1000 Hz on a chain under gravity; an explicit spring would need steps below 3.2, 0.64, 0.32 ms.
/// They go to their targets and stand there.
#[test]
fn stiff_servos() {
    for bandwidth in [100.0, 500.0, 1000.0] {
        for h in [0.01, 0.001, 0.0001] {
            let mut m = tree(&[JointType::Revolute; 5], true, 4);
            for a in &mut m.axes {
                (a.drive.servo_time, a.drive.max_torque) = (1.0 / (std::f64::consts::TAU * bandwidth), 200.0);
            }
            let mut w = world(&m, h);
            let targets = [0.5, -0.4, 0.3, -0.2, 0.6];
            w.set_commands(&targets.map(AxisCommand::servo)).unwrap();
            for _ in 0..(1.0 / h) as usize {
                w.advance();
                for axis in 0..targets.len() {
                    let (_, v) = w.state().axis(&m, axis);
                    assert!(v.abs() < 200.0, "{bandwidth} {h}: {v}");
                }
            }
            for (axis, target) in targets.iter().enumerate() {
                let (q, v) = w.state().axis(&m, axis);
                assert!((q - target).abs() <= 1e-9 && v.abs() <= 1e-8, "{bandwidth} {h}: {q} {v}");
            }
        }
    }
}

/// Torques that no drive has, on a chain with nothing that bounds them, or only its stops: finite, and what no step can
/// resolve is told.
#[test]
fn huge_torques() {
    for (h, stops) in [(0.01, true), (0.001, true), (0.01, false), (0.001, false), (0.0001, false)] {
        let mut m = tree(&[JointType::Revolute; 6], true, 9);
        if stops {
            m.axes.iter_mut().for_each(|a| (a.lower, a.upper) = (-1.0, 1.0));
            m.effects = Effects::called_for(&m);
        }
        let mut w = world(&m, h);
        w.set_commands(&[1e6, -1e6, 1e6, -1e6, 1e6, -1e6].map(AxisCommand::torque)).unwrap();
        run(&mut w, 0.5);
        assert!(w.state().q.iter().chain(&w.state().v).all(|x| x.is_finite()), "{h} {stops}");
        assert_eq!((w.stats().diverged_steps, w.stats().guarded_pieces > 0), (0, !stops), "{h} {stops}");
    }
}

/// The guard slows down what whirls; a body that flies beside it in the same world keeps its momentum, and so does the robot
/// that whirls.
#[test]
fn the_guard_leaves_the_neighbours_alone() {
    let mut joints = vec![JointType::Floating];
    joints.extend([JointType::Revolute; 5]);
    let mut m = tree(&joints, true, 9);
    m.join(tree(&[JointType::Floating], true, 5), "other");
    m.effects.gravity = false;
    let mut w = world(&m, 0.001);
    let mut s = State::initial(&m);
    let slow = [0.1, -0.2, 0.05, 0.3, 0.1, -0.2];
    let n = s.v.len();
    s.v[n - 6..].copy_from_slice(&slow);
    w.set_initial_state(s);
    let momentum = |w: &World| {
        let (mut k, s) = (Kinematics::new(&m), w.state());
        kinematics(&m, &mut k, &s.q, &s.v);
        let (i, b) = (m.bodies.len() - 1, &m.bodies[m.bodies.len() - 1]);
        Vec3::from(k.r[i].mv(k.v[i] * b.mass + k.w[i].cross(b.mc)))
    };
    let before = momentum(&w);
    w.set_commands(&[1e6, -1e6, 1e6, -1e6, 1e6].map(AxisCommand::torque)).unwrap();
    for _ in 0..200 {
        w.advance();
    }
    assert!(w.stats().guarded_pieces > 0 && w.stats().diverged_steps == 0, "{:?}", w.stats());
    // The rule errs by (h ω)² per radian: 10⁻⁸ here.
    assert!((momentum(&w) - before).norm() <= 1e-6 * before.norm(), "{before} {}", momentum(&w));
}

/// Inertias of 1e8 : 1 in one chain, either way round.
#[test]
fn huge_inertia_ratios() {
    for heavy in [1, 3, 6] {
        for h in [0.01, 0.001] {
            let mut m = tree(&[JointType::Revolute; 6], true, 3);
            scale(&mut m, heavy, 1e4);
            scale(&mut m, 7 - heavy, 1e-4);
            let mut w = world(&m, h);
            let (q, v) = state(&m, &mut Random(2), 0.5);
            w.set_initial_state(State { q, v, angles: vec![] });
            let (before, kinetic) = (total(&w), w.energy().kinetic);
            let mut largest: f64 = 0.0;
            for _ in 0..(5.0 / h) as usize {
                w.advance();
                largest = largest.max(w.energy().kinetic);
            }
            assert_eq!(w.stats().diverged_steps, 0);
            // A light link between the wall and a heavy tip whirls faster than any step here resolves: that is told.
            let told = w.stats().guarded_pieces > 0;
            let gain = total(&w) - before;
            let bounded = gain <= 1e-2 * (largest + kinetic);
            assert!(if heavy == 6 { told } else { bounded }, "{heavy} {h}: {gain} {told}");
        }
    }
}

/// A chain of 100 links falls for two seconds: finite at 10 ms; at 1 ms it keeps its energy to a thousandth of what moves.
#[test]
fn a_chain_of_100_links() {
    let mut m = tree(&[JointType::Revolute; 100], true, 77);
    m.bodies.iter_mut().for_each(|b| b.tree_p = b.tree_p * 0.2);
    for (h, share) in [(0.01, f64::INFINITY), (0.001, 1e-3)] {
        let mut w = world(&m, h);
        let before = total(&w);
        run(&mut w, 2.0);
        assert_eq!(w.stats().diverged_steps, 0);
        assert!((total(&w) - before).abs() <= share * w.energy().kinetic);
    }
}

/// Random trees, drives, frictions, stops and commands: 10 000 steps at 2 ms are finite.
#[test]
fn random_drives_for_10_000_steps() {
    for seed in 0..12 {
        let mut w = random_world(seed, 0.002);
        let mut rng = Random(seed + 1000);
        for step in 0..10_000 {
            if step % 7 == 0 {
                command(&mut w, &mut rng);
            }
            w.advance();
        }
        assert_eq!(w.stats().diverged_steps, 0, "seed {seed}");
        assert!(w.state().q.iter().chain(&w.state().v).all(|x| x.is_finite()), "seed {seed}");
    }
}

/// What the drives put in is what the energy gains and the losses take, within the order of the method: the sum over the
/// worlds of what is missing falls at least with h (events are of first order).
#[test]
fn power_in_is_change_and_losses() {
    let missing: Vec<f64> = [0.002, 0.001, 0.0005, 0.00025].into_iter().map(missing_energy).collect();
    assert!(missing[3] <= missing[0] / 8.0 * 1.5, "{missing:?}");
}

/// Largest part of the energy of a world that is not accounted for, over all worlds, relative to what was moved.
fn missing_energy(h: f64) -> f64 {
    let mut worst = 0.0_f64;
    for seed in 0..20 {
        let mut w = random_world(seed, h);
        let mut rng = Random(seed + 500);
        let before = total(&w);
        for _ in 0..25 {
            command(&mut w, &mut rng);
            run(&mut w, 0.02);
        }
        let work = w.work();
        let missing = total(&w) - before - work.drives + work.losses;
        worst = worst.max(missing.abs() / (1.0 + work.drives.abs() + work.losses.abs()));
    }
    worst
}

fn random_world(seed: u64, h: f64) -> World {
    let mut rng = Random(seed);
    let joints: Vec<JointType> = (0..9).map(|i| ALL[(i + seed as usize) % 4]).collect();
    let mut m = tree(&joints, seed.is_multiple_of(2), seed);
    for a in &mut m.axes {
        (a.damping, a.friction) = (rng.unit().abs(), rng.unit().abs());
        (a.lower, a.upper) = (-0.5 - rng.unit().abs(), 0.5 + rng.unit().abs());
        let dynamic = rng.unit().abs();
        a.drive.max_torque = 1.0 + 20.0 * rng.unit().abs();
        a.drive.no_load_speed = 1.0 + 10.0 * rng.unit().abs();
        a.drive.max_speed = a.drive.no_load_speed;
        (a.drive.dynamic_resistance, a.drive.static_resistance) = (dynamic, dynamic + rng.unit().abs());
        (a.drive.short_brake, a.drive.rotor_inertia) = (rng.unit() > 0.0, 0.05 * rng.unit().abs());
        a.drive.servo_time = 0.001 + 0.05 * rng.unit().abs();
    }
    m.effects = Effects::called_for(&m);
    world(&m, h)
}

fn command(w: &mut World, rng: &mut Random) {
    let mut commands = w.commands().to_vec();
    let axis = rng.next() as usize % commands.len();
    commands[axis] = match rng.next() % 4 {
        0 => AxisCommand::IDLE,
        1 => AxisCommand::torque(0.0),
        2 => AxisCommand::torque(rng.unit() * 30.0),
        _ => AxisCommand::servo(rng.unit()),
    };
    w.set_commands(&commands).unwrap();
}
