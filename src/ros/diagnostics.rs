//! `/diagnostics` at 1 Hz.

use super::commands::RefusalKind;
use super::counts::{CommandCounts, CommandTopic};
use super::messages::{DiagnosticArray, DiagnosticStatus, Header, KeyValue, Level, Time};
use crate::monitor::{Percentiles, Timing};
use crate::world::{Broken, Stats};
use std::time::Instant;

/// What the publishing thread has seen of the latest sample.
#[derive(Clone, Debug)]
pub struct Latest {
    /// Simulated time, ns.
    pub stamp_ns: i64,
    /// Control intervals.
    pub interval: u64,
    /// Counters of the world.
    pub stats: Stats,
    /// Contacts that carry something.
    pub contacts: usize,
    /// Does time stand by the parameter `paused`?
    pub paused: bool,
    /// Is the state finite?
    pub finite: bool,
    /// Joints that have come apart.
    pub broken: Vec<Broken>,
}

/// What else counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Snapshots dropped by the ring.
    pub dropped: u64,
    /// Messages that DDS refused.
    pub refused_by_dds: u64,
}

/// Collects a report per second.
pub struct Diagnostics {
    node: String,
    robot: String,
    /// Since the start.
    pub total: Timing,
    recent: Timing,
    reported: (Instant, i64),
    started: (Instant, i64),
    losses: Losses,
    refused: u64,
}

impl Diagnostics {
    /// For `robot`, simulated by `node`.
    pub fn new(node: &str, robot: &str) -> Result<Self, String> {
        let start = (Instant::now(), 0);
        Ok(Self {
            node: node.into(),
            robot: robot.into(),
            total: Timing::new()?,
            recent: Timing::new()?,
            reported: start,
            started: start,
            losses: Losses::default(),
            refused: 0,
        })
    }

    /// Real time counts from now.
    pub fn start(&mut self) {
        (self.started, self.reported) = ((Instant::now(), 0), (Instant::now(), 0));
    }

    /// Adds a timing record of the control thread.
    pub fn record(&mut self, timing: &Timing) {
        self.total.merge(timing);
        self.recent.merge(timing);
    }

    /// Simulated time per real time since the start, up to `stamp_ns`.
    pub fn overall_factor(&self, stamp_ns: i64) -> f64 {
        factor(self.started, (Instant::now(), stamp_ns))
    }

    /// The report since the last one.
    pub fn report(&mut self, latest: &Latest, losses: Losses, counts: &CommandCounts) -> DiagnosticArray {
        let now = (Instant::now(), latest.stamp_ns);
        let status = vec![self.real_time(now, losses), self.simulation(latest), self.commands(counts)];
        self.recent.clear();
        (self.reported, self.losses, self.refused) = (now, losses, counts.all_refused());
        let header = Header { stamp: Time::from_ns(latest.stamp_ns), frame_id: String::new() };
        DiagnosticArray { header, status }
    }

    fn real_time(&self, now: (Instant, i64), losses: Losses) -> DiagnosticStatus {
        let late = self.recent.overruns > 0 || losses != self.losses;
        let (level, message) = match (self.recent.rebases > 0, late) {
            (true, _) => (Level::Error, "too slow: real time was given up"),
            (_, true) => (Level::Warn, "overruns were caught up, or states were dropped"),
            _ => (Level::Ok, "in time"),
        };
        let mut values = vec![pair("real-time factor", format!("{:.4}", factor(self.reported, now)))];
        values.extend(percentiles("lateness", self.recent.lateness()));
        values.extend(percentiles("step time", self.recent.step()));
        values.extend([
            pair("intervals", self.total.intervals),
            pair("overruns", self.total.overruns),
            pair("deadline set anew", self.total.rebases),
            pair("real time given up [s]", format!("{:.6}", self.total.lost_ns as f64 * 1e-9)),
            pair("dropped snapshots", losses.dropped),
            pair("messages refused by DDS", losses.refused_by_dds),
        ]);
        self.status("real time", (level, message), values)
    }

    fn simulation(&self, latest: &Latest) -> DiagnosticStatus {
        let state = match (latest.finite, latest.broken.is_empty()) {
            (false, _) => (Level::Error, "diverged: stands still at the last finite state"),
            (_, false) => (Level::Warn, "joints have come apart"),
            _ if latest.stats.guarded_pieces > 0 => (Level::Warn, "limbs too fast for any step were slowed down"),
            _ if latest.paused => (Level::Ok, "paused"),
            _ => (Level::Ok, "finite"),
        };
        let mut values = vec![
            pair("simulated time [s]", format!("{:.9}", latest.stamp_ns as f64 * 1e-9)),
            pair("control intervals", latest.interval),
            pair("steps", latest.stats.steps),
            pair("fallback steps", latest.stats.fallback_steps),
            pair("unsettled steps", latest.stats.unsettled_steps),
            pair("halvings", latest.stats.halvings),
            pair("divided steps", latest.stats.divided_steps),
            pair("fast pieces", latest.stats.fast_pieces),
            pair("guarded pieces", latest.stats.guarded_pieces),
            pair("guarded energy [J]", latest.stats.guarded_energy),
            pair("trimmed energy [J]", latest.stats.trimmed_energy),
            pair("tempered steps", latest.stats.tempered_steps),
            pair("worst residual of contacts [m/s]", latest.stats.worst_residual),
            pair("pole steps", latest.stats.pole_steps),
            pair("contacts", latest.contacts),
            pair("worst penetration [m]", latest.stats.worst_penetration),
            pair("finite", latest.finite),
            pair("broken joints", latest.broken.len()),
        ];
        values.extend(latest.broken.iter().map(|b| pair(&format!("broken: {}", b.joint), b)));
        self.status("simulation", state, values)
    }

    fn commands(&self, counts: &CommandCounts) -> DiagnosticStatus {
        let state = match (counts.all_refused(), counts.all_refused() > self.refused) {
            (_, true) => (Level::Warn, "commands were refused in the last second"),
            (0, _) => (Level::Ok, "none refused"),
            _ => (Level::Ok, "none refused in the last second"),
        };
        let mut values = vec![];
        for topic in CommandTopic::ALL {
            values.push(pair(&format!("{} accepted", topic.name()), counts.accepted(topic)));
            for kind in RefusalKind::ALL {
                let key = format!("{} refused: {}", topic.name(), kind.name());
                values.push(pair(&key, counts.refused(topic, kind)));
            }
        }
        self.status("commands", state, values)
    }

    fn status(&self, part: &str, (level, message): (Level, &str), values: Vec<KeyValue>) -> DiagnosticStatus {
        DiagnosticStatus {
            level: level as u8,
            name: format!("{}: {part}", self.node),
            message: message.into(),
            hardware_id: self.robot.clone(),
            values,
        }
    }
}

fn factor(from: (Instant, i64), to: (Instant, i64)) -> f64 {
    (to.1 - from.1) as f64 * 1e-9 / (to.0 - from.0).as_secs_f64()
}

fn percentiles(name: &str, p: Percentiles) -> [KeyValue; 3] {
    [("p50", p.p50), ("p99", p.p99), ("max", p.max)]
        .map(|(label, ns)| pair(&format!("{name} {label} [us]"), format!("{:.1}", ns as f64 * 1e-3)))
}

fn pair(key: &str, value: impl ToString) -> KeyValue {
    KeyValue { key: key.into(), value: value.to_string() }
}
