//! Bullet, the source's own engine (table 6-10 and on): btDiscreteDynamicsWorld with sequential impulses, through C++ of ours.
//!
//! A step is semi-implicit Euler in Bullet, whatever the settings say of an integrator; `solver_iterations` are Bullet's. Drives,
//! friction and damping of the axes are the same laws as in rbx ([`Actuation`]); stops are Bullet's.

mod bridge;
mod exchange;
mod plan;
mod power;
mod shapes;
mod turns;

use super::actuation::{Actuation, Start};
use super::pairs::is_steep;
use super::sleep::same;
use super::{Engine, EngineKind, Integrator, State, StepReport, StepSettings};
use crate::dynamics::{Kinematics, kinematics};
use crate::math::V3;
use crate::model::Model;
use crate::solver::{AxisCommand, Books, ContactPoint};
use bridge::{Contact, MotorInput, Moving, PairInput, StepInput, World};
use cxx::UniquePtr;
use plan::Plan;
use std::sync::{Mutex, PoisonError};

pub use bridge::{JointForce, worlds};

/// One world in Bullet. A copy goes on from the same poses and velocities, but without the impulses that Bullet starts the next
/// step's contacts from, and awake.
#[derive(Debug)]
pub struct Bullet {
    plan: Plan,
    world: Held,
    state: State,
    before: State,
    /// As Bullet has the bodies: joints may gape.
    k: Kinematics,
    /// At the start of a part of a step.
    from: (State, Kinematics),
    /// Of the last step.
    commands: Vec<AxisCommand>,
    bodies: Vec<Moving>,
    inputs: Vec<MotorInput>,
    pairs: Vec<PairInput>,
    /// Per constraint.
    forces: Vec<JointForce>,
    given: Vec<f64>,
    /// Per axis: what its motor gave, N·m or N.
    motors: Vec<f64>,
    actuation: Actuation,
    contacts: Vec<Contact>,
    received: Vec<V3<f64>>,
    worst_penetration: f64,
    drift: f64,
}

/// A world, or why there is none. Never asked for but by whom it belongs to: the mutex is not locked.
struct Held(Mutex<Result<UniquePtr<World>, String>>);

impl Held {
    fn get(&mut self) -> &mut Result<UniquePtr<World>, String> {
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner)
    }
}

impl std::fmt::Debug for Held {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Held")
    }
}

/// Parts of a step near a pole, each of which has its own gradients.
const FRESH: u32 = 10;

impl Bullet {
    /// # Errors
    /// What Bullet cannot take, and what it could not do.
    pub fn new(m: &Model, state: &State) -> Result<Self, String> {
        let mut engine = Self {
            plan: Plan::new(m)?,
            world: Held(Mutex::new(Err(String::new()))),
            state: state.clone(),
            before: state.clone(),
            k: Kinematics::new(m),
            from: (state.clone(), Kinematics::new(m)),
            commands: Vec::with_capacity(m.axes.len()),
            bodies: vec![],
            inputs: vec![],
            pairs: vec![],
            forces: vec![],
            given: vec![],
            motors: vec![0.0; m.axes.len()],
            actuation: Actuation::of_warm_motors(m),
            contacts: vec![],
            received: vec![],
            worst_penetration: 0.0,
            drift: 0.0,
        };
        engine.make(m);
        match engine.world.get() {
            Ok(_) => Ok(engine),
            Err(fault) => Err(std::mem::take(fault)),
        }
    }

    /// Why the world stands still, if it does: what Bullet could not take or do.
    pub fn fault(&mut self) -> Option<&str> {
        self.world.get().as_ref().err().map(String::as_str)
    }

    /// Makes the world anew from the state.
    fn make(&mut self, m: &Model) {
        kinematics(m, &mut self.k, &self.state.q, &self.state.v);
        self.bodies.clear();
        for seat in &self.plan.bodies {
            let at = seat.motion(&self.k);
            let pose = plan::array(&at.pose);
            self.bodies.push(Moving { pose, angular: at.angular.into(), linear: at.linear.into() });
        }
        self.fill();
    }

    /// Makes the world anew from the bodies.
    fn fill(&mut self) {
        for (spec, moving) in self.plan.spec.bodies.iter_mut().zip(&self.bodies) {
            spec.moving = *moving;
        }
        *self.world.get() = bridge::build(&self.plan.spec).map_err(|e| format!("bullet: {e}"));
        self.inputs = vec![MotorInput::default(); self.plan.spec.motors.len()];
        self.pairs = vec![PairInput::default(); self.plan.spec.pairs.len()];
        self.forces = vec![JointForce::default(); self.plan.links.len()];
        self.given = vec![0.0; self.inputs.len()];
        self.received = if self.plan.spec.shapes.is_empty() { vec![] } else { vec![V3::default(); self.k.r.len()] };
        self.contacts.clear();
    }

    /// Another model, or one that has moved.
    fn remake(&mut self, m: &Model) {
        match Plan::new(m) {
            Ok(plan) => {
                self.plan = plan;
                self.make(m);
            }
            Err(fault) => *self.world.get() = Err(fault),
        }
    }

    fn advance(&mut self, m: &Model, s: &StepSettings, h: f64) -> Result<(), String> {
        let input = StepInput { h, gravity: s.gravity, iterations: i32::try_from(s.passes).unwrap_or(i32::MAX) };
        let (given, bodies) = (&mut self.given, &mut self.bodies);
        let world = self.world.get().as_mut().map_err(|e| e.clone())?;
        let mut world = world.as_mut().ok_or_else(String::new)?;
        let done = world.as_mut().step(&input, &self.inputs, &self.pairs, given, bodies);
        done.and_then(|()| world.joint_forces(&mut self.forces)).map_err(|e| format!("bullet: {e}"))?;
        self.read_contacts(m, h / s.h)
    }

    /// A part of a step, of `h` seconds. Was a 3DOF group at its pole?
    fn part(&mut self, m: &Model, commands: &[AxisCommand], s: &StepSettings, h: f64) -> Result<bool, String> {
        self.from.0.copy_from(&self.state);
        self.from.1.copy_from(&self.k);
        let start = Start { state: &self.from.0, commands, effects: s.effects, h: (h, s.h) };
        let at_pole = self.actuation.prepare(m, &start);
        self.write_inputs(m, h);
        self.advance(m, s, h)?;
        self.read_motors(m);
        self.read(m);
        if !self.state.finite() {
            return Err("bullet: the state is not finite".into());
        }
        let work = power::work(self, &self.forces, [&self.from.1, &self.k], h);
        self.actuation.books.work.losses -= work;
        self.actuation.finish(m, (h, s.h), &self.state, &self.motors);
        Ok(at_pole)
    }

    /// Per joint between two bodies with mass: what it gave its child in the last step, without what its motors gave.
    ///
    /// # Errors
    /// Why the world stands still.
    pub fn joint_forces(&mut self) -> Result<Vec<JointForce>, String> {
        self.world.get().as_ref().map_err(|e| e.clone())?;
        Ok(self.forces.clone())
    }
}

impl Engine for Bullet {
    fn kind(&self) -> EngineKind {
        EngineKind::Bullet
    }

    /// Bullet has one integrator of its own.
    fn prepare(&mut self, _: &Model, _: Integrator) {}

    /// Bullet keeps its memory, but asks for more as contacts come.
    fn step(&mut self, m: &Model, commands: &[AxisCommand], s: &StepSettings) -> StepReport {
        self.before.copy_from(&self.state);
        if self.commands.len() != commands.len() || !self.commands.iter().zip(commands).all(|(a, b)| same(a, b)) {
            self.commands.clear();
            self.commands.extend_from_slice(commands);
            self.wake(m);
        }
        self.actuation.open_books();
        self.received.fill(V3::default());
        let parts = if is_steep(&self.state) { FRESH } else { 1 };
        let mut report = StepReport::default();
        for _ in 0..parts {
            match self.part(m, commands, s, s.h / f64::from(parts)) {
                Ok(at_pole) => report.at_pole |= at_pole,
                Err(fault) => {
                    self.state.copy_from(&self.before);
                    *self.world.get() = Err(fault);
                    report.diverged = true;
                    break;
                }
            }
        }
        report
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restart(&mut self, m: &Model, state: &State) {
        self.state.copy_from(state);
        self.actuation.reset();
        (self.worst_penetration, self.drift) = (0.0, 0.0);
        self.make(m);
    }

    fn place(&mut self, m: &Model, state: &State) {
        self.state.copy_from(state);
        self.actuation.forget();
        self.make(m);
    }

    fn refit(&mut self, m: &Model, state: State, _: Integrator) {
        self.before = state.clone();
        self.state = state;
        self.k = Kinematics::new(m);
        self.from = (self.before.clone(), Kinematics::new(m));
        self.actuation.refit(m);
        self.motors.fill(0.0);
        self.remake(m);
    }

    fn moved(&mut self, m: &Model) {
        self.remake(m);
    }

    fn wake(&mut self, _: &Model) {
        if let Ok(world) = self.world.get()
            && let Some(world) = world.as_mut()
        {
            world.wake();
        }
    }

    fn poses(&mut self, _: &Model, k: &mut Kinematics) {
        k.copy_from(&self.k);
    }

    fn has_contacts(&self) -> bool {
        !self.plan.spec.shapes.is_empty()
    }

    fn contacts(&self, _: &Kinematics, show: &mut dyn FnMut(ContactPoint)) {
        for c in self.contacts.iter().filter(|c| V3::from(c.force).dot(V3::from(c.normal)) > 0.0) {
            show(ContactPoint {
                colliders: c.shapes.map(|s| s as usize),
                point: V3::from(c.point),
                normal: V3::from(c.normal),
                depth: c.depth,
                force: V3::from(c.force),
            });
        }
    }

    fn worst_penetration(&self, _: &Kinematics) -> f64 {
        self.worst_penetration
    }

    fn received(&self) -> &[V3<f64>] {
        &self.received
    }

    fn books(&self) -> &Books {
        &self.actuation.books
    }

    fn books_mut(&mut self) -> &mut Books {
        &mut self.actuation.books
    }

    fn joint_drift(&self) -> f64 {
        self.drift
    }

    fn copy(&self) -> Box<dyn Engine> {
        let mut copy = Self {
            plan: self.plan.clone(),
            world: Held(Mutex::new(Err(String::new()))),
            state: self.state.clone(),
            before: self.before.clone(),
            k: self.k.clone(),
            from: self.from.clone(),
            commands: self.commands.clone(),
            bodies: self.bodies.clone(),
            inputs: vec![],
            pairs: vec![],
            forces: vec![],
            given: vec![],
            motors: self.motors.clone(),
            actuation: self.actuation.clone(),
            contacts: vec![],
            received: vec![],
            worst_penetration: self.worst_penetration,
            drift: self.drift,
        };
        copy.fill();
        Box::new(copy)
    }
}
