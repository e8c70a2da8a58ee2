//! What a run of `simulate` leaves to tell.

use crate::model::Model;
use crate::world::{Stats, World};
use serde_json::json;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// What became of a run.
#[derive(Default)]
pub(super) struct Outcome {
    /// CPU time of the steps, s.
    pub cpu: f64,
    /// Energy at the start, J.
    pub energy: f64,
    pub rows: u64,
    /// Every value looked at was finite.
    pub finite: bool,
    /// By a signal.
    pub stopped: bool,
    pub files: Vec<PathBuf>,
    /// Per axis.
    pub peaks: Vec<Peak>,
    /// The error of the run, if it was asked for.
    pub estimate: Option<serde_json::Value>,
}

/// Greatest magnitudes at the ends of the control intervals (J-15, J-16).
#[derive(Clone, Copy, Default)]
pub(super) struct Peak {
    /// N·m or N, really applied.
    pub torque: f64,
    /// rad/s or m/s.
    pub speed: f64,
}

impl Outcome {
    pub fn note_peaks(&mut self, world: &World) {
        for (axis, peak) in self.peaks.iter_mut().enumerate() {
            peak.torque = peak.torque.max(world.efforts()[axis].abs());
            peak.speed = peak.speed.max(world.state().axis(world.model(), axis).1.abs());
        }
    }

    pub fn peaks(&self, m: &Model) -> serde_json::Map<String, serde_json::Value> {
        let told = |(axis, peak): (&crate::model::Axis, &Peak)| {
            (axis.name.clone(), json!({"torque": peak.torque, "speed": peak.speed}))
        };
        m.axes.iter().zip(&self.peaks).map(told).collect()
    }
}

/// A line on standard error that tells how far a long run is, if people see it.
pub(super) struct Progress {
    /// When it is written next; never if nobody sees it.
    next: Option<Instant>,
    shown: bool,
}

impl Progress {
    const PAUSE: Duration = Duration::from_millis(500);

    pub fn new() -> Self {
        Self { next: std::io::stderr().is_terminal().then(|| Instant::now() + Self::PAUSE), shown: false }
    }

    /// Nobody is told.
    pub fn silent() -> Self {
        Self { next: None, shown: false }
    }

    pub fn show(&mut self, done: u64, all: u64) {
        if self.next.is_some_and(|next| Instant::now() >= next) {
            let _ = write!(std::io::stderr(), "\r{:3.0} % of the duration", 100.0 * done as f64 / all as f64);
            (self.next, self.shown) = (Some(Instant::now() + Self::PAUSE), true);
        }
    }

    pub fn clear(&self) {
        if self.shown {
            let _ = write!(std::io::stderr(), "\r{:30}\r", "");
        }
    }
}

/// What is counted in a run, and what it means.
pub(super) fn counted(s: &Stats) -> [(u64, &'static str); 7] {
    [
        (
            s.fallback_steps,
            "steps were made by implicit_midpoint, because an axis began or ceased to stand still, a servo was on its \
             way, something touched, a viscous term was stiff, or a joint is soft or a fixed one that may break",
        ),
        (
            s.halvings,
            "times a step was halved, because limbs turned too fast for its iteration: a finer step costs the same",
        ),
        (s.unsettled_steps, "steps ended before the axis laws had settled: allow more --iterations"),
        (
            s.guarded_pieces,
            "pieces of steps were not resolved by the shortest piece there is: the motion of the limbs was slowed down \
             to the energy that drives and weight had paid for (guarded_energy, J); take a finer step",
        ),
        (
            s.fast_pieces,
            "pieces of steps, the shortest there are, had bodies near each other that moved further than they are \
             thick: they may have passed through each other; take a finer step",
        ),
        (s.pole_steps, "steps had a 3dof group at its pole: torques about its angles were bounded there"),
        (s.diverged_steps, "step would have given values that are not finite: the world stood still from there on"),
    ]
}
