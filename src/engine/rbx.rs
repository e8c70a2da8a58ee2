//! rbx: reduced coordinates, one step at a time.

use super::Integrator;
use super::extrapolation::Extrapolation;
use super::midpoint::Midpoint;
use super::paid::Paid;
use super::rk4::Stages;
use super::sleep::Sleep;
use super::whirl::{Trees, Whirl};
use crate::dynamics::{Kinematics, Scheme, Workspace, kinematics, normalize, write_damping};
use crate::math::{V3, Vec3};
use crate::model::{AxisSlot, Base, Body, Effects, JointType, Model, rotation};
use crate::solver::{AxisCommand, AxisSet, Driven, StateRef, StepStart};

/// State of one robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Coordinates (nq).
    pub q: Vec<f64>,
    /// Velocities (nv).
    pub v: Vec<f64>,
    /// H, P, B of each 3DOF group, continuous.
    pub angles: Vec<[f64; 3]>,
}

impl State {
    /// All angles at 0, or at the stop next to it; followers where their leaders put them; at rest.
    pub fn initial(m: &Model) -> Self {
        let mut s = Self { q: m.neutral(), v: vec![0.0; m.nv], angles: vec![[0.0; 3]; m.eulers.len()] };
        for axis in 0..m.axes.len() {
            let a = &m.axes[axis];
            if a.lower > 0.0 || a.upper < 0.0 {
                s.set_axis(m, axis, a.lower.max(a.upper.min(0.0)), 0.0);
            }
        }
        s.couple_in_range(m);
        s
    }

    /// Appends the state of a model that joins ([`Model::join`]).
    pub fn join(&mut self, other: &Self) {
        self.q.extend_from_slice(&other.q);
        self.v.extend_from_slice(&other.v);
        self.angles.extend_from_slice(&other.angles);
    }

    /// Position (rad, m) and speed of an axis.
    pub fn axis(&self, m: &Model, axis: usize) -> (f64, f64) {
        match m.axes[axis].slot {
            AxisSlot::Scalar { q, v } => (self.q[q], self.v[v]),
            AxisSlot::Euler { group, angle } => {
                let rates = m.eulers[group].rates(self.angles[group]);
                (self.angles[group][angle], rates.gradient[angle].dot(self.group_velocity(m, group)))
            }
            AxisSlot::Apart { position } => (position, 0.0),
        }
    }

    /// Positions of all axes, rad or m.
    pub fn positions(&self, m: &Model) -> Vec<f64> {
        (0..m.axes.len()).map(|axis| self.axis(m, axis).0).collect()
    }

    /// Kinetic energy of rotors of these inertias (kg·m² or kg, per axis) with their speeds relative to the joints, J.
    pub fn rotor_energy(&self, m: &Model, rotors: impl Iterator<Item = f64>) -> f64 {
        let turning = rotors.enumerate().filter(|(_, inertia)| *inertia > 0.0);
        turning.map(|(i, inertia)| 0.5 * inertia * self.axis(m, i).1.powi(2)).sum()
    }

    /// Acceleration of an axis, given those of the velocity coordinates (nv).
    pub fn axis_acceleration(&self, m: &Model, axis: usize, vdot: &[f64]) -> f64 {
        match m.axes[axis].slot {
            AxisSlot::Apart { .. } => 0.0,
            AxisSlot::Scalar { v, .. } => vdot[v],
            AxisSlot::Euler { group, angle } => {
                let g = &m.eulers[group];
                let rates = g.rates(self.angles[group]).gradient;
                let w = self.group_velocity(m, group);
                let turning = g.direction_rates(self.angles[group], rates.map(|r| r.dot(w)));
                rates[angle].dot(V3::new(vdot[g.v], vdot[g.v + 1], vdot[g.v + 2]) - turning)
            }
        }
    }

    /// Adds a torque on an axis to the torques of the velocity coordinates (nv).
    pub fn add_axis_torque(&self, m: &Model, axis: usize, torque: f64, tau: &mut [f64]) {
        match m.axes[axis].slot {
            AxisSlot::Apart { .. } => {}
            AxisSlot::Scalar { v, .. } => tau[v] += torque,
            AxisSlot::Euler { group, angle } => {
                let g = &m.eulers[group];
                let t = g.rates(self.angles[group]).gradient[angle] * torque;
                for (to, from) in tau[g.v..g.v + 3].iter_mut().zip([t.x, t.y, t.z]) {
                    *to += from;
                }
            }
        }
    }

    fn group_velocity(&self, m: &Model, group: usize) -> V3<f64> {
        let at = m.eulers[group].v;
        V3::new(self.v[at], self.v[at + 1], self.v[at + 2])
    }

    /// Sets an axis; in a 3DOF group the other two angles and rates stay as they are.
    pub fn set_axis(&mut self, m: &Model, axis: usize, position: f64, speed: f64) {
        match m.axes[axis].slot {
            AxisSlot::Apart { .. } => {}
            AxisSlot::Scalar { q, v } => (self.q[q], self.v[v]) = (position, speed),
            AxisSlot::Euler { group, angle } => {
                let g = &m.eulers[group];
                let w = self.group_velocity(m, group);
                let old = g.rates(self.angles[group]);
                let mut rates = [0, 1, 2].map(|k| old.gradient[k].dot(w));
                rates[angle] = speed;
                self.angles[group][angle] = position;
                self.q[g.q..g.q + 4].copy_from_slice(&g.quaternion(self.angles[group]));
                let d = g.directions(self.angles[group]);
                let w = d[0] * rates[0] + d[1] * rates[1] + d[2] * rates[2];
                self.v[g.v..g.v + 3].copy_from_slice(&[w.x, w.y, w.z]);
            }
        }
    }

    /// Sets the base of a free robot: position (m) and unit quaternion (x, y, z, w) in the world.
    pub fn set_base_pose(&mut self, m: &Model, xyz: [f64; 3], xyzw: [f64; 4]) {
        if let Some(b) = free_base(m) {
            self.q[b.q..b.q + 3].copy_from_slice(&xyz);
            self.q[b.q + 3..b.q + 7].copy_from_slice(&[xyzw[3], xyzw[0], xyzw[1], xyzw[2]]);
            normalize(&mut self.q[b.q + 3..b.q + 7]);
        }
    }

    /// Sets the twist of a free base, in the base frame.
    pub fn set_base_twist(&mut self, m: &Model, angular: Vec3, linear: Vec3) {
        if let Some(b) = free_base(m) {
            for k in 0..3 {
                (self.v[b.v + k], self.v[b.v + 3 + k]) = (angular[k], linear[k]);
            }
        }
    }

    pub(super) fn read_angles(&mut self, m: &Model) {
        for (g, angles) in m.eulers.iter().zip(&mut self.angles) {
            let r = rotation([self.q[g.q], self.q[g.q + 1], self.q[g.q + 2], self.q[g.q + 3]]);
            *angles = g.angles(&r, *angles);
        }
    }

    /// Takes over another state of the same model; allocates nothing.
    pub fn copy_from(&mut self, other: &Self) {
        self.q.copy_from_slice(&other.q);
        self.v.copy_from_slice(&other.v);
        self.angles.copy_from_slice(&other.angles);
    }

    pub(super) fn as_ref(&self) -> StateRef<'_> {
        StateRef { q: &self.q, v: &self.v, angles: &self.angles }
    }

    pub(super) fn finite(&self) -> bool {
        self.q.iter().chain(&self.v).all(|x| x.is_finite())
    }
}

/// The body of a free base. On a fixed one, what floats on the world has come off.
fn free_base(m: &Model) -> Option<&Body> {
    m.bodies.get(1).filter(|b| m.base == Base::Free && b.joint == JointType::Floating && b.parent == 0)
}

/// What one step needs to know.
#[derive(Clone, Copy, Debug)]
pub struct StepSettings {
    /// Step, s.
    pub h: f64,
    /// m/s², world.
    pub gravity: [f64; 3],
    /// What is simulated.
    pub effects: Effects,
    /// Passes of the dynamics and the axis set, at most.
    pub passes: u32,
    /// Integrator.
    pub integrator: Integrator,
    /// Error per second that the extrapolation method may make, relative to 1 rad, m, rad/s, m/s and the coordinate.
    pub accuracy: f64,
}

/// What became of a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepReport {
    /// RK4 or Euler's rule handed the step to the implicit midpoint rule, or Euler's rule or the extrapolation method its rest.
    pub fell_back: bool,
    /// The axis set did not settle within its passes.
    pub unsettled: bool,
    /// How many times a step was halved, because the iteration of the midpoint rule did not contract.
    pub halvings: u32,
    /// The step was divided, because bodies that are near move further than they are thick.
    pub divided: bool,
    /// Pieces in which even so they did.
    pub fast: u32,
    /// Pieces of the step that were slowed down to the energy that was paid for.
    pub guarded: u32,
    /// What they lost, J.
    pub guarded_energy: f64,
    /// Energy that contacts would have made out of the error of the step, and that was taken out of speeds and heights, J.
    pub trimmed_energy: f64,
    /// Bounces were made smaller, because together with friction they would have made energy.
    pub tempered: bool,
    /// What the rows of contacts were left with at most, m/s.
    pub residual: f64,
    /// A 3DOF group was at its pole.
    pub at_pole: bool,
    /// The new state would not have been finite: it was not taken.
    pub diverged: bool,
}

/// One robot in the rbx engine: a clone goes on with the same bits.
#[derive(Clone, Debug)]
pub struct Rbx {
    /// State.
    pub state: State,
    /// Axis laws and efforts.
    pub axes: AxisSet,
    pub(super) ws: Workspace<f64>,
    pub(super) qdd: Vec<f64>,
    pub(super) before: State,
    /// State at the start of a piece of an Euler step.
    pub(super) piece: State,
    /// Speeds that keep bodies out of each other.
    pub(super) lift: Vec<f64>,
    pub(super) unlifted: Vec<f64>,
    /// `None` if nothing can touch.
    pub(super) paid: Option<Paid>,
    /// `None` if nothing ever rests.
    pub(super) sleep: Option<Sleep>,
    /// The step, s, of which a halved one is a part.
    pub(super) whole_step: f64,
    /// What RK4 and Euler's rule look for whirls with; `None` for all others.
    pub(super) whirl: Option<Whirl>,
    pub(super) trees: Option<Trees>,
    pub(super) midpoint: Option<Midpoint>,
    stages: Option<Stages>,
    pub(super) extrapolation: Option<Box<Extrapolation>>,
}

impl Rbx {
    /// At the initial state.
    pub fn new(m: &Model) -> Self {
        let (state, axes) = (State::initial(m), AxisSet::new(m));
        let mut ws = Workspace::new(m);
        ws.put_side_by_side(m);
        Self {
            ws,
            qdd: vec![0.0; m.nv],
            before: state.clone(),
            piece: state.clone(),
            lift: vec![0.0; m.nv],
            unlifted: vec![0.0; m.nq],
            paid: axes.contacts().is_some().then(|| Paid::new(m)),
            axes,
            sleep: Sleep::new(m),
            whole_step: 0.0,
            whirl: None,
            trees: None,
            midpoint: None,
            stages: None,
            extrapolation: None,
            state,
        }
    }

    /// Makes the memory that an integrator needs, so that steps make none.
    pub fn prepare(&mut self, m: &Model, integrator: Integrator) {
        self.midpoint = Some(Midpoint::new(m));
        self.whirl = (integrator == Integrator::Rk4).then(|| Whirl::new(m.nv));
        let euler = integrator == Integrator::SemiImplicitEuler;
        self.trees = euler.then(|| Trees::new(m));
        self.axes.driven = euler.then(|| Box::new(Driven::new(m)));
        self.stages = (integrator == Integrator::Rk4).then(|| Stages::new(m));
        let extrapolates = integrator == Integrator::Extrapolation;
        self.extrapolation = extrapolates.then(|| Box::new(Extrapolation::new(m)));
    }

    /// Takes over a state; the steps before it are forgotten.
    pub fn restart(&mut self, m: &Model, state: &State) {
        self.state.copy_from(state);
        self.axes.reset();
        self.wake(m);
        self.forget();
    }

    /// Forgets the accelerations of the last step.
    pub(super) fn forget(&mut self) {
        if let Some(midpoint) = &mut self.midpoint {
            midpoint.forget();
        }
        if let Some(trees) = &mut self.trees {
            trees.forget();
        }
        if let Some(extrapolation) = &mut self.extrapolation {
            extrapolation.forget();
        }
    }

    /// One step: the laws of the axes, then the integrator; a state that is not finite is not taken.
    pub fn step(&mut self, m: &Model, commands: &[AxisCommand], s: &StepSettings) -> StepReport {
        let mut report = StepReport::default();
        if self.rests(m, commands, s.gravity) {
            return report;
        }
        self.before.copy_from(&self.state);
        self.whole_step = s.h;
        self.axes.open_books();
        let tempered = self.axes.tempered();
        let rest = match s.integrator {
            Integrator::ImplicitMidpoint => s.h,
            Integrator::SemiImplicitEuler => self.euler(m, commands, s, &mut report),
            Integrator::Rk4 if self.rk4(m, commands, s, &mut report) => 0.0,
            Integrator::Rk4 => s.h,
            Integrator::Extrapolation => {
                self.extrapolated_step(m, commands, s, &mut report);
                0.0
            }
        };
        if let Some(mut midpoint) = self.midpoint.take_if(|_| rest > 0.0) {
            report.fell_back = s.integrator != Integrator::ImplicitMidpoint;
            self.midpoint_step(m, &mut midpoint, commands, &StepSettings { h: rest, ..*s }, &mut report);
            self.midpoint = Some(midpoint);
        }
        if !self.state.finite() {
            self.state.copy_from(&self.before);
            report.diverged = true;
        }
        report.residual = self.axes.residual();
        report.tempered = self.axes.tempered() > tempered;
        self.observe(m, s);
        report
    }

    /// Fills `k` from the state.
    pub fn poses(&mut self, m: &Model, k: &mut Kinematics) {
        match self.axes.contacts_mut() {
            None => kinematics(m, k, &self.state.q, &self.state.v),
            Some(contacts) => k.copy_from(contacts.arrive(m, &self.state.q, &self.state.v)),
        }
    }

    /// What stands on the world has been moved with it.
    pub fn moved(&mut self) {
        if let Some(contacts) = self.axes.contacts_mut() {
            contacts.forget();
        }
        if let Some(paid) = &mut self.paid {
            paid.forget();
        }
    }

    /// False, with the state as before, if the step is not smooth.
    fn rk4(&mut self, m: &Model, commands: &[AxisCommand], s: &StepSettings, report: &mut StepReport) -> bool {
        let start =
            StepStart { state: self.state.as_ref(), commands, h: s.h, whole: s.h, mean: true, sweeps: s.passes };
        report.at_pole |= self.axes.prepare(m, &start, s.effects);
        if !self.axes.is_smooth(m) || self.axes.is_fast() || self.axes.collides(m, None) {
            return false;
        }
        let Some(mut st) = self.stages.take() else { return false };
        write_damping(m, &mut self.ws, (s.h, Scheme::Continuous), s.effects.body_damping);
        let smooth = self.rk4_stages(m, s, &mut st) && !self.axes.collides(m, Some(self.state.as_ref()));
        self.stages = Some(st);
        if !smooth {
            self.state.copy_from(&self.before);
        } else {
            self.put_back(m);
        }
        smooth
    }

    /// Ends a move of the coordinates: angles, and axes that were beyond their stops go back.
    pub(super) fn put_back(&mut self, m: &Model) {
        self.state.read_angles(m);
        if self.axes.push_back(m, &mut self.state.q, &self.state.angles) {
            self.state.read_angles(m);
        }
    }
}

pub(super) fn normalize_all(m: &Model, q: &mut [f64]) {
    for b in &m.bodies[1..] {
        match b.joint {
            JointType::Spherical => normalize(&mut q[b.q..b.q + 4]),
            JointType::Floating => normalize(&mut q[b.q + 3..b.q + 7]),
            _ => {}
        }
    }
}
