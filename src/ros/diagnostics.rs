//! `/diagnostics` at 1 Hz.

use super::commands::RefusalKind;
use super::counts::{CommandCounts, CommandTopic};
use super::log::Warnings;
use super::messages::{DiagnosticArray, DiagnosticStatus, Header, KeyValue, Level, Time};
use super::recording::{self, Tape};
use crate::model::{Kind, Listed, Model};
use crate::monitor::{Percentiles, Timing};
use crate::world::{Broken, Deviation, Largest, Settings, Stats};
use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;

/// What the publishing thread has seen of the latest sample.
#[derive(Clone, Debug)]
pub struct Latest {
    /// Simulated time, ns.
    pub stamp_ns: i64,
    /// Simulated time since the start of the node, whatever was reset, ns.
    pub simulated_ns: i64,
    /// Control intervals.
    pub interval: u64,
    /// Counters of the world.
    pub stats: Stats,
    /// Settings in force.
    pub settings: Settings,
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

/// What the node itself does.
#[derive(Clone, Debug, Default)]
pub struct Doings {
    /// What it has warned of.
    pub warnings: Warnings,
    /// Messages of `debug/markers` made since the connection.
    pub markers: u64,
    /// Topics that are made on demand, and their subscribers.
    pub audience: Vec<(String, usize)>,
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
    warnings: u64,
    effects: Vec<Listed>,
    /// Of axes, then of links.
    names: Vec<String>,
}

impl Diagnostics {
    /// For the robot of `model`, simulated by `node`.
    ///
    /// # Errors
    /// Why the histograms cannot be made.
    pub fn new(node: &str, model: &Model) -> Result<Self, String> {
        let start = (Instant::now(), 0);
        Ok(Self {
            node: node.into(),
            robot: model.name.clone(),
            total: Timing::new()?,
            recent: Timing::new()?,
            reported: start,
            started: start,
            losses: Losses::default(),
            refused: 0,
            warnings: 0,
            effects: model.listed_effects(),
            names: model
                .axes
                .iter()
                .map(|a| a.name.clone())
                .chain(model.links.iter().map(|l| l.name.clone()))
                .collect(),
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

    /// Simulated time per real time since the start; `simulated_ns` have been simulated.
    pub fn overall_factor(&self, simulated_ns: i64) -> f64 {
        factor(self.started, (Instant::now(), simulated_ns))
    }

    /// The report since the last one.
    pub fn report(
        &mut self,
        latest: &Latest,
        losses: Losses,
        counts: &CommandCounts,
        doings: &Doings,
    ) -> DiagnosticArray {
        let now = (Instant::now(), latest.simulated_ns);
        let mut status = vec![
            self.real_time(now, losses),
            self.simulation(latest),
            self.commands(counts),
            self.effects(),
            self.node(doings),
        ];
        status.extend(self.error());
        self.recent.clear();
        (self.reported, self.losses, self.refused) = (now, losses, counts.all_refused());
        self.warnings = doings.warnings.count;
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
            pair("state", latest.state()),
            pair("engine", latest.settings.engine.name()),
            pair("integrator", latest.settings.integrator.name()),
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
        let lapses = &counts.lapses;
        let state = match (counts.all_refused(), counts.all_refused() > self.refused) {
            _ if lapses.fallen_back.load(Relaxed) => (Level::Warn, "no command for too long: on_timeout is in force"),
            (_, true) => (Level::Warn, "commands were refused in the last second"),
            (0, _) => (Level::Ok, "none refused"),
            _ => (Level::Ok, "none refused in the last second"),
        };
        let mut values = vec![
            pair("command timeouts", lapses.timeouts.load(Relaxed)),
            pair("lock-step intervals without a command", lapses.unled_intervals.load(Relaxed)),
        ];
        for topic in CommandTopic::ALL {
            values.push(pair(&format!("{} accepted", topic.name()), counts.accepted(topic)));
            for kind in RefusalKind::ALL {
                let key = format!("{} refused: {}", topic.name(), kind.name());
                values.push(pair(&key, counts.refused(topic, kind)));
            }
        }
        self.status("commands", state, values)
    }

    /// Topics that others publish, too, and their nodes.
    pub fn shared_topics(&self, shared: &[(String, String)]) -> DiagnosticStatus {
        let state = match shared {
            [] => (Level::Ok, "nobody else publishes our topics"),
            _ => (Level::Warn, "others publish our topics, too"),
        };
        self.status("topics", state, shared.iter().map(|(topic, node)| pair(topic, node)).collect())
    }

    /// Of the recording, once there has been one.
    pub fn recording(&self, tape: &Tape) -> Option<DiagnosticStatus> {
        recording::status(tape, &self.node, &self.robot)
    }

    /// What the intervals of the last second were off by, if that was asked for.
    fn error(&self) -> Option<DiagnosticStatus> {
        let found = self.recent.estimates;
        let of = |l: &Largest| self.names.get(l.place).map_or("", String::as_str);
        let Deviation { position, speed } = &found.worst;
        let values = vec![
            pair("largest position error of an interval [rad or m]", format!("{:e}", position.size)),
            pair("of", of(position)),
            pair("largest speed error of an interval [rad/s or m/s]", format!("{:e}", speed.size)),
            pair("of (speed)", of(speed)),
            pair("intervals estimated", found.intervals),
            pair("time per estimate [µs]", format!("{:.1}", found.ns as f64 * 1e-3 / found.intervals.max(1) as f64)),
        ];
        let message = "by step doubling, in the last second";
        (found.intervals > 0).then(|| self.status("error", (Level::Ok, message), values))
    }

    /// Every effect of the steps with what calls for it in the scene.
    fn effects(&self) -> DiagnosticStatus {
        let in_steps = || self.effects.iter().filter(|e| !matches!(e.effect.kind, Kind::OnDemand(_)));
        let switched = in_steps().filter(|e| e.on && e.effect.kind == Kind::Switched);
        let active: Vec<&str> = switched.map(|e| e.effect.name).collect();
        let value = |e: &Listed| match e {
            e if e.on && e.called_for => pair(e.effect.name, format!("active, called for by {}", e.by)),
            e if e.on => pair(e.effect.name, "active, switched on"),
            e if e.is_switched_off() => pair(e.effect.name, format!("switched off; called for by {}", e.by)),
            e => pair(e.effect.name, "off"),
        };
        let message = if active.is_empty() { "none active".into() } else { active.join(", ") };
        self.status("effects", (Level::Ok, &message), in_steps().map(value).collect())
    }

    fn node(&self, doings: &Doings) -> DiagnosticStatus {
        let state = match doings.warnings.count {
            count if count > self.warnings => (Level::Warn, doings.warnings.last.as_str()),
            0 => (Level::Ok, "no warnings"),
            _ => (Level::Ok, "no warnings in the last second"),
        };
        let mut values = vec![
            pair("resident memory [MiB]", memory().map_or("unknown".into(), |m| format!("{m:.1}"))),
            pair("warnings", doings.warnings.count),
            pair("last warning", &doings.warnings.last),
            pair("marker messages", doings.markers),
        ];
        values.extend(doings.audience.iter().map(|(topic, n)| pair(&format!("subscribers of {topic}"), n)));
        self.status("node", state, values)
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

impl Latest {
    /// In a word.
    fn state(&self) -> &'static str {
        match (self.finite, self.paused) {
            (false, _) => "diverged",
            (_, true) => "paused",
            _ => "running",
        }
    }
}

/// Resident memory of this process, MiB; `None` where the system does not tell.
fn memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kib / 1024.0)
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
