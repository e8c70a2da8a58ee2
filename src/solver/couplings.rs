//! Axes that follow others (`<mimic>`): one equality row per follower, solved after each pass of the hybrid dynamics, before
//! the axes are asked whether they fit their laws. So a follower's stop holds its leader, and a leader's servo carries its
//! followers, without a law that knows of the other.

use super::axis_set::{AxisSet, StateRef, StepStart};
use super::contacts::{Contacts, Pass};
use super::lifting::Reached;
use super::rows::{Kind, Rows};
use super::seat::Seat;
use crate::dynamics::{Push, Response, Workspace};
use crate::model::{AxisSlot, Coupling, Model};

/// Share of a follower's deviation that one step takes back, by a speed. The rows keep the velocities together to rounding, so it
/// has only rounding, the curvature of a 3DOF group's angles and what an unsettled step has left to take back.
const ERP: f64 = 0.2;
/// The same in the stages of an explicit step: time constant of a critically damped return, in steps.
const RETURN: f64 = 10.0;
/// Sweeps before the direct finish. Couplings are few and equalities, so the finish is exact and cheap.
const SWEEPS: u32 = 10;
/// Share of the velocities at the start to which the rows are solved if that is possible: rounding, so that an explicit step
/// keeps its order and its energy.
pub(super) const AIM: f64 = 1e-14;
/// Share of the velocities at the start that may be left.
const TOLERANCE: f64 = 1e-11;
/// A row that moves this much less than it would without the locks of a spherical joint is held by them.
const HELD: f64 = 1e-10;
/// Velocities of two locked axes that agree, relative.
const AGREE: f64 = 1e-9;
/// Positions over the step that agree: what rounding makes of the speed that reaches a stop, relative.
const ROUNDING: f64 = 1e-13;
/// A deviation this small is rounding of the positions, relative: to chase it would keep a resting follower trembling.
const STILL: f64 = 4.0 * f64::EPSILON;

/// The rows of all couplings. Makes its memory once.
#[derive(Clone, Debug)]
pub struct Couplings {
    pub(super) response: Response,
    pub(super) rows: Rows,
    pub(super) pairs: Vec<Pair>,
    /// Stops that a lift reaches.
    pub(super) reached: Vec<Reached>,
    /// Step of the impulses that are kept, s.
    h: f64,
    /// `None` if nothing can touch.
    pub(super) contacts: Option<Contacts>,
}

/// One coupling, and what the present pass found of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub coupling: Coupling,
    follower: Seat,
    leader: Seat,
    pub pushes: [Push; 2],
    /// What the follower's end of the step (velocity; in explicit stages acceleration) is to fall short of the leader's
    /// by, so that a deviation goes.
    back: f64,
    /// Velocity of the follower against its leader's without the row, minus the one wanted.
    pub bias: f64,
    /// How large that is as rounding.
    pub slack: f64,
}

/// How a step asks for the couplings.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// Step, s.
    pub h: f64,
    /// Is this the first stage of the step? There the deviation is read that all stages take back.
    pub first: bool,
}

/// Position, velocity and acceleration of an axis.
#[derive(Clone, Copy)]
struct Motion {
    q: f64,
    v: f64,
    a: f64,
}

impl Couplings {
    /// Room for the couplings of this model; `None` if there are none in force.
    pub fn new(m: &Model) -> Option<Box<Self>> {
        let pair = |c: &Coupling| {
            let (follower, leader) = (Seat::of(m, c.follower)?, Seat::of(m, c.leader)?);
            Some(Pair { coupling: *c, follower, leader, pushes: Default::default(), back: 0.0, bias: 0.0, slack: 0.0 })
        };
        let pairs: Vec<Pair> = m.couplings_in_force().iter().filter_map(pair).collect();
        let contacts = if m.effects.contact { Contacts::new(m) } else { None };
        if pairs.is_empty() && contacts.is_none() {
            return None;
        }
        let response = Response::new(m);
        let mut rows = Rows::new(response.layout.width());
        for pair in &pairs {
            let mut ids = vec![];
            response.layout.join(pair.follower.body(), pair.leader.body(), &mut ids);
            rows.add(Kind::EQUALITY, 1, &ids);
        }
        Some(Box::new(Self { response, rows, pairs, reached: vec![], h: 0.0, contacts }))
    }

    /// Forgets the last step.
    pub fn reset(&mut self) {
        self.rows.reset();
        self.h = 0.0;
        if let Some(contacts) = &mut self.contacts {
            contacts.reset();
        }
    }

    /// All contacts, if anything can touch.
    pub fn contacts(&self) -> Option<&Contacts> {
        self.contacts.as_ref()
    }

    /// Is there nothing to solve?
    pub(super) fn idle(&self) -> bool {
        self.pairs.is_empty() && self.contacts.as_ref().is_none_or(Contacts::is_empty)
    }

    /// Solves the rows of `self.pairs`, and those of the contacts of an implicit step, and applies their impulses. True if
    /// the pairs hold then.
    fn solve(
        &mut self,
        m: &Model,
        ws: &mut Workspace<f64>,
        (pass, contacts): (&Pass, bool),
        set: &mut AxisSet,
        qdd: &mut [f64],
    ) -> bool {
        let h = pass.h;
        if self.h > 0.0 && self.h != h {
            self.rows.scale_impulses(h / self.h);
        }
        self.h = h;
        self.response.refresh(m, ws);
        self.rows.truncate(self.pairs.len());
        for (k, pair) in self.pairs.iter().enumerate() {
            let mobility = self.response.row(m, ws, pass.q, &pair.pushes, self.rows.response(k, 0));
            self.rows.row(k, 0).bias = pair.bias;
            if mobility.free > HELD * mobility.unlocked {
                self.rows.seal(k);
            } else {
                self.rows.switch_off(k);
            }
        }
        let mut contacts = self.contacts.as_mut().filter(|c| contacts && !c.is_empty());
        let solved = match &mut contacts {
            None => self.rows.solve(SWEEPS, AIM),
            Some(c) => {
                set.write_contests(m, ws, (&mut self.response, &mut self.rows), (pass.q, h, qdd));
                let solved = c.solve(m, ws, (&mut self.response, &mut self.rows), pass, qdd);
                set.take_contests(&mut self.response, &self.rows, h);
                solved
            }
        };
        for k in 0..self.pairs.len() {
            self.push(k, self.rows.row_impulse(k) / h);
        }
        self.response.apply(m, ws, pass.q, qdd);
        solved.within(TOLERANCE)
    }

    fn push(&mut self, k: usize, force: f64) {
        if force != 0.0 {
            for push in &self.pairs[k].pushes {
                self.response.push(push, force);
            }
        }
    }
}

/// How far the follower is from where its leader puts it; 0 if that is rounding.
fn deviation(pair: &Pair, follower: &Motion, leader: &Motion) -> f64 {
    let error = follower.q - pair.coupling.position(leader.q);
    let size = follower.q.abs() + (pair.coupling.ratio * leader.q).abs() + pair.coupling.offset.abs();
    if error.abs() <= STILL * size { 0.0 } else { error }
}

impl AxisSet {
    /// Reads how far the followers are from where their leaders put them at the start of an implicit step.
    pub(super) fn start_couplings(&mut self, m: &Model, start: &StepStart) {
        let Some(mut couplings) = self.couplings.take() else { return };
        if let Some(contacts) = &mut couplings.contacts {
            contacts.begin(m, (start.state.q, start.state.v), start.h);
        }
        for pair in &mut couplings.pairs {
            let motion = |axis: usize| Motion { q: self.axis_state(m, &m.axes[axis], start.state).0, v: 0.0, a: 0.0 };
            let error = deviation(pair, &motion(pair.coupling.follower), &motion(pair.coupling.leader));
            pair.back = ERP * error / start.h;
        }
        self.couplings = Some(couplings);
    }

    /// Coupled axes move alike: with their speeds at the end of the step as soon as one of them does.
    pub(super) fn share_ends(&mut self, m: &Model) {
        let Some(couplings) = self.couplings.take() else { return };
        let group = |axis: usize| match m.axes[axis].slot {
            AxisSlot::Euler { group, .. } => Some(group),
            _ => None,
        };
        let ends = |at_end: &[bool], axis: usize| match group(axis) {
            None => at_end[axis],
            own => (0..at_end.len()).any(|i| at_end[i] && group(i) == own),
        };
        for _ in 0..couplings.pairs.len() {
            let mut changed = false;
            for Coupling { follower, leader, .. } in couplings.pairs.iter().map(|p| p.coupling) {
                let end = ends(&self.at_end, follower) || ends(&self.at_end, leader);
                changed |= end && !(self.at_end[follower] && self.at_end[leader]);
                self.at_end[follower] |= end;
                self.at_end[leader] |= end;
            }
            if !changed {
                break;
            }
        }
        self.couplings = Some(couplings);
    }

    /// After a pass of an implicit step of `h` seconds: brings the ends of the step together, in `qdd` and `ws`. Returns how
    /// many couplings do not hold; then the laws have to be asked again.
    pub(super) fn couple(
        &mut self,
        m: &Model,
        ws: &mut Workspace<f64>,
        (s, v0): (StateRef, &[f64]),
        h: f64,
        qdd: &mut [f64],
    ) -> usize {
        let Some(mut couplings) = self.couplings.take_if(|c| !c.idle()) else { return 0 };
        for pair in &mut couplings.pairs {
            let (follower, leader, ratio) = self.motions(m, s, pair, qdd, false);
            pair.bias = follower.v + h * follower.a - ratio * (leader.v + h * leader.a) + pair.back;
            self.set_up(m, pair, (follower, leader, h));
        }
        let pass = Pass { q: s.q, v0, h, mean: self.mean, sweeps: self.sweeps };
        let converged = couplings.solve(m, ws, (&pass, true), self, qdd);
        let mut loose = usize::from(!converged && !couplings.pairs.is_empty());
        let mut forced = false;
        for k in 0..couplings.pairs.len() {
            let pair = couplings.pairs[k];
            if couplings.rows.is_off(k) && pair.bias.abs() > pair.slack {
                loose += 1;
                let force = self.break_loose(m, ws, &pair, qdd);
                couplings.push(k, force);
                forced |= force != 0.0;
            }
        }
        if forced {
            couplings.response.apply(m, ws, s.q, qdd);
        }
        self.agree(
            (m, ws),
            &couplings,
            qdd,
            |set, axis, a| set.speed_at_end(axis, a, h),
            |set, axis, end| (end - set.speed[axis]) / h,
        );
        self.couplings = Some(couplings);
        loose
    }

    /// Are there axes that follow others?
    pub fn is_coupled(&self) -> bool {
        self.couplings.as_ref().is_some_and(|c| !c.pairs.is_empty())
    }

    /// As `AxisSet::couple` in a stage of an explicit step: brings the accelerations together. False if the step is better
    /// made otherwise.
    ///
    /// What takes a deviation back is read at the beginning of the step: the stages in between leave a curved constraint by
    /// the order of their own, and chasing that would cost the step its order.
    pub fn couple_smooth(
        &mut self,
        m: &Model,
        ws: &mut Workspace<f64>,
        s: StateRef,
        stage: Stage,
        qdd: &mut [f64],
    ) -> bool {
        let Some(mut couplings) = self.couplings.take_if(|c| !c.pairs.is_empty()) else { return true };
        let h = stage.h;
        for pair in &mut couplings.pairs {
            let (follower, leader, ratio) = self.motions(m, s, pair, qdd, true);
            if stage.first {
                let speed = follower.v - ratio * leader.v;
                let rate = 1.0 / (RETURN * h);
                pair.back = rate * (2.0 * speed + rate * deviation(pair, &follower, &leader));
            }
            pair.bias = h * (follower.a - ratio * leader.a + pair.back);
            self.set_up(m, pair, (follower, leader, h));
        }
        let pass = Pass { q: s.q, v0: s.v, h, mean: true, sweeps: SWEEPS };
        let converged = couplings.solve(m, ws, (&pass, false), self, qdd);
        let held = |k: usize| couplings.rows.is_off(k) && couplings.pairs[k].bias.abs() > couplings.pairs[k].slack;
        let loose = (0..couplings.pairs.len()).any(held);
        self.agree((m, ws), &couplings, qdd, |_, _, a| a, |_, _, end| end);
        self.couplings = Some(couplings);
        converged && !loose
    }

    /// Takes out the rounding of the rows, so that what stands still with a locked partner stands exactly still: from the
    /// follower that is hardest to move to a leader that is easier to move, then from the leaders to all others, so that the
    /// heavy side never takes over the rounding of the light one. `end` makes of an axis' acceleration what the coupling
    /// is about, `acceleration` goes back.
    fn agree(
        &self,
        (m, ws): (&Model, &Workspace<f64>),
        couplings: &Couplings,
        qdd: &mut [f64],
        end: impl Fn(&Self, usize, f64) -> f64,
        acceleration: impl Fn(&Self, usize, f64) -> f64,
    ) {
        for to_leaders in [true, false] {
            for (k, pair) in couplings.pairs.iter().enumerate() {
                let c = pair.coupling;
                let (AxisSlot::Scalar { v: f, .. }, AxisSlot::Scalar { v: l, .. }) =
                    (m.axes[c.follower].slot, m.axes[c.leader].slot)
                else {
                    continue;
                };
                if couplings.rows.is_off(k) || self.leads(m, ws, couplings, &c) != to_leaders {
                    continue;
                }
                if to_leaders {
                    let wanted = (end(self, c.follower, qdd[f]) + pair.back) / c.ratio;
                    qdd[l] = acceleration(self, c.leader, wanted);
                } else {
                    let wanted = c.ratio * end(self, c.leader, qdd[l]) - pair.back;
                    qdd[f] = acceleration(self, c.follower, wanted);
                }
            }
        }
    }

    /// Is this follower harder to move than its leader, and than all that follow the same one?
    fn leads(&self, m: &Model, ws: &Workspace<f64>, couplings: &Couplings, c: &Coupling) -> bool {
        let own = self.mobility(m, ws, c.follower);
        let easier = |o: &Coupling| own * o.ratio * o.ratio <= self.mobility(m, ws, o.follower) * c.ratio * c.ratio;
        let mut others = couplings.pairs.iter().map(|p| &p.coupling).filter(|o| o.leader == c.leader);
        own < c.ratio * c.ratio * self.mobility(m, ws, c.leader) && others.all(easier)
    }

    /// Speed of an axis at the end of an implicit step.
    fn speed_at_end(&self, axis: usize, acceleration: f64, h: f64) -> f64 {
        let place = self.place[axis];
        if place.is_multiple_of(2) {
            return self.speed[axis] + h * acceleration;
        }
        self.laws[axis].knots[place / 2].speed
    }

    /// Motion of follower and leader, and the ratio. The acceleration of an angle of a group is that of its gradient,
    /// `g·ω̇`, as the implicit laws have it, or the `true` one of the angle itself.
    fn motions(&self, m: &Model, s: StateRef, pair: &Pair, qdd: &[f64], real: bool) -> (Motion, Motion, f64) {
        let motion = |axis: usize| {
            let (q, v) = self.axis_state(m, &m.axes[axis], s);
            let v = if real { v } else { self.speed[axis] };
            Motion { q, v, a: self.acceleration(m, s, axis, qdd, real) }
        };
        (motion(pair.coupling.follower), motion(pair.coupling.leader), pair.coupling.ratio)
    }

    fn acceleration(&self, m: &Model, s: StateRef, axis: usize, qdd: &[f64], real: bool) -> f64 {
        let along = self.axis_rate(m, &m.axes[axis], qdd);
        match m.axes[axis].slot {
            AxisSlot::Euler { group, angle } if real => {
                along - self.rates[group].gradient[angle].dot(self.turning(m, s, group))
            }
            _ => along,
        }
    }

    /// Sets the forces and the slack of a pair.
    fn set_up(&self, m: &Model, pair: &mut Pair, (f, l, h): (Motion, Motion, f64)) {
        let c = pair.coupling;
        pair.pushes =
            [self.push_of(m, c.follower, pair.follower, 1.0), self.push_of(m, c.leader, pair.leader, -c.ratio)];
        let speeds = f.v.abs() + h * f.a.abs() + c.ratio.abs() * (l.v.abs() + h * l.a.abs());
        let positions = (f.q.abs() + (c.ratio * l.q).abs() + c.offset.abs()) / h;
        pair.slack = AGREE * speeds + ROUNDING * positions;
    }
}
