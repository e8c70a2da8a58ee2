//! The engine: order of the integrators, conservation, stops, friction, servos, bits and memory.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::engine::State;
use realnoid::math::V3;
use realnoid::model::{JointType, Model};
use realnoid::world::{AxisCommand, Integrator, Settings, World};
use std::sync::Arc;
use support::{ALL, Random, state, tree};

fn settings(integrator: Integrator, interval: f64, steps: u32) -> Settings {
    Settings {
        integrator,
        control_interval_ns: (interval * 1e9) as i64,
        steps_per_interval: steps,
        ..Settings::default()
    }
}

fn world(m: &Model, s: Settings) -> World {
    World::new(Arc::new(m.clone()), s).unwrap()
}

fn run(w: &mut World, seconds: f64) {
    let intervals = (seconds / (w.settings().control_interval_ns as f64 * 1e-9)).round() as usize;
    for _ in 0..intervals {
        w.advance();
    }
}

/// One axis: a point-like pendulum about a horizontal line, centre of mass below the axis at angle 0.
fn pendulum() -> Model {
    let mut m = tree(&[JointType::Revolute], true, 1);
    let b = &mut m.bodies[1];
    // Joint z along world y, body x downwards: rows are world x, y, z in body coordinates.
    b.tree_r.r = [V3::new(0.0, 1.0, 0.0), V3::new(0.0, 0.0, 1.0), V3::new(-1.0, 0.0, 0.0)];
    b.tree_r.r[0] = V3::new(0.0, -1.0, 0.0);
    (b.mass, b.mc) = (2.0, V3::new(1.0, 0.0, 0.0));
    b.inertia = Default::default();
    (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (0.01, 0.51, 0.51);
    m
}

fn error_after_one_second(m: &Model, start: &State, integrator: Integrator, steps: u32, reference: &State) -> f64 {
    let end = state_after(m, start, integrator, steps);
    let d = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>();
    (d(&end.q, &reference.q) + d(&end.v, &reference.v)).sqrt()
}

fn state_after(m: &Model, start: &State, integrator: Integrator, steps: u32) -> State {
    let mut w = world(m, settings(integrator, 0.01, steps));
    w.set_initial_state(start.clone());
    run(&mut w, 1.0);
    w.state().clone()
}

fn slope(errors: &[f64]) -> f64 {
    let n = errors.len() as f64;
    let points: Vec<(f64, f64)> = errors.iter().enumerate().map(|(k, e)| (-(k as f64), e.log2())).collect();
    let (mx, my) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (sxy, sxx) =
        points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + (x - mx) * (y - my), b + (x - mx) * (x - mx)));
    sxy / sxx
}

fn chains() -> Vec<(Model, State)> {
    let mut mixed = vec![JointType::Spherical, JointType::Revolute, JointType::Universal, JointType::Revolute];
    let hinges = tree(&[JointType::Revolute; 5], true, 11);
    let mixed_fixed = tree(&mixed, true, 12);
    mixed.insert(0, JointType::Floating);
    let mixed_free = tree(&mixed, true, 13);
    [hinges, mixed_fixed, mixed_free]
        .into_iter()
        .enumerate()
        .map(|(k, m)| {
            let (q, v) = state(&m, &mut Random(k as u64), if k == 2 { 5.0 } else { 0.7 });
            let s = State { q, v, angles: vec![] };
            (m, s)
        })
        .collect()
}

/// The state error of an undriven chain after 1 s against a 64 × finer run falls with the method's order.
#[test]
fn orders_of_the_integrators() {
    for (n, (m, start)) in chains().iter().enumerate() {
        for (integrator, base, low, high) in
            [(Integrator::Rk4, if n == 2 { 1 } else { 2 }, 3.9, 4.5), (Integrator::SemiImplicitEuler, 20, 0.9, 1.1)]
        {
            let reference = state_after(m, start, Integrator::Rk4, 64 * base.min(8));
            let errors: Vec<f64> =
                (0..4).map(|k| error_after_one_second(m, start, integrator, base << k, &reference)).collect();
            let order = slope(&errors);
            println!("chain {n} {integrator:?}: errors {errors:?} order {order:.3}");
            assert!(order >= low && order <= high, "chain {n} {integrator:?}: {errors:?} order {order}");
        }
    }
}

/// Axes that stand still (in their friction, on their stop) do not cost RK4 its order: no step falls back.
#[test]
fn standing_axes_keep_the_order() {
    let joints = [JointType::Spherical, JointType::Revolute, JointType::Universal, JointType::Revolute];
    let mut m = tree(&joints, true, 12);
    m.axes[0].friction = 1e3;
    (m.axes[1].lower, m.axes[1].upper) = (0.3, 0.3 + 1e-9);
    (m.effects.friction, m.effects.limits) = (true, true);
    let (q, v) = state(&m, &mut Random(1), 0.7);
    let mut start = State { q, v, angles: vec![] };
    start.set_axis(&m, 0, 0.4, 0.0);
    // A heavy limb leans on this stop during the whole second, in whichever direction it leans.
    start.set_axis(&m, 1, 0.3, 0.0);
    m.axes[1].friction = 1e3;
    let end = |steps: u32| {
        let mut w = world(&m, settings(Integrator::Rk4, 0.01, steps));
        w.set_initial_state(start.clone());
        run(&mut w, 1.0);
        assert_eq!(
            (w.stats().fallback_steps, w.state().axis(&m, 0), w.state().axis(&m, 1)),
            (0, (0.4, 0.0), (0.3, 0.0))
        );
        w.state().clone()
    };
    let reference = end(128);
    let errors: Vec<f64> = (0..4)
        .map(|k| {
            let s = end(2 << k);
            let d = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>();
            (d(&s.q, &reference.q) + d(&s.v, &reference.v)).sqrt()
        })
        .collect();
    assert!(slope(&errors) >= 3.9, "{errors:?}");
}

/// RK4 at 1 ms keeps the energy of a fixed chain and the momentum of a free one to its truncation error.
#[test]
fn conservation() {
    for (n, (m, start)) in chains().iter().enumerate() {
        let mut s = settings(Integrator::Rk4, 0.001, 1);
        s.gravity = if n == 2 { [0.0; 3] } else { s.gravity };
        let mut w = world(m, s);
        w.set_initial_state(start.clone());
        let (e0, p0) = (w.energy(), w.momentum());
        run(&mut w, 1.0);
        let (e1, p1) = (w.energy(), w.momentum());
        let drift = (e1.kinetic + e1.potential - e0.kinetic - e0.potential).abs();
        assert!(drift <= 1e-6 * e0.kinetic.max(1.0), "chain {n}: energy drift {drift}");
        if n == 2 {
            assert!((p1.linear - p0.linear).norm() <= 1e-8 * p0.linear.norm());
            assert!((p1.angular - p0.angular).norm() <= 1e-7 * p0.angular.norm());
        }
    }
}

#[test]
fn the_same_run_twice_and_a_copy_give_the_same_bits() {
    let joints: Vec<JointType> = (0..15).map(|i| ALL[i % 5]).collect();
    let mut m = tree(&joints, false, 3);
    for a in &mut m.axes {
        (a.friction, a.damping, a.lower, a.upper) = (0.3, 0.1, -0.5, 0.4);
    }
    m.effects = realnoid::model::Effects::called_for(&m);
    let commands: Vec<AxisCommand> = (0..m.axes.len())
        .map(|i| if i % 2 == 0 { AxisCommand::servo(0.2) } else { AxisCommand::torque(3.0) })
        .collect();
    let mut a = world(&m, Settings::default());
    let mut b = world(&m, Settings::default());
    for w in [&mut a, &mut b] {
        w.set_commands(&commands).unwrap();
        run(w, 0.2);
    }
    assert_eq!(a.state(), b.state());
    let mut c = a.clone();
    run(&mut a, 0.2);
    run(&mut c, 0.2);
    assert_eq!(a.state(), c.state());
    assert!(a.state().q.iter().all(|x| x.is_finite()));
}

/// A pendulum that falls into a stop rests there: at the stop to rounding, with no speed, and never gains energy.
#[test]
fn a_stop_holds() {
    let mut m = pendulum();
    (m.axes[0].lower, m.axes[0].upper) = (0.3, 2.0);
    m.effects.limits = true;
    for (interval, speed) in [(0.01, 100.0), (0.01, 1.0), (0.001, 10.0), (0.0001, 100.0)] {
        let mut w = world(&m, settings(Integrator::SemiImplicitEuler, interval, 1));
        let mut s = State::initial(&m);
        s.set_axis(&m, 0, 1.0, speed);
        w.set_initial_state(s);
        let mut worst: f64 = 0.0;
        for _ in 0..(5.0 / interval) as usize {
            w.advance();
            let (q, _) = w.state().axis(&m, 0);
            worst = worst.max(0.3 - q).max(q - 2.0);
        }
        let (q, v) = w.state().axis(&m, 0);
        assert!(worst <= 1e-12, "penetration {worst} at {interval} s, {speed} rad/s");
        assert!((q - 0.3).abs() <= 1e-12 && v.abs() <= 1e-9, "rests at {q} with {v}");
    }
}

/// Below its friction an axis stays exactly where it is; above, it moves with the difference.
#[test]
fn dry_friction_sticks_exactly() {
    let mut m = pendulum();
    m.axes[0].friction = 2.0;
    m.effects.friction = true;
    m.effects.gravity = false;
    let mut w = world(&m, settings(Integrator::SemiImplicitEuler, 0.001, 1));
    w.set_commands(&[AxisCommand::torque(1.999)]).unwrap();
    run(&mut w, 10.0);
    assert_eq!(w.state().axis(&m, 0), (0.0, 0.0));
    w.set_commands(&[AxisCommand::torque(2.51)]).unwrap();
    run(&mut w, 1.0);
    let (q, v) = w.state().axis(&m, 0);
    // a = (2.51 − 2) / 0.51 = 1: v = 1; semi-implicit Euler overshoots t²/2 by h t / 2.
    assert!((v - 1.0).abs() <= 1e-9 && (q - 0.5 - 0.0005).abs() <= 1e-9, "{q} {v}");
    w.set_commands(&[AxisCommand::IDLE]).unwrap();
    run(&mut w, 1.0);
    assert_eq!(w.state().axis(&m, 0).1, 0.0);
}

/// A servo holds its target against gravity exactly if its torque suffices, at any step; the effort it reports is the
/// weight's torque. If the torque does not suffice it gives what it has.
#[test]
fn servos_hold_and_saturate() {
    let mut m = pendulum();
    m.axes[0].drive.max_torque = 30.0;
    for interval in [0.01, 0.001] {
        let mut w = world(&m, settings(Integrator::SemiImplicitEuler, interval, 1));
        w.set_commands(&[AxisCommand::servo(0.8)]).unwrap();
        run(&mut w, 3.0);
        let (q, v) = w.state().axis(&m, 0);
        assert!((q - 0.8).abs() <= 1e-9 && v.abs() <= 1e-8, "{q} {v}");
        let weight = 9.80665 * 0.8f64.sin();
        let mut shot = w.new_snapshot();
        w.write_snapshot(&mut shot);
        assert!((shot.effort[0] - weight).abs() <= 1e-6, "{} {weight}", shot.effort[0]);
        w.set_commands(&[AxisCommand { torque: 2.0, ..AxisCommand::servo(0.8) }]).unwrap();
        let mut lowest = f64::INFINITY;
        for _ in 0..(3.0 / interval) as usize {
            w.advance();
            w.write_snapshot(&mut shot);
            assert!(shot.effort[0].abs() <= 2.0 + 1e-12);
            lowest = shot.position[0].min(lowest);
        }
        // 2 N·m hold the weight at 0.205 rad: from 0.8 rad it must fall well past that.
        assert!(lowest < 0.2);
    }
}

/// A servo that nothing bounds (a URDF without effort) holds from any state, and a stop still stops it.
#[test]
fn an_unbounded_servo() {
    let mut m = pendulum();
    (m.axes[0].lower, m.axes[0].upper, m.axes[0].friction) = (-0.5, 1.2, 0.5);
    (m.effects.limits, m.effects.friction) = (true, true);
    for (start, speed, target, end) in
        [(1.0, 30.0, 0.3, 0.3), (0.0, -30.0, 0.3, 0.3), (0.5, 5.0, 2.0, 1.2), (0.0, 0.0, -3.0, -0.5)]
    {
        let mut w = world(&m, settings(Integrator::SemiImplicitEuler, 0.001, 1));
        let mut s = State::initial(&m);
        s.set_axis(&m, 0, start, speed);
        w.set_initial_state(s);
        w.set_commands(&[AxisCommand::servo(target)]).unwrap();
        run(&mut w, 2.0);
        let (q, v) = w.state().axis(&m, 0);
        assert!((q - end).abs() <= 1e-9 && v.abs() <= 1e-9, "{start} {speed} {target}: {q} {v}");
        let mut shot = w.new_snapshot();
        w.write_snapshot(&mut shot);
        assert!(shot.effort[0].is_finite());
    }
}

/// Spin-up along the torque–speed line: ω = ω0 (1 − exp(−t/τ)), with τ = I ω0 / T.
#[test]
fn torque_speed_line() {
    let mut m = pendulum();
    m.effects.gravity = false;
    m.axes[0].drive.no_load_speed = 4.0;
    let tau: f64 = 0.51 * 4.0 / 2.0;
    for interval in [0.01, 0.001] {
        let mut w = world(&m, settings(Integrator::SemiImplicitEuler, interval, 1));
        w.set_commands(&[AxisCommand::torque(2.0)]).unwrap();
        run(&mut w, 1.0);
        let exact = 4.0 * (1.0 - (-1.0 / tau).exp());
        let (_, v) = w.state().axis(&m, 0);
        // Implicit Euler's error at t: about ω0 exp(−t/τ) t h / (2 τ²).
        let bound = 4.0 * (-1.0 / tau).exp() * interval / (2.0 * tau * tau) * 1.5;
        assert!((v - exact).abs() <= bound, "{v} {exact} {bound}");
    }
}

/// Huge damping, huge torques, huge mass ratios at a large step: finite.
#[test]
fn stiff_and_extreme_stays_finite() {
    let mut m = tree(&[JointType::Revolute; 8], true, 21);
    for (k, b) in m.bodies.iter_mut().enumerate() {
        let f = if k % 2 == 0 { 1e-4 } else { 1e4 };
        b.mass *= f;
        b.mc = b.mc * f;
        for i in [
            &mut b.inertia.xx,
            &mut b.inertia.xy,
            &mut b.inertia.xz,
            &mut b.inertia.yy,
            &mut b.inertia.yz,
            &mut b.inertia.zz,
        ] {
            *i *= f;
        }
    }
    for a in &mut m.axes {
        (a.damping, a.lower, a.upper) = (1e6, -1.0, 1.0);
    }
    (m.effects.damping, m.effects.limits) = (true, true);
    let mut w = world(&m, settings(Integrator::SemiImplicitEuler, 0.01, 1));
    w.set_commands(&[AxisCommand::torque(1e6); 8]).unwrap();
    run(&mut w, 5.0);
    assert_eq!(w.stats().diverged_steps, 0);
    assert!(w.state().q.iter().chain(&w.state().v).all(|x| x.abs() < 1e6));
}

/// Random trees with every law at work and commands that change all the time, at a large step: finite, and the axis set
/// settles within the default iterations in all but one step of a hundred, and in all with 200 iterations.
#[test]
fn random_trees_under_random_commands() {
    for (iterations, allowed) in [(10, 0.01), (200, 0.0)] {
        let (unsettled, steps) = shake_random_trees(iterations);
        println!("{iterations} iterations: {unsettled} of {steps} steps unsettled");
        assert!(unsettled as f64 <= allowed * steps as f64);
    }
}

fn shake_random_trees(iterations: u32) -> (u64, u64) {
    let (mut unsettled, mut steps) = (0, 0);
    for seed in 0..40 {
        let mut rng = Random(seed);
        let joints: Vec<JointType> = (0..14).map(|i| ALL[(i * 2 + seed as usize) % 3]).collect();
        let mut m = tree(&joints, seed % 2 == 0, seed);
        for a in &mut m.axes {
            (a.friction, a.damping) = (rng.unit().abs() * 3.0, rng.unit().abs());
            (a.lower, a.upper) = (-0.2 - rng.unit().abs(), 0.2 + rng.unit().abs());
            (a.drive.max_torque, a.drive.max_speed) = (rng.unit().abs() * 100.0, 5.0);
        }
        m.effects = realnoid::model::Effects::called_for(&m);
        let s = Settings { solver_iterations: iterations, ..settings(Integrator::SemiImplicitEuler, 0.005, 1) };
        let mut w = world(&m, s);
        let mut commands = w.commands().to_vec();
        for step in 0..1000 {
            let axis = step % commands.len();
            commands[axis] = match rng.next() % 3 {
                0 => AxisCommand::IDLE,
                1 => AxisCommand::torque(rng.unit() * 30.0),
                _ => AxisCommand::servo(rng.unit()),
            };
            w.set_commands(&commands).unwrap();
            w.advance();
        }
        assert_eq!(w.stats().diverged_steps, 0, "seed {seed}");
        assert!(w.state().q.iter().chain(&w.state().v).all(|x| x.abs() < 1e6), "seed {seed}");
        unsettled += w.stats().unsettled_steps;
        steps += w.stats().steps;
    }
    (unsettled, steps)
}

/// What is not a number, or has no meaning, never reaches the state.
#[test]
fn unsound_commands_are_refused() {
    let m = pendulum();
    let mut w = world(&m, Settings::default());
    let before = format!("{:?}", w.commands());
    let with_speed = |torque, speed| AxisCommand { speed, ..AxisCommand::torque(torque) };
    for bad in [
        AxisCommand::servo(f64::NAN),
        AxisCommand::torque(f64::INFINITY),
        AxisCommand::servo(f64::INFINITY),
        with_speed(1.0, -2.0),
        with_speed(1.0, 0.0),
    ] {
        assert_eq!(w.set_commands(&[bad]), Err(0));
    }
    assert_eq!(format!("{:?}", w.commands()), before);
}

/// Time: the scale stretches it to the nanosecond, 0 stops it.
#[test]
fn time_scale() {
    let m = pendulum();
    let mut w = world(&m, Settings { time_scale: 1.0 / 3.0, ..Settings::default() });
    run(&mut w, 3.0);
    assert!((w.time() - 1.0).abs() <= 1e-9);
    w.set_settings(Settings { time_scale: 0.0, ..Settings::default() }).unwrap();
    let (time, state) = (w.time(), w.state().clone());
    run(&mut w, 1.0);
    assert_eq!((w.time(), w.state()), (time, &state));
    assert!(w.set_settings(Settings { time_scale: 101.0, ..Settings::default() }).unwrap_err().contains("time_scale"));
}

#[test]
fn a_world_goes_back_to_the_pose_that_it_remembers() {
    let m = tree(&ALL, false, 7);
    let mut w = world(&m, settings(Integrator::Rk4, 0.001, 5));
    let (q, v) = state(&m, &mut Random(3), 0.5);
    let start = State { q, v, angles: vec![[0.0; 3]; m.eulers.len()] };
    w.set_initial_state(start.clone());
    run(&mut w, 0.1);
    let there = w.state().clone();
    w.remember();
    run(&mut w, 0.1);
    assert_ne!(w.state().q, there.q, "it has moved on");
    w.reset();
    assert_eq!((&w.state().q, &w.state().angles), (&there.q, &there.angles), "the remembered pose");
    assert_eq!((&w.state().v, w.time()), (&start.v, 0.0), "the velocities at start, and time 0");
}
