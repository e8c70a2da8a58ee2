//! Responses to the six unit forces on one body, climbed once for all: a contact's rows are sums of them.

use super::layout::{CHUNK, Layout};
use super::{Dof, Push, Response, Workspace, aba::joint_transform_p, joint::universal_axis};
use crate::math::{M3, Real, V3, wide};
use crate::model::{JointType, Model};

/// One component of six forces.
type Six = [f64; 6];
/// Six torques, or six forces.
type Three = [Six; 3];

/// The responses to unit torques and forces about a body's origin along its axes.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    body: usize,
    /// [`Layout::chunks`] of the body.
    ids: Vec<u32>,
    /// Six columns, each [`CHUNK`] numbers per chunk.
    values: Vec<f64>,
}

impl Columns {
    /// Room for the deepest body of this layout, so that no later use allocates.
    pub fn new(layout: &Layout) -> Self {
        let most = layout.deepest();
        Self { body: 0, ids: Vec::with_capacity(most), values: Vec::with_capacity(6 * CHUNK * most) }
    }

    /// The body, index into `Model::bodies`.
    pub fn body(&self) -> usize {
        self.body
    }

    /// Adds the response to the torque and force of `push`, which is on this body, to a row over the chunks `ids` (from
    /// [`Layout::chunks`] or [`Layout::join`]; [`CHUNK`] numbers each in `out`).
    pub fn combine(&self, push: &Push, ids: &[u32], out: &mut [f64]) {
        debug_assert_eq!(push.body, self.body);
        wide!(
            Self::combine_any,
            Columns::combine_any,
            (this: &Columns = self, push: &Push = push, ids: &[u32] = ids, out: &mut [f64] = out)
        );
    }

    #[inline(always)]
    fn combine_any(&self, push: &Push, ids: &[u32], out: &mut [f64]) {
        let (t, f) = (push.torque, push.force);
        let wrench = [t.x, t.y, t.z, f.x, f.y, f.z];
        let count = self.ids.len();
        let chunks: &[[f64; CHUNK]] = &self.values.as_chunks().0[..6 * count];
        let (mut columns, mut rest): ([&[[f64; CHUNK]]; 6], _) = ([&[]; 6], chunks);
        for column in &mut columns {
            (*column, rest) = rest.split_at(count);
        }
        let mut place = 0;
        for (id, out) in ids.iter().zip(out.as_chunks_mut::<CHUNK>().0) {
            if self.ids.get(place) != Some(id) {
                continue;
            }
            let mut sum = *out;
            for (column, x) in columns.iter().zip(wrench) {
                let y = column[place];
                for k in 0..CHUNK {
                    sum[k] += x * y[k];
                }
            }
            *out = sum;
            place += 1;
        }
    }
}

impl Response {
    /// The responses of a body, for the state `q` (nq) of the factor; none for the world (body 0).
    pub fn columns(&self, m: &Model, ws: &Workspace<f64>, q: &[f64], body: usize, out: &mut Columns) {
        out.body = body;
        let at = (m, ws, q);
        wide!(
            Self::columns_any,
            Response::columns_any,
            (this: &Response = self, at: (&Model, &Workspace<f64>, &[f64]) = at, out: &mut Columns = out)
        );
    }

    #[inline(always)]
    fn columns_any(&self, (m, ws, q): (&Model, &Workspace<f64>, &[f64]), out: &mut Columns) {
        let ids = self.layout.chunks(out.body);
        out.ids.clear();
        out.ids.extend_from_slice(ids);
        out.values.clear();
        out.values.resize(6 * CHUNK * ids.len(), 0.0);
        let length = CHUNK * ids.len();
        let (mut force, mut y) = (Six6::unit(), [[0.0; 6]; 6]);
        let (mut i, mut chunk) = (out.body, ids.len());
        while i != 0 {
            let place = self.layout.place(i);
            while chunk > 0 && ids.get(chunk - 1).is_some_and(|id| *id as usize * CHUNK > place) {
                chunk -= 1;
            }
            let count = self.climb_six((m, ws, q), i, &mut force, &mut y);
            let at = chunk.saturating_sub(1) * CHUNK + place % CHUNK;
            for (k, y) in y[..count].iter().enumerate() {
                for (column, y) in out.values.chunks_exact_mut(length).zip(y) {
                    column[at + k] = *y;
                }
            }
            let b = &m.bodies[i];
            if b.joint == JointType::Floating {
                break;
            }
            if b.parent != 0 {
                force.pass_on(&ws.kin[i].r, joint_transform_p(b, q));
            }
            i = b.parent;
        }
    }

    /// Takes six forces past the joint of a body: its responses `y` to them, and how many those are.
    #[inline(always)]
    fn climb_six(
        &self,
        (m, ws, q): (&Model, &Workspace<f64>, &[f64]),
        i: usize,
        f: &mut Six6,
        y: &mut [Six; 6],
    ) -> usize {
        let b = &m.bodies[i];
        match b.joint {
            JointType::Revolute => {
                let u = f.torque[2];
                y[0] = scaled(self.scale[b.v], &u);
                f.take(&ws.dof[b.v], &u);
            }
            JointType::Prismatic => {
                let u = f.force[2];
                y[0] = scaled(self.scale[b.v], &u);
                f.take(&ws.dof[b.v], &u);
            }
            JointType::Universal => {
                let u = f.torque[2];
                y[1] = scaled(self.scale[b.v + 1], &u);
                f.take(&ws.dof[b.v + 1], &u);
                let u = dot(universal_axis(Real::sin_cos(q[b.q + 1])), &f.torque);
                y[0] = scaled(self.scale[b.v], &u);
                f.take(&ws.dof[b.v], &u);
            }
            JointType::Spherical => {
                let t = f.torque;
                [y[0], y[1], y[2]] = times(&self.balls[b.ball], &t);
                for (k, ((x, y), z)) in t[0].into_iter().zip(t[1]).zip(t[2]).enumerate() {
                    let (_, carried) = ws.balls[b.ball].yielding(V3::new(x, y, z));
                    f.sub(k, carried.a, carried.l);
                }
            }
            JointType::Floating => {
                for k in 0..6 {
                    let r = self.floats[self.float_of[i]].response(f.column(k));
                    for (y, r) in y.iter_mut().zip([r.a.x, r.a.y, r.a.z, r.l.x, r.l.y, r.l.z]) {
                        y[k] = r;
                    }
                }
            }
        }
        b.joint.nv()
    }
}

/// Six wrenches side by side.
struct Six6 {
    torque: Three,
    force: Three,
}

impl Six6 {
    fn unit() -> Self {
        let at = |first: usize| std::array::from_fn(|n| std::array::from_fn(|k| f64::from(k == first + n)));
        Self { torque: at(0), force: at(3) }
    }

    fn column(&self, k: usize) -> super::articulated::Spatial<f64> {
        let of = |v: &Three| V3::new(v[0][k], v[1][k], v[2][k]);
        super::articulated::Spatial { a: of(&self.torque), l: of(&self.force) }
    }

    fn sub(&mut self, k: usize, a: V3<f64>, l: V3<f64>) {
        for (row, x) in self.torque.iter_mut().zip([a.x, a.y, a.z]).chain(self.force.iter_mut().zip([l.x, l.y, l.z])) {
            row[k] -= x;
        }
    }

    /// Takes out what the motion of one direction carries of its loads.
    #[inline(always)]
    fn take(&mut self, d: &Dof<f64>, u: &Six) {
        let x = scaled(d.d, u);
        for (row, s) in self.torque.iter_mut().zip([d.ua.x, d.ua.y, d.ua.z]) {
            for k in 0..6 {
                row[k] -= s * x[k];
            }
        }
        for (row, s) in self.force.iter_mut().zip([d.ul.x, d.ul.y, d.ul.z]) {
            for k in 0..6 {
                row[k] -= s * x[k];
            }
        }
    }

    /// About the parent's origin, in the parent's axes.
    #[inline(always)]
    fn pass_on(&mut self, r: &M3<f64>, p: V3<f64>) {
        let (t, f) = (times(r, &self.torque), times(r, &self.force));
        self.torque = [
            cross((p.y, &f[2]), (p.z, &f[1]), &t[0]),
            cross((p.z, &f[0]), (p.x, &f[2]), &t[1]),
            cross((p.x, &f[1]), (p.y, &f[0]), &t[2]),
        ];
        self.force = f;
    }
}

// Loops, not closures: those may be compiled apart, without the features of the function around them.

#[inline(always)]
fn scaled(s: f64, x: &Six) -> Six {
    let mut out = *x;
    for out in &mut out {
        *out *= s;
    }
    out
}

/// `a x − b y + t`.
#[inline(always)]
fn cross((a, x): (f64, &Six), (b, y): (f64, &Six), t: &Six) -> Six {
    let mut out = *t;
    for k in 0..6 {
        out[k] += a * x[k] - b * y[k];
    }
    out
}

#[inline(always)]
fn dot(v: V3<f64>, x: &Three) -> Six {
    let mut out = [0.0; 6];
    for k in 0..6 {
        out[k] = v.x * x[0][k] + v.y * x[1][k] + v.z * x[2][k];
    }
    out
}

#[inline(always)]
fn times(r: &M3<f64>, x: &Three) -> Three {
    [dot(r.r[0], x), dot(r.r[1], x), dot(r.r[2], x)]
}
