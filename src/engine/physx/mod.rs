//! PhysX 5.1, for free bodies (the source's table 6-16): boxes, balls, capsules, planes, convex hulls and meshes that stand still.
//! Links are left out: they stand where they are at the start, and nothing touches them.
//!
//! A step is semi-implicit Euler with PhysX's TGS solver, whose position iterations are `solver_iterations`; more than 255 are
//! made in several steps. PhysX computes in single precision: a position in a room is good to 1 µm, a second of free fall to 0.1 mm.
//! Damping of bodies, rolling friction and sleep are ours. No state is taken whose numbers are beyond [`Moving::MOST`].

mod contacts;
mod flight;
mod honour;
mod plan;
mod rest;
mod shapes;
mod share;
mod spec;
mod sys;

use super::maximal::read_body;
use super::{Engine, EngineKind, Integrator, State, StepReport, StepSettings};
use crate::dynamics::{Kinematics, kinematics};
use crate::math::{V3, Vec3};
use crate::model::Model;
use crate::solver::{AxisCommand, Books, ContactPoint};
use contacts::{Contacts, Part};
use flight::Flight;
use plan::Plan;
use rest::Rest;
use spec::{Moving, Step};
use sys::Sim;

pub use honour::shortfalls;
pub use sys::allocations;

/// PhysX counts the passes of a step in 8 bits.
const PASSES: u32 = 255;
/// What gravity makes within this many steps is not the speed of an impact.
const BOUNCE: f64 = 2.0;

/// One world in PhysX. A copy goes on from the same poses and velocities, but without the contacts that PhysX remembers from
/// step to step, and awake.
#[derive(Debug)]
pub struct Physx {
    plan: Plan,
    /// Or why the world stands still.
    sim: Result<Sim, String>,
    state: State,
    k: Kinematics,
    bodies: Vec<Moving>,
    from: Vec<Flight>,
    to: Vec<Flight>,
    contacts: Contacts,
    rest: Rest,
    books: Books,
    gravity: [f64; 3],
}

impl Physx {
    /// At a state of the model. Allocates.
    ///
    /// # Errors
    /// What PhysX cannot take, and what it could not do.
    pub fn new(m: &Model, state: &State) -> Result<Self, String> {
        let plan = Plan::new(m)?;
        let mut engine = Self {
            sim: Err(String::new()),
            state: state.clone(),
            k: Kinematics::new(m),
            bodies: vec![],
            from: vec![],
            to: vec![],
            contacts: Contacts::default(),
            rest: Rest::default(),
            books: Books::new(m),
            gravity: [0.0; 3],
            plan,
        };
        engine.put(m);
        match &mut engine.sim {
            Ok(_) => Ok(engine),
            Err(fault) => Err(std::mem::take(fault)),
        }
    }

    /// Why the world stands still, if it does: what PhysX could not take or do.
    pub fn fault(&self) -> Option<&str> {
        self.sim.as_ref().err().map(String::as_str)
    }

    /// Makes the scene anew at the state; links stand still. Allocates.
    fn put(&mut self, m: &Model) {
        for (i, b) in m.bodies.iter().enumerate().skip(1).filter(|(i, _)| self.plan.index[*i].is_none()) {
            debug_assert!(i > 0);
            self.state.v[b.v..b.v + b.joint.nv()].fill(0.0);
        }
        kinematics(m, &mut self.k, &self.state.q, &self.state.v);
        self.bodies.resize(self.plan.seats.len(), Moving::default());
        self.plan.place(&self.k, &mut self.bodies);
        self.contacts = Contacts::new(m, &self.plan).after(self.contacts.worst);
        self.fill();
    }

    /// Makes the scene anew from the bodies. Allocates.
    fn fill(&mut self) {
        for (body, moving) in self.plan.scene.bodies.iter_mut().zip(&self.bodies) {
            body.moving = *moving;
        }
        self.rest = Rest::new(&self.plan);
        self.to = self.bodies.iter().map(Flight::new).collect();
        self.from = self.to.clone();
        // The old one goes before the new one comes.
        self.sim = Err(String::new());
        self.sim = Sim::new(&self.plan.scene);
    }

    /// Another model, or one that has moved.
    fn remake(&mut self, m: &Model) {
        match Plan::new(m) {
            Ok(plan) => {
                self.plan = plan;
                self.put(m);
            }
            Err(fault) => self.sim = Err(fault),
        }
    }

    /// One part of a step: its length and that of the step, s, and its passes.
    fn part(&mut self, m: &Model, s: &StepSettings, (h, passes): (f64, u32)) -> Result<(), String> {
        let sim = self.sim.as_mut().map_err(|fault| fault.clone())?;
        let gravity = Vec3::from(s.gravity);
        let bounce = (BOUNCE * h * gravity.norm()).max(f64::from(f32::EPSILON)) as f32;
        let step = Step { h: h as f32, gravity: Flight::single(gravity), passes, bounce };
        sim.step(&step, &mut self.bodies)?;
        if !self.bodies.iter().all(Moving::is_sound) {
            return Err("physx: the state is not finite, or beyond what single precision holds".into());
        }
        self.rest.look(sim);
        for (i, moving) in self.bodies.iter().enumerate() {
            self.from[i] = self.to[i];
            self.to[i] = Flight::new(moving);
        }
        let mut part = Part { from: &self.from, to: &mut self.to, asleep: &self.rest.asleep, gravity, h: (h, s.h) };
        self.contacts.read(m, &self.plan, sim.touches(), &part);
        let rolls = self.contacts.roll(m, &self.plan, &mut part);
        if rolls | damp(&self.plan, &mut part, s.effects.body_damping) {
            self.hand_back();
        }
        if let Ok(sim) = &mut self.sim {
            self.rest.observe(m, &self.plan, sim, (&self.to, &self.contacts.points, h));
        }
        Ok(())
    }

    /// Speeds that we have changed go back to PhysX.
    fn hand_back(&mut self) {
        let Ok(sim) = &mut self.sim else { return };
        for (i, at) in self.to.iter().enumerate() {
            if !self.rest.asleep[i] {
                let (linear, angular) = (Flight::single(at.v), Flight::single(at.w));
                sim.set_speed(i, linear, angular);
                (self.bodies[i].linear, self.bodies[i].angular) = (linear, angular);
            }
        }
    }

    fn read(&mut self, m: &Model) {
        for (seat, at) in self.plan.seats.iter().zip(&self.to) {
            seat.own.write(&at.motion(), &mut self.k);
            read_body(m, &self.k, seat.own.body, &mut self.state);
        }
    }

    fn rouse(&mut self) {
        if let Ok(sim) = &mut self.sim {
            self.rest.wake(sim);
        }
    }
}

/// Damping of bodies (B-8 I, J): v ← v·(1 − d)^h. True if there is any.
fn damp(plan: &Plan, part: &mut Part, on: bool) -> bool {
    let mut damped = false;
    for (seat, at) in plan.seats.iter().zip(part.to.iter_mut()).filter(|_| on) {
        if let Some(d) = seat.damping {
            let [linear, angular] = d.kept(part.h.0);
            at.v *= linear;
            at.w *= angular;
            damped = true;
        }
    }
    damped
}

impl Engine for Physx {
    fn kind(&self) -> EngineKind {
        EngineKind::Physx
    }

    /// PhysX has one integrator of its own.
    fn prepare(&mut self, _: &Model, _: Integrator) {}

    /// PhysX keeps its memory, but asks for more as contacts come.
    fn step(&mut self, m: &Model, _: &[AxisCommand], s: &StepSettings) -> StepReport {
        if self.gravity != s.gravity {
            self.gravity = s.gravity;
            self.rouse();
        }
        self.books.effort.fill(0.0);
        self.contacts.open();
        let parts = s.passes.div_ceil(PASSES).max(1);
        let part = (s.h / f64::from(parts), s.passes.div_ceil(parts));
        let done = (0..parts).try_for_each(|_| self.part(m, s, part));
        match done {
            Ok(()) => {
                self.read(m);
                self.books.work.contacts += self.contacts.taken;
                StepReport::default()
            }
            Err(fault) => {
                self.sim = Err(fault);
                StepReport { diverged: true, ..StepReport::default() }
            }
        }
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restart(&mut self, m: &Model, state: &State) {
        self.state.copy_from(state);
        self.books.reset();
        self.contacts.worst = 0.0;
        self.put(m);
    }

    fn place(&mut self, m: &Model, state: &State) {
        self.state.copy_from(state);
        self.put(m);
    }

    fn refit(&mut self, m: &Model, state: State, _: Integrator) {
        self.state = state;
        self.k = Kinematics::new(m);
        self.remake(m);
    }

    fn moved(&mut self, m: &Model) {
        self.remake(m);
    }

    fn wake(&mut self, _: &Model) {
        self.rouse();
    }

    fn poses(&mut self, _: &Model, k: &mut Kinematics) {
        k.copy_from(&self.k);
    }

    fn has_contacts(&self) -> bool {
        !self.plan.scene.shapes.is_empty()
    }

    fn contacts(&self, _: &Kinematics, show: &mut dyn FnMut(ContactPoint)) {
        self.contacts.points.iter().copied().for_each(show);
    }

    fn worst_penetration(&self, _: &Kinematics) -> f64 {
        self.contacts.worst
    }

    fn received(&self) -> &[V3<f64>] {
        &self.contacts.received
    }

    fn books(&self) -> &Books {
        &self.books
    }

    fn books_mut(&mut self) -> &mut Books {
        &mut self.books
    }

    fn copy(&self) -> Box<dyn Engine> {
        let mut copy = Self {
            plan: self.plan.clone(),
            sim: Err(String::new()),
            state: self.state.clone(),
            k: self.k.clone(),
            bodies: self.bodies.clone(),
            from: vec![],
            to: vec![],
            contacts: self.contacts.clone(),
            rest: Rest::default(),
            books: self.books.clone(),
            gravity: self.gravity,
        };
        copy.fill();
        if let Err(fault) = &self.sim {
            copy.sim = Err(fault.clone());
        }
        Box::new(copy)
    }
}
