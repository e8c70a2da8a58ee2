//! Command timeout: what the axes do when nobody commands them any more, decided in simulated time.

use super::exchange::Pace;
use crate::model::{Axis, Model};
use crate::world::{AxisCommand, Mode, Order, World};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Parameter `on_timeout`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnTimeout {
    /// Servo where the axis is.
    #[default]
    Hold,
    /// The drive gives no torque.
    Idle,
    /// No torque is applied, and the motor is short-circuited (J-13 g).
    Brake,
}

impl OnTimeout {
    /// Names of the values; the first one is the default.
    pub const NAMES: [&'static str; 3] = ["hold", "idle", "brake"];

    /// From its name; the default for any other text.
    pub fn by_name(name: &str) -> Self {
        match name {
            "idle" => Self::Idle,
            "brake" => Self::Brake,
            _ => Self::Hold,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// What an axis does at `position` (rad or m) that may (`may_switch`) or may not leave its mode. Without leaving it, a servo holds
    /// and torque ends.
    fn command(self, mode: Mode, may_switch: bool, position: f64) -> AxisCommand {
        match (self, mode) {
            (Self::Hold, _) if may_switch => AxisCommand::servo(position),
            (Self::Idle, _) if may_switch => AxisCommand::IDLE,
            (Self::Brake, _) if may_switch => AxisCommand::torque(0.0),
            (_, Mode::Servo) => AxisCommand::servo(position),
            (_, Mode::Torque) => AxisCommand::torque(0.0),
            (_, Mode::Idle) => AxisCommand::IDLE,
        }
    }

    /// Which axes cannot do this, and what they do instead; `None` if all can.
    pub fn left_out(self, m: &Model, allow_mode_switch: bool) -> Option<String> {
        let stays = |a: &&Axis| !(a.switchable && allow_mode_switch) && a.mode != self.mode();
        let names = |axes: Vec<&str>| (!axes.is_empty()).then(|| axes.join(", "));
        let stay = names(m.axes.iter().filter(stays).map(|a| a.name.as_str()).collect());
        let stay = stay.map(|n| format!("{n}: may not switch to it; torque ends there, servos hold where they are"));
        let bounded = |a: &Axis| a.drive.max_torque.is_finite() && a.drive.no_load_speed.is_finite();
        let free = |a: &&Axis| self == Self::Brake && !bounded(a);
        let free = names(m.axes.iter().filter(free).map(|a| a.name.as_str()).collect());
        let free =
            free.map(|n| format!("{n}: cannot brake without a finite max_torque and no_load_speed; no torque there"));
        let parts: Vec<String> = stay.into_iter().chain(free).collect();
        (!parts.is_empty()).then(|| format!("on_timeout {} leaves axes out: {}", self.name(), parts.join("; ")))
    }

    fn mode(self) -> Mode {
        match self {
            Self::Hold => Mode::Servo,
            Self::Idle => Mode::Idle,
            Self::Brake => Mode::Torque,
        }
    }
}

/// What happened because no command came, for `/diagnostics`.
#[derive(Debug, Default)]
pub struct Lapses {
    /// Command timeouts.
    pub timeouts: AtomicU64,
    /// Is `on_timeout` in force?
    pub fallen_back: AtomicBool,
    /// Intervals that were made in lock-step without a command.
    pub unled_intervals: AtomicU64,
}

/// Watches over the commands, in the control loop; allocates nothing once it is made.
pub struct Watchdog {
    /// Simulated time since the last command, ns; `None`: there was none yet, or the timeout is over.
    silence: Option<i64>,
    commands: Vec<AxisCommand>,
    /// Per axis: does it follow another one, which holds it?
    follows: Vec<bool>,
    /// Switches the short brake of those drives that have it not on by their tag on, and off again.
    brake: [Arc<Order>; 2],
    braking: bool,
}

impl Watchdog {
    /// For `world`, as it starts.
    pub fn new(world: &World) -> Self {
        let m = world.model();
        let axes: Vec<usize> = (0..m.axes.len()).filter(|i| !m.axes[*i].drive.short_brake).collect();
        let brake = [true, false].map(|on| Arc::new(Order::ShortBrake { axes: axes.clone(), on }));
        let follows = |i| m.couplings_in_force().iter().any(|c| c.follower == i);
        Self {
            silence: None,
            commands: world.commands().to_vec(),
            follows: (0..m.axes.len()).map(follows).collect(),
            brake,
            braking: false,
        }
    }

    /// A command has come. An order to release the brake, if it is on.
    pub fn heard(&mut self, lapses: &Lapses) -> Option<&Arc<Order>> {
        self.silence = Some(0);
        self.end(lapses)
    }

    /// The commands of the start are in force again. An order to release the brake, if it is on.
    pub fn forget(&mut self, lapses: &Lapses) -> Option<&Arc<Order>> {
        self.silence = None;
        self.end(lapses)
    }

    fn end(&mut self, lapses: &Lapses) -> Option<&Arc<Order>> {
        lapses.fallen_back.store(false, Relaxed);
        std::mem::take(&mut self.braking).then_some(&self.brake[1])
    }

    /// Simulated time has passed, ns.
    pub fn passed(&mut self, ns: i64) {
        if let Some(silence) = &mut self.silence {
            *silence += ns;
        }
    }

    /// Has there been no command for too long?
    pub fn is_due(&self, pace: &Pace) -> bool {
        pace.command_timeout_ns > 0 && self.silence.is_some_and(|ns| ns >= pace.command_timeout_ns)
    }

    /// The commands that are in force from now on, and an order to brake, if that is what is wanted.
    pub fn fall_back(&mut self, world: &World, pace: &Pace, lapses: &Lapses) -> (&[AxisCommand], Option<&Arc<Order>>) {
        let (m, state) = (world.model(), world.state());
        for (i, (axis, present)) in m.axes.iter().zip(world.commands()).enumerate() {
            let may_switch = axis.switchable && pace.allow_mode_switch;
            let policy = match pace.on_timeout {
                OnTimeout::Hold if self.follows[i] => OnTimeout::Idle,
                policy => policy,
            };
            self.commands[i] = policy.command(present.mode, may_switch, state.axis(m, i).0);
        }
        self.silence = None;
        self.braking = pace.on_timeout == OnTimeout::Brake;
        lapses.timeouts.fetch_add(1, Relaxed);
        lapses.fallen_back.store(true, Relaxed);
        (&self.commands, self.braking.then_some(&self.brake[0]))
    }
}
