//! The joint-space mass matrix: composite rigid bodies (Featherstone 2008, §6.2), O(n·depth).

use super::aba::{Workspace, joint_transform_p};
use super::joint::{joint_transform, universal_axis};
use crate::math::{M3, Real, S3, V3};
use crate::model::{Body, JointType, Model};

/// A rigid inertia about the body's origin: what moves with the body, all joints behind it held.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Composite<T> {
    mass: T,
    mc: V3<T>,
    j: S3<T>,
}

impl<T: Real> Composite<T> {
    #[inline(always)]
    fn own(b: &Body) -> Self {
        Self { mass: T::of(b.mass), mc: V3::of(b.mc), j: S3::of(&b.inertia) }
    }

    #[inline(always)]
    fn add(&mut self, o: &Self) {
        self.mass += o.mass;
        self.mc += o.mc;
        self.j += o.j;
    }

    /// About the parent's origin, in the parent's axes.
    #[inline(always)]
    fn to_parent(self, r: &M3<T>, p: V3<T>) -> Self {
        let c = r.mv(self.mc);
        let mc = p.mad(self.mass, c);
        let mut j = self.j.rotated(r);
        // J + 2 (p·c) 1 − (p cᵀ + c pᵀ) + m (p·p 1 − p pᵀ), where c + mc = 2 c + m p gathers both.
        let both = c + mc;
        let trace = p.dot(both);
        let off = |a: T, b: T, pa: T, pb: T| (pa.mad(b, pb * a)) * T::of(0.5);
        j.xx += trace - p.x * both.x;
        j.yy += trace - p.y * both.y;
        j.zz += trace - p.z * both.z;
        j.xy -= off(both.x, both.y, p.x, p.y);
        j.xz -= off(both.x, both.z, p.x, p.z);
        j.yz -= off(both.y, both.z, p.y, p.z);
        Self { mass: self.mass, mc, j }
    }

    /// Force (torque, force) per acceleration of the body along a turning `a` and a sliding `l`.
    #[inline(always)]
    fn force(&self, a: V3<T>, l: V3<T>) -> (V3<T>, V3<T>) {
        (self.mc.cross_add(l, self.j.mv(a)), a.cross_add(self.mc, l * self.mass))
    }
}

/// Writes the mass matrix of the coordinates `q` (nq), nv × nv row by row, both triangles, into `mass`.
pub fn crba(m: &Model, ws: &mut Workspace<f64>, q: &[f64], mass: &mut [f64]) {
    for (i, b) in m.bodies.iter().enumerate().skip(1) {
        ws.kin[i].r = joint_transform(b, q).0;
        ws.composite[i] = Composite::own(b);
    }
    mass.fill(0.0);
    for i in (1..m.bodies.len()).rev() {
        let b = &m.bodies[i];
        for n in 0..b.joint.nv() {
            column(m, ws, (i, n), q, mass);
        }
        if b.parent != 0 {
            let given = ws.composite[i].to_parent(&ws.kin[i].r, joint_transform_p(b, q));
            ws.composite[b.parent].add(&given);
        }
    }
}

/// The column of one direction: its force, seen by the directions of all ancestors.
#[inline(always)]
fn column(m: &Model, ws: &Workspace<f64>, (i, n): (usize, usize), q: &[f64], mass: &mut [f64]) {
    let b = &m.bodies[i];
    let (a, l) = direction(b, q, n);
    let (mut torque, mut force) = ws.composite[i].force(a, l);
    let (mut at, column) = (i, b.v + n);
    loop {
        let a = &m.bodies[at];
        if a.joint == JointType::Revolute {
            mass[column * m.nv + a.v] = torque.z;
            mass[a.v * m.nv + column] = torque.z;
        } else {
            for k in 0..a.joint.nv() {
                let (da, dl) = direction(a, q, k);
                let value = da.dot(torque) + dl.dot(force);
                mass[column * m.nv + a.v + k] = value;
                mass[(a.v + k) * m.nv + column] = value;
            }
        }
        if a.parent == 0 {
            return;
        }
        let (r, p) = (&ws.kin[at].r, joint_transform_p(a, q));
        force = r.mv(force);
        torque = p.cross_add(force, r.mv(torque));
        at = a.parent;
    }
}

/// Direction `n` of a joint in the child frame: (angular, linear).
#[inline(always)]
fn direction<T: Real>(b: &Body, q: &[T], n: usize) -> (V3<T>, V3<T>) {
    match (b.joint, n) {
        (JointType::Revolute, _) => (unit(2), V3::default()),
        (JointType::Prismatic, _) => (V3::default(), unit(2)),
        (JointType::Universal, 0) => (universal_axis(q[b.q + 1].sin_cos()), V3::default()),
        (JointType::Universal, _) => (unit(2), V3::default()),
        (JointType::Spherical, n) => (unit(n), V3::default()),
        (JointType::Floating, n) if n < 3 => (unit(n), V3::default()),
        (JointType::Floating, n) => (V3::default(), unit(n - 3)),
    }
}

#[inline(always)]
fn unit<T: Real>(k: usize) -> V3<T> {
    let (o, l) = (T::of(0.0), T::of(1.0));
    match k {
        0 => V3::new(l, o, o),
        1 => V3::new(o, l, o),
        _ => V3::new(o, o, l),
    }
}
