//! Time: states, steps, reset, copies. No ROS, no files, no wall clock.

mod breaking;
mod contact;
mod drive;
mod elements;
mod estimate;
mod order;
mod pose;
mod rebuild;
mod settings;
mod share;
mod snapshot;
mod warnings;

use crate::dynamics::{Energy, Kinematics, Momentum, energy, link_pose, link_twist, momentum};
use crate::engine::{Engine, State, StepSettings};
use crate::math::{Pose, Twist};
use crate::model::{Effects, Model};
use std::sync::Arc;

pub use crate::solver::{AxisCommand, Mode, Work};
pub use breaking::Broken;
pub use contact::ContactPoint;
pub use elements::{Element, ElementKind};
pub use estimate::{Deviation, Largest, LocalEstimate};
pub use order::{Order, checked_pose};
pub use pose::Side;
pub use rebuild::Condition;
pub use settings::{ACCURACY, EngineKind, Integrator, Settings};
pub use snapshot::{SHOWN_CONTACTS, Snapshot, Wrench};
pub use warnings::{Warning, WarningKind, Warnings};

/// Counters since the start; none of them is ever reset by a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Steps made.
    pub steps: u64,
    /// Steps of RK4 and Euler's rule that fell back to the implicit midpoint rule, and those of Euler's rule and the extrapolation method
    /// whose rest did.
    pub fallback_steps: u64,
    /// Steps whose axis set did not settle within the iterations.
    pub unsettled_steps: u64,
    /// How often a step was halved because its iteration did not contract: velocity products of light limbs that whirl.
    pub halvings: u64,
    /// Steps that were divided, because bodies that were near moved further than they are thick.
    pub divided_steps: u64,
    /// Pieces of steps, the shortest there are, in which they still did: they may have passed through each other.
    pub fast_pieces: u64,
    /// Pieces of steps that were not resolved (the shortest ones that did not contract, and halved ones that gained energy): their
    /// motion was slowed down to the energy that drives and weight had paid for.
    pub guarded_pieces: u64,
    /// What they lost, J.
    pub guarded_energy: f64,
    /// By how much an axis was outside its range at most (a soft stop, a start there, an angle of a 3DOF group); rad or m.
    pub worst_stop_violation: f64,
    /// Energy that steps in contact would have made out of nothing, and that was taken out of speeds and heights, J.
    pub trimmed_energy: f64,
    /// Steps whose bounces were made smaller, because together with friction they would have made energy.
    pub tempered_steps: u64,
    /// What the rows of contacts were left with at the end of a step at most: how far a velocity is from where Coulomb's law
    /// wants it, m/s.
    pub worst_residual: f64,
    /// The deepest penetration of two bodies at the start or the end of a step, m.
    pub worst_penetration: f64,
    /// Steps in which a 3DOF group was so near its pole that angle torques were regularised.
    pub pole_steps: u64,
    /// Steps whose result was not finite and was not taken. The world stands still from the first one on.
    pub diverged_steps: u64,
}

/// One simulated world. A clone made between intervals goes on with the same bits.
#[derive(Clone, Debug)]
pub struct World {
    /// What is left of the robot.
    model: Arc<Model>,
    breaking: breaking::Breaking,
    history: rebuild::History,
    /// The model as it was before its fixed base was moved, if it was.
    unmoved: Option<Arc<Model>>,
    settings: Settings,
    engine: Box<dyn Engine>,
    effects: Effects,
    initial: State,
    commands: Vec<AxisCommand>,
    kinematics: Kinematics,
    interval: u64,
    stamp_ns: i64,
    /// Part of a nanosecond that the time scale has left over.
    rest_ns: f64,
    stats: Stats,
    contacts: Vec<ContactPoint>,
    warnings: Warnings,
}

impl World {
    /// A world at its initial state, time 0, every axis in its mode at start.
    ///
    /// # Errors
    /// Says which setting is out of range.
    pub fn new(model: Arc<Model>, settings: Settings) -> Result<Self, String> {
        settings.check()?;
        let model = model.in_force();
        let initial = State::initial(&model);
        let mut engine = settings.engine.build(&model, &initial)?;
        engine.prepare(&model, settings.integrator);
        let mut world = Self {
            effects: model.effects,
            initial,
            engine,
            commands: vec![AxisCommand::IDLE; model.axes.len()],
            kinematics: Kinematics::new(&model),
            breaking: breaking::Breaking::new(&model),
            history: rebuild::History::default(),
            model,
            unmoved: None,
            settings,
            interval: 0,
            stamp_ns: 0,
            rest_ns: 0.0,
            stats: Stats::default(),
            contacts: vec![],
            warnings: Warnings::default(),
        };
        world.reset();
        world.warn_of_setup();
        Ok(world)
    }

    /// The model; once joints have come apart ([`World::broken`]), what is left of it: the same axes and links, other bodies.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The settings in force.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Takes effect with the next step. Allocates only if the engine or the integrator changes. Another engine goes on from the
    /// present state with the present drives and ledgers.
    ///
    /// # Errors
    /// Says which setting is out of range, or what the engine cannot take; nothing changes then.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), String> {
        settings.check()?;
        if settings.engine != self.settings.engine {
            self.engine = self.built(&self.model, self.engine.state(), &settings)?;
        } else if settings.integrator != self.settings.integrator {
            self.engine.prepare(&self.model, settings.integrator);
        }
        self.settings = settings;
        Ok(())
    }

    /// Sets the drive inputs of all axes, in the order of `Model::axes`; allocates nothing.
    ///
    /// # Errors
    /// The index of the first axis whose command is not a number, or whose count does not fit; nothing changes then.
    pub fn set_commands(&mut self, commands: &[AxisCommand]) -> Result<(), usize> {
        if commands.len() != self.commands.len() {
            return Err(commands.len());
        }
        if let Some(bad) = commands.iter().position(|c| !c.is_sound()) {
            return Err(bad);
        }
        self.commands.copy_from_slice(commands);
        Ok(())
    }

    /// The drive inputs in force.
    pub fn commands(&self) -> &[AxisCommand] {
        &self.commands
    }

    /// Per axis, N·m or N: the drive torque really applied in the last step.
    pub fn efforts(&self) -> &[f64] {
        &self.engine.books().effort
    }

    /// The state.
    pub fn state(&self) -> &State {
        self.engine.state()
    }

    /// Puts the world into a state of the model with all its joints, which also becomes the one that [`World::reset`] goes back to.
    pub fn set_initial_state(&mut self, state: State) {
        self.initial = state;
        self.reset();
        self.warn_of_setup();
    }

    /// Remembers where everything is now as the state that [`World::reset`] goes back to (B-13, B-14): poses
    /// and angles; the velocities at start stay what they were. `false`, and nothing is remembered, while a joint is apart: the
    /// initial state is one of the whole robot.
    pub fn remember(&mut self) -> bool {
        if !self.broken().is_empty() {
            return false;
        }
        self.initial.q.copy_from_slice(&self.engine.state().q);
        self.initial.angles.copy_from_slice(&self.engine.state().angles);
        self.unmoved = None;
        self.breaking.intact = self.model.clone();
        true
    }

    /// Advances one control interval; allocates nothing but when a joint comes apart, cannot panic. A world that has diverged
    /// stands still.
    pub fn advance(&mut self) {
        let scaled = self.settings.control_interval_ns as f64 * self.settings.time_scale + self.rest_ns;
        let whole = scaled.floor();
        self.rest_ns = scaled - whole;
        self.stamp_ns += whole as i64;
        self.interval += 1;
        if self.settings.time_scale == 0.0 {
            return;
        }
        self.begin_to_run();
        let step = self.step_settings();
        for to_come in (0..self.settings.steps_per_interval).rev() {
            if self.stats.diverged_steps > 0 || self.history.faulty {
                break;
            }
            self.watch_joints();
            self.step(&step);
            self.break_joints(&step, self.time() - f64::from(to_come) * step.h);
        }
        self.update();
        self.warn_of_events();
    }

    fn step_settings(&self) -> StepSettings {
        let s = &self.settings;
        let interval = s.control_interval_ns as f64 * 1e-9 * s.time_scale;
        StepSettings {
            h: interval / f64::from(s.steps_per_interval),
            gravity: self.gravity(),
            effects: self.effects,
            passes: s.solver_iterations,
            integrator: s.integrator,
            accuracy: s.accuracy,
        }
    }

    fn step(&mut self, settings: &StepSettings) {
        let report = self.engine.step(&self.model, &self.commands, settings);
        let s = &mut self.stats;
        s.steps += 1;
        s.fallback_steps += u64::from(report.fell_back);
        s.unsettled_steps += u64::from(report.unsettled);
        s.halvings += u64::from(report.halvings);
        s.divided_steps += u64::from(report.divided);
        s.fast_pieces += u64::from(report.fast);
        s.guarded_pieces += u64::from(report.guarded);
        s.guarded_energy += report.guarded_energy;
        s.worst_residual = s.worst_residual.max(report.residual);
        s.trimmed_energy += report.trimmed_energy;
        s.tempered_steps += u64::from(report.tempered);
        s.worst_stop_violation = self.engine.books().worst_stop;
        s.pole_steps += u64::from(report.at_pole);
        s.diverged_steps += u64::from(report.diverged);
    }

    /// Gravity in force: zero if the effect is off.
    fn gravity(&self) -> [f64; 3] {
        if self.effects.gravity { self.settings.gravity } else { [0.0; 3] }
    }

    /// Back to the initial state and time 0; every axis in its mode at start, every joint whole. Allocates only if one was apart.
    pub fn reset(&mut self) {
        self.reset_time();
        self.reset_state();
    }

    /// Time is 0; everything stays where it is.
    pub fn reset_time(&mut self) {
        (self.interval, self.stamp_ns, self.rest_ns) = (0, 0, 0.0);
    }

    /// Back to the initial state, as [`World::reset`]; time goes on.
    pub fn reset_state(&mut self) {
        self.mend_joints();
        self.history.faulty = false;
        if let Some(model) = self.unmoved.take() {
            self.model = model;
        }
        self.engine.restart(&self.model, &self.initial);
        for (i, axis) in self.model.axes.iter().enumerate() {
            self.commands[i] = match axis.mode {
                Mode::Idle => AxisCommand::IDLE,
                Mode::Torque => AxisCommand::torque(0.0),
                Mode::Servo => AxisCommand::servo(self.initial.axis(&self.model, i).0),
            };
        }
        self.stats = Stats::default();
        self.update();
    }

    fn update(&mut self) {
        self.engine.poses(&self.model, &mut self.kinematics);
        if self.engine.has_contacts() {
            self.show_contacts();
        }
    }

    /// A snapshot with all buffers at their size.
    pub fn new_snapshot(&self) -> Snapshot {
        let (axes, links) = (self.model.axes.len(), self.model.links.len());
        let mut s = Snapshot {
            position: vec![0.0; axes],
            velocity: vec![0.0; axes],
            effort: vec![0.0; axes],
            commands: self.commands.clone(),
            settings: self.settings,
            link_pose: vec![Pose::identity(); links],
            link_twist: vec![Twist::default(); links],
            cut_off: vec![false; links],
            removed: vec![false; links],
            contacts: Vec::with_capacity(SHOWN_CONTACTS),
            link_wrench: vec![Wrench::default(); links],
            broken: Vec::with_capacity(self.breaking.intact.breakables.len()),
            ..Snapshot::default()
        };
        self.write_snapshot(&mut s);
        s
    }

    /// Writes the present state; allocates nothing.
    pub fn write_snapshot(&self, s: &mut Snapshot) {
        let (m, state) = (&self.model, self.engine.state());
        (s.interval, s.stamp_ns) = (self.interval, self.stamp_ns);
        for i in 0..m.axes.len() {
            (s.position[i], s.velocity[i]) = state.axis(m, i);
        }
        s.effort.copy_from_slice(&self.engine.books().effort);
        s.commands.copy_from_slice(&self.commands);
        s.settings = self.settings;
        s.cause = None;
        for link in 0..m.links.len() {
            s.link_pose[link] = link_pose(m, &self.kinematics, &state.q, &state.angles, link);
            s.removed[link] = m.links[link].removed;
            s.cut_off[link] = m.links[link].parent.is_none() && !m.is_root(link);
            s.link_twist[link] = link_twist(m, &self.kinematics, (&state.q, &state.v), &state.angles, link);
        }
        let e = self.energy();
        (s.kinetic_energy, s.potential_energy) = (e.kinetic, e.potential);
        s.take_contacts(m, &self.contacts);
        s.stats = self.stats;
        s.broken.clear();
        s.broken.extend_from_slice(self.broken());
        (s.condition, s.warnings) = (self.condition(), self.warnings.count());
        s.finite = self.stats.diverged_steps == 0;
    }

    /// Simulated time, ns.
    pub fn stamp_ns(&self) -> i64 {
        self.stamp_ns
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.stamp_ns as f64 * 1e-9
    }

    /// Kinetic and potential energy, J; rotors count with their speed relative to the joint.
    pub fn energy(&self) -> Energy {
        let mut e = energy(&self.model, &self.kinematics, self.gravity());
        e.kinetic += self.rotor_energy();
        e
    }

    /// Of the rotors, with their speed relative to the joint, J.
    fn rotor_energy(&self) -> f64 {
        if !self.effects.rotor_inertia {
            return 0.0;
        }
        self.state().rotor_energy(&self.model, self.engine.books().drives.iter().map(|d| d.rotor_inertia))
    }

    /// Work of the drives, losses at the axes and at contacts since the start or the last reset, J. With [`World::energy`] and
    /// what the counters say was taken out it shows the error of the integrator: what the energy has gained beyond
    /// `drives − losses − contacts`.
    pub fn work(&self) -> Work {
        self.engine.books().work
    }

    /// Momentum in the world frame, about the common centre of mass.
    pub fn momentum(&self) -> Momentum {
        momentum(&self.model, &self.kinematics)
    }

    /// By how much the two sides of a joint have come apart at most since the start, m; 0 in reduced coordinates.
    pub fn joint_drift(&self) -> f64 {
        self.engine.joint_drift()
    }

    /// Counters.
    pub fn stats(&self) -> Stats {
        self.stats
    }
}
