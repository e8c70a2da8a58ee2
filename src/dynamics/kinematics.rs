//! Where the bodies are and how they move, in the world.

use super::articulated::Spatial;
use super::joint::{carried, joint_transform, joint_velocity, turned_x, turned_z};
use super::limbs::Frames;
use super::turn::{Turn, with_turn};
use crate::math::{M3, Mat3, Pose, Quat, Real, Twist, V3, Vec3};
use crate::model::{JointType, LinkFrame, Model};
use nalgebra::{Rotation3, Translation3, UnitQuaternion};
use std::sync::Arc;

/// Frames and velocities of all bodies. Makes its memory once.
#[derive(Clone, Debug, Default)]
pub struct Kinematics {
    /// Per body: axes of its frame in the world.
    pub r: Vec<M3<f64>>,
    /// Per body: origin in the world, m.
    pub p: Vec<V3<f64>>,
    /// Per body: angular velocity along its own axes, rad/s.
    pub w: Vec<V3<f64>>,
    /// Per body: velocity of its origin along its own axes, m/s.
    pub v: Vec<V3<f64>>,
    /// How [`kinematics`] computes limbs side by side, if that pays.
    limbs: Option<Arc<Frames>>,
}

impl Kinematics {
    /// Room for this model.
    pub fn new(model: &Model) -> Self {
        let n = model.bodies.len();
        Self {
            r: vec![M3::identity(); n],
            p: vec![V3::default(); n],
            w: vec![V3::default(); n],
            v: vec![V3::default(); n],
            limbs: Frames::new(model).map(Arc::new),
        }
    }

    /// Takes over another one of the same model; allocates nothing.
    pub fn copy_from(&mut self, other: &Self) {
        self.r.copy_from_slice(&other.r);
        self.p.copy_from_slice(&other.p);
        self.w.copy_from_slice(&other.w);
        self.v.copy_from_slice(&other.v);
    }

    #[inline(always)]
    fn put(&mut self, i: usize, on: usize, at: (&impl Turn<f64>, V3<f64>), own: Spatial<f64>) {
        let f = Frame { r: self.r[on], p: self.p[on], w: self.w[on], v: self.v[on] }.carry(at, own);
        (self.r[i], self.p[i], self.w[i], self.v[i]) = (f.r, f.p, f.w, f.v);
    }

    /// Velocity of a body at a point of the world, along the world's axes, m/s.
    #[inline(always)]
    pub fn velocity_at(&self, body: usize, point: V3<f64>) -> V3<f64> {
        self.r[body].mv(self.v[body]) + self.r[body].mv(self.w[body]).cross(point - self.p[body])
    }

    /// The same of these bodies only.
    pub fn copy_of(&mut self, other: &Self, bodies: &[usize]) {
        for i in bodies {
            (self.r[*i], self.p[*i], self.w[*i], self.v[*i]) = (other.r[*i], other.p[*i], other.w[*i], other.v[*i]);
        }
    }
}

/// Fills `k` from the state `q` (nq), `v` (nv).
pub fn kinematics(m: &Model, k: &mut Kinematics, q: &[f64], v: &[f64]) {
    match k.limbs.take() {
        None => (1..m.bodies.len()).for_each(|i| one(m, k, (q, v), i)),
        Some(limbs) => {
            limbs.fill(m, k, (q, v), |k, i| one(m, k, (q, v), i));
            k.limbs = Some(limbs);
        }
    }
}

/// As [`kinematics`], of these bodies only: ascending, with all that carry them.
pub fn kinematics_of(m: &Model, k: &mut Kinematics, (q, v): (&[f64], &[f64]), bodies: &[usize]) {
    bodies.iter().for_each(|i| one(m, k, (q, v), *i));
}

#[inline(always)]
fn one(m: &Model, k: &mut Kinematics, (q, v): (&[f64], &[f64]), i: usize) {
    let b = &m.bodies[i];
    if b.joint == JointType::Revolute {
        let (turn, spin) = (Real::sin_cos(q[b.q]), Spatial { a: V3::new(0.0, 0.0, v[b.v]), l: V3::default() });
        return with_turn!(b.along, &b.tree_r, r => k.put(i, b.parent, (&r.turned_z(turn), b.tree_p), spin));
    }
    let (r, p) = joint_transform(b, q);
    k.put(i, b.parent, (&r, p), joint_velocity(b, q, v));
}

/// What [`Kinematics`] holds of a body.
#[derive(Clone, Copy, Default)]
pub(super) struct Frame<T> {
    pub r: M3<T>,
    pub p: V3<T>,
    pub w: V3<T>,
    pub v: V3<T>,
}

impl<T: Real> Frame<T> {
    /// Of a body on its parent: its frame in the parent's, and its joint's own velocity.
    #[inline(always)]
    pub fn carry(&self, (r, p): (&impl Turn<T>, V3<T>), own: Spatial<T>) -> Self {
        let (w, v) = carried((r, p), (self.w, self.v), own);
        // Zero is added because a −0 may come of products that are left out: so all ways have +0.
        let o = V3::default();
        let [x, y, z] = self.r.r;
        Self { r: M3::rows(r.tv(x) + o, r.tv(y) + o, r.tv(z) + o), p: self.r.mv(p) + self.p, w, v }
    }
}

/// Frames and velocities that know their state: to ask for the same again costs a comparison.
#[derive(Clone, Debug)]
pub struct Posed {
    /// Those of the state.
    pub k: Kinematics,
    q: Vec<f64>,
    v: Vec<f64>,
    known: bool,
}

impl Posed {
    /// Of no state yet.
    pub fn new(m: &Model) -> Self {
        Self { k: Kinematics::new(m), q: vec![0.0; m.nq], v: vec![0.0; m.nv], known: false }
    }

    /// The model has moved: no state is known any more.
    pub fn forget(&mut self) {
        self.known = false;
    }

    /// Are they those of this state?
    pub fn is_at(&self, q: &[f64], v: &[f64]) -> bool {
        self.known && self.q == q && self.v == v
    }

    /// Makes them those of the state `q` (nq), `v` (nv).
    pub fn update(&mut self, m: &Model, q: &[f64], v: &[f64]) {
        if !self.is_at(q, v) {
            kinematics(m, &mut self.k, q, v);
            self.q.copy_from_slice(q);
            self.v.copy_from_slice(v);
            self.known = true;
        }
    }
}

/// Frame of a link in the world. `q` and the angles of the 3DOF groups belong to the state that filled `k`.
pub fn link_pose(m: &Model, k: &Kinematics, q: &[f64], angles: &[[f64; 3]], link: usize) -> Pose {
    match &m.links[link].frame {
        LinkFrame::OnBody { body, offset } => body_pose(k, *body) * offset,
        LinkFrame::InGroup { body, turns, offset } => {
            let b = &m.bodies[*body];
            let r = k.r[b.parent].mm(&partial(m, *body, *turns, q, angles));
            let p = k.r[b.parent].mv(b.tree_p) + k.p[b.parent];
            pose(&r, p) * offset
        }
    }
}

/// Velocity of a link frame's origin along the link's own axes.
pub fn link_twist(m: &Model, k: &Kinematics, (q, v): (&[f64], &[f64]), angles: &[[f64; 3]], link: usize) -> Twist {
    match &m.links[link].frame {
        LinkFrame::OnBody { body, offset } => {
            let (w, v) = (Vec3::from(k.w[*body]), Vec3::from(k.v[*body]));
            seen_from(offset, w, v)
        }
        LinkFrame::InGroup { body, turns, offset } => {
            let b = &m.bodies[*body];
            let r = partial(m, *body, *turns, q, angles);
            let parent = (k.w[b.parent], k.v[b.parent]);
            let linear = r.tv(parent.0.cross_add(b.tree_p, parent.1));
            let angular = r.tv(parent.0) + partial_rate(m, *body, *turns, v, angles);
            seen_from(offset, angular.into(), linear.into())
        }
    }
}

/// A twist at the origin of a frame, moved to and expressed in `X_BL`.
fn seen_from(offset: &Pose, w: Vec3, v: Vec3) -> Twist {
    let back = offset.rotation.inverse();
    Twist { angular: back * w, linear: back * (v + w.cross(&offset.translation.vector)) }
}

/// Frame of a group's massless link in the parent body: the joint frame after the first turns.
fn partial(m: &Model, body: usize, turns: usize, q: &[f64], angles: &[[f64; 3]]) -> M3<f64> {
    let b = &m.bodies[body];
    if b.joint == JointType::Universal {
        return turned_x(&b.tree_r, q[b.q].sin_cos());
    }
    let hpb = angles[group_of(m, body)];
    let r = turned_z(&b.tree_r, Real::sin_cos(hpb[0]));
    if turns == 1 { r } else { turned_y(&r, hpb[1]) }
}

/// Angular velocity of that frame against the parent, along its own axes.
fn partial_rate(m: &Model, body: usize, turns: usize, v: &[f64], angles: &[[f64; 3]]) -> V3<f64> {
    let b = &m.bodies[body];
    if b.joint == JointType::Universal {
        return V3::new(v[b.v], 0.0, 0.0);
    }
    let group = group_of(m, body);
    let rates = m.eulers[group].rates(angles[group]);
    let w = V3::new(v[b.v], v[b.v + 1], v[b.v + 2]);
    let (h, p) = (rates.gradient[0].dot(w), rates.gradient[1].dot(w));
    if turns == 1 {
        return V3::new(0.0, 0.0, h);
    }
    let (s, c) = crate::math::sin_cos(angles[group][1]);
    V3::new(-s * h, p, c * h)
}

fn group_of(m: &Model, body: usize) -> usize {
    m.eulers.iter().position(|e| e.body == body).unwrap_or(0)
}

fn turned_y(r: &M3<f64>, angle: f64) -> M3<f64> {
    let (s, c) = crate::math::sin_cos(angle);
    r.mm(&M3::rows(V3::new(c, 0.0, s), V3::new(0.0, 1.0, 0.0), V3::new(-s, 0.0, c)))
}

/// Frame of a body in the world.
pub fn body_pose(k: &Kinematics, body: usize) -> Pose {
    pose(&k.r[body], k.p[body])
}

fn pose(r: &M3<f64>, p: V3<f64>) -> Pose {
    let q: Quat = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(Mat3::from(*r)));
    Pose::from_parts(Translation3::from(Vec3::from(p)), q)
}
