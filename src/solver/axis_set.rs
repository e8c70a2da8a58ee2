//! All axes at once: which of them stand on a riser of their law, which slide on a segment.
//!
//! A standing axis is locked to the speed of its riser by the hybrid dynamics, exactly; a sliding one gets the torque of
//! its segment. After each pass the axes whose reaction or speed does not fit move to the neighbouring part of their law. All
//! that do not fit move at once while that helps; else only the last of them (block principal pivoting with Murty's rule
//! as the fallback; Júdice and Pires 1994), which ends because the mass matrix is positive definite.
//!
//! A sliding axis moves with the mean of its speeds at the start and the end of the step, of second order. One that stands,
//! or whose slope is stiff against the step, moves with the speed at the end: of first order, but it cannot ring.

use super::between::Between;
use super::books::Books;
use super::contested::Contest;
use super::couplings::Couplings;
use super::driven::Driven;
use super::law::{FRICTION, Law};
use super::mobility::Answers;
use super::{AxisCommand, AxisInput, Brakes};
use crate::dynamics::{Workspace, aba_hybrid};
use crate::math::V3;
use crate::model::{Axis, AxisSlot, Effects, EulerRates, Model};

/// Passes that may move all axes at once without getting better.
const PATIENCE: u32 = 3;

/// A state as the solver sees it.
#[derive(Clone, Copy, Debug)]
pub struct StateRef<'a> {
    /// Coordinates.
    pub q: &'a [f64],
    /// Velocities.
    pub v: &'a [f64],
    /// H, P, B of each 3DOF group.
    pub angles: &'a [[f64; 3]],
}

/// What a step starts from.
#[derive(Clone, Copy, Debug)]
pub struct StepStart<'a> {
    /// State at the start.
    pub state: StateRef<'a>,
    /// Commands of all axes.
    pub commands: &'a [AxisCommand],
    /// Step, s.
    pub h: f64,
    /// The step that it is a piece of, s.
    pub whole: f64,
    /// Sliding axes move with their mean speed; else all move with the speed at the end.
    pub mean: bool,
    /// Sweeps over the rows of contacts, at most.
    pub sweeps: u32,
}

/// Laws and places of all axes. Makes its memory once.
#[derive(Clone, Debug)]
pub struct AxisSet {
    /// The drives, and what became of them.
    pub books: Books,
    pub(super) laws: Vec<Law>,
    /// Effects that the laws were made with.
    effects: Effects,
    /// Axes whose laws need not be made anew.
    pub(super) between: Vec<Between>,
    /// Is there an axis that is put back into its range after the step?
    pub(super) pushes: bool,
    /// Is there a servo, which will be told its mobility?
    servos: bool,
    /// Per axis: 2 j on segment j, 2 k + 1 on riser k.
    pub(super) place: Vec<usize>,
    /// Per axis: it moves with its speed at the end of the step.
    pub(super) at_end: Vec<bool>,
    /// Per axis: its slope was stiff against the last step.
    pub(super) stiff: Vec<bool>,
    /// Kinds of the riser an axis stood on at the end of the last step; 0 = it slid.
    pub(super) memory: Vec<u8>,
    pub(super) moves: Vec<isize>,
    /// Per axis of a 3DOF group: which of its group's locks is its own, while it is locked.
    pub(super) lock: Vec<usize>,
    pub(super) rates: Vec<EulerRates>,
    /// Speed at the start of the step.
    pub(super) speed: Vec<f64>,
    pub(super) brakes: Vec<Brakes>,
    /// Per axis: inertia of the rotor, 0 while that effect is off.
    pub(super) rotor: Vec<f64>,
    /// Per axis with a rotor: what its gradient times ω̇ has beyond the acceleration of its angle; 0 but in 3DOF groups.
    pub(super) turning: Vec<f64>,
    /// Per velocity coordinate: share of the new velocity in the speed with which it moves, ½ or 1.
    pub weight: Vec<f64>,
    /// Per axis, then per soft direction: work of the last step with the speeds at its start, and at its end, J.
    pub(super) paid: Vec<(f64, f64)>,
    /// The same of the damping of bodies.
    pub(super) damped: (f64, f64),
    /// Per axis: is it a row beside contacts? Empty if nothing can touch.
    pub(super) contests: Vec<Contest>,
    /// Pass of the step.
    passes: u32,
    /// Step of the last pass, s.
    pub(super) h: f64,
    /// What joints change from step to step, for the rule that asks for it.
    pub driven: Option<Box<Driven>>,
    /// Per axis: its tree is out of the computation. Empty if nothing ever rests.
    pub resting: Vec<bool>,
    pub(super) mean: bool,
    /// Sweeps over the rows of contacts, at most.
    pub(super) sweeps: u32,
    best: usize,
    patience: u32,
    /// Rows that hold followers to their leaders, if there are any.
    pub(super) couplings: Option<Box<Couplings>>,
    /// `None` only while it is used.
    pub(super) answers: Option<Box<Answers>>,
}

impl AxisSet {
    /// Room for this model.
    pub fn new(model: &Model) -> Self {
        let n = model.axes.len();
        let couplings = Couplings::new(model);
        let contested = if couplings.as_ref().is_some_and(|c| c.contacts().is_some()) { n } else { 0 };
        Self {
            books: Books::new(model),
            laws: vec![Law::default(); n],
            effects: Effects::NONE,
            between: Between::all(model),
            pushes: false,
            servos: false,
            place: vec![0; n],
            at_end: vec![true; n],
            stiff: vec![false; n],
            memory: vec![0; n],
            moves: vec![0; n],
            lock: vec![0; n],
            rates: vec![EulerRates::default(); model.eulers.len()],
            speed: vec![0.0; n],
            brakes: vec![Brakes::default(); n],
            rotor: vec![0.0; n],
            turning: vec![0.0; n],
            weight: vec![1.0; model.nv],
            couplings,
            answers: Some(Box::new(Answers::new(model))),
            paid: vec![(0.0, 0.0); n + model.softs.len()],
            damped: (0.0, 0.0),
            contests: vec![Contest::default(); contested],
            passes: 0,
            h: 0.0,
            driven: None,
            resting: vec![false; if model.effects.deactivation { n } else { 0 }],
            mean: false,
            sweeps: 1,
            best: usize::MAX,
            patience: PATIENCE,
        }
    }

    /// Forgets the steps so far.
    pub fn reset(&mut self) {
        self.memory.fill(0);
        self.books.reset();
        self.stiff.fill(false);
        self.resting.fill(false);
        self.brakes.fill(Brakes::default());
        if let Some(couplings) = &mut self.couplings {
            couplings.reset();
        }
    }

    /// Sets up the laws of a step and the first guess of each axis' place. True if a 3DOF group is at its pole.
    pub fn prepare(&mut self, m: &Model, start: &StepStart, effects: Effects) -> bool {
        let at_pole = self.update_rates(m, start.state.angles);
        (self.best, self.patience) = (usize::MAX, PATIENCE);
        (self.passes, self.h) = (0, start.h);
        self.contests.fill(Contest::default());
        if self.effects != effects {
            self.laws.iter_mut().for_each(|law| law.plain = false);
            self.effects = effects;
        }
        (self.pushes, self.servos) = (false, false);
        for (i, axis) in m.axes.iter().enumerate() {
            if self.rests(i) {
                self.between[i].on = false;
                self.pushes |= self.laws[i].push != 0.0;
            } else if !self.prepare_between(i, start, effects) {
                self.prepare_axis(m, (i, axis), start, effects);
            }
        }
        (self.mean, self.sweeps) = (start.mean, start.sweeps);
        self.start_couplings(m, start);
        self.set_weights(m);
        at_pole
    }

    /// The law of one axis, and the first guess of its place.
    fn prepare_axis(&mut self, m: &Model, (i, axis): (usize, &Axis), start: &StepStart, effects: Effects) {
        let (q, v) = self.axis_state(m, axis, start.state);
        self.speed[i] = v;
        if effects.limits {
            self.books.watch_stop(axis, q);
        }
        self.rotor[i] = self.books.rotor(i, effects);
        let input = AxisInput {
            axis,
            limits: &self.books.drives[i],
            command: start.commands[i],
            q,
            stuck: self.memory[i] & FRICTION != 0 || v == 0.0,
            brakes: self.brakes[i],
        };
        if axis.is_graspable(&self.rates) {
            self.laws[i].set(&input, effects, (start.h, start.whole))
        } else {
            self.laws[i].clear()
        }
        self.pushes |= self.laws[i].push != 0.0;
        self.servos |= self.laws[i].is_servo();
        self.place[i] = self.laws[i].guess(v, self.memory[i]);
        self.at_end[i] = !start.mean || self.stiff[i] || self.place[i] % 2 == 1 || self.laws[i].in_soft_stop;
    }

    /// Is the tree of an axis out of the computation?
    #[inline(always)]
    pub(super) fn rests(&self, axis: usize) -> bool {
        self.resting.get(axis) == Some(&true)
    }

    #[inline(always)]
    pub(super) fn axis_state(&self, m: &Model, axis: &Axis, s: StateRef) -> (f64, f64) {
        match axis.slot {
            AxisSlot::Scalar { q, v } => (s.q[q], s.v[v]),
            AxisSlot::Euler { group, angle } => (s.angles[group][angle], self.axis_rate(m, axis, s.v)),
            AxisSlot::Apart { position } => (position, 0.0),
        }
    }

    /// One pass of an implicit step after [`AxisSet::prepare`]: accelerations from `v0`, the velocities at the start, with
    /// everything else at the state `at`. Returns how many axes do not fit their laws; they have been moved then, if another
    /// pass is `wanted`.
    pub fn pass(
        &mut self,
        m: &Model,
        ws: &mut Workspace<f64>,
        (at, v0): (StateRef, &[f64]),
        (gravity, h): ([f64; 3], f64),
        (qdd, wanted): (&mut [f64], bool),
    ) -> usize {
        self.take_rates(m, at, v0);
        self.write_inputs(m, ws, h);
        ws.frugal = !self.servos && self.couplings.as_ref().is_none_or(|c| c.idle());
        aba_hybrid(m, ws, (at.q, at.v), gravity, qdd);
        if let Some(driven) = &mut self.driven {
            driven.note(ws, qdd);
        }
        if let Some(answers) = &mut self.answers {
            answers.forget();
        }
        let loose = self.couple(m, ws, (at, v0), h, qdd);
        let misfits = self.misfits(m, ws, (h, qdd)) + loose;
        self.passes += 1;
        if misfits > 0 && wanted {
            if misfits < self.best {
                (self.best, self.patience) = (misfits, PATIENCE);
            } else {
                self.patience = self.patience.saturating_sub(1);
            }
            self.apply(self.patience > 0);
            self.set_weights(m);
        }
        misfits
    }

    /// At most `passes` passes at the state at the start of a step; true if every axis fits its law after one of them.
    pub fn settle(
        &mut self,
        m: &Model,
        ws: &mut Workspace<f64>,
        at: StateRef,
        (gravity, h, passes): ([f64; 3], f64, u32),
        qdd: &mut [f64],
    ) -> bool {
        let passes = passes.max(1);
        (1..=passes).any(|pass| self.pass(m, ws, (at, at.v), (gravity, h), (&mut *qdd, pass < passes)) == 0)
    }

    /// Notes for every axis to which side it leaves its part of the law; returns how many do.
    fn misfits(&mut self, m: &Model, ws: &Workspace<f64>, (h, qdd): (f64, &[f64])) -> usize {
        let (mut count, mut breaking) = (0, 0);
        for (i, axis) in m.axes.iter().enumerate() {
            if self.stays_between(ws, i, (h, qdd)) {
                continue;
            }
            self.moves[i] = 0;
            if self.rests(i) {
                continue;
            }
            if self.is_contested(i) {
                let end = self.speed[i] + h * self.axis_rate(m, axis, qdd);
                self.moves[i] = self.leaves_contest(i, end);
                count += usize::from(self.moves[i] != 0);
                continue;
            }
            let (law, place) = (&self.laws[i], self.place[i]);
            if place % 2 == 1 {
                self.moves[i] = law.leaves_riser(place / 2, self.riser_torque(m, ws, i, qdd));
                let moves = usize::from(self.moves[i] != 0);
                if law.stiction > 0.0 {
                    breaking += moves
                } else {
                    count += moves
                }
                continue;
            }
            let stiff = law.segments[place / 2].slope * h * self.mobility(m, ws, i) > 1.0;
            self.stiff[i] = stiff;
            if law.smooth() && (self.at_end[i] || !stiff) {
                continue;
            }
            let end = self.speed[i] + h * self.axis_rate(m, axis, qdd);
            let mean = if self.at_end[i] { end } else { 0.5 * (self.speed[i] + end) };
            let (by_mean, by_end) = (law.leaves_segment(place / 2, mean), law.leaves_segment(place / 2, end));
            self.moves[i] = if by_mean != 0 { by_mean } else { by_end };
            let hardens = !self.at_end[i] && (stiff || self.moves[i] != 0);
            self.at_end[i] |= hardens;
            count += usize::from(hardens || self.moves[i] != 0);
        }
        if count > 0 && breaking > 0 {
            self.keep_stuck();
        }
        count + breaking
    }

    /// An axis breaks loose only when all others fit their laws: before that its reaction may be that of a guess.
    fn keep_stuck(&mut self) {
        for (step, (law, place)) in self.moves.iter_mut().zip(self.laws.iter().zip(&self.place)) {
            if place % 2 == 1 && law.stiction > 0.0 {
                *step = 0;
            }
        }
    }

    /// Moves all that do not fit, or only the last of them.
    fn apply(&mut self, all: bool) {
        let contest = self.passes > 1 && self.contacts().is_some_and(|c| !c.is_empty());
        for i in (0..self.moves.len()).rev() {
            if self.moves[i] == 0 || (contest && self.contest(i, self.moves[i])) {
                continue;
            }
            self.place[i] = self.laws[i].neighbour(self.place[i], self.moves[i]);
            self.laws[i].hold(self.place[i]);
            self.at_end[i] |= self.place[i] % 2 == 1;
            if !all {
                return;
            }
        }
    }

    /// Per axis: inertia of the rotor that counts, kg·m² or kg.
    pub fn rotors(&self) -> impl Iterator<Item = f64> {
        self.rotor.iter().copied()
    }

    /// True if no axis has been moved to another part of its law in the last pass.
    pub fn is_calm(&self) -> bool {
        self.best == usize::MAX
    }

    /// Gradients of the angles at these angles; true if a 3DOF group is at its pole.
    pub fn update_rates(&mut self, m: &Model, angles: &[[f64; 3]]) -> bool {
        m.write_rates(angles, &mut self.rates)
    }

    /// Rate of an axis for rates of the velocity coordinates: its speed from velocities, its acceleration from
    /// accelerations (of an angle: with its gradient held).
    #[inline(always)]
    pub(super) fn axis_rate(&self, m: &Model, axis: &Axis, rates: &[f64]) -> f64 {
        match axis.slot {
            AxisSlot::Scalar { v, .. } => rates[v],
            AxisSlot::Euler { group, angle } => {
                let g = self.rates[group].gradient[angle];
                let at = m.eulers[group].v;
                g.dot(V3::new(rates[at], rates[at + 1], rates[at + 2]))
            }
            AxisSlot::Apart { .. } => 0.0,
        }
    }
}
