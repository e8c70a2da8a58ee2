//! The control loop, in a thread of its own: wakes on absolute deadlines, allocates nothing, logs nothing, locks nothing.

use super::clock;
use super::exchange::{ControlEnd, Pace};
use crate::monitor::Timing;
use crate::world::World;
use std::sync::atomic::Ordering;
use std::thread::Thread;

/// How often timing records are handed over, ns.
const TIMING_PERIOD_NS: u64 = 1_000_000_000;
/// Pause while the ring is full and nothing may be dropped, ns.
const FULL_RING_PAUSE_NS: u64 = 100_000;
/// How often the state is shown while time stands, ns; parameters are looked at as often.
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
    /// ns on the monotonic clock.
    deadline: u64,
    next_hand_over: u64,
}

impl ControlLoop {
    /// A loop over `world` that wakes `reader` after each interval.
    pub fn new(world: World, end: ControlEnd, reader: Thread) -> Result<Self, String> {
        let pace = *end.pace.output_buffer();
        let timing = Box::new(Timing::new()?);
        Ok(Self { world, end, reader, timing, pace, deadline: 0, next_hand_over: 0 })
    }

    /// Shows the state at t = 0, then runs until the stop flag is set.
    pub fn run(mut self) {
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
        if self.pace.paused {
            return self.stand();
        }
        let start = clock::now_ns();
        let lateness = if self.paced() { start.saturating_sub(self.deadline) } else { 0 };
        let before = clock::now_ns();
        self.world.advance();
        let step = clock::now_ns() - before;
        self.emit();
        self.timing.record(lateness, step, self.period_ns());
        self.next_deadline(lateness);
        if start >= self.next_hand_over {
            self.end.hand_over(&mut self.timing);
            self.next_hand_over = start + TIMING_PERIOD_NS;
        }
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

    fn take_inputs(&mut self) {
        if self.end.pace.update() {
            self.pace = *self.end.pace.output_buffer();
            // Checked before it was sent. Allocates if, and only if, the engine or the integrator changes.
            let _ = self.world.set_settings(self.pace.settings);
        }
        if self.end.commands.update() {
            // Checked before they were sent, too.
            let _ = self.world.set_commands(self.end.commands.output_buffer());
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

    /// Sleeps until the next interval is due; false at the end of the program.
    fn wait(&self) -> bool {
        loop {
            if self.end.stop.load(Ordering::Relaxed) {
                return false;
            }
            let now = clock::now_ns();
            let until = match self.paced() {
                _ if self.pace.paused && now < self.deadline => self.deadline,
                true if now < self.deadline => self.deadline,
                false if !self.end.has_room() => now + FULL_RING_PAUSE_NS,
                _ => return true,
            };
            clock::sleep_until_ns(until.min(now + LONGEST_SLEEP_NS));
        }
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
