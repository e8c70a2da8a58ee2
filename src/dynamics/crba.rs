//! The joint-space mass matrix: composite rigid bodies (Featherstone 2008, §6.2), O(n·depth).

use super::aba::{Workspace, joint_transform_p, velocities};
use super::articulated::{Acc, Spatial};
use super::joint::universal_axis;
use crate::math::{Real, V3};
use crate::model::{Body, JointType, Model};

/// Writes the mass matrix of the coordinates `q` (nq), nv × nv row by row, both triangles, into `mass`.
pub fn crba(m: &Model, ws: &mut Workspace<f64>, q: &[f64], mass: &mut [f64]) {
    let v = std::mem::take(&mut ws.reaction);
    velocities(m, ws, q, &v);
    ws.reaction = v;
    mass.fill(0.0);
    for i in (1..m.bodies.len()).rev() {
        let b = &m.bodies[i];
        let mut k = ws.acc[i];
        k.add_rigid(b, V3::default(), V3::default());
        ws.acc[i] = k;
        columns(m, ws, i, q, mass);
        if b.parent != 0 {
            let (r, p) = (ws.kin[i].r, joint_transform_p(b, q));
            ws.acc[b.parent].add(&k.to_parent(&r, p));
        }
    }
}

/// The columns of one body: the force of each of its directions, seen by the directions of all its ancestors.
fn columns(m: &Model, ws: &Workspace<f64>, i: usize, q: &[f64], mass: &mut [f64]) {
    let b = &m.bodies[i];
    for n in 0..b.joint.nv() {
        let s = direction(b, q, n);
        let mut force = Acc { ia: ws.acc[i].ia, ..Acc::default() };
        force.push(s);
        let (mut n_at, mut f_at, mut at) = (force.n, force.f, i);
        loop {
            let a = &m.bodies[at];
            for k in 0..a.joint.nv() {
                let d = direction(a, q, k);
                let value = d.a.dot(n_at) + d.l.dot(f_at);
                mass[(b.v + n) * m.nv + a.v + k] = value;
                mass[(a.v + k) * m.nv + b.v + n] = value;
            }
            if a.parent == 0 {
                break;
            }
            let (r, p) = (&ws.kin[at].r, joint_transform_p(a, q));
            f_at = r.mv(f_at);
            n_at = p.cross_add(f_at, r.mv(n_at));
            at = a.parent;
        }
    }
}

/// Direction `n` of a joint, in the child frame.
#[inline(always)]
pub(crate) fn direction<T: Real>(b: &Body, q: &[T], n: usize) -> Spatial<T> {
    let unit = |k: usize| {
        let e = |n| if n == k { T::of(1.0) } else { T::of(0.0) };
        V3::new(e(0), e(1), e(2))
    };
    let turning = |a| Spatial { a, l: V3::default() };
    let sliding = |l| Spatial { a: V3::default(), l };
    match (b.joint, n) {
        (JointType::Revolute, _) => turning(unit(2)),
        (JointType::Prismatic, _) => sliding(unit(2)),
        (JointType::Universal, 0) => turning(universal_axis(q[b.q + 1].sin_cos())),
        (JointType::Universal, _) => turning(unit(2)),
        (JointType::Spherical, n) => turning(unit(n)),
        (JointType::Floating, n) if n < 3 => turning(unit(n)),
        (JointType::Floating, n) => sliding(unit(n - 3)),
    }
}
