//! Stops (J-13 limits, J-18 stop ERP and stop CFM): hit at any speed with any step, pushed into by a motor, soft.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::engine::State;
use realnoid::math::{M3, V3};
use realnoid::model::{DriveLimits, Effects, JointType, Model, Softness};
use realnoid::world::{AxisCommand, Integrator, Settings, World};
use std::sync::Arc;
use support::{Random, state, tree};

const J: f64 = 0.5;

/// A fly-wheel on a vertical axis between stops at ±1 rad.
fn wheel(stop: Softness) -> Model {
    let mut m = tree(&[JointType::Revolute], true, 1);
    let b = &mut m.bodies[1];
    b.tree_r = M3::identity();
    (b.mass, b.mc, b.inertia) = (1.0, V3::default(), Default::default());
    (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (J, J, J);
    (m.axes[0].lower, m.axes[0].upper, m.axes[0].stop) = (-1.0, 1.0, stop);
    m.effects = Effects::called_for(&m);
    m
}

const HARD: Softness = Softness { erp: 0.2, cfm: 0.0 };

fn world(m: &Model, h: f64, integrator: Integrator) -> World {
    let settings = Settings {
        control_interval_ns: (h * 1e9).round() as i64,
        steps_per_interval: 1,
        integrator,
        ..Settings::default()
    };
    World::new(Arc::new(m.clone()), settings).unwrap()
}

fn start(w: &mut World, q: f64, v: f64) {
    let m = w.model().clone();
    let mut s = State::initial(&m);
    s.set_axis(&m, 0, q, v);
    w.set_initial_state(s);
}

fn total(w: &World) -> f64 {
    let e = w.energy();
    e.kinetic + e.potential
}

const STEPS: [f64; 5] = [0.01, 0.003, 0.001, 0.0003, 0.0001];

/// It rests at the stop, has gone no farther than the stop by more than rounding (so it falls with h² for any h), and its
/// energy never grows.
#[test]
fn a_stop_hit_at_speed() {
    for (_, integrator) in Integrator::NAMES {
        for h in STEPS {
            for speed in [1.0, 10.0, 100.0, -1.0, -10.0, -100.0] {
                let mut w = world(&wheel(HARD), h, integrator);
                start(&mut w, 0.1, speed);
                let mut energy = total(&w);
                for _ in 0..(2.0 / h) as usize {
                    w.advance();
                    let (q, _) = w.state().axis(w.model(), 0);
                    assert!(q.abs() <= 1.0 + 1e-14, "{integrator:?} {h} {speed}: {q}");
                    assert!(total(&w) <= energy, "{integrator:?} {h} {speed}: energy grows");
                    energy = total(&w);
                }
                let (q, v) = w.state().axis(w.model(), 0);
                assert!((q - speed.signum()).abs() <= 1e-14 && v == 0.0, "{integrator:?} {h} {speed}: {q} {v}");
            }
        }
    }
}

/// A motor that pushes into its stop: no jitter, and its torque is shown in full.
#[test]
fn a_motor_pushes_into_the_stop() {
    for h in STEPS {
        let mut m = wheel(HARD);
        m.axes[0].drive = DriveLimits { max_torque: 20.0, ..DriveLimits::default() };
        for command in [AxisCommand::torque(20.0), AxisCommand::servo(3.0)] {
            let mut w = world(&m, h, Integrator::default());
            w.set_commands(&[command]).unwrap();
            let mut shot = w.new_snapshot();
            for k in 0..(3.0 / h) as usize {
                w.advance();
                w.write_snapshot(&mut shot);
                if k as f64 * h > 2.0 {
                    assert!((shot.position[0] - 1.0).abs() <= 1e-14 && shot.velocity[0].abs() <= 1e-12);
                    assert!((shot.effort[0] - 20.0).abs() <= 1e-9, "{:?} {}", command, shot.effort[0]);
                }
            }
        }
    }
}

/// Outside its range an axis comes back by the ERP's share of the way in every step, (1 − ERP)ⁿ, and gets no speed from that.
#[test]
fn a_penetrated_stop_is_left_by_its_erp() {
    for erp in [0.2, 0.5, 1.0] {
        let mut w = world(&wheel(Softness { erp, cfm: 0.0 }), 0.001, Integrator::default());
        start(&mut w, 1.1, 0.0);
        for n in 1..20 {
            w.advance();
            let (q, v) = w.state().axis(w.model(), 0);
            assert!((q - 1.0 - 0.1 * (1.0 - erp).powi(n)).abs() <= 1e-12 && v == 0.0, "{erp} {n} {q}");
        }
    }
}

/// A soft stop is implicit Euler on the spring k and damper d of ERP = hk/(hk + d), CFM = 1/(hk + d).
#[test]
fn a_soft_stop_is_a_spring_and_a_damper() {
    for integrator in [Integrator::ImplicitMidpoint, Integrator::SemiImplicitEuler] {
        for (k, d, h) in [(1e4, 20.0, 0.001), (1e6, 100.0, 0.001), (1e3, 0.0, 0.01), (1e9, 1e3, 0.01)] {
            let soft = Softness { erp: h * k / (h * k + d), cfm: 1.0 / (h * k + d) };
            let mut w = world(&wheel(soft), h, integrator);
            start(&mut w, 1.0, 5.0);
            let (mut x, mut v, mut farthest) = (0.0, 5.0, 0.0_f64);
            for _ in 0..1000 {
                w.advance();
                v = (J * v - h * k * x) / (J + h * (d + h * k));
                x += h * v;
                // Leaving it, the spring would pull: a stop does not.
                if x < 0.0 || k * x + d * v < 0.0 {
                    break;
                }
                let (q, speed) = w.state().axis(w.model(), 0);
                farthest = farthest.max(q - 1.0);
                let scale = 1e-9 * (1.0 + 5.0 / (k / J).sqrt());
                assert!(
                    (q - 1.0 - x).abs() <= scale && (speed - v).abs() <= 1e-9 * 5.0 + 1e-12 * k.sqrt(),
                    "{k} {d} {h}"
                );
            }
            assert!(farthest > 0.0);
        }
    }
}

/// At rest a soft stop gives way by exactly torque / k.
#[test]
fn a_soft_stop_under_load() {
    let (k, d, h, load) = (5e3, 400.0, 0.002, 30.0);
    let mut w = world(&wheel(Softness { erp: h * k / (h * k + d), cfm: 1.0 / (h * k + d) }), h, Integrator::default());
    w.set_commands(&[AxisCommand::torque(load)]).unwrap();
    (0..5000).for_each(|_| w.advance());
    let (q, v) = w.state().axis(w.model(), 0);
    assert!((q - 1.0 - load / k).abs() <= 1e-12 && v.abs() <= 1e-9, "{q} {v}");
}

/// A passive chain thrown against its stops: inside all of them at every step, and its energy grows by no more than the
/// midpoint rule's own error, which falls with h².
#[test]
fn a_chain_against_its_stops() {
    let gains: Vec<f64> = [0.002, 0.001, 0.0005].into_iter().map(gain_of_a_chain).collect();
    println!("{gains:?}");
    assert!(gains[2] <= 0.5 * gains[0] + 1e-9, "{gains:?}");
}

/// Largest gain of energy over the lowest value before, J, over twelve chains.
fn gain_of_a_chain(h: f64) -> f64 {
    let mut worst = 0.0_f64;
    for seed in 0..12 {
        let mut m = tree(&[JointType::Revolute; 6], true, seed);
        for a in &mut m.axes {
            (a.lower, a.upper) = (-0.4, 0.5);
        }
        m.effects = Effects::called_for(&m);
        let (_, v) = state(&m, &mut Random(seed), 8.0);
        let mut w = world(&m, h, Integrator::default());
        w.set_initial_state(State { q: vec![0.05; m.nq], v, angles: vec![] });
        let mut lowest = total(&w);
        for _ in 0..(2.0 / h) as usize {
            w.advance();
            worst = worst.max(total(&w) - lowest);
            lowest = lowest.min(total(&w));
            assert!(w.state().q.iter().all(|q| (-0.4 - 1e-12..=0.5 + 1e-12).contains(q)), "{:?}", w.state().q);
        }
        assert_eq!((w.stats().diverged_steps, w.stats().unsettled_steps), (0, 0));
    }
    worst
}
