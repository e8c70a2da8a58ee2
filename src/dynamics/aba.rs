//! Forward dynamics: the articulated-body algorithm (Featherstone 2008, §7.3), O(n), and its hybrid form (§9.2).
//!
//! A joint of n degrees of freedom is n rank-1 eliminations in the child's frame, the one nearest the child first; that is
//! exact block elimination. Spherical and floating joints eliminate as a block. Velocity terms and rigid inertias are
//! recomputed instead of stored: the small workspace is what makes it fast.

use super::DofIn;
use super::articulated::{Acc, Art, Spatial, Sum, sums};
use super::ball::{Ball, BallIn, eliminate_ball, eliminate_floating};
use super::crba::Composite;
use super::damping::{Damped, resist};
use super::eliminate::{eliminate_axis, eliminate_linear_z, revolute, revolute_root};
use super::hybrid::mixed;
use super::joint::{axis_z, bias, carried, joint_transform, joint_velocity, turned, turned_outward, universal_axis};
use super::limbs::Limbs;
use super::turn::with_turn;
use crate::math::{Flat, M3, Real, V3};
use crate::model::{Body, JointType, Model};

/// Frame and motion of a body; its velocity gives way to its acceleration in the last pass.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct Kin<T> {
    pub r: M3<T>,
    pub w: V3<T>,
    pub v: V3<T>,
}

/// What the elimination of one degree of freedom leaves: `q̈ = x − d·(U·a)`.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Dof<T> {
    pub(crate) ua: V3<T>,
    pub(crate) ul: V3<T>,
    /// 1/D, or 0 for a locked one.
    pub(crate) d: T,
    /// Torque left over, divided by D; the prescribed acceleration of a locked one.
    pub(crate) x: T,
    /// Own part of the reaction of a locked one: `S·p + S·U q̈`.
    pub(crate) own: T,
}

// SAFETY: repr(C), of V3, M3 and T alone.
unsafe impl<T: Real> Flat<T> for Kin<T> {}
// SAFETY: the same.
unsafe impl<T: Real> Flat<T> for Dof<T> {}

/// Scratch of the dynamics of one model. Makes its memory once.
#[derive(Clone, Debug, Default)]
pub struct Workspace<T> {
    pub(crate) kin: Vec<Kin<T>>,
    pub(crate) acc: Vec<Acc<T>>,
    pub(crate) dof: Vec<Dof<T>>,
    pub(crate) balls: Vec<Ball<T>>,
    pub(crate) composite: Vec<Composite<T>>,
    /// Inputs of the hybrid dynamics, one per velocity.
    pub dofs: Vec<DofIn<T>>,
    /// Inputs of the hybrid dynamics, one per spherical joint.
    pub ball_in: Vec<BallIn<T>>,
    /// Torque that keeps a locked velocity coordinate to its acceleration (filled by [`super::aba_hybrid`]).
    pub reaction: Vec<T>,
    /// The next pass of [`super::aba_hybrid`] need not leave the factor behind that [`super::Response`] takes over: where bodies or robots
    /// are computed side by side, that is a sixth of the time or more. Accelerations, reactions and mobilities are there in any case.
    pub frugal: bool,
    /// It has not.
    pub(super) bare: bool,
    /// Bodies that the hybrid dynamics damp.
    pub(crate) damped: Vec<Damped<T>>,
    /// Per body, if any is damped: room for [`super::damping_powers`].
    pub(crate) wrenches: Vec<Spatial<T>>,
    /// The bodies that take part, first and one past the last, ascending: whole trees. The accelerations of the others stay
    /// as they are.
    pub active: Vec<(usize, usize)>,
    /// Per body: where what it collects comes from.
    sums: Vec<Sum>,
    /// For [`super::aba_hybrid`], if limbs are computed side by side.
    pub(super) limbs: Option<Box<Limbs>>,
    /// Per velocity, of lanes only: 1 in the lanes that are plain, if others are not.
    pub(super) mixed: Vec<Option<T>>,
}

impl<T: Real> Workspace<T> {
    /// Room for this model.
    pub fn new(model: &Model) -> Self {
        let (n, nv) = (model.bodies.len(), model.nv);
        let o = T::of(0.0);
        Self {
            kin: vec![Kin { r: M3::identity(), ..Kin::default() }; n],
            acc: vec![Acc::default(); n],
            dof: vec![Dof::default(); nv],
            balls: vec![Ball::default(); model.balls],
            composite: vec![Composite::default(); n],
            dofs: vec![DofIn::free(o); nv],
            ball_in: vec![BallIn::default(); model.balls],
            reaction: vec![o; nv],
            frugal: false,
            bare: false,
            damped: Vec::with_capacity(model.dampings.len()),
            wrenches: vec![Spatial::default(); if model.dampings.is_empty() { 0 } else { n }],
            active: vec![(1, n)],
            sums: sums(model),
            limbs: None,
            mixed: vec![],
        }
    }

    /// Room for several robots of this model, one in each lane.
    pub(super) fn of_lanes(model: &Model) -> Self {
        Self { mixed: vec![None; model.nv], ..Self::new(model) }
    }

    /// From now on [`super::aba_hybrid`] computes limbs side by side, where all bodies take part and none is damped. The bits stay
    /// the same. False if that does not pay for this model, or cannot be done on this machine.
    pub fn put_side_by_side(&mut self, m: &Model) -> bool {
        self.limbs = Limbs::new(m).filter(Limbs::pays).map(Box::new);
        self.limbs.is_some()
    }

    /// Acceleration per torque of a velocity coordinate in the last solve, with what hangs on it free and its base held:
    /// 1/D of the articulated inertia; 0 if it was locked. With a free base it accelerates more.
    pub fn mobility(&self, v: usize) -> T {
        self.dof[v].d
    }

    /// The same along a gradient (child frame) of a spherical joint, as if none of its angles were locked.
    pub fn ball_mobility(&self, ball: usize, gradient: V3<T>) -> T {
        self.balls[ball].mobility(gradient)
    }

    /// Acceleration of the world minus gravity.
    #[inline(always)]
    pub(crate) fn start(&mut self, gravity: V3<T>) {
        self.kin[0] = Kin { r: M3::identity(), w: V3::default(), v: -gravity };
    }
}

/// Accelerations `qdd` (nv) of the state `q` (nq), `v` (nv) under torques `tau` (nv) and gravity (m/s², world).
///
/// The same bits on every machine. Lengths must fit the model.
pub fn aba(
    m: &Model,
    ws: &mut Workspace<f64>,
    state: (&[f64], &[f64]),
    tau: &[f64],
    gravity: [f64; 3],
    qdd: &mut [f64],
) {
    kernel::<f64, false>(m, ws, state, tau, V3::from(gravity), qdd);
}

#[inline(always)]
pub(super) fn kernel<T: Real, const HYBRID: bool>(
    m: &Model,
    ws: &mut Workspace<T>,
    (q, v): (&[T], &[T]),
    tau: &[T],
    gravity: V3<T>,
    qdd: &mut [T],
) {
    let bodies = &m.bodies[..];
    ws.kin[0] = Kin { r: M3::identity(), ..Kin::default() };
    for k in 0..ws.active.len() {
        let (from, to) = ws.active[k];
        for (i, b) in bodies.iter().enumerate().take(to).skip(from) {
            let kin = moved(b, q, v, &ws.kin[b.parent]);
            if ws.sums[i] == Sum::Several {
                ws.acc[i] = Acc::rigid(b, kin.w, kin.v);
            }
            ws.kin[i] = kin;
        }
        if HYBRID && !ws.damped.is_empty() {
            resist(m, ws, from..to);
        }
        // First what a body has collected, then what it hands on, in place: a copy would be most of a kilobyte in lanes.
        let mut k = Acc::rigid(&bodies[0], ws.kin[0].w, ws.kin[0].v);
        for i in (from..to).rev() {
            let b = &bodies[i];
            match ws.sums[i] {
                Sum::Own => k = Acc::rigid(b, ws.kin[i].w, ws.kin[i].v),
                Sum::Next => k.add(&Acc::rigid(b, ws.kin[i].w, ws.kin[i].v)),
                Sum::Several => k = ws.acc[i],
            }
            inward::<T, HYBRID>(b, ws, (i, &mut k), (q, v), tau);
            if b.parent != 0 && ws.sums[b.parent] == Sum::Several {
                ws.acc[b.parent].add(&k);
            }
        }
    }
    ws.start(gravity);
    for k in 0..ws.active.len() {
        let (from, to) = ws.active[k];
        for (i, b) in bodies.iter().enumerate().take(to).skip(from) {
            outward::<T, HYBRID>(b, ws, i, (q, v), qdd);
        }
    }
}

/// First pass: frames and velocities, from the world outwards.
#[inline(always)]
pub(crate) fn velocities<T: Real>(m: &Model, ws: &mut Workspace<T>, q: &[T], v: &[T]) {
    ws.kin[0] = Kin { r: M3::identity(), ..Kin::default() };
    for (i, b) in m.bodies.iter().enumerate().skip(1) {
        ws.kin[i] = moved(b, q, v, &ws.kin[b.parent]);
    }
}

/// Frame and velocity of a body, given its parent's.
#[inline(always)]
pub(super) fn moved<T: Real>(b: &Body, q: &[T], v: &[T], parent: &Kin<T>) -> Kin<T> {
    if b.joint == JointType::Revolute {
        let (at_rest, p, own) = (&M3::of(&b.tree_r), V3::of(b.tree_p), (q[b.q], v[b.v]));
        return with_turn!(b.along, at_rest, r => turned((r, p), own, (parent.w, parent.v)));
    }
    let (r, p) = joint_transform(b, q);
    let (w, v) = carried((&r, p), (parent.w, parent.v), joint_velocity(b, q, v));
    Kin { r, w, v }
}

/// Second pass, one body: eliminate its joint from what it has collected; that becomes what its parent gets, unless that is
/// the world.
#[inline(always)]
pub(super) fn inward<T: Real, const HYBRID: bool>(
    b: &Body,
    ws: &mut Workspace<T>,
    (i, k): (usize, &mut Acc<T>),
    (q, v): (&[T], &[T]),
    tau: &[T],
) {
    let kin = ws.kin[i];
    if b.joint == JointType::Floating {
        let t = |n: usize| if HYBRID { ws.dofs[b.v + n].tau } else { tau[b.v + n] };
        let own = [t(0), t(1), t(2), t(3), t(4), t(5)];
        eliminate_floating(k, own, &mut ws.dof[b.v..b.v + 6]);
        if b.parent != 0 {
            *k = hand_over_floating(b, &kin, own, q);
        }
        return;
    }
    if b.joint == JointType::Revolute && (!HYBRID || ws.dofs[b.v].plain) {
        let t = if HYBRID { ws.dofs[b.v].tau } else { tau[b.v] };
        if b.parent == 0 {
            revolute_root(k, (&mut ws.dof[b.v], t));
        } else {
            let (p, own, out) = (V3::of(b.tree_p), (kin.w, kin.v), (&mut ws.dof[b.v], t));
            *k = with_turn!(b.along, &kin.r, r => revolute(k, (r, p), own, v[b.v], out));
        }
        return;
    }
    if T::SEVERAL
        && b.joint == JointType::Revolute
        && let Some(Some(mask)) = ws.mixed.get(b.v).copied()
    {
        mixed(b, ws, (i, k), v, mask);
        return;
    }
    let c = bias(b, q, v, (kin.w, kin.v));
    match b.joint {
        JointType::Revolute => eliminate_axis(k, axis_z(), &mut ws.dof[b.v], &ws.dofs[b.v]),
        JointType::Prismatic => {
            let input = scalar_input::<T, HYBRID>(ws, tau, b.v);
            eliminate_linear_z(k, &mut ws.dof[b.v], &input);
        }
        JointType::Universal => {
            let (first, second) =
                (scalar_input::<T, HYBRID>(ws, tau, b.v), scalar_input::<T, HYBRID>(ws, tau, b.v + 1));
            eliminate_axis(k, axis_z(), &mut ws.dof[b.v + 1], &second);
            eliminate_axis(k, universal_axis(q[b.q + 1].sin_cos()), &mut ws.dof[b.v], &first);
        }
        JointType::Spherical | JointType::Floating => {
            if !HYBRID {
                ws.ball_in[b.ball] = BallIn { tau: V3::new(tau[b.v], tau[b.v + 1], tau[b.v + 2]), ..BallIn::default() };
            }
            eliminate_ball(k, &mut ws.balls[b.ball], &ws.ball_in[b.ball]);
        }
    }
    if b.parent != 0 {
        k.push(c);
        *k = k.to_parent(&kin.r, joint_transform_p(b, q));
    }
}

/// A floating joint hands its own force, and no inertia, to the parent.
#[inline(always)]
fn hand_over_floating<T: Real>(b: &Body, kin: &Kin<T>, own: [T; 6], q: &[T]) -> Acc<T> {
    let force = Acc { ia: Art::default(), n: V3::new(own[0], own[1], own[2]), f: V3::new(own[3], own[4], own[5]) };
    force.to_parent(&kin.r, joint_transform_p(b, q))
}

/// Third pass, one body: accelerations, from the world outwards.
#[inline(always)]
pub(super) fn outward<T: Real, const HYBRID: bool>(
    b: &Body,
    ws: &mut Workspace<T>,
    i: usize,
    (q, v): (&[T], &[T]),
    qdd: &mut [T],
) {
    let kin = ws.kin[i];
    let parent = ws.kin[b.parent];
    if b.joint == JointType::Revolute {
        let (p, own, parent) = (V3::of(b.tree_p), (kin.w, kin.v), (parent.w, parent.v));
        let (mut a, l) = with_turn!(b.along, &kin.r, r => turned_outward((r, p), v[b.v], own, parent));
        a.z += scalar_out::<T, HYBRID>(ws, b.v, (a, l), qdd);
        (ws.kin[i].w, ws.kin[i].v) = (a, l);
        return;
    }
    let c = bias(b, q, v, (kin.w, kin.v));
    let p = joint_transform_p(b, q);
    let mut a = kin.r.tv(parent.w) + c.a;
    let mut l = kin.r.tv(parent.w.cross_add(p, parent.v)) + c.l;
    match b.joint {
        JointType::Revolute => a.z += scalar_out::<T, HYBRID>(ws, b.v, (a, l), qdd),
        JointType::Prismatic => l.z += scalar_out::<T, HYBRID>(ws, b.v, (a, l), qdd),
        JointType::Universal => {
            let first = scalar_out::<T, HYBRID>(ws, b.v, (a, l), qdd);
            a = universal_axis(q[b.q + 1].sin_cos()).mad(first, a);
            a.z += scalar_out::<T, HYBRID>(ws, b.v + 1, (a, l), qdd);
        }
        JointType::Spherical => {
            let out = ws.balls[b.ball].acceleration(Spatial { a, l });
            if HYBRID {
                ws.balls[b.ball].set_load(Spatial { a, l });
                ws.ball_in[b.ball].react(&ws.balls[b.ball]);
            }
            (qdd[b.v], qdd[b.v + 1], qdd[b.v + 2]) = (out.x, out.y, out.z);
            a += out;
        }
        JointType::Floating => {
            let own = &ws.dof[b.v..b.v + 6];
            let (ga, gl) = (V3::new(own[0].x, own[1].x, own[2].x), V3::new(own[3].x, own[4].x, own[5].x));
            let (da, dl) = (ga - a, gl - l);
            (qdd[b.v], qdd[b.v + 1], qdd[b.v + 2]) = (da.x, da.y, da.z);
            (qdd[b.v + 3], qdd[b.v + 4], qdd[b.v + 5]) = (dl.x, dl.y, dl.z);
            (a, l) = (ga, gl);
        }
    }
    ws.kin[i].w = a;
    ws.kin[i].v = l;
}

/// Acceleration of one degree of freedom, given that of the frame it moves against.
#[inline(always)]
fn scalar_out<T: Real, const HYBRID: bool>(
    ws: &mut Workspace<T>,
    k: usize,
    (a, l): (V3<T>, V3<T>),
    qdd: &mut [T],
) -> T {
    let d = ws.dof[k];
    let reach = d.ua.dot(a) + d.ul.dot(l);
    let acceleration = (-d.d).mad(reach, d.x);
    if HYBRID {
        ws.reaction[k] = d.own + reach;
    }
    qdd[k] = acceleration;
    acceleration
}

#[inline(always)]
pub(crate) fn joint_transform_p<T: Real>(b: &Body, q: &[T]) -> V3<T> {
    match b.joint {
        JointType::Prismatic => V3::of(b.tree_r.col2()).mad(q[b.q], V3::of(b.tree_p)),
        JointType::Floating => M3::of(&b.tree_r).mv(V3::new(q[b.q], q[b.q + 1], q[b.q + 2])) + V3::of(b.tree_p),
        _ => V3::of(b.tree_p),
    }
}

#[inline(always)]
fn scalar_input<T: Real, const HYBRID: bool>(ws: &Workspace<T>, tau: &[T], k: usize) -> DofIn<T> {
    if HYBRID { ws.dofs[k] } else { DofIn::free(tau[k]) }
}
