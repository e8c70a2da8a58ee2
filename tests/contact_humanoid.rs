//! The embedded humanoid on the ground: it stands on its servos, and it falls, from many poses and at many steps.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;
mod touching;

use realnoid::cli::load::{Source, load};
use realnoid::dynamics::{Kinematics, kinematics};
use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::{Base, DriveLimits, Model};
use realnoid::world::{AxisCommand, Integrator, Side, World};
use support::Random;
use touching::*;

fn humanoid() -> Model {
    let source = Source { urdf: None, packages: &[] };
    let mut m = Model::clone(&load(source, Base::Free).unwrap_or_else(|e| panic!("{e}")).model);
    let mut all = std::mem::take(&mut m.colliders);
    all.push(ground(1.0));
    m.set_colliders(all);
    m
}

/// The base so high that the lowest point of anything that collides is `gap` above the ground.
fn place(m: &Model, s: &mut State, gap: f64) {
    let at = s.q[2];
    let (mut low, mut high) = (at - 3.0, at + 3.0);
    let mut detector = realnoid::contact::Detector::new(m).unwrap();
    let floor = m.colliders.len() as u32 - 1;
    let mut k = Kinematics::new(m);
    for _ in 0..60 {
        s.q[2] = 0.5 * (low + high);
        kinematics(m, &mut k, &s.q, &vec![0.0; m.nv]);
        let mut touches = vec![];
        detector.find(&k, 0.0, &mut touches);
        let near = touches.iter().filter(|t| t.pair[1] == floor).map(|t| t.placed(&k).gap);
        if near.fold(f64::INFINITY, f64::min) < 1e-9 { low = s.q[2] } else { high = s.q[2] }
    }
    s.q[2] = high + gap;
}

fn total(w: &World) -> f64 {
    w.energy().kinetic + w.energy().potential
}

fn center(w: &World) -> Vec3 {
    w.momentum().center
}

/// Ten seconds on its servos: it settles within a second; then the centre of mass drifts by less than 1 µm/s and nothing swings.
/// With deactivation on it leaves the computation, and comes back when a servo is told something else.
#[test]
fn it_stands_on_its_servos() {
    let mut m = humanoid();
    rest(&mut m, 0.005, 0.01, 0.5);
    for sleeps in [false, true] {
        m.effects.deactivation = sleeps;
        let mut w = world(m.clone(), settings(1e-3, Integrator::ImplicitMidpoint));
        let mut s = State::initial(&m);
        place(&m, &mut s, 0.0);
        w.set_initial_state(s.clone());
        let mut commands: Vec<_> = (0..m.axes.len()).map(|i| AxisCommand::servo(s.axis(&m, i).0)).collect();
        w.set_commands(&commands).unwrap();
        (0..1000).for_each(|_| w.advance());
        let (settled, mut most) = (center(&w), 0.0_f64);
        for _ in 0..9000 {
            w.advance();
            most = most.max(w.energy().kinetic);
        }
        let drift = (center(&w) - settled).norm() / 9.0;
        println!("deactivation {sleeps}: drift {drift:e} m/s, kinetic energy at most {most:e} J, {:?}", w.stats());
        assert!(drift < 1e-6 && most < 1e-9);
        assert!(w.stats().worst_penetration < 1e-6);
        let weight: f64 = w.contacts().iter().map(|c| c.force.z.abs()).filter(|f| f.is_finite()).sum();
        assert!((weight / (m.mass() * 9.81) - 1.0).abs() < 1e-3, "{weight}");
        if sleeps {
            let q = w.state().q.clone();
            w.advance();
            assert_eq!(w.state().q, q);
            let arm = m.axes.iter().position(|a| a.name.contains("elbow")).unwrap();
            commands[arm] = AxisCommand::servo(s.axis(&m, arm).0 - 0.3);
            w.set_commands(&commands).unwrap();
            (0..300).for_each(|_| w.advance());
            assert!((w.state().axis(&m, arm).0 - s.axis(&m, arm).0).abs() > 0.2);
            // At rest again, its elbow is turned by hand; then its drive is weaker than the forearm.
            (0..3000).for_each(|_| w.advance());
            let at = w.state().axis(&m, arm).0;
            w.set_joint_angle(arm, at + 0.1, Side::Tip).unwrap();
            (0..300).for_each(|_| w.advance());
            assert!((w.state().axis(&m, arm).0 - at).abs() < 0.05, "the servo takes it back");
            (0..3000).for_each(|_| w.advance());
            let weak = DriveLimits { max_torque: 1e-3, ..m.axes[arm].drive };
            w.set_drive(arm, weak).unwrap();
            (0..1000).for_each(|_| w.advance());
            assert!((w.state().axis(&m, arm).0 - at).abs() > 0.1, "it hangs");
        }
    }
}

/// A random pose within two thirds of each range, in which no two links overlap.
fn pose(m: &Model, random: &mut Random) -> State {
    let mut detector = realnoid::contact::Detector::new(m).unwrap();
    let mut k = Kinematics::new(m);
    loop {
        let mut s = State::initial(m);
        for axis in 0..m.axes.len() {
            let a = &m.axes[axis];
            let (low, high) = (a.lower.max(-1.0), a.upper.min(1.0));
            s.set_axis(m, axis, 0.5 * (low + high) + 0.33 * (high - low) * random.unit(), 0.0);
        }
        let q = random.rotation().coords;
        s.set_base_pose(m, [0.0, 0.0, 3.0], [q.x, q.y, q.z, q.w]);
        kinematics(m, &mut k, &s.q, &vec![0.0; m.nv]);
        let mut touches = vec![];
        detector.find(&k, 0.0, &mut touches);
        if touches.iter().all(|t| t.placed(&k).gap > 0.0) {
            s.q[2] = 1.0;
            return s;
        }
    }
}

/// What became of one drop.
#[derive(Debug, Default)]
struct Drop {
    /// m.
    worst: f64,
    /// Deepest in the last tenth of the time, m.
    at_rest: f64,
    /// Sum of all steps that gained energy, J.
    grown: f64,
    /// Greatest kinetic energy in the last tenth of the time, J.
    kinetic: f64,
}

/// Dropped from 10 cm with passive joints: the lowest point of the robot is 10 cm above the ground.
fn dropped(m: &Model, seed: u64, (h, seconds): (f64, f64)) -> Drop {
    let mut w = world(m.clone(), settings(h, Integrator::ImplicitMidpoint));
    let mut s = if seed == 0 { State::initial(m) } else { pose(m, &mut Random(seed)) };
    place(m, &mut s, 0.1);
    w.set_initial_state(s);
    let steps = (seconds / h).round() as usize;
    let (mut energy, mut drop) = (total(&w), Drop::default());
    for step in 0..steps {
        w.advance();
        drop.grown += (total(&w) - energy).max(0.0);
        energy = total(&w);
        if step > steps * 9 / 10 {
            drop.at_rest = w.contacts().iter().map(|c| c.depth).fold(drop.at_rest, f64::max);
            drop.kinetic = drop.kinetic.max(w.energy().kinetic);
        }
    }
    let stats = w.stats();
    assert_eq!(stats.diverged_steps, 0);
    drop.worst = stats.worst_penetration;
    println!(
        "h {h} seed {seed}: {drop:?}, trimmed {:.1e} J, halvings {}, unsettled {}, guarded {}, residual {:.1e} m/s",
        stats.trimmed_energy, stats.halvings, stats.unsettled_steps, stats.guarded_pieces, stats.worst_residual
    );
    drop
}

fn passive() -> Model {
    let mut m = humanoid();
    m.effects.drives = false;
    m
}

/// 20 poses at 1 ms: it comes to rest, never deeper than 3 mm, and lies no deeper than 0.1 mm; no step makes energy.
#[test]
fn it_falls_from_twenty_poses() {
    let m = passive();
    for seed in 0..20 {
        let drop = dropped(&m, seed, (1e-3, 4.0));
        assert!(drop.worst < 3e-3 && drop.at_rest < 1e-4, "{drop:?}");
        assert!(drop.grown < 1e-4, "{drop:?}");
        assert!(drop.kinetic < 0.05, "{drop:?}");
    }
}

/// At 5 ms, and at 0.25 ms.
#[test]
fn it_falls_at_longer_and_shorter_steps() {
    let m = passive();
    let coarse: Vec<f64> = (0..20).map(|seed| dropped(&m, seed, (5e-3, 3.0)).worst).collect();
    assert!(coarse.iter().filter(|worst| **worst < 5e-3).count() >= 19, "{coarse:?}");
    assert!(coarse.iter().all(|worst| *worst < 1e-2), "{coarse:?}");
    for seed in 0..6 {
        let drop = dropped(&m, seed, (2.5e-4, 0.8));
        assert!(drop.worst < 2e-4 && drop.grown < 1e-4, "{drop:?}");
    }
}

/// From 10 ms down nothing blows up.
#[test]
fn it_falls_at_any_step() {
    let m = passive();
    for h in [1e-2, 7e-3, 2e-3, 5e-4] {
        for seed in 0..4 {
            let drop = dropped(&m, seed, (h, 1.5));
            assert!(drop.worst < 0.05 && drop.kinetic.is_finite(), "{drop:?}");
        }
    }
}
