//! The factor that the hybrid pass leaves, against the dense mass matrix.

use crate::support::{ALL, Random, state, tree};
use nalgebra::{DMatrix, DVector};
use realnoid::dynamics::{
    BallIn, BallLock, CHUNK, DofIn, Kinematics, Push, Response, Workspace, aba_hybrid, crba, kinematics,
};
use realnoid::math::{V3, Vec3};
use realnoid::model::{JointType, Model};

const GRAVITY: [f64; 3] = [0.3, -0.2, -9.81];

/// A model with a state and inputs of the hybrid dynamics: free ones, diagonals and locks of all kinds.
pub struct Case {
    pub m: Model,
    pub q: Vec<f64>,
    v: Vec<f64>,
    pub ws: Workspace<f64>,
    pub qdd: Vec<f64>,
}

pub fn cases() -> Vec<Case> {
    let mixed = |s: u64| tree(&(0..12).map(|i| ALL[(i + s as usize) % 5]).collect::<Vec<_>>(), s.is_multiple_of(3), s);
    let mut models: Vec<Model> = (0..20).map(mixed).collect();
    models.extend(ALL.map(|j| tree(&[j; 6], true, 77)));
    models.into_iter().enumerate().map(|(n, m)| case(m, n as u64)).collect()
}

fn case(m: Model, seed: u64) -> Case {
    let mut rng = Random(seed + 4000);
    let (q, v) = state(&m, &mut rng, 1.0);
    let mut ws = Workspace::new(&m);
    for dof in &mut ws.dofs {
        let (a, b) = (rng.unit() * 4.0, rng.unit().abs());
        *dof = match rng.next() % 3 {
            0 => DofIn::free(a),
            1 => DofIn::implicit(a, b),
            _ => DofIn::locked(a),
        };
    }
    for input in &mut ws.ball_in {
        let g = V3::from(rng.vec3(1.0));
        *input = BallIn { tau: V3::from(rng.vec3(4.0)), locks: rng.next() as usize % 4, ..BallIn::default() };
        input.inertia.xx = 0.3;
        input.inertia.sub_outer(g * -0.2, g);
        for lock in &mut input.lock {
            *lock = BallLock { gradient: V3::from(rng.vec3(1.0)), acceleration: rng.unit(), reaction: 0.0 };
        }
    }
    let mut qdd = vec![0.0; m.nv];
    aba_hybrid(&m, &mut ws, (&q, &v), GRAVITY, &mut qdd);
    Case { m, q, v, ws, qdd }
}

impl Case {
    /// The mass matrix with diagonals.
    fn mass(&self) -> DMatrix<f64> {
        let (m, mut ws) = (&self.m, Workspace::new(&self.m));
        let mut flat = vec![0.0; m.nv * m.nv];
        crba(m, &mut ws, &self.q, &mut flat);
        let mut mass = DMatrix::from_row_slice(m.nv, m.nv, &flat);
        for b in &m.bodies[1..] {
            for k in b.v..b.v + b.joint.nv() {
                match b.joint {
                    JointType::Spherical | JointType::Floating => {}
                    _ => mass[(k, k)] += self.ws.dofs[k].diagonal,
                }
            }
            if b.joint == JointType::Spherical {
                let i = self.ws.ball_in[b.ball].inertia;
                let rows = [i.row0(), i.row1(), i.row2()];
                for (r, row) in rows.iter().enumerate() {
                    for (c, x) in [row.x, row.y, row.z].into_iter().enumerate() {
                        mass[(b.v + r, b.v + c)] += x;
                    }
                }
            }
        }
        mass
    }

    /// Columns that span the directions that are not locked.
    fn free(&self) -> DMatrix<f64> {
        let mut columns: Vec<DVector<f64>> = vec![];
        let unit = |k: usize| DVector::from_fn(self.m.nv, |i, _| f64::from(i == k));
        for b in &self.m.bodies[1..] {
            if b.joint == JointType::Spherical {
                let input = &self.ws.ball_in[b.ball];
                let mut held: Vec<Vec3> = vec![];
                let locks = input.lock[..input.locks].iter().map(|l| Vec3::from(l.gradient));
                for (n, candidate) in locks.chain([Vec3::x(), Vec3::y(), Vec3::z()]).enumerate() {
                    let mut rest = candidate;
                    for _ in 0..2 {
                        for h in &held {
                            rest -= h * h.dot(&rest);
                        }
                    }
                    if held.len() == 3 || rest.norm() < 1e-3 {
                        continue;
                    }
                    held.push(rest.normalize());
                    if n >= input.locks {
                        let d = held[held.len() - 1];
                        columns.push(unit(b.v) * d.x + unit(b.v + 1) * d.y + unit(b.v + 2) * d.z);
                    }
                }
            } else {
                let free = |k: &usize| b.joint == JointType::Floating || self.ws.dofs[*k].free == 1.0;
                columns.extend((b.v..b.v + b.joint.nv()).filter(free).map(unit));
            }
        }
        if columns.is_empty() { DMatrix::zeros(self.m.nv, 0) } else { DMatrix::from_columns(&columns) }
    }

    /// A push as torques on all velocity coordinates: what it does per unit of each velocity.
    fn generalized(&self, push: &Push) -> DVector<f64> {
        let mut k = Kinematics::new(&self.m);
        let b = &self.m.bodies[push.body];
        DVector::from_fn(self.m.nv, |i, _| {
            let v: Vec<f64> = (0..self.m.nv).map(|j| f64::from(i == j)).collect();
            kinematics(&self.m, &mut k, &self.q, &v);
            let own = if (b.v..b.v + b.joint.nv()).contains(&i) { push.own[i - b.v] } else { 0.0 };
            own + push.torque.dot(k.w[push.body]) + push.force.dot(k.v[push.body])
        })
    }

    pub fn push(&self, rng: &mut Random) -> Push {
        let body = 1 + rng.next() as usize % (self.m.bodies.len() - 1);
        let mut push = Push { body, ..Push::default() };
        if rng.next().is_multiple_of(2) {
            (push.torque, push.force) = (V3::from(rng.vec3(1.0)), V3::from(rng.vec3(1.0)));
        }
        let nv = self.m.bodies[body].joint.nv();
        push.own[..nv].copy_from_slice(&rng.many(nv, 1.0));
        push
    }
}

/// The response of a push, or the sum of two, spread over the whole of w.
fn spread(r: &mut Response, c: &Case, pushes: &[Push; 2]) -> (Vec<f64>, f64, f64) {
    let mut ids = vec![];
    r.layout.join(pushes[0].body, pushes[1].body, &mut ids);
    let mut values = vec![f64::NAN; ids.len() * CHUNK];
    let mobility = r.row(&c.m, &c.ws, &c.q, pushes, (&ids, &mut values));
    let mut w = vec![0.0; r.layout.width()];
    for (id, y) in ids.iter().zip(values.chunks(CHUNK)) {
        w[*id as usize * CHUNK..*id as usize * CHUNK + CHUNK].copy_from_slice(y);
    }
    (w, mobility.free, mobility.unlocked)
}

/// `y_a·y_b = J_a M̂⁻¹ J_bᵀ`, to 1e-12 of `|y_a| |y_b|`.
#[test]
fn responses_agree_with_the_dense_inverse() {
    let mut worst = 0.0f64;
    for (n, c) in cases().iter().enumerate() {
        let mut r = Response::new(&c.m);
        r.refresh(&c.m, &c.ws);
        let mut rng = Random(n as u64 + 9000);
        let rows: Vec<[Push; 2]> = (0..8).map(|_| [c.push(&mut rng), c.push(&mut rng)]).collect();
        let y: Vec<(Vec<f64>, f64, f64)> = rows.iter().map(|p| spread(&mut r, c, p)).collect();
        let z = c.free();
        let reduced = z.transpose() * c.mass() * &z;
        let inverse = reduced.clone().cholesky().map(|f| f.inverse());
        let j: Vec<DVector<f64>> =
            rows.iter().map(|[a, b]| z.transpose() * (c.generalized(a) + c.generalized(b))).collect();
        for a in 0..rows.len() {
            for b in 0..=a {
                // Refined once: the dense inverse loses what its conditioning says.
                let dense = inverse.as_ref().map_or(0.0, |i| {
                    let x = i * &j[b];
                    let x = &x + i * (&j[b] - &reduced * &x);
                    j[a].dot(&x)
                });
                let ours: f64 = y[a].0.iter().zip(&y[b].0).map(|(x, y)| x * y).sum();
                let scale = (y[a].1 * y[b].1).sqrt();
                let locked = [a, b].into_iter().any(|k| y[k].1 <= 1e-26 * y[k].2);
                if locked {
                    assert!(dense.abs() <= 1e-13 * (y[a].2 * y[b].2).sqrt(), "model {n}: {dense}");
                    continue;
                }
                let error = (ours - dense).abs() / scale;
                worst = worst.max(error);
                assert!(error <= 1e-12, "model {n}, rows {a}, {b}: {ours} {dense}, {error}");
            }
            let size: f64 = y[a].0.iter().map(|x| x * x).sum();
            assert!((size - y[a].1).abs() <= 1e-14 * size, "the mobility is the size of the row");
        }
    }
    println!("worst relative difference {worst:e}");
}

/// Applying forces is solving again with them among the inputs: accelerations, reactions of locked coordinates and of the
/// locks of spherical joints; 1e-10 of the largest acceleration, and of the forces that act inside.
#[test]
fn applying_is_solving_again() {
    let mut worst = [0.0f64; 3];
    for (n, c) in cases().iter().enumerate() {
        let mut r = Response::new(&c.m);
        r.refresh(&c.m, &c.ws);
        let mut rng = Random(n as u64 + 11_000);
        let mut again = c.ws.clone();
        let (mut ws, mut qdd) = (c.ws.clone(), c.qdd.clone());
        let mut torque = DVector::zeros(c.m.nv);
        for _ in 0..5 {
            let (push, factor) = (c.push(&mut rng), 3.0 * rng.unit());
            torque += c.generalized(&push) * factor;
            r.push(&push, factor);
        }
        r.apply(&c.m, &mut ws, &c.q, &mut qdd);
        for (k, dof) in again.dofs.iter_mut().enumerate() {
            dof.tau += torque[k];
            dof.plain = false;
        }
        for b in c.m.bodies[1..].iter().filter(|b| b.joint == JointType::Spherical) {
            again.ball_in[b.ball].tau += V3::new(torque[b.v], torque[b.v + 1], torque[b.v + 2]);
        }
        let mut expected = vec![0.0; c.m.nv];
        aba_hybrid(&c.m, &mut again, (&c.q, &c.v), GRAVITY, &mut expected);
        let largest = expected.iter().chain(&c.qdd).fold(1.0f64, |m, x| m.max(x.abs()));
        let inside = again.reaction.iter().chain(torque.iter()).fold(largest, |m, x| m.max(x.abs()));
        for k in 0..c.m.nv {
            worst[0] = worst[0].max((qdd[k] - expected[k]).abs() / largest);
        }
        for b in &c.m.bodies[1..] {
            match b.joint {
                JointType::Floating => {}
                JointType::Spherical => {
                    let (a, e) = (&ws.ball_in[b.ball], &again.ball_in[b.ball]);
                    let scale = e.lock[..e.locks].iter().fold(inside, |m, l| m.max(l.reaction.abs()));
                    for (a, e) in a.lock[..a.locks].iter().zip(&e.lock) {
                        worst[1] = worst[1].max((a.reaction - e.reaction).abs() / scale);
                    }
                }
                _ => {
                    for k in (b.v..b.v + b.joint.nv()).filter(|k| c.ws.dofs[*k].free == 0.0) {
                        worst[2] = worst[2].max((ws.reaction[k] - (again.reaction[k] - torque[k])).abs() / inside);
                    }
                }
            }
        }
        assert!(worst.iter().all(|w| *w <= 1e-10), "model {n}: {worst:?}");
        // A second time, on top: linear, and nothing is left of the first.
        let once = qdd.clone();
        r.apply(&c.m, &mut ws, &c.q, &mut qdd);
        assert_eq!(once, qdd);
    }
    println!("worst: accelerations, reactions of spherical locks, of coordinates {worst:?}");
}

/// A direction of a spherical joint that is locked has no response, not even the root of a rounding error.
#[test]
fn a_lock_has_no_response() {
    for (n, c) in cases().iter().enumerate() {
        let mut r = Response::new(&c.m);
        r.refresh(&c.m, &c.ws);
        for (i, b) in c.m.bodies.iter().enumerate().skip(1).filter(|(_, b)| b.joint == JointType::Spherical) {
            let input = &c.ws.ball_in[b.ball];
            for lock in &input.lock[..input.locks] {
                let mut push = Push { body: i, ..Push::default() };
                let g = lock.gradient;
                push.own[..3].copy_from_slice(&[g.x, g.y, g.z]);
                let mut ids = vec![];
                r.layout.join(i, i, &mut ids);
                let mut values = vec![0.0; ids.len() * CHUNK];
                let none = Push { body: i, ..Push::default() };
                let mobility = r.row(&c.m, &c.ws, &c.q, &[push, none], (&ids, &mut values));
                assert!(mobility.free <= 1e-26 * mobility.unlocked, "model {n}: {mobility:?}");
            }
        }
    }
}
