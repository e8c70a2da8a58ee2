//! Inverse dynamics: recursive Newton–Euler (Featherstone 2008, §5.3), O(n).

use super::aba::{Kin, Workspace, joint_transform_p, velocities};
use super::articulated::Spatial;
use super::joint::{bias, universal_axis};
use crate::math::{M3, Real, S3, V3};
use crate::model::{Body, JointType, Model};

/// Torques `tau` (nv) that give the accelerations `qdd` (nv) in the state `q` (nq), `v` (nv) under gravity (m/s², world).
pub fn rnea(
    m: &Model,
    ws: &mut Workspace<f64>,
    state: (&[f64], &[f64]),
    qdd: &[f64],
    gravity: [f64; 3],
    tau: &mut [f64],
) {
    kernel(m, ws, state, qdd, gravity, tau);
}

#[inline(always)]
fn kernel<T: Real>(
    m: &Model,
    ws: &mut Workspace<T>,
    (q, v): (&[T], &[T]),
    qdd: &[T],
    gravity: [f64; 3],
    tau: &mut [T],
) {
    velocities(m, ws, q, v);
    ws.start(V3::of(V3::from(gravity)));
    for i in 1..m.bodies.len() {
        outward(m, ws, i, (q, v), qdd);
    }
    for i in (1..m.bodies.len()).rev() {
        inward(m, ws, i, q, tau);
    }
}

/// Accelerations, and the force that each body's own inertia needs.
#[inline(always)]
fn outward<T: Real>(m: &Model, ws: &mut Workspace<T>, i: usize, (q, v): (&[T], &[T]), qdd: &[T]) {
    let b = &m.bodies[i];
    let kin = ws.kin[i];
    let parent = ws.kin[b.parent];
    let c = bias(b, q, v, (kin.w, kin.v));
    let own = super::joint::joint_velocity(b, q, qdd);
    let p = joint_transform_p(b, q);
    let a = Spatial { a: kin.r.tv(parent.w) + c.a + own.a, l: kin.r.tv(parent.w.cross_add(p, parent.v)) + c.l + own.l };
    let force = body_force(b, (kin.w, kin.v), a);
    ws.acc[i].n = force.a;
    ws.acc[i].f = force.l;
    ws.kin[i] = Kin { r: kin.r, w: a.a, v: a.l };
}

/// `I a + v ×* I v`.
#[inline(always)]
fn body_force<T: Real>(b: &Body, (w, v): (V3<T>, V3<T>), a: Spatial<T>) -> Spatial<T> {
    let (m, mc, j) = (T::of(b.mass), V3::of(b.mc), S3::of(&b.inertia));
    let turning = w.cross(mc);
    let angular = mc.cross_add(v, j.mv(w));
    Spatial {
        a: w.cross_add(angular, v.cross_add(turning, mc.cross_add(a.l, j.mv(a.a)))),
        l: w.cross_add(v.mad(m, turning), a.a.cross_add(mc, a.l * m)),
    }
}

/// Projects the force on the joint's directions and hands it to the parent.
#[inline(always)]
fn inward<T: Real>(m: &Model, ws: &mut Workspace<T>, i: usize, q: &[T], tau: &mut [T]) {
    let b = &m.bodies[i];
    let (n, f) = (ws.acc[i].n, ws.acc[i].f);
    match b.joint {
        JointType::Revolute => tau[b.v] = n.z,
        JointType::Prismatic => tau[b.v] = f.z,
        JointType::Universal => {
            tau[b.v] = universal_axis(q[b.q + 1].sin_cos()).dot(n);
            tau[b.v + 1] = n.z;
        }
        JointType::Spherical => (tau[b.v], tau[b.v + 1], tau[b.v + 2]) = (n.x, n.y, n.z),
        JointType::Floating => {
            (tau[b.v], tau[b.v + 1], tau[b.v + 2]) = (n.x, n.y, n.z);
            (tau[b.v + 3], tau[b.v + 4], tau[b.v + 5]) = (f.x, f.y, f.z);
        }
    }
    if b.parent != 0 {
        let (r, p): (M3<T>, V3<T>) = (ws.kin[i].r, joint_transform_p(b, q));
        let f = r.mv(f);
        ws.acc[b.parent].f += f;
        ws.acc[b.parent].n += p.cross_add(f, r.mv(n));
    }
}
