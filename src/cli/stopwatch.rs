//! CPU time of one world.

use super::bench::cpu_seconds;
use crate::dynamics::own_turn;
use rustix::time::{ClockId, clock_gettime};

/// Time that has passed since some instant, s.
pub fn wall_seconds() -> f64 {
    let t = clock_gettime(ClockId::Monotonic);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

/// Measures parts of what one world takes, CPU time in s, also while it takes turns with others on this thread, by [`wall_seconds`].
pub struct Stopwatch {
    cpu: f64,
    wall: f64,
}

impl Stopwatch {
    /// From now on.
    pub fn new() -> Self {
        Self { cpu: cpu_seconds(), wall: wall_seconds() }
    }

    /// Only differences mean something, times [`Stopwatch::share`].
    pub fn now(&self) -> f64 {
        own_turn().map_or_else(cpu_seconds, |turn| turn.before + (wall_seconds() - turn.since))
    }

    /// Turns are measured by the clock on the wall: how much of that the thread has had since the start.
    pub fn share(&self) -> f64 {
        let (cpu, wall) = (cpu_seconds() - self.cpu, wall_seconds() - self.wall);
        if own_turn().is_some() && wall > 0.0 { cpu / wall } else { 1.0 }
    }
}
