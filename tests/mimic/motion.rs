//! Coupled axes in motion: closed forms, energy, drift, extremes.

use super::scene::{ALL_INTEGRATORS, IMPLICIT, Part, advance, axis, deviation, model, model_on, settings, text, world};
use super::support::{ALL, Random, state, tree};
use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::{Base, Coupling, Effects, JointType};
use realnoid::world::{AxisCommand, Integrator, World};
use std::sync::Arc;

const NO_GRAVITY: [f64; 3] = [0.0; 3];
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.80665];

/// Two hinges, the second turning −2 times as far.
fn geared(first: f64, second: f64) -> Vec<Part<'static>> {
    let mimic = "<mimic joint='a' multiplier='-2'/>";
    vec![
        Part { name: "a", inertia: first, ..Part::default() },
        Part { name: "b", inertia: second, inner: mimic, ..Part::default() },
    ]
}

/// Two hinges coupled 1 : −2 under a torque are one of the inertia I₁ + 4 I₂, to rounding: the torque is constant, so semi-
/// implicit Euler has the exact speed, the others the exact position as well. Also when one side is a million times the other.
#[test]
fn coupled_hinges_are_one() {
    for (first, second) in [(0.3, 0.05), (1e-3, 1e3), (1e3, 1e-3)] {
        for integrator in ALL_INTEGRATORS {
            let m = model(&geared(first, second));
            let mut w = world(&m, settings(integrator, 0.001, NO_GRAVITY), &[("a", 0.2, 0.7)]);
            assert_eq!(axis(&w, "b"), (-0.4, -1.4));
            let torque = 3.0 * (first + 4.0 * second);
            w.set_commands(&[AxisCommand::torque(torque), AxisCommand::IDLE]).unwrap();
            advance(&mut w, 1000);
            let ((qa, va), (qb, vb)) = (axis(&w, "a"), axis(&w, "b"));
            assert!((va - 3.7).abs() <= 1e-11 && (vb + 7.4).abs() <= 1e-11, "{first} {second}: {va} {vb}");
            let position = 0.2 + 0.7 + 1.5 + if integrator == Integrator::SemiImplicitEuler { 0.0015 } else { 0.0 };
            assert!((qa - position).abs() <= 1e-11 && (qb + 2.0 * qa).abs() <= 1e-11, "{first} {second}: {qa} {qb}");
            assert_eq!((w.stats().unsettled_steps, w.stats().fallback_steps), (0, 0));
        }
    }
}

/// A limb whose elbow and wrist follow its shoulder, under gravity: links hang on each other, so the coupling acts through
/// the whole chain. The coordinate is one; RK4 keeps its energy with the method's order, and the coupling to rounding.
#[test]
fn energy_and_coupling_are_kept_to_the_order() {
    let m = model(&[
        Part { name: "a", axis: "0 1 0", center: "0.1 0 -0.2", ..Part::default() },
        Part {
            name: "b",
            parent: "a",
            axis: "0 1 0",
            center: "0.05 0 -0.1",
            inner: "<mimic joint='a' multiplier='1.5' offset='0.3'/>",
            ..Part::default()
        },
        Part {
            name: "c",
            parent: "b",
            axis: "1 0 0",
            center: "0 0.05 -0.1",
            inner: "<mimic joint='b' multiplier='-1'/>",
            ..Part::default()
        },
    ]);
    let drift = |integrator, h: f64| {
        let mut w = world(&m, settings(integrator, h, GRAVITY), &[("a", 0.5, 2.0)]);
        let start = w.energy();
        let mut worst = 0.0f64;
        advance(&mut w, (1.0 / h).round() as usize);
        worst = worst.max(deviation(&w));
        assert_eq!((w.stats().unsettled_steps, w.stats().fallback_steps), (0, 0));
        let e = w.energy();
        ((e.kinetic + e.potential - start.kinetic - start.potential).abs(), worst)
    };
    let errors = [0.01, 0.005, 0.0025].map(|h| drift(Integrator::Rk4, h));
    println!("rk4 {errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0].0 / pair[1].0).log2();
        assert!(order > 3.7, "{errors:?}");
    }
    let errors = [0.001, 0.0005, 0.00025].map(|h| drift(Integrator::SemiImplicitEuler, h));
    println!("semi-implicit {errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0].0 / pair[1].0).log2() > 0.8, "{errors:?}");
    }
    assert!(errors.iter().all(|e| e.1 <= 1e-12), "{errors:?}");
    let errors = [0.002, 0.001, 0.0005].map(|h| drift(Integrator::ImplicitMidpoint, h));
    println!("midpoint {errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0].0 / pair[1].0).log2() > 1.8, "{errors:?}");
    }
    assert!(errors.iter().all(|e| e.1 <= 1e-12), "{errors:?}");
}

/// 10⁵ steps at rest under load, and in motion: the deviation stays at rounding, it does not add up.
#[test]
fn nothing_drifts() {
    let m = model(&[
        Part { name: "a", axis: "0 1 0", center: "0.1 0 -0.2", ..Part::default() },
        Part {
            name: "b",
            axis: "0 1 0",
            center: "0.2 0 0",
            inner: "<mimic joint='a' multiplier='-1.7' offset='0.1'/>",
            ..Part::default()
        },
    ]);
    for (command, speed) in [(AxisCommand::servo(0.3), 0.0), (AxisCommand::IDLE, 3.0)] {
        for integrator in ALL_INTEGRATORS {
            let mut w = world(&m, settings(integrator, 0.001, GRAVITY), &[("a", 0.3, speed)]);
            w.set_commands(&[command, AxisCommand::IDLE]).unwrap();
            advance(&mut w, 100_000);
            let (q, _) = axis(&w, "a");
            assert!(deviation(&w) <= 1e-13 * (1.0 + q.abs()) * 10.0, "{command:?} {integrator:?}: {}", deviation(&w));
            if speed == 0.0 {
                assert_eq!(axis(&w, "a"), (0.3, 0.0));
                assert_eq!(axis(&w, "b").1, 0.0);
            }
        }
    }
}

/// A deviation at the start is taken back, a fifth in each step, and costs no energy beyond what it is.
#[test]
fn a_deviation_is_taken_back() {
    let m = model(&geared(0.3, 0.05));
    for integrator in ALL_INTEGRATORS {
        let mut w = World::new(m.clone(), settings(integrator, 0.001, NO_GRAVITY)).unwrap();
        let mut s = State::initial(&m);
        s.set_axis(&m, 1, 0.01, 0.0);
        w.set_initial_state(s);
        advance(&mut w, 400);
        assert!(deviation(&w) <= 1e-12, "{integrator:?}: {}", deviation(&w));
        assert!(w.energy().kinetic <= 1e-12, "{integrator:?}: {:?}", w.energy());
    }
}

/// Roll of a 3DOF hip follows a hinge elsewhere, and a hinge follows the pitch of the hip, while all of it tumbles: the
/// deviation is of the order of the integrator and small.
#[test]
fn axes_of_a_group_follow_and_lead() {
    let tag = "<realnoid version='1'><joint_group name='hip' type='3dof' h='h' p='p' b='b'/></realnoid>";
    let limit = "<limit lower='-1.5' upper='1.5' effort='100' velocity='20'/>";
    let roll = format!("{limit}<mimic joint='lead' multiplier='0.5'/>");
    let mut all = text(
        &[
            Part { name: "lead", axis: "0 1 0", center: "0.1 0 -0.1", ..Part::default() },
            Part { name: "h", kind: "revolute", inner: limit, ..Part::default() },
            Part { name: "p", parent: "h", kind: "revolute", axis: "0 1 0", inner: limit, ..Part::default() },
            Part {
                name: "b",
                parent: "p",
                kind: "revolute",
                axis: "1 0 0",
                inner: &roll,
                mass: 3.0,
                center: "0.02 0.01 -0.3",
                ..Part::default()
            },
            Part {
                name: "tail",
                axis: "1 0 0",
                center: "0 0.2 0",
                inner: "<mimic joint='p' multiplier='-2' offset='0.1'/>",
                ..Part::default()
            },
        ],
        tag,
    );
    // The links inside the group are massless and share its origin.
    for inner in ["h", "p"] {
        let at = all.find(&format!("<link name='{inner}_link'>")).unwrap();
        let end = at + all[at..].find("</link>").unwrap();
        all.replace_range(at..end + 7, &format!("<link name='{inner}_link'/>"));
    }
    for inner in ["p", "b"] {
        let at = all.find(&format!("<joint name='{inner}'")).unwrap();
        let origin = at + all[at..].find("xyz='0.1 0 0'").unwrap();
        all.replace_range(origin..origin + 13, "xyz='0 0 0'");
    }
    let m = model_on(&all, Base::Fixed);
    assert_eq!((m.balls, m.couplings.len()), (1, 2));
    let run = |integrator, h: f64| {
        let mut w =
            world(&m, settings(integrator, h, GRAVITY), &[("lead", 0.4, 1.0), ("h", 0.2, 2.0), ("p", 0.3, -1.0)]);
        let (start, mut worst) = (w.energy(), 0.0f64);
        for _ in 0..(0.5 / h).round() as usize {
            w.advance();
            worst = worst.max(deviation(&w));
        }
        // Euler leaves steps that change fast to the default rule.
        let left = if integrator == Integrator::SemiImplicitEuler { 0 } else { w.stats().fallback_steps };
        assert_eq!((w.stats().unsettled_steps, left), (0, 0), "{integrator:?}");
        let e = w.energy();
        (worst, (e.kinetic + e.potential - start.kinetic - start.potential).abs())
    };
    let euler = [0.002, 0.001, 0.0005].map(|h| run(Integrator::SemiImplicitEuler, h));
    let rk4 = [0.01, 0.005, 0.0025].map(|h| run(Integrator::Rk4, h));
    let midpoint = [0.002, 0.001, 0.0005].map(|h| run(Integrator::ImplicitMidpoint, h));
    println!("semi-implicit {euler:?}\nrk4 {rk4:?}\nmidpoint {midpoint:?}");
    for pair in midpoint.windows(2) {
        assert!((pair[0].0 / pair[1].0).log2() > 1.8 && (pair[0].1 / pair[1].1).log2() > 1.7, "{midpoint:?}");
    }
    for pair in euler.windows(2) {
        assert!((pair[0].0 / pair[1].0).log2() > 1.7, "curvature per step: {euler:?}");
    }
    for pair in rk4.windows(2) {
        assert!((pair[0].1 / pair[1].1).log2() > 3.5, "{rk4:?}");
    }
    assert!(euler[1].0 <= 1e-4 && rk4[1].0 <= 1e-6, "{euler:?} {rk4:?}");
}

/// Random trees of all joints with random couplings, ratios from 1e-3 to 1e3, random torques, friction and stops: finite, and
/// the couplings hold as far as rounding goes.
#[test]
fn random_couplings_stay_finite() {
    IMPLICIT.into_iter().for_each(random_couplings_stay_finite_by);
}

fn random_couplings_stay_finite_by(integrator: Integrator) {
    for seed in 0..40u64 {
        let mut rng = Random(seed + 70);
        let joints: Vec<JointType> = (0..10).map(|i| ALL[(i + seed as usize) % 5]).collect();
        let mut m = tree(&joints, seed % 2 == 0, seed);
        let n = m.axes.len();
        let leader = rng.next() as usize % n;
        m.couplings = (0..n)
            .filter(|a| *a != leader && a % 3 != 0)
            .map(|follower| Coupling {
                follower,
                leader,
                ratio: (3.0 * rng.unit()).exp2() * rng.unit().signum(),
                offset: rng.unit(),
            })
            .collect();
        for a in &mut m.axes {
            (a.friction, a.damping) = (rng.unit().max(0.0), rng.unit().max(0.0));
        }
        (m.axes[leader].lower, m.axes[leader].upper) = (-1.0, 1.0);
        m.effects = Effects::called_for(&m);
        let m = Arc::new(m);
        let mut w = World::new(m.clone(), settings(integrator, 0.001, GRAVITY)).unwrap();
        let (q, v) = state(&m, &mut rng, 0.3);
        let mut s = State { q, v, angles: vec![] };
        s.set_axis(&m, leader, 0.3, 0.1);
        s.couple(&m);
        w.set_initial_state(s);
        for step in 0..1000 {
            if step % 100 == 0 {
                let commands: Vec<AxisCommand> = (0..n).map(|_| AxisCommand::torque(3.0 * rng.unit())).collect();
                w.set_commands(&commands).unwrap();
            }
            w.advance();
        }
        let stats = w.stats();
        assert_eq!(stats.diverged_steps, 0, "seed {seed}");
        assert!(stats.unsettled_steps <= 50, "seed {seed}: {stats:?}");
        assert!(deviation(&w) <= 1e-9, "seed {seed}: {} {stats:?}", deviation(&w));
    }
}

/// Everything at once, on hinges, slides and cardans: stops and servos on all axes, bounded and not, friction, steps of 5 ms.
/// Nearly every step settles, and the couplings hold to rounding.
#[test]
fn drives_stops_and_couplings_settle() {
    IMPLICIT.into_iter().for_each(drives_stops_and_couplings_settle_by);
}

fn drives_stops_and_couplings_settle_by(integrator: Integrator) {
    let (mut steps, mut unsettled) = (0, 0);
    for seed in 0..60u64 {
        let mut rng = Random(seed + 900);
        let joints: Vec<JointType> = (0..9).map(|i| ALL[(i + seed as usize) % 3]).collect();
        let mut m = tree(&joints, seed % 2 == 0, seed);
        let n = m.axes.len();
        for a in &mut m.axes {
            (a.lower, a.upper) = (-1.5 + 0.3 * rng.unit(), 1.5 + 0.3 * rng.unit());
            (a.friction, a.damping) = (rng.unit().max(0.0), 0.5 + 0.3 * rng.unit());
            a.drive.max_torque = if rng.unit() > 0.3 { f64::INFINITY } else { 20.0 };
            a.drive.max_speed = 3.0;
        }
        m.couplings = (0..n - n % 2)
            .filter(|a| a % 2 == 1)
            .map(|follower| Coupling {
                follower,
                leader: follower - 1,
                ratio: 2.0 * rng.unit(),
                offset: 0.2 * rng.unit(),
            })
            .collect();
        m.effects = Effects::called_for(&m);
        let m = Arc::new(m);
        let mut w = World::new(m.clone(), settings(integrator, 0.005, GRAVITY)).unwrap();
        for step in 0..2000 {
            if step % 200 == 0 {
                let command = |i: usize, rng: &mut Random| match (i % 2, rng.next() % 3) {
                    (1, 0 | 1) | (_, 0) => AxisCommand::torque(10.0 * rng.unit()),
                    _ => AxisCommand::servo(2.0 * rng.unit()),
                };
                let commands: Vec<AxisCommand> = (0..n).map(|i| command(i, &mut rng)).collect();
                w.set_commands(&commands).unwrap();
            }
            w.advance();
        }
        (steps, unsettled) = (steps + w.stats().steps, unsettled + w.stats().unsettled_steps);
        assert_eq!(w.stats().diverged_steps, 0, "seed {seed}");
        assert!(deviation(&w) <= 1e-12, "seed {seed}: {}", deviation(&w));
    }
    println!("{unsettled} of {steps}");
    assert!(unsettled * 1000 <= steps, "{unsettled} of {steps}");
}

/// What is coupled inside a free body does not change its momentum.
#[test]
fn couplings_are_inner_forces() {
    let m = model_on(&text(&geared(0.3, 0.05), ""), Base::Free);
    let mut w = world(&m, settings(Integrator::Rk4, 0.001, NO_GRAVITY), &[("a", 0.1, 5.0)]);
    let start = w.momentum();
    w.set_commands(&[AxisCommand::torque(0.4), AxisCommand::IDLE]).unwrap();
    advance(&mut w, 1000);
    let end = w.momentum();
    let apart = |a: Vec3, b: Vec3| (a - b).norm();
    assert!(apart(start.angular, end.angular) <= 1e-11 && apart(start.linear, end.linear) <= 1e-11);
    assert!(axis(&w, "a").1.abs() > 5.0 && deviation(&w) <= 1e-12);
}
