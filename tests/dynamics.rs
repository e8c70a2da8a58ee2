//! The dynamics by identity: each algorithm against the others, and against what must be conserved.

mod support;

use realnoid::dynamics::{
    BallLock, DofIn, Kinematics, Workspace, aba, aba_fused, aba_hybrid, coordinate_rates, crba, energy, kinematics,
    momentum, rnea,
};
use realnoid::math::V3;
use realnoid::model::{JointType, Model};
use support::{ALL, Random, state, tree};

const GRAVITY: [f64; 3] = [0.3, -0.2, -9.81];

fn mixed(n: usize, seed: u64) -> Model {
    let joints: Vec<JointType> = (0..n).map(|i| ALL[(i + seed as usize) % 5]).collect();
    tree(&joints, false, seed)
}

fn models() -> Vec<Model> {
    let mut all: Vec<Model> = (0..20).map(|s| mixed(12, s)).collect();
    all.extend(ALL.map(|j| tree(&[j; 6], true, 77)));
    all
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |m, (x, y)| m.max((x - y).abs()))
}

/// ABA ∘ RNEA = identity to 1e-12 of the scale of the forces that act inside: Σ|M_ij q̈_j| plus the bias.
#[test]
fn rnea_undoes_aba() {
    for (n, m) in models().iter().enumerate() {
        let (mut ws, mut rng) = (Workspace::new(m), Random(n as u64));
        for _ in 0..20 {
            let (q, v) = state(m, &mut rng, 2.0);
            let tau = rng.many(m.nv, 5.0);
            let (mut qdd, mut back) = (vec![0.0; m.nv], vec![0.0; m.nv]);
            aba(m, &mut ws, (&q, &v), &tau, GRAVITY, &mut qdd);
            rnea(m, &mut ws, (&q, &v), &qdd, GRAVITY, &mut back);
            let scale = force_scale(m, &mut ws, &q, &qdd);
            assert!(difference(&tau, &back) <= 1e-12 * scale, "model {n}: {} of {scale}", difference(&tau, &back));
        }
    }
}

fn force_scale(m: &Model, ws: &mut Workspace<f64>, q: &[f64], qdd: &[f64]) -> f64 {
    let mut mass = vec![0.0; m.nv * m.nv];
    crba(m, ws, q, &mut mass);
    let rows = mass.chunks(m.nv).map(|row| row.iter().zip(qdd).map(|(a, b)| (a * b).abs()).sum::<f64>());
    rows.fold(0.0, f64::max)
}

/// M q̈ + bias = τ, with M from CRBA and the bias from RNEA.
#[test]
fn mass_matrix_agrees_with_rnea() {
    for (n, m) in models().iter().enumerate() {
        let (mut ws, mut rng) = (Workspace::new(m), Random(n as u64 + 500));
        let (q, v) = state(m, &mut rng, 1.0);
        let qdd = rng.many(m.nv, 3.0);
        let (mut tau, mut bias, mut mass) = (vec![0.0; m.nv], vec![0.0; m.nv], vec![0.0; m.nv * m.nv]);
        rnea(m, &mut ws, (&q, &v), &qdd, GRAVITY, &mut tau);
        rnea(m, &mut ws, (&q, &v), &vec![0.0; m.nv], GRAVITY, &mut bias);
        crba(m, &mut ws, &q, &mut mass);
        for i in 0..m.nv {
            let sum: f64 = bias[i] + (0..m.nv).map(|j| mass[i * m.nv + j] * qdd[j]).sum::<f64>();
            assert!((sum - tau[i]).abs() <= 1e-12 * largest(&tau).max(1.0) * m.nv as f64);
        }
    }
}

/// ½ vᵀ M v is the kinetic energy, and the power of gravity is minus the rate of the potential.
#[test]
fn energies_agree_with_the_mass_matrix() {
    for (n, m) in models().iter().enumerate() {
        let (mut ws, mut kin, mut rng) = (Workspace::new(m), Kinematics::new(m), Random(n as u64 + 900));
        let (q, v) = state(m, &mut rng, 1.0);
        let mut mass = vec![0.0; m.nv * m.nv];
        crba(m, &mut ws, &q, &mut mass);
        let half: f64 = (0..m.nv * m.nv).map(|k| 0.5 * v[k / m.nv] * mass[k] * v[k % m.nv]).sum();
        kinematics(m, &mut kin, &q, &v);
        let e = energy(m, &kin, GRAVITY);
        assert!((e.kinetic - half).abs() <= 1e-12 * half.max(1.0) * m.nv as f64);
        let mut weight = vec![0.0; m.nv];
        rnea(m, &mut ws, (&q, &vec![0.0; m.nv]), &vec![0.0; m.nv], GRAVITY, &mut weight);
        let power: f64 = weight.iter().zip(&v).map(|(a, b)| a * b).sum();
        let rate = central(|h| {
            let moved = moved(m, &q, &v, h);
            kinematics(m, &mut kin, &moved, &v);
            energy(m, &kin, GRAVITY).potential
        });
        assert!((power - rate).abs() <= 1e-7 * power.abs().max(10.0), "model {n}: {power} {rate}");
    }
}

fn central(mut f: impl FnMut(f64) -> f64) -> f64 {
    let h = 1e-5;
    (f(h) - f(-h)) / (2.0 * h)
}

fn moved(m: &Model, q: &[f64], v: &[f64], h: f64) -> Vec<f64> {
    let mut rates = vec![0.0; m.nq];
    coordinate_rates(m, q, v, &mut rates);
    q.iter().zip(&rates).map(|(q, r)| q + h * r).collect()
}

/// With nothing that acts from outside, the momentum of a floating tree does not change, whatever the joint torques do.
#[test]
fn inner_torques_leave_the_momentum_alone() {
    for seed in 0..10 {
        let mut joints = vec![JointType::Floating];
        joints.extend((0..8).map(|i| ALL[(i + seed as usize) % 4]));
        let m = &tree(&joints, true, seed);
        let (mut ws, mut kin, mut rng) = (Workspace::new(m), Kinematics::new(m), Random(seed + 40));
        let (q, v) = state(m, &mut rng, 1.0);
        let mut tau = rng.many(m.nv, 5.0);
        tau[..6].fill(0.0);
        let mut qdd = vec![0.0; m.nv];
        aba(m, &mut ws, (&q, &v), &tau, [0.0; 3], &mut qdd);
        for axis in 0..6 {
            let rate = central(|h| {
                let (q, v) = (moved(m, &q, &v, h), v.iter().zip(&qdd).map(|(v, a)| v + h * a).collect::<Vec<_>>());
                kinematics(m, &mut kin, &q, &v);
                let p = momentum(m, &kin);
                if axis < 3 { p.linear[axis] } else { p.angular[axis - 3] }
            });
            assert!(rate.abs() <= 1e-7 * largest(&qdd).max(1.0), "seed {seed} axis {axis}: {rate}");
        }
    }
}

/// The fused kernel computes the same, up to rounding.
#[test]
fn fused_agrees_with_portable() {
    for (n, m) in models().iter().enumerate() {
        let mut rng = Random(n as u64 + 1300);
        let (q, v) = state(m, &mut rng, 1.0);
        let tau = rng.many(m.nv, 5.0);
        let (mut a, mut b) = (vec![0.0; m.nv], vec![0.0; m.nv]);
        aba(m, &mut Workspace::new(m), (&q, &v), &tau, GRAVITY, &mut a);
        if !aba_fused(m, &mut Workspace::new(m), (&q, &v), &tau, GRAVITY, &mut b) {
            return;
        }
        assert!(difference(&a, &b) <= 1e-10 * largest(&a).max(1.0));
    }
}

/// Hybrid dynamics: locked coordinates get the acceleration asked for, the torque reported gives it, and a diagonal is a
/// diagonal of the mass matrix: M q̈ + diag q̈ + bias = τ.
#[test]
fn hybrid_dynamics_solve_the_augmented_system() {
    for (n, m) in models().iter().enumerate() {
        let (mut ws, mut rng) = (Workspace::new(m), Random(n as u64 + 1700));
        let (q, v) = state(m, &mut rng, 1.0);
        for k in 0..m.nv {
            let (a, b) = (rng.unit() * 4.0, rng.unit().abs());
            ws.dofs[k] = match k % 3 {
                0 => DofIn::free(a),
                1 => DofIn::implicit(a, b),
                _ => DofIn::locked(a),
            };
        }
        let mut expected_balls = vec![];
        for b in m.bodies.iter().filter(|b| b.joint == JointType::Spherical) {
            let input = &mut ws.ball_in[b.ball];
            input.tau = V3::from(rng.vec3(4.0));
            let g = V3::from(rng.vec3(1.0));
            input.inertia.xx = 0.3;
            input.inertia.sub_outer(g * -0.2, g);
            input.locks = b.ball % 4;
            for lock in &mut input.lock {
                *lock = BallLock { gradient: V3::from(rng.vec3(1.0)), acceleration: rng.unit(), reaction: 0.0 };
            }
            expected_balls.push((b.v, b.ball));
        }
        let mut qdd = vec![0.0; m.nv];
        aba_hybrid(m, &mut ws, (&q, &v), GRAVITY, &mut qdd);
        let (dofs, balls, reaction) = (ws.dofs.clone(), ws.ball_in.clone(), ws.reaction.clone());
        let mut needed = vec![0.0; m.nv];
        rnea(m, &mut ws, (&q, &v), &qdd, GRAVITY, &mut needed);
        let scale = force_scale(m, &mut ws, &q, &qdd).max(1.0);
        for b in &m.bodies[1..] {
            if b.joint == JointType::Spherical {
                let w = V3::new(qdd[b.v], qdd[b.v + 1], qdd[b.v + 2]);
                let input = &balls[b.ball];
                let mut given = input.tau - input.inertia.mv(w);
                for lock in &input.lock[..input.locks] {
                    assert!((lock.gradient.dot(w) - lock.acceleration).abs() <= 1e-9 * largest(&qdd).max(1.0));
                    given += lock.gradient * lock.reaction;
                }
                let have = [given.x, given.y, given.z];
                assert!(difference(&have, &needed[b.v..b.v + 3]) <= 1e-10 * scale, "model {n}");
                continue;
            }
            for k in b.v..b.v + b.joint.nv() {
                let given = if b.joint == JointType::Floating {
                    dofs[k].tau
                } else if dofs[k].free == 0.0 {
                    assert_eq!(qdd[k], dofs[k].acceleration);
                    reaction[k]
                } else {
                    dofs[k].tau - dofs[k].diagonal * qdd[k]
                };
                assert!((given - needed[k]).abs() <= 1e-11 * scale, "model {n} k {k}: {given} {}", needed[k]);
            }
        }
    }
}

/// Long chains: the identity in units of the force scale.
#[test]
fn long_chains_keep_their_precision() {
    for n in [50, 200] {
        let m = &tree(&vec![JointType::Revolute; n], true, 5);
        let (mut ws, mut rng) = (Workspace::new(m), Random(3));
        let (q, v) = state(m, &mut rng, 0.5);
        let tau = rng.many(m.nv, 1.0);
        let (mut qdd, mut back) = (vec![0.0; m.nv], vec![0.0; m.nv]);
        aba(m, &mut ws, (&q, &v), &tau, GRAVITY, &mut qdd);
        rnea(m, &mut ws, (&q, &v), &qdd, GRAVITY, &mut back);
        let scale = force_scale(m, &mut ws, &q, &qdd);
        assert!(difference(&tau, &back) <= 1e-12 * scale, "{n}: {} of {scale}", difference(&tau, &back));
    }
}
