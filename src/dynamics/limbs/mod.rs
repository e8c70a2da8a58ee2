//! Forward dynamics of one robot whose limbs are computed side by side, four bodies in a vector register.
//!
//! The operations on a body, and the order in which a body adds up what its children hand it, are those of
//! [`super::aba`]: the bits are the same. What is gained depends on how many bodies stand side by side: about half of the
//! time on a humanoid, nothing on a chain.

mod frames;
mod schedule;

use super::aba::{Dof, Kin, inward, moved, outward};
use super::articulated::Acc;
use super::eliminate::{eliminate_axis, revolute};
use super::joint::{axis_z, turned, turned_outward, turning_bias};
use super::{DofIn, Workspace};
#[cfg(not(target_arch = "x86_64"))]
use crate::math::Lanes4;
#[cfg(target_arch = "x86_64")]
use crate::math::X4;
use crate::math::{Flat, Lane, M3, Real, V3};
use crate::model::Model;
pub(super) use frames::Frames;
use schedule::{Below, Place, Schedule, Step};

/// Four bodies.
#[cfg(target_arch = "x86_64")]
type X = X4<false>;
#[cfg(not(target_arch = "x86_64"))]
type X = Lanes4;
const LANES: usize = X::COUNT;
/// Bodies per step below which it does not pay.
const WORTH: f64 = 2.0;

/// Order of computation and scratch of one model. Makes its memory once.
#[derive(Clone, Debug)]
pub struct Limbs {
    schedule: Schedule,
    kin: Vec<Kin<X>>,
    given: Vec<Acc<X>>,
    dof: Vec<Dof<X>>,
}

impl Limbs {
    /// `None` if the machine has no AVX2, or if a body that hangs on another one has a joint that is not revolute.
    pub fn new(m: &Model) -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        if !X::is_available() {
            return None;
        }
        #[cfg(not(target_arch = "x86_64"))]
        if true {
            return None;
        }
        let schedule = Schedule::new(m)?;
        let n = schedule.steps.len();
        Some(Self {
            schedule,
            kin: vec![Kin::default(); n],
            given: vec![Acc::default(); n],
            dof: vec![Dof::default(); n],
        })
    }

    /// Do enough bodies stand side by side?
    pub fn pays(&self) -> bool {
        let bodies: usize = self.schedule.steps.iter().map(|s| s.own.iter().filter(|own| **own).count()).sum();
        bodies > 0 && bodies as f64 >= WORTH * self.schedule.steps.len() as f64
    }
}

/// As [`super::aba`], with the same bits, limbs side by side.
pub fn aba_limbs(
    m: &Model,
    (ws, limbs): (&mut Workspace<f64>, &mut Limbs),
    state: (&[f64], &[f64]),
    tau: &[f64],
    gravity: [f64; 3],
    qdd: &mut [f64],
) {
    #[allow(unused_unsafe)] // elsewhere the features are not asked for
    // SAFETY: `Limbs::new` has asked the machine for both features.
    unsafe {
        plain(m, (ws, limbs), state, tau, gravity, qdd)
    };
}

/// As [`super::aba_hybrid`], with the same bits, limbs side by side. All bodies must take part, and none be damped.
pub(super) fn hybrid_limbs(
    m: &Model,
    (ws, limbs): (&mut Workspace<f64>, &mut Limbs),
    state: (&[f64], &[f64]),
    gravity: [f64; 3],
    qdd: &mut [f64],
) {
    #[allow(unused_unsafe)] // elsewhere the features are not asked for
    // SAFETY: `Limbs::new` has asked the machine for both features.
    unsafe {
        hybrid(m, (ws, limbs), state, gravity, qdd)
    };
}

#[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx2,fma"))]
fn plain(
    m: &Model,
    work: (&mut Workspace<f64>, &mut Limbs),
    state: (&[f64], &[f64]),
    tau: &[f64],
    gravity: [f64; 3],
    qdd: &mut [f64],
) {
    solve::<false>(m, work, state, tau, gravity, qdd);
}

#[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx2,fma"))]
fn hybrid(
    m: &Model,
    work: (&mut Workspace<f64>, &mut Limbs),
    state: (&[f64], &[f64]),
    gravity: [f64; 3],
    qdd: &mut [f64],
) {
    solve::<true>(m, work, state, &[], gravity, qdd);
}

#[inline(always)]
fn solve<const HYBRID: bool>(
    m: &Model,
    (ws, limbs): (&mut Workspace<f64>, &mut Limbs),
    (q, v): (&[f64], &[f64]),
    tau: &[f64],
    gravity: [f64; 3],
    qdd: &mut [f64],
) {
    let Limbs { schedule, kin, given, dof } = limbs;
    schedule.look(m);
    let steps = &schedule.steps[..];
    ws.kin[0] = Kin { r: M3::identity(), ..Kin::default() };
    for i in &schedule.alone {
        let own = moved(&m.bodies[*i], q, v, &ws.kin[0]);
        (ws.kin[*i], ws.acc[*i]) = (own, Acc::rigid(&m.bodies[*i], own.w, own.v));
    }
    for (s, step) in steps.iter().enumerate() {
        kin[s] = turned((&step.r, step.p), (pick(q, &step.q), pick(v, &step.v)), above(step, s, &ws.kin, kin));
    }
    for (s, step) in steps.iter().enumerate().rev() {
        let mut k = Acc::of_mass(step.mass, kin[s].w, kin[s].v);
        match &step.below {
            Below::Straight => k.add(&given[s + 1]),
            Below::Some(list) => list.iter().for_each(|(lane, from, l)| add_lane((&mut k, *lane), (&given[*from], *l))),
        }
        let speed = pick(v, &step.v);
        if !HYBRID || step.v.iter().all(|v| ws.dofs[*v].plain) {
            let tau = if HYBRID { X::from_numbers(step.v.map(|v| ws.dofs[v].tau)) } else { pick(tau, &step.v) };
            given[s] = revolute(&k, (&kin[s].r, step.p), (kin[s].w, kin[s].v), speed, (&mut dof[s], tau));
        } else {
            loaded(ws, step, (k, &kin[s]), speed, (&mut given[s], &mut dof[s]));
        }
        if HYBRID {
            export_dof(ws, step, &dof[s]);
        }
    }
    for (body, s, lane) in &schedule.hang {
        add_single(&mut ws.acc[*body], (&given[*s], *lane));
    }
    for i in schedule.alone.iter().rev() {
        let mut own = ws.acc[*i];
        inward::<f64, HYBRID>(&m.bodies[*i], ws, (*i, &mut own), (q, v), tau);
    }
    ws.start(V3::from(gravity));
    for i in &schedule.alone {
        outward::<f64, HYBRID>(&m.bodies[*i], ws, *i, (q, v), qdd);
    }
    for (s, step) in steps.iter().enumerate() {
        let (mut a, l) =
            turned_outward((&kin[s].r, step.p), pick(v, &step.v), (kin[s].w, kin[s].v), above(step, s, &ws.kin, kin));
        let d = &dof[s];
        let reach = d.ua.dot(a) + d.ul.dot(l);
        let acceleration = (-d.d).mad(reach, d.x);
        a.z += acceleration;
        (kin[s].w, kin[s].v) = (a, l);
        let reaction = d.own + reach;
        for lane in (0..LANES).filter(|lane| step.own[*lane]) {
            qdd[step.v[lane]] = acceleration.numbers()[lane];
            if HYBRID {
                ws.reaction[step.v[lane]] = reaction.numbers()[lane];
                if !ws.frugal {
                    ws.kin[step.body[lane]] = single_kin(&kin[s], lane);
                }
            }
        }
    }
}

/// One number for each lane.
#[inline(always)]
fn pick(x: &[f64], at: &[usize; LANES]) -> X {
    X::from_numbers([x[at[0]], x[at[1]], x[at[2]], x[at[3]]])
}

/// Motions of the parents.
#[inline(always)]
fn above(step: &Step, s: usize, alone: &[Kin<f64>], kin: &[Kin<X>]) -> (V3<X>, V3<X>) {
    if step.straight {
        let before = &kin[s - 1];
        return (before.w, before.v);
    }
    let f = &step.from;
    let (a, b, c, d) =
        (motion(f[0], alone, kin), motion(f[1], alone, kin), motion(f[2], alone, kin), motion(f[3], alone, kin));
    let row = |k: usize| X::from_numbers([a[k], b[k], c[k], d[k]]);
    (V3::new(row(0), row(1), row(2)), V3::new(row(3), row(4), row(5)))
}

#[inline(always)]
fn motion(place: Place, alone: &[Kin<f64>], kin: &[Kin<X>]) -> [f64; 6] {
    match place {
        Place::Alone(i) => {
            let (w, v) = (alone[i].w, alone[i].v);
            [w.x, w.y, w.z, v.x, v.y, v.z]
        }
        Place::Lane(s, lane) => {
            let (w, v) = (single(&kin[s].w, lane), single(&kin[s].v, lane));
            [w.x, w.y, w.z, v.x, v.y, v.z]
        }
    }
}

/// Bodies of which some have more than a torque on their joints: with a diagonal, or locked. The others keep the bits of
/// [`revolute`].
#[inline(always)]
fn loaded(
    ws: &Workspace<f64>,
    step: &Step,
    (mut k, kin): (Acc<X>, &Kin<X>),
    speed: X,
    (given, dof): (&mut Acc<X>, &mut Dof<X>),
) {
    let input = step.v.map(|v| ws.dofs[v]);
    let lanes = DofIn {
        tau: X::from_numbers(input.map(|d| d.tau)),
        diagonal: X::from_numbers(input.map(|d| d.diagonal)),
        free: X::from_numbers(input.map(|d| d.free)),
        acceleration: X::from_numbers(input.map(|d| d.acceleration)),
        plain: false,
    };
    if !input.iter().any(|d| d.plain) {
        eliminate_axis(&mut k, axis_z(), dof, &lanes);
        k.push(turning_bias(speed, (kin.w, kin.v)));
        *given = k.to_parent(&kin.r, step.p);
        return;
    }
    let mut plain_dof = Dof::default();
    let plain = revolute(&k, (&kin.r, step.p), (kin.w, kin.v), speed, (&mut plain_dof, lanes.tau));
    eliminate_axis(&mut k, axis_z(), dof, &lanes);
    k.push(turning_bias(speed, (kin.w, kin.v)));
    *given = k.to_parent(&kin.r, step.p);
    for lane in (0..LANES).filter(|lane| input[*lane].plain) {
        let acc = given.numbers_of_mut().iter_mut().zip(plain.numbers_of());
        let dof = dof.numbers_of_mut().iter_mut().zip(plain_dof.numbers_of());
        acc.chain(dof).for_each(|(to, from)| to.numbers_mut()[lane] = from.numbers()[lane]);
    }
}

/// Adds what one body hands on, to one lane.
fn add_lane((to, lane): (&mut Acc<X>, usize), (from, from_lane): (&Acc<X>, usize)) {
    for (to, from) in to.numbers_of_mut().iter_mut().zip(from.numbers_of()) {
        to.numbers_mut()[lane] += from.numbers()[from_lane];
    }
}

/// The same, to a body that is computed alone.
fn add_single(to: &mut Acc<f64>, (from, lane): (&Acc<X>, usize)) {
    for (to, from) in to.numbers_of_mut().iter_mut().zip(from.numbers_of()) {
        *to += from.numbers()[lane];
    }
}

fn single(v: &V3<X>, lane: usize) -> V3<f64> {
    V3::new(v.x.numbers()[lane], v.y.numbers()[lane], v.z.numbers()[lane])
}

fn single_kin(k: &Kin<X>, lane: usize) -> Kin<f64> {
    let r = &k.r.r;
    let r = M3::rows(single(&r[0], lane), single(&r[1], lane), single(&r[2], lane));
    Kin { r, w: single(&k.w, lane), v: single(&k.v, lane) }
}

/// What the elimination leaves, to where it is read after the pass.
fn export_dof(ws: &mut Workspace<f64>, step: &Step, dof: &Dof<X>) {
    for lane in (0..LANES).filter(|lane| step.own[*lane]) {
        if ws.frugal {
            ws.dof[step.v[lane]].d = dof.d.numbers()[lane];
            continue;
        }
        let to = ws.dof[step.v[lane]].numbers_of_mut();
        to.iter_mut().zip(dof.numbers_of()).for_each(|(to, from)| *to = from.numbers()[lane]);
    }
}
