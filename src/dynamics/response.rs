//! What forces do to the accelerations, in factor space.
//!
//! After [`aba_hybrid`](super::aba_hybrid) the workspace holds a factorisation of the inverse mass matrix M̂⁻¹ (of the free
//! directions, with diagonals): the innovation form, `M̂⁻¹ = (1 − K)ᵀ D⁻¹ (1 − K)` (Rodriguez, Jain and Kreutz-Delgado 1991),
//! where applying `1 − K` is the inward pass of the algorithm. So for a generalized force φ one pass from its body to the
//! root gives `y = D^(−1/2) (1 − K) φ` with `y_a·y_b = φ_a M̂⁻¹ φ_b`, and y differs from 0 at the ancestors only.

use super::articulated::Spatial;
use super::factor::{FloatingRoot, ball_root, floating_index};
use super::impulses::Load;
use super::joint::universal_axis;
use super::layout::{CHUNK, Layout};
use super::{Dof, Workspace, aba::joint_transform_p};
use crate::math::{Real, V3};
use crate::model::{JointType, Model};

/// A generalized force: a wrench on one body and forces along the velocity coordinates of the joint that carries it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Push {
    /// Index into `Model::bodies`.
    pub body: usize,
    /// Torque about the body's origin along its axes, N·m.
    pub torque: V3<f64>,
    /// Force along the body's axes, N.
    pub force: V3<f64>,
    /// Forces along the velocity coordinates of the body's joint: N·m or N each. Those that the joint has count.
    pub own: [f64; 6],
}

/// The size of a response.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mobility {
    /// `|y|² = φ M̂⁻¹ φ`.
    pub free: f64,
    /// As `free`, with the locks of the spherical joints on the way lifted: where this is far greater, `free` is rounding.
    pub unlocked: f64,
}

/// The factor, and scratch for rows and for their reverse. Makes its memory once.
#[derive(Clone, Debug)]
pub struct Response {
    /// Where the velocities lie.
    pub layout: Layout,
    /// Per velocity of a joint with single directions: `D^(−1/2)`, 0 for a locked one.
    pub(super) scale: Vec<f64>,
    pub(super) balls: Vec<crate::math::M3<f64>>,
    pub(super) floats: Vec<FloatingRoot>,
    pub(super) float_of: Vec<usize>,
    /// w, 0 between calls.
    dense: Vec<f64>,
    unlocked: f64,
    /// Forces per body between [`Response::push`] and [`Response::apply`].
    pub(super) load: Vec<Load>,
}

/// A force on its way to the root.
#[derive(Clone, Copy)]
pub(super) struct Walk {
    pub body: usize,
    pub force: Spatial<f64>,
    pub own: [f64; 6],
}

impl Response {
    /// Room for this model.
    pub fn new(m: &Model) -> Self {
        let layout = Layout::new(m);
        let (float_of, floats) = floating_index(m);
        Self {
            scale: vec![0.0; m.nv],
            balls: vec![crate::math::M3::identity(); m.balls],
            floats: vec![FloatingRoot::default(); floats],
            float_of,
            dense: vec![0.0; layout.width()],
            unlocked: 0.0,
            load: vec![Load::default(); m.bodies.len()],
            layout,
        }
    }

    /// Takes the factor over from the last [`aba_hybrid`](super::aba_hybrid) in `ws`. Before the first row after it. If that has left none
    /// ([`Workspace::frugal`]), responses are not numbers.
    pub fn refresh(&mut self, m: &Model, ws: &Workspace<f64>) {
        if ws.bare {
            self.scale.fill(f64::NAN);
            return;
        }
        for (i, b) in m.bodies.iter().enumerate().skip(1) {
            match b.joint {
                JointType::Revolute | JointType::Prismatic => self.scale[b.v] = ws.dof[b.v].d.sqrt(),
                JointType::Universal => {
                    self.scale[b.v] = ws.dof[b.v].d.sqrt();
                    self.scale[b.v + 1] = ws.dof[b.v + 1].d.sqrt();
                }
                JointType::Spherical => self.balls[b.ball] = ball_root(&ws.balls[b.ball], &ws.ball_in[b.ball]),
                JointType::Floating => self.floats[self.float_of[i]] = FloatingRoot::of(ws, i),
            }
        }
    }

    /// Writes the response to the sum of two forces: the numbers of the chunks `ids`, which [`Layout::join`] gives, to
    /// `out` ([`CHUNK`] per chunk). `q` (nq) is the state of the factor.
    pub fn row(
        &mut self,
        m: &Model,
        ws: &Workspace<f64>,
        q: &[f64],
        pushes: &[Push; 2],
        (ids, out): (&[u32], &mut [f64]),
    ) -> Mobility {
        self.unlocked = 0.0;
        let [mut a, mut b] = pushes.map(Walk::new);
        while a.body != b.body {
            let deeper = if a.body > b.body { &mut a } else { &mut b };
            *deeper = self.climb(m, ws, q, *deeper);
        }
        a.join(&b);
        while a.body != 0 {
            a = self.climb(m, ws, q, a);
        }
        let mut free = 0.0;
        for (id, values) in ids.iter().zip(out.chunks_exact_mut(CHUNK)) {
            let place = *id as usize * CHUNK;
            let from = &mut self.dense[place..place + CHUNK];
            values.copy_from_slice(from);
            from.fill(0.0);
            free += values.iter().map(|y| y * y).sum::<f64>();
        }
        Mobility { free, unlocked: self.unlocked.max(free) }
    }

    /// Takes a force past the joint of its body, and notes the response of that joint.
    #[inline(always)]
    fn climb(&mut self, m: &Model, ws: &Workspace<f64>, q: &[f64], walk: Walk) -> Walk {
        let b = &m.bodies[walk.body];
        let (u, rest) = eliminate(m, ws, q, &walk);
        let y = &mut self.dense[self.layout.place(walk.body)..];
        match b.joint {
            JointType::Revolute | JointType::Prismatic => y[0] = self.scale[b.v] * u[0],
            JointType::Universal => (y[0], y[1]) = (self.scale[b.v] * u[0], self.scale[b.v + 1] * u[1]),
            JointType::Spherical => {
                let t = V3::new(u[0], u[1], u[2]);
                let r = self.balls[b.ball].mv(t);
                (y[0], y[1], y[2]) = (r.x, r.y, r.z);
                self.unlocked += ws.balls[b.ball].unlocked(t);
            }
            JointType::Floating => {
                let r = self.floats[self.float_of[walk.body]].response(spatial(&u));
                y[..6].copy_from_slice(&[r.a.x, r.a.y, r.a.z, r.l.x, r.l.y, r.l.z]);
            }
        }
        if b.parent == 0 {
            return Walk { body: 0, force: Spatial::default(), own: [0.0; 6] };
        }
        let force = to_parent(m, ws, q, walk.body, rest);
        Walk { body: b.parent, force, own: [0.0; 6] }
    }
}

impl Walk {
    fn new(push: Push) -> Self {
        Self { body: push.body, force: Spatial { a: push.torque, l: push.force }, own: push.own }
    }

    fn join(&mut self, other: &Self) {
        self.force.a += other.force.a;
        self.force.l += other.force.l;
        for (to, from) in self.own.iter_mut().zip(other.own) {
            *to += from;
        }
    }
}

/// The load of each direction of a body's joint, the one nearest the body first, and the force that is left.
#[inline(always)]
pub(super) fn eliminate(m: &Model, ws: &Workspace<f64>, q: &[f64], walk: &Walk) -> ([f64; 6], Spatial<f64>) {
    let (b, mut f, mut u) = (&m.bodies[walk.body], walk.force, walk.own);
    match b.joint {
        JointType::Revolute => {
            u[0] += f.a.z;
            take(&mut f, &ws.dof[b.v], u[0]);
        }
        JointType::Prismatic => {
            u[0] += f.l.z;
            take(&mut f, &ws.dof[b.v], u[0]);
        }
        JointType::Universal => {
            u[1] += f.a.z;
            take(&mut f, &ws.dof[b.v + 1], u[1]);
            u[0] += universal_axis(Real::sin_cos(q[b.q + 1])).dot(f.a);
            take(&mut f, &ws.dof[b.v], u[0]);
        }
        JointType::Spherical => {
            add(&mut u[..3], [f.a.x, f.a.y, f.a.z]);
            let carried = ws.balls[b.ball].yielding(V3::new(u[0], u[1], u[2])).1;
            f.a -= carried.a;
            f.l -= carried.l;
        }
        JointType::Floating => {
            let own = spatial(&u);
            add(&mut u, [f.a.x, f.a.y, f.a.z, f.l.x, f.l.y, f.l.z]);
            f = Spatial { a: -own.a, l: -own.l };
        }
    }
    (u, f)
}

/// Takes out what the motion of one direction carries of its load.
#[inline(always)]
fn take(f: &mut Spatial<f64>, d: &Dof<f64>, u: f64) {
    let x = -(d.d * u);
    f.a = d.ua.mad(x, f.a);
    f.l = d.ul.mad(x, f.l);
}

/// About the parent's origin, in the parent's axes.
#[inline(always)]
pub(super) fn to_parent(m: &Model, ws: &Workspace<f64>, q: &[f64], i: usize, f: Spatial<f64>) -> Spatial<f64> {
    let (r, p) = (&ws.kin[i].r, joint_transform_p(&m.bodies[i], q));
    let l = r.mv(f.l);
    Spatial { a: p.cross_add(l, r.mv(f.a)), l }
}

pub(super) fn spatial(u: &[f64; 6]) -> Spatial<f64> {
    Spatial { a: V3::new(u[0], u[1], u[2]), l: V3::new(u[3], u[4], u[5]) }
}

pub(super) fn add<const N: usize>(to: &mut [f64], from: [f64; N]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += from;
    }
}
