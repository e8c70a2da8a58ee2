//! From poses and twists of all bodies back to coordinates.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::dynamics::{Kinematics, kinematics, kinematics_of};
use realnoid::engine::State;
use realnoid::engine::maximal::{Gap, read_state};
use realnoid::math::V3;
use realnoid::model::{Base, JointType, Model};
use support::{ALL, Random, tree};

/// Rounding of a chain of ten bodies, with poses and speeds of order 10.
const ROUNDING: f64 = 1e-12;

fn origin() -> std::sync::Arc<Model> {
    support::urdf::model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Free)
}

/// Random coordinates; quaternions of unit length, angles of groups read from them.
fn random(m: &Model, rng: &mut Random) -> State {
    let mut s = State { q: rng.many(m.nq, 3.0), v: rng.many(m.nv, 5.0), angles: vec![[0.0; 3]; m.eulers.len()] };
    for b in &m.bodies[1..] {
        let at = match b.joint {
            JointType::Spherical => b.q,
            JointType::Floating => b.q + 3,
            _ => continue,
        };
        let norm = s.q[at..at + 4].iter().map(|x| x * x).sum::<f64>().sqrt();
        s.q[at..at + 4].iter_mut().for_each(|x| *x /= norm);
    }
    for (g, angles) in m.eulers.iter().zip(&mut s.angles) {
        let r = realnoid::model::rotation([s.q[g.q], s.q[g.q + 1], s.q[g.q + 2], s.q[g.q + 3]]);
        *angles = g.angles(&r, *angles);
    }
    s
}

fn worst(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// The state, forgotten by a little, and read again.
fn there_and_back(m: &Model, s: &State, rng: &mut Random) -> (f64, Gap) {
    let mut k = Kinematics::new(m);
    kinematics(m, &mut k, &s.q, &s.v);
    let mut read = s.clone();
    read.q.iter_mut().for_each(|q| *q += 0.3 * rng.unit());
    read.v.fill(0.0);
    read.angles.iter_mut().flatten().for_each(|a| *a += 0.3 * rng.unit());
    let gap = read_state(m, &k, &mut read);
    let angles: Vec<f64> =
        read.angles.iter().zip(&s.angles).flat_map(|(a, b)| [0, 1, 2].map(|i| a[i] - b[i])).collect();
    let zeros = vec![0.0; angles.len()];
    (worst(&read.q, &s.q).max(worst(&read.v, &s.v)).max(worst(&angles, &zeros)), gap)
}

#[test]
fn every_joint_there_and_back() {
    let mut rng = Random(7);
    for joint in ALL {
        for seed in 0..50 {
            let m = tree(&[joint, joint, joint], true, seed);
            let s = random(&m, &mut rng);
            let (error, gap) = there_and_back(&m, &s, &mut rng);
            assert!(error < ROUNDING && gap.linear < ROUNDING && gap.angular < ROUNDING, "{joint:?} {error} {gap:?}");
        }
    }
}

#[test]
fn the_humanoid_there_and_back() {
    let (m, mut rng) = (origin(), Random(8));
    for _ in 0..200 {
        // Within the ranges of its angles, where the branch of H, P, B is the one that is looked for.
        let mut s = State::initial(&m);
        for axis in 0..m.axes.len() {
            let (low, high) = (m.axes[axis].lower.max(-1.2), m.axes[axis].upper.min(1.2));
            s.set_axis(&m, axis, low + 0.5 * (1.0 + rng.unit()) * (high - low), 4.0 * rng.unit());
        }
        let (error, gap) = there_and_back(&m, &s, &mut rng);
        assert!(error < ROUNDING && gap.linear < ROUNDING && gap.angular < ROUNDING, "{error} {gap:?}");
    }
}

#[test]
fn angles_go_on_over_many_turns() {
    let m = tree(&[JointType::Revolute, JointType::Universal], true, 3);
    let (mut s, mut k) = (State::initial(&m), Kinematics::new(&m));
    let mut read = s.clone();
    for i in 0..200 {
        let turn = 0.3 * f64::from(i);
        s.q.copy_from_slice(&[turn, -turn, 0.5 * turn]);
        kinematics(&m, &mut k, &s.q, &s.v);
        read_state(&m, &k, &mut read);
        // Rounding of 60 rad.
        assert!(worst(&read.q, &s.q) < 1e-12, "{:?} {:?}", read.q, s.q);
    }
}

#[test]
fn a_gap_is_as_wide_as_it_was_made() {
    for joint in [JointType::Revolute, JointType::Universal, JointType::Spherical] {
        let m = tree(&[joint], true, 5);
        let (s, mut k) = (random(&m, &mut Random(1)), Kinematics::new(&m));
        kinematics(&m, &mut k, &s.q, &s.v);
        k.p[1] += V3::new(3e-4, 0.0, 4e-4);
        let mut read = s.clone();
        let gap = read_state(&m, &k, &mut read);
        assert!((gap.linear - 5e-4).abs() < ROUNDING && gap.angular < ROUNDING, "{joint:?} {gap:?}");
    }
}

#[test]
fn a_body_is_carried_where_kinematics_put_it() {
    let m = tree(&ALL, true, 9);
    let (s, mut k) = (random(&m, &mut Random(2)), Kinematics::new(&m));
    kinematics(&m, &mut k, &s.q, &s.v);
    let mut carried = k.clone();
    for body in 1..m.bodies.len() {
        (carried.p[body], carried.w[body]) = Default::default();
        kinematics_of(&m, &mut carried, (&s.q, &s.v), &[body]);
        assert_eq!((carried.p[body], carried.r[body]), (k.p[body], k.r[body]));
        assert_eq!((carried.w[body], carried.v[body]), (k.w[body], k.v[body]));
    }
}
