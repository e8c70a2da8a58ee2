//! The lock-free cells between the control thread and the ROS threads. Nothing here blocks or, after set-up, allocates.
//!
//! Commands and settings go in through triple buffers (the latest value wins), snapshots come out through a bounded
//! ring that drops the oldest and counts, timing comes out by exchanging boxes. What is asked of the world (`asks.rs`) waits in a
//! bounded queue; commands that the control loop has set on its own come out through a triple buffer.

use super::asks::{Ask, Asks};
use super::lockstep::Gate;
use super::watchdog::OnTimeout;
use crate::monitor::Timing;
use crate::world::{AxisCommand, Order, Settings, Snapshot, World};
use crossbeam_queue::ArrayQueue;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use triple_buffer::{Input, Output, triple_buffer};

/// Snapshots that the ring holds before it drops the oldest: a second of a 1 ms loop.
pub const RING_CAPACITY: usize = 1024;
/// One is being written and one is being published while the ring is full.
const SPARE_BOXES: usize = 2;
/// One collects, one travels, one is being read.
const TIMING_BOXES: usize = 3;

/// Settings that may change while the loop runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Settings of the world.
    pub settings: Settings,
    /// Time stands still; states are shown all the same.
    pub paused: bool,
    /// Real time per control interval = interval / factor; 0 = as fast as the snapshots are taken.
    pub real_time_factor: f64,
    /// Control intervals that may be caught up before the deadline is set anew.
    pub max_catch_up: u32,
    /// W-7: does a reset of the state put the joints back, too?
    pub reset_joints: bool,
    /// W-8: is the state reset whenever time goes on after a pause?
    pub reset_at_start: bool,
    /// Is every interval made again with finer steps, to see what it is off by?
    pub estimate_error: bool,
    /// Does the world wait for stamped commands?
    pub lockstep: bool,
    /// Real time that it waits at most, ns; 0: for ever.
    pub lockstep_timeout_ns: u64,
    /// Simulated time without a command after which `on_timeout` comes into force, ns; 0: never.
    pub command_timeout_ns: i64,
    /// What the axes do then.
    pub on_timeout: OnTimeout,
    /// May the control loop switch modes of drives?
    pub allow_mode_switch: bool,
}

impl Default for Pace {
    /// In real time.
    fn default() -> Self {
        Self {
            settings: Settings::default(),
            paused: false,
            real_time_factor: 1.0,
            max_catch_up: 100,
            reset_joints: true,
            reset_at_start: false,
            estimate_error: false,
            lockstep: false,
            lockstep_timeout_ns: 0,
            command_timeout_ns: 0,
            on_timeout: OnTimeout::Hold,
            allow_mode_switch: true,
        }
    }
}

/// The control thread's end.
pub struct ControlEnd {
    /// Latest commands of all axes.
    pub commands: Output<Vec<AxisCommand>>,
    /// Latest settings.
    pub pace: Output<Pace>,
    /// Set to end the loop.
    pub stop: Arc<AtomicBool>,
    /// What is asked of the world.
    pub asks: Arc<Asks>,
    /// Where it waits in lock-step.
    pub gate: Arc<Gate>,
    in_force: Input<Vec<AxisCommand>>,
    ring: Arc<Ring>,
}

/// The publishing thread's end.
pub struct PublishEnd {
    ring: Arc<Ring>,
}

/// The commanding thread's end.
pub struct CommandEnd {
    commands: Input<Vec<AxisCommand>>,
    pace: Input<Pace>,
    in_force: Output<Vec<AxisCommand>>,
    /// To ask something of the world.
    pub asks: Arc<Asks>,
    /// Where the world waits in lock-step.
    pub gate: Arc<Gate>,
}

struct Ring {
    full: ArrayQueue<Box<Snapshot>>,
    free: ArrayQueue<Box<Snapshot>>,
    dropped: AtomicU64,
    timing_full: ArrayQueue<Box<Timing>>,
    timing_free: ArrayQueue<Box<Timing>>,
}

/// The three ends for `world`; `stop` ends the loop. `commands` and `pace` are the values at start.
pub fn exchange(
    world: &World,
    commands: &Vec<AxisCommand>,
    pace: &Pace,
    stop: Arc<AtomicBool>,
) -> Result<(ControlEnd, PublishEnd, CommandEnd), String> {
    let (commands_in, commands_out) = triple_buffer(commands);
    let (pace_in, pace_out) = triple_buffer(pace);
    let (in_force_in, in_force_out) = triple_buffer(commands);
    let (ring, asks, gate) = (Arc::new(Ring::new(world)?), Arc::new(Asks::default()), Arc::new(Gate::default()));
    Ok((
        ControlEnd {
            commands: commands_out,
            pace: pace_out,
            stop,
            asks: asks.clone(),
            gate: gate.clone(),
            in_force: in_force_in,
            ring: ring.clone(),
        },
        PublishEnd { ring },
        CommandEnd { commands: commands_in, pace: pace_in, in_force: in_force_out, asks, gate },
    ))
}

impl Ring {
    fn new(world: &World) -> Result<Self, String> {
        let ring = Self {
            full: ArrayQueue::new(RING_CAPACITY),
            free: ArrayQueue::new(RING_CAPACITY + SPARE_BOXES),
            dropped: AtomicU64::new(0),
            timing_full: ArrayQueue::new(TIMING_BOXES),
            timing_free: ArrayQueue::new(TIMING_BOXES),
        };
        for _ in 0..RING_CAPACITY + SPARE_BOXES {
            let _ = ring.free.push(Box::new(world.new_snapshot()));
        }
        for _ in 1..TIMING_BOXES {
            let _ = ring.timing_free.push(Box::new(Timing::new()?));
        }
        Ok(ring)
    }
}

impl ControlEnd {
    /// Hands the state of `world` out; drops the oldest unpublished state if there is no room, and counts it.
    pub fn emit(&self, world: &World) {
        self.emit_after(world, None);
    }

    /// The same, after an order.
    pub fn emit_after(&self, world: &World, cause: Option<Arc<Order>>) {
        // Never empty: the ring and the publishing thread together hold one box less than there are.
        let Some(mut snapshot) = self.ring.free.pop() else { return };
        world.write_snapshot(&mut snapshot);
        snapshot.cause = cause;
        if let Some(oldest) = self.ring.full.force_push(snapshot) {
            self.ring.dropped.fetch_add(1, Ordering::Relaxed);
            let _ = self.ring.free.push(oldest);
        }
    }

    /// Tells the listening thread that these commands are in force now, whoever commanded something else before.
    pub fn overrule(&mut self, commands: &[AxisCommand]) {
        self.in_force.input_buffer_mut().copy_from_slice(commands);
        self.in_force.publish();
    }

    /// The next thing that is asked of the world.
    pub fn ask(&self) -> Option<Ask> {
        self.asks.next()
    }

    /// True if the next [`Self::emit`] drops nothing.
    pub fn has_room(&self) -> bool {
        !self.ring.full.is_full() && !self.ring.free.is_empty()
    }

    /// Exchanges a full timing record for an empty one; keeps collecting if none has come back yet.
    pub fn hand_over(&self, timing: &mut Box<Timing>) {
        if let Some(empty) = self.ring.timing_free.pop() {
            let _ = self.ring.timing_full.push(std::mem::replace(timing, empty));
        }
    }
}

impl PublishEnd {
    /// Shows the oldest unpublished snapshot to `publish`; false if there is none.
    pub fn next(&self, publish: impl FnOnce(&Snapshot)) -> bool {
        let Some(snapshot) = self.ring.full.pop() else { return false };
        publish(&snapshot);
        let _ = self.ring.free.push(snapshot);
        true
    }

    /// Snapshots dropped since the start because the ring was full.
    pub fn dropped(&self) -> u64 {
        self.ring.dropped.load(Ordering::Relaxed)
    }

    /// Snapshots waiting.
    pub fn waiting(&self) -> usize {
        self.ring.full.len()
    }

    /// Shows every timing record that has come in to `read`.
    pub fn timings(&self, mut read: impl FnMut(&Timing)) {
        while let Some(mut timing) = self.ring.timing_full.pop() {
            read(&timing);
            timing.clear();
            let _ = self.ring.timing_free.push(timing);
        }
    }
}

impl CommandEnd {
    /// Makes `commands` (all axes) the latest.
    pub fn command(&mut self, commands: &[AxisCommand]) {
        // Cloned from the start value, so the length is right.
        self.commands.input_buffer_mut().copy_from_slice(commands);
        self.commands.publish();
    }

    /// Commands that the control loop has set on its own since the last call; what was commanded before is no longer in force.
    pub fn overruled(&mut self) -> Option<&[AxisCommand]> {
        if self.in_force.update() { Some(self.in_force.output_buffer()) } else { None }
    }

    /// Makes `pace` the latest, and wakes a loop that stands.
    pub fn set_pace(&mut self, pace: Pace) {
        self.pace.write(pace);
        self.asks.wake();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::MassProperties;
    use crate::math::{Mat3, Pose, Vec3};
    use crate::model::{Base, Model};

    /// Two links, one axis.
    fn world() -> World {
        let text = r#"<robot name="r"><link name="a"/>
            <link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
            <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>"#;
        let description = crate::description::read(text, "r.urdf").description.unwrap();
        let (none, one) = (Mat3::zeros(), Mat3::identity());
        let masses =
            [(0.0, none), (1.0, one)].map(|(mass, inertia)| MassProperties { mass, center: Vec3::zeros(), inertia });
        let model = Model::build(&description, &masses, Base::Fixed, Pose::identity());
        World::new(Arc::new(model), Settings::default()).unwrap()
    }

    fn ends(world: &World) -> (ControlEnd, PublishEnd, CommandEnd) {
        let pace = Pace::default();
        exchange(world, &world.commands().to_vec(), &pace, Arc::default()).unwrap()
    }

    #[test]
    fn a_full_ring_drops_the_oldest_and_counts() {
        let mut world = world();
        let (control, publish, _) = ends(&world);
        let extra = 5;
        for _ in 0..RING_CAPACITY + extra {
            world.advance();
            control.emit(&world);
        }
        assert!(!control.has_room());
        let mut seen = vec![];
        while publish.next(|s| seen.push(s.interval)) {}
        assert_eq!(publish.dropped(), extra as u64);
        assert!(seen.iter().copied().eq(extra as u64 + 1..=(RING_CAPACITY + extra) as u64), "{seen:?}");
        assert!(control.has_room());
    }

    #[test]
    fn the_latest_pace_wins() {
        let world = world();
        let (mut control, _, mut command) = ends(&world);
        let pace = *control.pace.output_buffer();
        command.set_pace(Pace { max_catch_up: 1, ..pace });
        command.set_pace(Pace { max_catch_up: 2, ..pace });
        assert!(control.pace.update());
        assert_eq!(control.pace.output_buffer().max_catch_up, 2);
        assert!(!control.pace.update());
    }

    #[test]
    fn timing_is_kept_while_nobody_reads_it() {
        let world = world();
        let (control, publish, _) = ends(&world);
        let mut timing = Box::new(Timing::new().unwrap());
        for _ in 0..10 {
            timing.record(1, 1, 1000);
            control.hand_over(&mut timing);
        }
        let mut intervals = 0;
        publish.timings(|t| intervals += t.intervals);
        control.hand_over(&mut timing);
        publish.timings(|t| intervals += t.intervals);
        assert_eq!(intervals, 10);
    }
}
