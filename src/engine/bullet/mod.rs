//! Bullet, the source's own engine (table 6-10 and on): btDiscreteDynamicsWorld with sequential impulses, through C++ of ours.
//!
//! A step is semi-implicit Euler in Bullet, whatever the settings say of an integrator; `solver_iterations` are Bullet's. Drives,
//! friction and damping of the axes are the same laws as in rbx ([`Actuation`]); stops are Bullet's.

mod bridge;
mod plan;
mod shapes;
mod turns;

use super::actuation::{Actuation, Start};
use super::maximal::read_state;
use super::sleep::same;
use super::{Engine, EngineKind, Integrator, State, StepReport, StepSettings};
use crate::dynamics::{Kinematics, kinematics, kinematics_of};
use crate::math::{M3, V3, Vec3};
use crate::model::{AxisSlot, Model};
use crate::solver::{AxisCommand, Books, ContactPoint};
use bridge::{Contact, MotorInput, Moving, StepInput, World};
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
    /// Of the last step.
    commands: Vec<AxisCommand>,
    bodies: Vec<Moving>,
    inputs: Vec<MotorInput>,
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
            commands: Vec::with_capacity(m.axes.len()),
            bodies: vec![],
            inputs: vec![],
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
            let i = seat.body;
            let (w, v) = (Vec3::from(self.k.w[i]), Vec3::from(self.k.v[i]));
            let x_wb = crate::dynamics::body_pose(&self.k, i);
            let center = v + w.cross(&seat.frame.translation.vector);
            self.bodies.push(Moving {
                pose: plan::array(&(x_wb * seat.frame)),
                angular: (x_wb.rotation * w).into(),
                linear: (x_wb.rotation * center).into(),
            });
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

    /// What a row of Bullet's counts of a unit of an axis: it goes along the unit vector of the axis' gradient; along its
    /// opposite, negative.
    fn scale(&self, m: &Model, axis: usize) -> f64 {
        match m.axes[axis].slot {
            AxisSlot::Euler { group, angle } => {
                let g = self.actuation.gradient(group, angle);
                // Bullet's middle axis is z × x, which turns over where cos P changes its sign.
                let over = angle == 1 && crate::math::sin_cos(self.before.angles[group][1]).1 < 0.0;
                if over { -g.dot(g).sqrt() } else { g.dot(g).sqrt() }
            }
            _ => turns::scale(&self.plan.links, &m.axes[axis].slot, m, &self.state),
        }
    }

    fn write_inputs(&mut self, m: &Model, h: f64) {
        for axis in 0..m.axes.len() {
            let Some(driven) = self.plan.axes[axis] else { continue };
            let (piece, scale) = (self.actuation.motor(axis, h), self.scale(m, axis));
            let [low, high] = self.actuation.stop(axis).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            let (sense, scale) = (driven.sense * scale.signum(), scale.abs());
            let soft = if piece.damping.is_finite() { 1.0 / (piece.damping * scale * scale) } else { 0.0 };
            self.inputs[driven.motor] = MotorInput {
                torque: sense * piece.torque * scale,
                speed: sense * piece.speed / scale,
                cfm: if piece.damping > 0.0 { soft } else { 0.0 },
                bound: if piece.damping > 0.0 { piece.bound * scale } else { 0.0 },
                stop: if driven.sense > 0.0 { [low, high] } else { [-high, -low] },
            };
        }
    }

    fn read_motors(&mut self, m: &Model) {
        for axis in 0..m.axes.len() {
            if let Some(driven) = self.plan.axes[axis] {
                self.motors[axis] = driven.sense * self.given[driven.motor] / self.scale(m, axis);
            }
        }
    }

    /// From Bullet's bodies to the state.
    fn read(&mut self, m: &Model) {
        for (seat, moving) in self.plan.bodies.iter().zip(&self.bodies) {
            let x_wb = plan::pose(&moving.pose) * seat.frame.inverse();
            let (w, v) = (Vec3::from(moving.angular), Vec3::from(moving.linear));
            let origin = v - w.cross(&(x_wb.rotation * seat.frame.translation.vector));
            let (r, i) = (x_wb.rotation.inverse(), seat.body);
            self.k.r[i] = M3::from(*x_wb.rotation.to_rotation_matrix().matrix());
            self.k.p[i] = V3::from(x_wb.translation.vector);
            (self.k.w[i], self.k.v[i]) = (V3::from(r * w), V3::from(r * origin));
        }
        for link in self.plan.links.iter().filter(|l| !l.turns.is_empty()) {
            turns::read(m, link, &self.k, &mut self.state);
        }
        kinematics_of(m, &mut self.k, (&self.state.q, &self.state.v), &self.plan.carried);
        self.drift = self.drift.max(read_state(m, &self.k, &mut self.state).linear);
    }

    fn read_contacts(&mut self, m: &Model) -> Result<(), String> {
        if self.plan.spec.shapes.is_empty() {
            return Ok(());
        }
        if let Ok(world) = self.world.get().as_ref().map_err(|_| ()) {
            world.contacts(&mut self.contacts).map_err(|e| e.to_string())?;
        }
        self.received.fill(V3::default());
        for c in &self.contacts {
            self.worst_penetration = self.worst_penetration.max(c.depth);
            let force = V3::new(c.force[0], c.force[1], c.force[2]);
            for (shape, force) in c.shapes.iter().zip([-force, force]) {
                let body = self.plan.spec.shapes.get(*shape as usize).map_or(-1, |s| s.body);
                if let Some(seat) = usize::try_from(body).ok().and_then(|i| self.plan.bodies.get(i)) {
                    self.received[seat.body] += force;
                }
            }
        }
        debug_assert!(self.received.len() == m.bodies.len());
        Ok(())
    }

    fn advance(&mut self, m: &Model, s: &StepSettings) -> Result<(), String> {
        let input = StepInput { h: s.h, gravity: s.gravity, iterations: i32::try_from(s.passes).unwrap_or(i32::MAX) };
        let (inputs, given, bodies) = (&self.inputs, &mut self.given, &mut self.bodies);
        let world = self.world.get().as_mut().map_err(|e| e.clone())?;
        let world = world.as_mut().ok_or_else(String::new)?;
        world.step(&input, inputs, given, bodies).map_err(|e| format!("bullet: {e}"))?;
        self.read_contacts(m)
    }

    /// Per joint between two bodies with mass: what it gave its child in the last step, without what its motors gave.
    ///
    /// # Errors
    /// Why the world stands still.
    pub fn joint_forces(&mut self) -> Result<Vec<JointForce>, String> {
        let mut forces = vec![JointForce::default(); self.plan.links.len()];
        let world = self.world.get().as_ref().map_err(|e| e.clone())?;
        world.joint_forces(&mut forces).map_err(|e| e.to_string())?;
        Ok(forces)
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
        let start = Start { state: &self.before, commands, effects: s.effects, h: (s.h, s.h) };
        let at_pole = self.actuation.prepare(m, &start);
        self.write_inputs(m, s.h);
        if let Err(fault) = self.advance(m, s) {
            *self.world.get() = Err(fault);
            return StepReport { diverged: true, at_pole, ..StepReport::default() };
        }
        self.read_motors(m);
        self.read(m);
        let finite = self.state.finite();
        if finite {
            self.actuation.finish(m, (s.h, s.h), &self.state, &self.motors);
        } else {
            self.state.copy_from(&self.before);
            *self.world.get() = Err("bullet: the state is not finite".into());
        }
        StepReport { diverged: !finite, at_pole, ..StepReport::default() }
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
        let v3 = |a: [f64; 3]| V3::new(a[0], a[1], a[2]);
        for c in self.contacts.iter().filter(|c| v3(c.force).dot(v3(c.normal)) > 0.0) {
            show(ContactPoint {
                colliders: c.shapes.map(|s| s as usize),
                point: v3(c.point),
                normal: v3(c.normal),
                depth: c.depth,
                force: v3(c.force),
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
            commands: self.commands.clone(),
            bodies: self.bodies.clone(),
            inputs: vec![],
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
