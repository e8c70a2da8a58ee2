//! The control loop, in a thread of its own: wakes on absolute deadlines, allocates nothing, logs nothing, locks nothing.

use super::asks::{Ask, Reply};
use super::clock;
use super::exchange::{ControlEnd, Pace};
use super::listen::Live;
use super::watchdog::Watchdog;
use crate::monitor::Timing;
use crate::world::{AxisCommand, LocalEstimate, Mode, Order, World};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, Thread};
use std::time::Duration;

/// How often timing records are handed over, ns.
const TIMING_PERIOD_NS: u64 = 1_000_000_000;
/// Pause while the ring is full and nothing may be dropped, ns.
const FULL_RING_PAUSE_NS: u64 = 100_000;
/// How often the state is shown while time stands, ns.
const PAUSED_PERIOD_NS: u64 = 20_000_000;
/// Longest single sleep, so that the end of the program is noticed in time, ns.
const LONGEST_SLEEP_NS: u64 = 50_000_000;

/// The loop and what it owns.
pub struct ControlLoop {
    world: World,
    end: ControlEnd,
    /// The publishing thread, woken after each interval.
    reader: Thread,
    timing: Box<Timing>,
    pace: Pace,
    /// Commands at the start and after a reset.
    at_start: Vec<AxisCommand>,
    /// Control intervals that are still to be made while time stands, and who waits for them.
    steps: Option<(u64, Reply<i64>)>,
    watchdog: Watchdog,
    estimate: LocalEstimate,
    live: Arc<Live>,
    /// ns on the monotonic clock.
    deadline: u64,
    /// When lock-step goes on without a command, ns on the monotonic clock.
    patience: u64,
    next_hand_over: u64,
}

impl ControlLoop {
    /// A loop over `world` that wakes `reader` after each interval.
    pub fn new(world: World, end: ControlEnd, reader: Thread, live: Arc<Live>) -> Result<Self, String> {
        let pace = *end.pace.output_buffer();
        let timing = Box::new(Timing::new()?);
        let at_start = world.commands().to_vec();
        let watchdog = Watchdog::new(&world);
        Ok(Self {
            world,
            end,
            reader,
            timing,
            pace,
            at_start,
            steps: None,
            watchdog,
            estimate: LocalEstimate::default(),
            live,
            deadline: 0,
            patience: u64::MAX,
            next_hand_over: 0,
        })
    }

    /// Shows the state at t = 0, then runs until the stop flag is set.
    pub fn run(mut self) {
        self.end.asks.serve();
        self.open_gate();
        self.emit();
        self.deadline = clock::now_ns() + self.period_ns();
        self.next_hand_over = clock::now_ns() + TIMING_PERIOD_NS;
        while self.wait() {
            self.interval();
        }
        self.end.hand_over(&mut self.timing);
        self.reader.unpark();
    }

    /// One control interval: inputs, physics, outputs, bookkeeping.
    fn interval(&mut self) {
        self.take_inputs();
        if self.stands() {
            return self.stand();
        }
        let start = clock::now_ns();
        let lateness = if self.paced() { start.saturating_sub(self.deadline) } else { 0 };
        self.advance(lateness, self.period_ns());
        self.next_deadline(lateness);
        if start >= self.next_hand_over {
            self.end.hand_over(&mut self.timing);
            self.next_hand_over = start + TIMING_PERIOD_NS;
        }
    }

    /// Physics and outputs of an interval that is late by `lateness` and takes `period` of real time, ns.
    fn advance(&mut self, lateness: u64, period: u64) {
        if self.watchdog.is_due(&self.pace) {
            self.fall_back();
        }
        let (stamp, before) = (self.world.stamp_ns(), clock::now_ns());
        if self.pace.estimate_error {
            self.advance_twice();
        } else {
            self.world.advance();
        }
        self.timing.record(lateness, clock::now_ns() - before, period);
        self.watchdog.passed(self.world.stamp_ns() - stamp);
        self.open_gate();
        self.emit();
    }

    /// One interval, and again with finer steps. Allocates.
    fn advance_twice(&mut self) {
        let start = clock::now_ns();
        self.estimate.begin(&self.world);
        let middle = clock::now_ns();
        self.world.advance();
        let end = clock::now_ns();
        let error = self.estimate.end(&self.world);
        self.timing.record_estimate(clock::now_ns() - end + middle - start, &error);
    }

    /// One interval while time stands otherwise.
    fn advance_by_one(&mut self) {
        self.advance(0, 0);
        self.deadline = clock::now_ns() + PAUSED_PERIOD_NS;
    }

    /// Nobody has commanded anything for too long.
    fn fall_back(&mut self) {
        let (commands, brake) = self.watchdog.fall_back(&self.world, &self.pace, &self.live.counts.lapses);
        let brake = brake.cloned();
        // Made of finite positions, of the right count.
        let _ = self.world.set_commands(commands);
        self.end.overrule(commands);
        self.switch_brake(brake);
    }

    fn switch_brake(&mut self, order: Option<Arc<Order>>) {
        if let Some(order) = order {
            let _ = self.world.execute(&order);
            self.end.emit_after(&self.world, Some(order));
        }
    }

    /// In lock-step the world waits from now on.
    fn open_gate(&mut self) {
        let stamp = self.world.stamp_ns();
        match self.pace.lockstep {
            true => self.end.gate.open(stamp),
            false => self.end.gate.close(stamp),
        }
        self.be_patient();
    }

    /// The time in which a command should come begins now.
    fn be_patient(&mut self) {
        self.patience = match self.pace.lockstep_timeout_ns {
            ns if ns > 0 && self.pace.lockstep => clock::now_ns().saturating_add(ns),
            _ => u64::MAX,
        };
    }

    /// In lock-step: has a command come for the present state, or has that taken too long?
    fn is_led(&mut self) -> bool {
        if self.pace.paused || !self.pace.lockstep || !self.end.has_room() {
            return false;
        }
        if self.end.gate.take() {
            return true;
        }
        let late = clock::now_ns() >= self.patience && self.end.gate.expire(self.world.stamp_ns());
        if late {
            self.live.counts.lapses.unled_intervals.fetch_add(1, Ordering::Relaxed);
        }
        late
    }

    /// Shows the state again and sets the deadline anew: time that has stood is not caught up.
    fn stand(&mut self) {
        self.emit();
        let now = clock::now_ns();
        self.deadline = now + PAUSED_PERIOD_NS;
        if now >= self.next_hand_over {
            self.end.hand_over(&mut self.timing);
            self.next_hand_over = now + TIMING_PERIOD_NS;
        }
    }

    /// One of the intervals that were asked for.
    fn make_step(&mut self) {
        self.take_inputs();
        let Some((left, reply)) = self.steps.take() else { return };
        if left == 0 {
            let _ = reply.send(Ok(self.world.stamp_ns()));
            return;
        }
        self.advance_by_one();
        self.steps = Some((left - 1, reply));
    }

    /// Does what is asked of the world. May allocate: what is asked for is not done in every interval.
    fn answer(&mut self) {
        while let Some(ask) = self.end.ask() {
            match ask {
                Ask::Order(order, reply) => {
                    let _ = reply.send(self.execute(&order));
                }
                Ask::Look(look) => look(&self.world),
                Ask::Steps(_, reply) if !self.stands() => refuse(reply, "time runs: pause the simulation first"),
                Ask::Steps(_, reply) if self.steps.is_some() => {
                    refuse(reply, "steps that were asked for are being made")
                }
                Ask::Steps(count, reply) => self.steps = Some((count, reply)),
            }
        }
    }

    /// Nobody waits for steps any more.
    fn give_up_steps(&mut self, why: &str) {
        if let Some((left, reply)) = self.steps.take() {
            refuse(reply, &format!("{why}: {left} steps were not made"));
        }
    }

    fn execute(&mut self, order: &Arc<Order>) -> Result<(), String> {
        self.world.execute(order)?;
        if matches!(**order, Order::Reset { state: true, .. } | Order::Rebuild { .. }) {
            self.give_up_steps("the state was reset");
            // A command that came just before is not in force any more.
            self.end.commands.update();
            let held = self.held_at_start();
            let _ = self.world.set_commands(&held);
            self.end.overrule(&held);
            let brake = self.watchdog.forget(&self.live.counts.lapses).cloned();
            self.switch_brake(brake);
        }
        if matches!(**order, Order::Reset { .. }) {
            self.open_gate();
        }
        self.end.emit_after(&self.world, Some(order.clone()));
        self.reader.unpark();
        Ok(())
    }

    /// The commands at start; servos hold where the axes are.
    fn held_at_start(&self) -> Vec<AxisCommand> {
        let positions = self.world.state().positions(self.world.model());
        let held = |(command, position): (&AxisCommand, f64)| match command.mode {
            Mode::Servo => AxisCommand { target: position, ..*command },
            _ => *command,
        };
        self.at_start.iter().zip(positions).map(held).collect()
    }

    fn take_inputs(&mut self) {
        if self.end.pace.update() {
            let before = std::mem::replace(&mut self.pace, *self.end.pace.output_buffer());
            // Checked before it was sent. Allocates if, and only if, the engine or the integrator changes.
            let _ = self.world.set_settings(self.pace.settings);
            if before.paused && !self.pace.paused {
                self.play();
            }
            if (before.lockstep, before.lockstep_timeout_ns) != (self.pace.lockstep, self.pace.lockstep_timeout_ns) {
                self.open_gate();
            }
        }
        if self.end.commands.update() {
            let brake = self.watchdog.heard(&self.live.counts.lapses).cloned();
            self.switch_brake(brake);
            // Checked before they were sent, too.
            let _ = self.world.set_commands(self.end.commands.output_buffer());
        }
    }

    /// Time goes on after a pause.
    fn play(&mut self) {
        self.be_patient();
        if !self.pace.lockstep {
            self.give_up_steps("time goes on");
        }
        if self.pace.reset_at_start {
            let _ = self.execute(&Arc::new(Order::Reset { time: false, state: true, joints: self.pace.reset_joints }));
        }
    }

    fn emit(&self) {
        self.end.emit(&self.world);
        self.reader.unpark();
    }

    /// W-17: a late loop keeps its deadlines and so simulates every interval, until it is too far behind.
    fn next_deadline(&mut self, lateness: u64) {
        let period = self.period_ns();
        if !self.paced() {
            self.deadline = clock::now_ns();
        } else if lateness > period.saturating_mul(u64::from(self.pace.max_catch_up)) {
            self.timing.record_rebase(lateness);
            self.deadline += lateness + period;
        } else {
            self.deadline += period;
        }
    }

    /// Sleeps until the next interval is due, and does what is asked for meanwhile; false at the end of the program.
    fn wait(&mut self) -> bool {
        loop {
            if self.end.stop.load(Ordering::Relaxed) {
                return false;
            }
            if self.end.asks.waiting() {
                self.take_inputs();
                self.answer();
            }
            if self.steps.is_some() && self.end.has_room() {
                self.make_step();
                continue;
            }
            if self.is_led() {
                self.take_inputs();
                self.advance_by_one();
                continue;
            }
            let now = clock::now_ns();
            let until = match self.paced() {
                _ if self.steps.is_some() => now + FULL_RING_PAUSE_NS,
                _ if self.stands() && self.end.pace.updated() => return true,
                _ if self.pace.paused && now < self.deadline => self.deadline,
                _ if self.pace.lockstep && now < self.deadline => {
                    self.deadline.min(self.patience).max(now + FULL_RING_PAUSE_NS)
                }
                true if now < self.deadline => self.deadline,
                false if !self.end.has_room() => now + FULL_RING_PAUSE_NS,
                _ => return true,
            };
            let until = until.min(now + LONGEST_SLEEP_NS);
            match self.paced() && !self.stands() {
                true => clock::sleep_until_ns(until),
                // Whoever asks wakes it.
                false => thread::park_timeout(Duration::from_nanos(until.saturating_sub(now))),
            }
        }
    }

    /// Does time stand until somebody asks for steps, or leads?
    fn stands(&self) -> bool {
        self.pace.paused || self.pace.lockstep
    }

    fn paced(&self) -> bool {
        self.pace.real_time_factor > 0.0
    }

    /// Real time per control interval, ns; 0 if the loop is not paced.
    fn period_ns(&self) -> u64 {
        if !self.paced() {
            return 0;
        }
        (self.pace.settings.control_interval_ns as f64 / self.pace.real_time_factor).round().max(1.0) as u64
    }
}

fn refuse<T>(reply: Reply<T>, reason: &str) {
    let _ = reply.send(Err(reason.into()));
}
