//! The extrapolation method: closed forms, errors that follow the accuracy, events, copies.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::engine::State;
use realnoid::math::{M3, V3};
use realnoid::model::{DriveLimits, Effects, JointType, Model};
use realnoid::world::{AxisCommand, Integrator, LocalEstimate, Settings, World};
use std::sync::Arc;
use support::{ALL, Random, state, tree};

/// Pieces with an event are not shorter than this, s.
const SHORTEST: f64 = 1e-11;

fn settings(interval: f64, accuracy: f64) -> Settings {
    Settings {
        integrator: Integrator::Extrapolation,
        accuracy,
        control_interval_ns: (interval * 1e9).round() as i64,
        steps_per_interval: 1,
        ..Settings::default()
    }
}

fn world(m: &Model, s: Settings, start: &State) -> World {
    let mut w = World::new(Arc::new(m.clone()), s).unwrap();
    w.set_initial_state(start.clone());
    w
}

fn run(w: &mut World, seconds: f64) {
    let intervals = (seconds / (w.settings().control_interval_ns as f64 * 1e-9)).round() as usize;
    (0..intervals).for_each(|_| w.advance());
}

/// sn, cn, dn of u with modulus k, by the arithmetic–geometric mean (Abramowitz and Stegun 16.4).
fn jacobi(u: f64, k: f64) -> [f64; 3] {
    let (mut a, mut g, mut c) = (vec![1.0_f64], (1.0 - k * k).sqrt(), vec![k]);
    while c[c.len() - 1].abs() > 1e-15 && a.len() < 20 {
        let last = a[a.len() - 1];
        c.push(0.5 * (last - g));
        a.push(0.5 * (last + g));
        g = (last * g).sqrt();
    }
    let n = a.len() - 1;
    let mut phi = f64::from(1u32 << n) * a[n] * u;
    for j in (1..=n).rev() {
        phi = 0.5 * (phi + (c[j] / a[j] * phi.sin()).asin());
    }
    [phi.sin(), phi.cos(), (1.0 - (k * phi.sin()).powi(2)).sqrt()]
}

/// A free body that turns about no principal axis: ω(t) in Jacobi's functions (Landau, Lifshitz: Mechanics, §37). Its equilibria are
/// passed again and again without errors that grow faster than linearly times e; 2 s.
#[test]
fn a_torque_free_body() {
    let mut m = tree(&[JointType::Floating], true, 1);
    let i = [0.01, 0.02, 0.028];
    let b = &mut m.bodies[1];
    (b.mass, b.mc, b.inertia) = (1.0, V3::default(), Default::default());
    (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (i[0], i[1], i[2]);
    m.effects.gravity = false;
    let (w1, w3) = (4.0, 8.0);
    let mut start = State::initial(&m);
    (start.v[0], start.v[2]) = (w1, w3);
    let energy = i[0] * w1 * w1 + i[2] * w3 * w3;
    let momentum = (i[0] * w1).powi(2) + (i[2] * w3).powi(2);
    assert!(momentum > energy * i[1]);
    let rate = ((i[2] - i[1]) * (momentum - energy * i[0]) / (i[0] * i[1] * i[2])).sqrt();
    let modulus = (i[1] - i[0]) * (energy * i[2] - momentum) / ((i[2] - i[1]) * (momentum - energy * i[0]));
    let side = ((energy * i[2] - momentum) / (i[1] * (i[2] - i[1]))).sqrt();
    for (interval, accuracy) in [(1e-3, 1e-10), (1e-2, 1e-12), (0.1, 1e-8), (1.0, 1e-11)] {
        let mut w = world(&m, settings(interval, accuracy), &start);
        run(&mut w, 2.0);
        let [sn, cn, dn] = jacobi(rate * 2.0, modulus.sqrt());
        let v = &w.state().v;
        // ω̇₂ = (I₃ − I₁) ω₃ ω₁ / I₂ > 0 at the start.
        let error = (v[0] - w1 * cn).abs().max((v[1] - side * sn).abs()).max((v[2] - w3 * dn).abs());
        // Speeds of 8: (1 + 8) per second; a phase that is wrong goes on: (1 + rate t) times.
        let allowed = accuracy * 2.0 * 9.0 * (1.0 + rate * 2.0) + 1e-12;
        assert!(error <= allowed, "{interval} {accuracy}: {error:e} of {allowed:e}");
        assert_eq!(w.stats().fallback_steps, 0);
    }
}

/// A physical pendulum about a horizontal axis, its centre of mass below the axis at angle 0.
fn pendulum() -> Model {
    let mut m = tree(&[JointType::Revolute], true, 1);
    let b = &mut m.bodies[1];
    b.tree_r.r = [V3::new(0.0, -1.0, 0.0), V3::new(0.0, 0.0, 1.0), V3::new(-1.0, 0.0, 0.0)];
    (b.mass, b.mc) = (2.0, V3::new(1.0, 0.0, 0.0));
    b.inertia = Default::default();
    (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (0.01, 0.51, 0.51);
    m
}

/// From rest at 3 rad: θ = 2 asin(k cn/dn).
#[test]
fn a_pendulum_of_large_amplitude() {
    let m = pendulum();
    let (amplitude, pace) = (3.0_f64, (9.80665 / 0.51_f64).sqrt());
    let mut start = State::initial(&m);
    start.set_axis(&m, 0, amplitude, 0.0);
    for (interval, accuracy) in [(1e-3, 1e-11), (0.05, 1e-9), (1.0, 1e-7)] {
        let mut w = world(&m, settings(interval, accuracy), &start);
        run(&mut w, 2.0);
        let k = (0.5 * amplitude).sin();
        let [_, cn, dn] = jacobi(pace * 2.0, k);
        let (exact, error) = (2.0 * (k * cn / dn).asin(), w.state().q[0]);
        // Near the upright an error grows like cosh(pace t) for half of the 2 s, when it is seen as one of speed of up to 2 pace.
        let allowed = accuracy * 2.0 * 12.0 * pace.cosh();
        assert!((error - exact).abs() <= allowed, "{interval} {accuracy}: {error} {exact}");
    }
}

/// The error after a second is at most what errors of the given accuracy make of it that enter at any time: accuracy times 1 and the
/// greatest coordinate, times what the system makes of a small difference in each coordinate.
#[test]
fn the_error_follows_the_accuracy() {
    let m = tree(&[JointType::Revolute; 5], true, 11);
    let (q, v) = state(&m, &mut Random(0), 0.7);
    let start = State { q, v, angles: vec![] };
    let end = |start: &State, interval: f64, accuracy: f64| {
        let mut w = world(&m, settings(interval, accuracy), start);
        run(&mut w, 1.0);
        w.state().clone()
    };
    let distance = |a: &State, b: &State| {
        a.q.iter().chain(&a.v).zip(b.q.iter().chain(&b.v)).fold(0.0_f64, |worst, (x, y)| worst.max((x - y).abs()))
    };
    let exact = end(&start, 0.01, 1e-13);
    let mut growth = 0.0;
    for k in 0..10 {
        let mut other = start.clone();
        *if k < 5 { &mut other.q[k] } else { &mut other.v[k - 5] } += 1e-7;
        growth += distance(&end(&other, 0.01, 1e-13), &exact) / 1e-7;
    }
    let size = exact.q.iter().chain(&exact.v).fold(0.0_f64, |worst, x| worst.max(x.abs()));
    let mut errors = vec![];
    for interval in [0.001, 0.01, 0.1] {
        for accuracy in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
            let error = distance(&end(&start, interval, accuracy), &exact);
            let allowed = (accuracy + 1e-13) * (1.0 + 3.0 * size) * growth;
            println!("{interval} {accuracy:e}: {error:e} of {allowed:e}");
            assert!(error <= allowed, "{interval} {accuracy:e}: {error:e} of {allowed:e}");
            errors.push(error);
        }
    }
    // It is not all the same what is asked for: where the pieces are chosen by it (0.1 s), the error falls.
    assert!(errors[10] > 1e3 * errors[14], "{errors:?}");
}

/// Two wheels on one vertical axis, the second on the first.
fn wheels(friction: f64, limit: f64) -> Model {
    let mut m = tree(&[JointType::Revolute; 2], true, 1);
    for b in &mut m.bodies[1..] {
        (b.tree_r, b.tree_p) = (M3::identity(), V3::default());
        (b.mass, b.mc, b.inertia) = (1.0, V3::default(), Default::default());
        (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (0.3, 0.3, 0.3);
    }
    m.bodies[2].inertia.zz = 0.1;
    m.axes[1].friction = friction;
    m.axes[1].upper = limit;
    m.effects = Effects::called_for(&m);
    m
}

/// The inner wheel runs into its stop on the outer one: from then on they turn together, with the angular momentum that there is.
/// The time of the hit is right to the piece that contains it, and the impact takes one more.
#[test]
fn a_stop_hit_inside_a_step() {
    let m = wheels(0.0, 1.0);
    let (outer, inner) = (0.5, 3.0);
    let hit = 1.0 / inner;
    let together = outer + inner * 0.1 / 0.4;
    for interval in [1e-3, 1e-2, 0.1] {
        for accuracy in [1e-4_f64, 1e-6, 1e-9, 1e-12] {
            let mut start = State::initial(&m);
            start.set_axis(&m, 0, 0.0, outer);
            start.set_axis(&m, 1, 0.0, inner);
            let mut w = world(&m, settings(interval, accuracy), &start);
            run(&mut w, 2.0);
            let [(q0, v0), (q1, v1)] = [0, 1].map(|axis| w.state().axis(&m, axis));
            let exact = outer * hit + together * (2.0 - hit);
            // Until the stop holds it the outer wheel may have its old speed or the other one's; and the steps' rounding.
            let allowed = 4.0 * accuracy.max(SHORTEST).min(interval / 64.0) * inner + 1e-12;
            assert!((q0 - exact).abs() <= allowed, "{interval} {accuracy}: {:e} of {allowed:e}", q0 - exact);
            assert!((q1 - 1.0).abs() <= 1e-14 && v1 == 0.0, "{interval} {accuracy}: {q1} {v1}");
            assert!((v0 - together).abs() <= 1e-10, "{interval} {accuracy}: {v0}");
            let work = w.work();
            let lost = 0.5 * (0.3 * outer * outer + 0.1 * (outer + inner).powi(2) - 0.4 * together * together);
            assert!((work.losses - lost).abs() <= 1e-4 * lost, "{} {lost}", work.losses);
            assert_eq!(w.stats().fallback_steps, 0);
        }
    }
}

/// Dry friction between the wheels brings them together and then holds: closed form, and books that balance.
#[test]
fn friction_ends_inside_a_step() {
    let (friction, outer, inner) = (0.15, -0.2, 2.0);
    let m = wheels(friction, f64::INFINITY);
    for interval in [1e-3, 1e-2, 0.1] {
        for accuracy in [1e-5_f64, 1e-9, 1e-12] {
            let mut start = State::initial(&m);
            start.set_axis(&m, 0, 0.0, outer);
            start.set_axis(&m, 1, 0.0, inner);
            let mut w = world(&m, settings(interval, accuracy), &start);
            let energy = w.energy().kinetic;
            run(&mut w, 2.0);
            // The outer one gains friction / 0.3, the inner one loses friction / 0.1.
            let slowing = friction / 0.3 + friction / 0.1;
            let [(q0, v0), (q1, v1)] = [0, 1].map(|axis| w.state().axis(&m, axis));
            let stands = inner / slowing;
            let gained = friction / 0.3 * stands;
            let exact = (outer * 2.0 + gained * (2.0 - 0.5 * stands), 0.5 * inner * stands);
            let allowed = 4.0 * accuracy.max(SHORTEST).min(interval / 64.0) * inner + 2.0 * accuracy * 3.0 + 1e-12;
            assert!((q0 - exact.0).abs() <= allowed, "{interval} {accuracy}: {:e}", q0 - exact.0);
            assert!((q1 - exact.1).abs() <= allowed && v1 == 0.0, "{interval} {accuracy}: {:e} {v1}", q1 - exact.1);
            assert!((v0 - outer - gained).abs() <= allowed, "{interval} {accuracy}: {v0}");
            let gone = energy - w.energy().kinetic - w.work().losses;
            assert!(gone.abs() <= allowed, "{interval} {accuracy}: {gone:e}");
            assert_eq!(w.stats().fallback_steps, 0);
        }
    }
}

/// A servo on its way is not smooth: those steps are the default's, and are counted; once it stands nothing is.
#[test]
fn a_servo_on_its_way_is_counted() {
    let mut m = pendulum();
    m.axes[0].drive = DriveLimits { max_torque: 40.0, ..DriveLimits::default() };
    let mut w = world(&m, settings(1e-3, 1e-9), &State::initial(&m));
    w.set_commands(&[AxisCommand::servo(0.5)]).unwrap();
    run(&mut w, 2.0);
    let counted = w.stats().fallback_steps;
    assert!(counted > 0);
    assert!((w.state().q[0] - 0.5).abs() <= 1e-9 && w.state().v[0] == 0.0);
    run(&mut w, 0.1);
    assert_eq!(w.stats().fallback_steps, counted);
}

/// Random trees with every law, under commands that change all the time: finite, and a copy goes on with the same bits.
#[test]
fn copies_go_on_with_the_same_bits() {
    for seed in 0..8 {
        let mut rng = Random(seed);
        let joints: Vec<JointType> = (0..7).map(|i| ALL[(i * 2 + seed as usize) % 5]).collect();
        let mut m = tree(&joints, seed % 2 == 0, seed);
        for a in &mut m.axes {
            (a.friction, a.damping) = (rng.unit().abs() * 3.0, rng.unit().abs());
            (a.lower, a.upper) = (-0.2 - rng.unit().abs(), 0.2 + rng.unit().abs());
            (a.drive.max_torque, a.drive.max_speed) = (rng.unit().abs() * 100.0, 5.0);
        }
        m.effects = Effects::called_for(&m);
        let mut w = world(&m, settings(0.005, 1e-8), &State::initial(&m));
        let mut commands = w.commands().to_vec();
        let mut copy = w.clone();
        for step in 0..120 {
            let axis = step % commands.len().max(1);
            if let Some(command) = commands.get_mut(axis) {
                *command = match rng.next() % 4 {
                    0 => AxisCommand::IDLE,
                    1 => AxisCommand::torque(rng.unit() * 30.0),
                    2 => AxisCommand::torque(f64::NAN),
                    _ => AxisCommand::servo(rng.unit()),
                };
            }
            if step == 60 {
                copy = w.clone();
            }
            w.set_commands(&commands).unwrap();
            w.advance();
            if step >= 60 {
                copy.set_commands(&commands).unwrap();
                copy.advance();
            }
        }
        assert_eq!((w.state(), w.work(), w.stats()), (copy.state(), copy.work(), copy.stats()), "{seed}");
        assert!(w.state().q.iter().chain(&w.state().v).all(|x| x.is_finite()), "{seed}");
        assert_eq!(w.stats().diverged_steps, 0, "{seed}");
    }
}

/// The estimate of a run's error, and of an interval's, is the error against a far more accurate run, for each integrator.
#[test]
fn estimates_are_the_errors() {
    let m = tree(&[JointType::Revolute; 3], true, 11);
    let (q, v) = state(&m, &mut Random(0), 0.7);
    let start = State { q, v, angles: vec![] };
    for (name, integrator) in Integrator::NAMES {
        let interval = if integrator == Integrator::Extrapolation { 0.1 } else { 0.002 };
        let s = Settings { integrator, accuracy: 1e-4, ..settings(interval, 1e-13) };
        let (mut w, mut exact) = (world(&m, s, &start), world(&m, settings(interval, 1e-13), &start));
        let mut finer = w.finer();
        let mut local = LocalEstimate::default();
        let steps = (0.4 / interval).round() as usize;
        for step in 0..steps {
            local.begin(&w);
            [&mut w, &mut exact, &mut finer].into_iter().for_each(World::advance);
            let (interval, whole) = (local.end(&w), w.error_by(&finer));
            if step == 0 {
                assert_eq!(interval, whole, "{name}: the first interval is the whole run");
            }
            if step + 1 < steps {
                continue;
            }
            let (a, b) = (w.state(), exact.state());
            let far = |x: &[f64], y: &[f64]| x.iter().zip(y).fold(0.0_f64, |far, (x, y)| far.max((x - y).abs()));
            let ratios = [whole.position.size / far(&a.q, &b.q), whole.speed.size / far(&a.v, &b.v)];
            println!("{name}: {whole:?} {ratios:?}");
            // The next order of the error is h times as large, with factors of some 1/s; and the method of variable order has no
            // fixed one, but its finer run is far nearer.
            assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() <= 0.1), "{name}: {ratios:?}");
        }
    }
}
