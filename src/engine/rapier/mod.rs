//! rapier: a rigid body for each link, joints as rows of impulses, solved by small substeps (rapier3d-f64).
//!
//! A step of h seconds is one of rapier's with W-6 as its number of substeps (`num_solver_iterations`): each makes h/W-6 seconds
//! with some sweeps over all rows. With anything that acts on an axis, or joints that break, it is W-6 steps of one substep each: then
//! what an axis gives, and what a contact carries, is known for all of the step and not only for its last substep, and laws
//! and gradients are those of each substep. That finds the contacts anew in each of them, and takes accordingly longer.
//!
//! This room alone names rapier and its vectors.

mod contacts;
mod convert;
mod honour;
mod joints;
mod pairs;
mod parts;
mod shapes;
mod sim;

use super::actuation::{Actuation, Start};
use super::maximal::{Gap, read_state};
use super::sleep::same;
use super::{Engine, EngineKind, Integrator, State, StepReport, StepSettings};
use crate::dynamics::{Kinematics, kinematics};
use crate::math::V3;
use crate::model::{Effects, Model};
use crate::solver::{AxisCommand, Books, ContactPoint};
pub use honour::{shape_name, shortfalls};

use contacts::{Contacts, Filter, insert_colliders};
use joints::{Load, Rows};
use parts::Parts;
use sim::Sim;

/// A model in rapier: a clone goes on with the same bits.
#[derive(Clone, Debug)]
pub struct Rapier {
    state: State,
    before: State,
    /// At the start of a part of it.
    start: State,
    /// Where the bodies are.
    k: Kinematics,
    /// Where they were at the start of the last part of a step.
    from: Kinematics,
    laws: Actuation,
    sim: Sim,
    parts: Parts,
    rows: Rows,
    contacts: Contacts,
    /// Per body: what acts on it in a step.
    loads: Vec<Load>,
    /// Per axis: what its motor and its stops gave.
    motors: Vec<f64>,
    stops: Vec<f64>,
    widest: Gap,
    /// What the bodies came to rest with.
    last: (Vec<AxisCommand>, [f64; 3]),
}

/// A part of a step: its length and that of the step, s, and substeps in it.
#[derive(Clone, Copy)]
struct Part {
    h: f64,
    whole: f64,
    substeps: u32,
}

impl Rapier {
    /// At a state of the model. Allocates.
    pub fn new(m: &Model, state: &State) -> Self {
        let mut k = Kinematics::new(m);
        let mut state = state.clone();
        let (sim, parts, rows) = build(m, &mut state, &mut k);
        Self {
            before: state.clone(),
            start: state.clone(),
            state,
            from: k.clone(),
            k,
            laws: Actuation::new(m),
            sim,
            parts,
            rows,
            contacts: Contacts::new(m),
            loads: vec![Load::default(); m.bodies.len()],
            motors: vec![0.0; m.axes.len()],
            stops: vec![0.0; m.axes.len()],
            widest: Gap::default(),
            last: (vec![AxisCommand::IDLE; m.axes.len()], [0.0; 3]),
        }
    }

    /// Makes rapier's world anew at a state: the same state goes on with the same bits. Allocates.
    fn put(&mut self, m: &Model, state: &State) {
        self.state.clone_from(state);
        self.before.clone_from(state);
        self.start.clone_from(state);
        (self.sim, self.parts, self.rows) = build(m, &mut self.state, &mut self.k);
        let worst = self.contacts.worst;
        self.contacts = Contacts { worst, ..Contacts::new(m) };
        self.from.clone_from(&self.k);
        self.loads.resize(m.bodies.len(), Load::default());
        self.laws.forget();
    }

    /// One part of a step; false if something is not finite.
    fn part(&mut self, m: &Model, commands: &[AxisCommand], s: &StepSettings, part: Part) -> (bool, bool) {
        let start = Start { state: &self.state, commands, effects: s.effects, h: (part.h, part.whole) };
        let at_pole = self.laws.prepare(m, &start);
        self.loads.fill(Load::default());
        self.rows.set(m, &mut self.sim, &self.laws, (&self.k, &self.state, part.h), &mut self.loads);
        self.load();
        let gravity = V3::from(s.gravity);
        let sound = self.sim.step((part.h, part.substeps as usize), gravity, &Filter(m));
        let substep = part.h / f64::from(part.substeps);
        self.contacts.read(m, &self.sim, (part.h, part.whole, substep));
        self.contacts.roll(m, &mut self.sim, &self.parts, (&self.k, part.h));
        self.laws.books.work.contacts += std::mem::take(&mut self.contacts.rolled);
        if s.effects.body_damping {
            self.damp(m, part.h);
        }
        self.from.copy_from(&self.k);
        self.parts.read(m, &self.sim, &self.state, &mut self.k);
        self.laws.books.work.contacts += self.contacts.taken(m, [&self.from, &self.k], part.h);
        self.start.copy_from(&self.state);
        let gap = read_state(m, &self.k, &mut self.state);
        let finite = sound && self.state.finite();
        if finite {
            self.widest = self.widest.max(gap);
            self.rows.read(&self.sim, (substep, &self.start), &mut self.motors, &mut self.stops);
            self.laws.book_stops(m, part.h, &self.state, &self.stops);
            self.laws.finish(m, (part.h, part.whole), &self.state, &self.motors);
        }
        (finite, at_pole)
    }

    /// Hands the constant torques to rapier.
    fn load(&mut self) {
        for (i, load) in self.loads.iter().enumerate().skip(1) {
            let center = self.parts.center(&self.k, i);
            let Some(body) = self.parts.handles[i].and_then(|h| self.sim.bodies.get_mut(h)) else { continue };
            body.reset_forces(false);
            body.reset_torques(false);
            body.add_force(convert::vector(load.force), false);
            let about = load.torque - (center - self.k.p[i]).cross(load.force);
            body.add_torque(convert::vector(about), false);
        }
    }

    /// Damping of bodies (B-8 I, J): v ← v·(1 − d)^h, after the step.
    fn damp(&mut self, m: &Model, h: f64) {
        for d in &m.dampings {
            let Some(body) = self.parts.handles[d.body].and_then(|h| self.sim.bodies.get_mut(h)) else { continue };
            let [linear, angular] = d.kept(h);
            let (v, w) = (body.linvel() * linear, body.angvel() * angular);
            body.set_linvel(v, false);
            body.set_angvel(w, false);
        }
    }

    /// What rests comes back when it is told something new.
    fn listen(&mut self, commands: &[AxisCommand], gravity: [f64; 3]) {
        let news = self.last.1 != gravity || !self.last.0.iter().zip(commands).all(|(a, b)| same(a, b));
        if news {
            self.last.0.copy_from_slice(commands);
            self.last.1 = gravity;
            self.rouse();
        }
    }

    fn rouse(&mut self) {
        if self.parts.sleepy {
            self.sim.bodies.iter_mut().for_each(|(_, body)| body.wake_up(true));
        }
    }
}

/// The whole world at a state, whose directions in which joints yield stand still.
fn build(m: &Model, state: &mut State, k: &mut Kinematics) -> (Sim, Parts, Rows) {
    for soft in &m.softs {
        state.v[soft.v] = 0.0;
    }
    *k = Kinematics::new(m);
    kinematics(m, k, &state.q, &state.v);
    let mut sim = Sim::new();
    let parts = Parts::new(m, &mut sim, k);
    let rows = Rows::new(m, &mut sim, &parts, &state.q);
    insert_colliders(m, &mut sim, &parts);
    (sim, parts, rows)
}

/// Must forces be known for all of the step? Then each of its parts is one substep.
fn is_fine(m: &Model, effects: Effects) -> bool {
    let laws = effects.drives || effects.friction || effects.damping || effects.limits || effects.rotor_inertia;
    effects.breaking || (laws && !m.axes.is_empty())
}

impl Engine for Rapier {
    fn kind(&self) -> EngineKind {
        EngineKind::Rapier
    }

    fn prepare(&mut self, _: &Model, _: Integrator) {}

    fn step(&mut self, m: &Model, commands: &[AxisCommand], s: &StepSettings) -> StepReport {
        let mut report = StepReport::default();
        self.listen(commands, s.gravity);
        self.before.copy_from(&self.state);
        self.laws.open_books();
        self.contacts.open();
        let parts = if is_fine(m, s.effects) { s.passes } else { 1 };
        let part = Part { h: s.h / f64::from(parts), whole: s.h, substeps: s.passes / parts };
        for _ in 0..parts {
            let (finite, at_pole) = self.part(m, commands, s, part);
            report.at_pole |= at_pole;
            if !finite {
                report.diverged = true;
                let before = self.before.clone();
                self.put(m, &before);
                break;
            }
        }
        report
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restart(&mut self, m: &Model, state: &State) {
        self.laws.reset();
        self.contacts.worst = 0.0;
        self.widest = Gap::default();
        self.put(m, state);
    }

    fn place(&mut self, m: &Model, state: &State) {
        self.put(m, state);
    }

    fn refit(&mut self, m: &Model, state: State, _: Integrator) {
        self.laws.refit(m);
        self.put(m, &state);
    }

    fn moved(&mut self, m: &Model) {
        let state = self.state.clone();
        self.put(m, &state);
    }

    fn wake(&mut self, _: &Model) {
        self.rouse();
    }

    fn poses(&mut self, _: &Model, k: &mut Kinematics) {
        k.copy_from(&self.k);
    }

    fn has_contacts(&self) -> bool {
        !self.sim.colliders.is_empty()
    }

    fn contacts(&self, _: &Kinematics, show: &mut dyn FnMut(ContactPoint)) {
        self.contacts.points.iter().copied().for_each(show);
    }

    fn worst_penetration(&self, _: &Kinematics) -> f64 {
        self.contacts.worst
    }

    fn received(&self) -> &[V3<f64>] {
        if self.has_contacts() { &self.contacts.received } else { &[] }
    }

    fn books(&self) -> &Books {
        &self.laws.books
    }

    fn books_mut(&mut self) -> &mut Books {
        &mut self.laws.books
    }

    fn joint_drift(&self) -> f64 {
        self.widest.linear
    }

    fn copy(&self) -> Box<dyn Engine> {
        Box::new(self.clone())
    }
}
