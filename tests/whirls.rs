//! What Euler's rule takes for a whirl, and what not: joints may do as they like, velocity products may not.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::dynamics::Workspace;
use realnoid::engine::State;
use realnoid::model::{Base, JointType, Model};
use realnoid::solver::{AxisSet, Driven, StateRef, StepStart};
use realnoid::world::{AxisCommand, Integrator, Settings, World};
use std::sync::Arc;
use support::{ALL, Random, scale, state, tree};

const H: f64 = 1e-3;
const DOWN: [f64; 3] = [0.0, 0.0, -9.80665];

fn humanoid(base: Base) -> Arc<Model> {
    support::urdf::model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), base)
}

/// Torques, servos that may reach the speed that they want in a step and others that may not, and drives at rest.
fn any_commands(m: &Model, rng: &mut Random) -> Vec<AxisCommand> {
    let any = |rng: &mut Random| match rng.next() % 4 {
        0 => AxisCommand::torque(0.0),
        1 => AxisCommand::servo(rng.unit()),
        _ => AxisCommand::torque(50.0 * rng.unit()),
    };
    m.axes.iter().map(|_| any(rng)).collect()
}

/// In one state nothing changes but what the joints do: all of the change of the accelerations is theirs, whatever part of their
/// laws they stand on before and after. Rounding: both are differences of accelerations, found with inertias of condition 1e4.
#[test]
fn what_joints_change_is_found_to_rounding() {
    let mut rng = Random(3);
    let mut models = vec![humanoid(Base::Fixed), humanoid(Base::Free)];
    models.extend((1..6).map(|seed| Arc::new(tree(&ALL, false, seed))));
    let mut moved: f64 = 0.0;
    for m in &models {
        let mut axes = AxisSet::new(m);
        axes.driven = Some(Box::new(Driven::new(m)));
        let mut ws = Workspace::new(m);
        let mut s = State::initial(m);
        for axis in 0..m.axes.len() {
            let (low, high) = (m.axes[axis].lower.max(-1.0), m.axes[axis].upper.min(1.0));
            s.set_axis(m, axis, low + 0.5 * (1.0 + rng.unit()) * (high - low), rng.unit());
        }
        let at = StateRef { q: &s.q, v: &s.v, angles: &s.angles };
        let mut before: Option<Vec<f64>> = None;
        for _ in 0..8 {
            let commands = any_commands(m, &mut rng);
            let start = StepStart { state: at, commands: &commands, h: H, whole: H, mean: false, sweeps: 10 };
            let mut now = vec![0.0; m.nv];
            axes.prepare(m, &start, m.effects);
            axes.settle(m, &mut ws, at, (DOWN, H, 10), &mut now);
            let driven = axes.driven.as_mut().unwrap();
            if let Some(before) = before {
                driven.explain(m, &ws, &s.q);
                let largest = now.iter().chain(&before).fold(0.0, |most: f64, a| most.max(a.abs()));
                for ((now, before), found) in now.iter().zip(&before).zip(driven.change()) {
                    assert!((now - before - found).abs() < 1e-11 * largest, "{}: {now} − {before} ≠ {found}", m.name);
                    moved = moved.max((now - before).abs());
                }
            }
            driven.end_step();
            before = Some(now);
        }
    }
    assert!(moved > 100.0, "{moved}");
}

fn euler(m: Arc<Model>) -> World {
    let settings = Settings {
        control_interval_ns: (H * 1e9) as i64,
        steps_per_interval: 1,
        integrator: Integrator::SemiImplicitEuler,
        ..Settings::default()
    };
    World::new(m, settings).unwrap()
}

/// A torque that flips at every step moves light limbs by more than a tenth of their velocity, and is no whirl.
#[test]
fn torques_that_flip_are_no_whirl() {
    let m = Arc::new(tree(&[JointType::Revolute], true, 1));
    let mut w = euler(m.clone());
    for k in 0..1000 {
        w.set_commands(&[AxisCommand::torque(if k % 2 == 0 { 1e3 } else { -1e3 })]).unwrap();
        w.advance();
    }
    assert_eq!(w.stats().fallback_steps, 0);
}

/// A controller whose torques jump by a tenth of what the drives can in every millisecond: the rule keeps nearly all its steps.
#[test]
fn a_humanoid_under_noisy_torques_keeps_its_steps() {
    let m = humanoid(Base::Fixed);
    let (mut w, mut rng) = (euler(m.clone()), Random(7));
    for _ in 0..1000 {
        let torque = |a: &realnoid::model::Axis, x: f64| AxisCommand::torque(0.1 * a.drive.max_torque * x);
        w.set_commands(&m.axes.iter().map(|a| torque(a, rng.unit())).collect::<Vec<_>>()).unwrap();
        w.advance();
    }
    assert!(w.stats().fallback_steps <= 10, "{}", w.stats().fallback_steps);
}

/// Light links behind heavy ones, with nothing that drives them: steps are given away as before.
#[test]
fn whips_still_whirl() {
    let mut m = tree(&[JointType::Revolute; 6], true, 2);
    for body in 1..m.bodies.len() {
        scale(&mut m, body, 0.1_f64.powi(body as i32));
    }
    let mut w = euler(Arc::new(m.clone()));
    let mut s = State::initial(&m);
    (s.q, s.v) = state(&m, &mut Random(5), 2.0);
    w.set_initial_state(s);
    (0..1000).for_each(|_| w.advance());
    assert!(w.stats().fallback_steps > 0);
}
