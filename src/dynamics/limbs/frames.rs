//! Frames and velocities of one robot's bodies in the world, limbs side by side: the bits of [`super::super::kinematics`].

use super::schedule::{Schedule, Step, frames};
use super::{LANES, X, pick, single};
use crate::dynamics::Kinematics;
use crate::dynamics::articulated::Spatial;
use crate::dynamics::joint::turned_z;
use crate::dynamics::kinematics::Frame;
use crate::math::{M3, Real, V3};
use crate::model::Model;

/// The order of computation.
#[derive(Clone, Debug)]
pub(in crate::dynamics) struct Frames {
    /// Bodies on the world whose joints are not revolute.
    alone: Vec<usize>,
    rows: Vec<Row>,
}

/// Four bodies with revolute joints, none above another.
#[derive(Clone, Debug)]
struct Row {
    /// Frame at angle 0 in the parent's.
    r: M3<X>,
    p: V3<X>,
    q: [usize; LANES],
    v: [usize; LANES],
    body: [usize; LANES],
    parent: [usize; LANES],
    /// Lanes that are no repetitions.
    own: [bool; LANES],
    /// All their parents are in the same lane of the row before.
    straight: bool,
    on_world: bool,
}

impl Frames {
    /// `None` where [`super::Limbs`] has none, or too few bodies stand side by side.
    pub fn new(m: &Model) -> Option<Self> {
        let limbs = super::Limbs::new(m).filter(super::Limbs::pays)?;
        let Schedule { steps, alone, .. } = limbs.schedule;
        Some(Self { rows: steps.iter().map(|step| Row::of(m, step)).collect(), alone })
    }

    /// Fills `k` from the state `q` (nq), `v` (nv); `one` does so for a body that is computed alone.
    pub fn fill(&self, m: &Model, k: &mut Kinematics, state: (&[f64], &[f64]), one: impl Fn(&mut Kinematics, usize)) {
        self.alone.iter().for_each(|i| one(k, *i));
        #[allow(unused_unsafe)] // elsewhere the features are not asked for
        // SAFETY: `Limbs::new` has asked the machine for both features.
        unsafe {
            side_by_side(m, &self.rows, k, state)
        };
    }
}

impl Row {
    fn of(m: &Model, step: &Step) -> Self {
        Self {
            r: step.r,
            p: step.p,
            q: step.q,
            v: step.v,
            body: step.body,
            parent: step.body.map(|i| m.bodies[i].parent),
            own: step.own,
            straight: step.straight,
            on_world: step.body.iter().any(|i| m.bodies[*i].parent == 0),
        }
    }
}

#[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx2,fma"))]
fn side_by_side(m: &Model, rows: &[Row], k: &mut Kinematics, (q, v): (&[f64], &[f64])) {
    let mut last = Frame::default();
    for row in rows {
        let parent = if row.straight { last } else { gathered(k, &row.parent) };
        // What stands on the world may have been moved.
        let (r, p) = if row.on_world { frames(m, &row.body) } else { (row.r, row.p) };
        last = moved(&parent, (&r, p), (pick(q, &row.q), pick(v, &row.v)));
        scatter(&last, k, row);
    }
}

/// A revolute joint, as in [`super::super::kinematics`].
#[inline(always)]
fn moved(parent: &Frame<X>, (r, p): (&M3<X>, V3<X>), (q, speed): (X, X)) -> Frame<X> {
    let o = X::of(0.0);
    parent.carry((&turned_z(r, q.sin_cos()), p), Spatial { a: V3::new(o, o, speed), l: V3::default() })
}

#[inline(always)]
fn gathered(k: &Kinematics, body: &[usize; LANES]) -> Frame<X> {
    let v3 = |of: &[V3<f64>]| vectors(body.map(|i| of[i]));
    let row = |n: usize| vectors(body.map(|i| k.r[i].r[n]));
    Frame { r: M3::rows(row(0), row(1), row(2)), p: v3(&k.p), w: v3(&k.w), v: v3(&k.v) }
}

#[inline(always)]
fn vectors(v: [V3<f64>; LANES]) -> V3<X> {
    V3::new(X::from_numbers(v.map(|v| v.x)), X::from_numbers(v.map(|v| v.y)), X::from_numbers(v.map(|v| v.z)))
}

#[inline(always)]
fn scatter(f: &Frame<X>, k: &mut Kinematics, row: &Row) {
    let [r0, r1, r2] = f.r.r;
    for (lane, i) in row.body.iter().enumerate().filter(|(lane, _)| row.own[*lane]) {
        k.r[*i] = M3::rows(single(&r0, lane), single(&r1, lane), single(&r2, lane));
        (k.p[*i], k.w[*i], k.v[*i]) = (single(&f.p, lane), single(&f.w, lane), single(&f.v, lane));
    }
}
