//! Workspaces of several robots, one in each lane of one workspace.

use super::Request;
use super::pass::WIDEST;
use crate::dynamics::aba::kernel;
use crate::dynamics::{BallIn, DofIn, Workspace};
use crate::math::{Flat, Lane, V3};
use crate::model::{Bodies, JointType, Model};

/// Scratch of one model at a time.
pub(super) struct Lanes<T> {
    /// Those that it is for.
    bodies: Bodies,
    ws: Workspace<T>,
    q: Vec<T>,
    v: Vec<T>,
    qdd: Vec<T>,
    /// Floating bodies: what they have collected is read after the pass.
    floating: Vec<usize>,
}

impl<T: Lane> Lanes<T> {
    pub fn new() -> Self {
        let bodies = Bodies::default();
        Self { bodies, ws: Workspace::default(), q: vec![], v: vec![], qdd: vec![], floating: vec![] }
    }

    /// Computes for robots with the bodies of this model, not more than there are lanes.
    #[inline(always)]
    pub fn solve(&mut self, m: &Model, requests: &[&Request]) {
        if !self.bodies.is_shared_with(&m.bodies) {
            self.fit(m);
        }
        let gravity = self.gather(requests);
        kernel::<T, true>(m, &mut self.ws, (&self.q, &self.v), &[], gravity, &mut self.qdd);
        self.scatter(requests);
    }

    #[cold]
    fn fit(&mut self, m: &Model) {
        if self.bodies == m.bodies {
            self.bodies = m.bodies.clone();
            return;
        }
        let zero = T::of(0.0);
        *self = Self {
            bodies: m.bodies.clone(),
            ws: Workspace::of_lanes(m),
            q: m.neutral().into_iter().map(T::of).collect(),
            v: vec![zero; m.nv],
            qdd: vec![zero; m.nv],
            floating: (1..m.bodies.len()).filter(|i| m.bodies[*i].joint == JointType::Floating).collect(),
        };
    }

    /// Lanes that are left over repeat the first; returns the gravity of each.
    #[inline(always)]
    fn gather(&mut self, requests: &[&Request]) -> V3<T> {
        let mut gravity = V3::<T>::default();
        let mut dofs: [&[DofIn<f64>]; WIDEST] = [&[]; WIDEST];
        let (mut q, mut v): ([&[f64]; WIDEST], [&[f64]; WIDEST]) = ([&[]; WIDEST], [&[]; WIDEST]);
        for lane in 0..T::COUNT {
            let request = requests.get(lane).unwrap_or(&requests[0]);
            // SAFETY: who waits borrows all this, and nobody writes to it now.
            let ws = unsafe { request.ws.as_ref() };
            // SAFETY: as above.
            (q[lane], v[lane], dofs[lane]) = unsafe { (request.q.as_ref(), request.v.as_ref(), &ws.dofs[..]) };
            put_one(gravity.numbers_of_mut(), &request.gravity, lane);
            for (to, from) in self.ws.ball_in.iter_mut().zip(&ws.ball_in) {
                put_ball(to, from, lane);
            }
        }
        put(&mut self.q, &q);
        put(&mut self.v, &v);
        for k in 0..self.ws.dofs.len() {
            self.ws.mixed[k] = put_dof(&mut self.ws.dofs[k], &dofs, k);
        }
        gravity
    }

    /// Writes to the workspaces what the pass leaves behind.
    #[inline(always)]
    fn scatter(&self, requests: &[&Request]) {
        // SAFETY: who waits borrows it, exclusively, and each waits with a workspace of its own.
        let each = |request: &&Request| unsafe { &mut *request.ws.as_ptr() };
        // SAFETY: as above.
        take(&self.qdd, requests, |request| unsafe { &mut *request.qdd.as_ptr() });
        take(&self.ws.reaction, requests, |r| &mut each(r).reaction);
        take(Flat::flat(&self.ws.balls), requests, |r| Flat::flat_mut(&mut each(r).balls));
        if requests.iter().all(|r| each(r).frugal) {
            for (k, dof) in self.ws.dof.iter().enumerate() {
                requests.iter().zip(dof.d.numbers()).for_each(|(r, d)| each(r).dof[k].d = *d);
            }
            requests.iter().for_each(|r| each(r).bare = true);
        } else {
            take(Flat::flat(&self.ws.kin), requests, |r| Flat::flat_mut(&mut each(r).kin));
            take(Flat::flat(&self.ws.dof), requests, |r| Flat::flat_mut(&mut each(r).dof));
            for i in &self.floating {
                take(self.ws.acc[*i].numbers_of(), requests, |r| each(r).acc[*i].numbers_of_mut());
            }
            requests.iter().for_each(|r| each(r).bare = false);
        }
        for (ball, from) in self.ws.ball_in.iter().enumerate() {
            for (n, lock) in from.lock[..from.locks].iter().enumerate() {
                for (lane, request) in requests.iter().enumerate() {
                    each(request).ball_in[ball].lock[n].reaction = lock.reaction.numbers()[lane];
                }
            }
        }
    }
}

/// Each list to a lane.
#[inline(always)]
fn put<T: Lane>(to: &mut [T], from: &[&[f64]; WIDEST]) {
    let mut done = 0;
    for block in to.chunks_exact_mut(T::COUNT) {
        for (row, from) in block.iter_mut().zip(from) {
            *row = T::read(&from[done..done + T::COUNT]);
        }
        T::transpose(block);
        done += T::COUNT;
    }
    for (k, to) in to.iter_mut().enumerate().skip(done) {
        to.numbers_mut().iter_mut().zip(from).for_each(|(to, from)| *to = from[k]);
    }
}

/// Inputs `k` of all lanes; 1 in the lanes where it is plain, if there are others.
#[inline(always)]
fn put_dof<T: Lane>(to: &mut DofIn<T>, from: &[&[DofIn<f64>]; WIDEST], k: usize) -> Option<T> {
    let mut plain = 0;
    for (tau, from) in to.tau.numbers_mut().iter_mut().zip(from) {
        *tau = from[k].tau;
        plain += usize::from(from[k].plain);
    }
    if plain == T::COUNT {
        *to = DofIn::free(to.tau);
        return None;
    }
    let mut mask = T::of(0.0);
    for (lane, from) in from.iter().enumerate().take(T::COUNT) {
        let from = &from[k];
        to.diagonal.numbers_mut()[lane] = from.diagonal;
        to.free.numbers_mut()[lane] = from.free;
        to.acceleration.numbers_mut()[lane] = from.acceleration;
        mask.numbers_mut()[lane] = f64::from(u8::from(from.plain));
    }
    to.plain = false;
    (plain > 0).then_some(mask)
}

#[inline(always)]
fn put_one<T: Lane>(to: &mut [T], from: &[f64], lane: usize) {
    for (to, from) in to.iter_mut().zip(from) {
        to.numbers_mut()[lane] = *from;
    }
}

/// As many locks in every lane.
#[inline(always)]
fn put_ball<T: Lane>(to: &mut BallIn<T>, from: &BallIn<f64>, lane: usize) {
    put_one(to.tau.numbers_of_mut(), from.tau.numbers_of(), lane);
    put_one(to.inertia.numbers_of_mut(), from.inertia.numbers_of(), lane);
    to.locks = from.locks;
    for (to, from) in to.lock.iter_mut().zip(&from.lock[..from.locks]) {
        put_one(to.gradient.numbers_of_mut(), from.gradient.numbers_of(), lane);
        to.acceleration.numbers_mut()[lane] = from.acceleration;
    }
}

/// Copies the lanes of a list to where each request has it.
#[inline(always)]
fn take<'a, T: Lane>(from: &[T], requests: &[&'a Request], place: impl Fn(&&'a Request) -> &'a mut [f64]) {
    let mut to: [&mut [f64]; WIDEST] = Default::default();
    for (to, request) in to.iter_mut().zip(requests) {
        *to = place(request);
    }
    let mut block = [T::of(0.0); WIDEST];
    let mut done = 0;
    for part in from.chunks_exact(T::COUNT) {
        block[..T::COUNT].copy_from_slice(part);
        T::transpose(&mut block[..T::COUNT]);
        for (to, own) in to.iter_mut().zip(&block[..requests.len()]) {
            to[done..done + T::COUNT].copy_from_slice(own.numbers());
        }
        done += T::COUNT;
    }
    for (lane, to) in to.iter_mut().enumerate().take(requests.len()) {
        for (to, from) in to[done..].iter_mut().zip(&from[done..]) {
            *to = from.numbers()[lane];
        }
    }
}
