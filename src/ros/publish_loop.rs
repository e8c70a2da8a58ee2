//! The publishing thread: states to topics, diagnostics once a second, and a look after the connection.

use super::connection::{Connection, Plan};
use super::diagnostics::{Diagnostics, Latest, Losses};
use super::exchange::PublishEnd;
use super::listen::{Desk, Live};
use super::log;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

const DIAGNOSTICS_PERIOD: Duration = Duration::from_secs(1);
/// Longest sleep; the control thread ends it after each state.
const PAUSE: Duration = Duration::from_millis(20);

/// What the publishing thread owns.
pub struct PublishLoop<'a> {
    plan: Plan<'a>,
    connection: Connection,
    end: PublishEnd,
    live: Arc<Live>,
    report: Diagnostics,
    latest: Option<Latest>,
    /// Messages that earlier connections refused.
    refused_before: u64,
}

impl<'a> PublishLoop<'a> {
    /// Connects. `Err` says what kept it from that.
    pub fn new(plan: Plan<'a>, desk: Desk, end: PublishEnd) -> Result<Self, String> {
        let node = super::names::join(&plan.args.namespace, &plan.args.node);
        let report = Diagnostics::new(&node, &plan.robot.model.name)?;
        let live = desk.live.clone();
        let connection = Connection::open(plan, desk)?;
        Ok(Self { plan, connection, end, live, report, latest: None, refused_before: 0 })
    }

    /// The present connection.
    pub fn connection(&self) -> &Connection {
        &self.connection
    }

    /// Publishes until `stop` is set. `Err` if the connection was lost and cannot be made again.
    pub fn run(mut self, stop: &AtomicBool) -> Result<Self, String> {
        self.report.start();
        let mut due = Instant::now() + DIAGNOSTICS_PERIOD;
        while !stop.load(Ordering::Relaxed) {
            self.drain();
            if Instant::now() >= due {
                if !self.connection.is_alive() {
                    self = self.reconnect()?;
                }
                self.diagnose();
                due += DIAGNOSTICS_PERIOD;
            }
            thread::park_timeout(PAUSE.min(due.saturating_duration_since(Instant::now())));
        }
        Ok(self)
    }

    /// Publishes what is left, leaves ROS, and tells the whole story in a table.
    pub fn finish(mut self) -> String {
        self.drain();
        let summary = self.summary();
        self.connection.close();
        summary
    }

    fn reconnect(self) -> Result<Self, String> {
        let refused_before = self.refused_by_dds();
        let desk = self.connection.close().ok_or("the listening thread has panicked")?;
        let connection = Connection::open(self.plan, desk)?;
        log::stay();
        connection.log.warn("the DDS library had stopped, as it does after SIGSTOP or Ctrl-Z; connected to ROS again");
        Ok(Self { connection, refused_before, ..self })
    }

    /// Publishes every state that waits, up to one ring full, and takes over the timing records.
    fn drain(&mut self) {
        let (tf_rate, paused) = (self.live.tf_rate(), self.live.paused());
        for _ in 0..=self.end.waiting() {
            let (outlet, latest) = (&mut self.connection.outlet, &mut self.latest);
            let any = self.end.next(|s| {
                outlet.publish(s, tf_rate);
                let (stamp_ns, interval, stats, finite) = (s.stamp_ns, s.interval, s.stats, s.finite);
                let (contacts, broken) = (s.contacts.len() + s.omitted_contacts, s.broken.clone());
                *latest = Some(Latest { stamp_ns, interval, stats, contacts, paused, finite, broken });
            });
            if !any {
                break;
            }
        }
        self.end.timings(|timing| self.report.record(timing));
    }

    fn refused_by_dds(&self) -> u64 {
        self.refused_before + self.connection.outlet.refused_by_dds
    }

    fn diagnose(&mut self) {
        let Some(latest) = &self.latest else { return };
        let losses = Losses { dropped: self.end.dropped(), refused_by_dds: self.refused_by_dds() };
        let report = self.report.report(latest, losses, &self.live.counts);
        let _ = self.connection.diagnostics.publish(report);
        let log = &self.connection.log;
        if !latest.finite {
            log.warn_once("finite", "a step would have given values that are not finite: the simulation stands still at the state before it");
        }
        for broken in &latest.broken {
            let joint = &broken.joint;
            log.warn_once(
                &format!("broken {joint}"),
                format!("joint '{joint}' {broken}: more than its break_threshold"),
            );
        }
        if self.report.total.rebases > 0 {
            let lost = self.report.total.lost_ns as f64 * 1e-9;
            let mend = "simulate less per interval, or set real_time_factor below 1";
            log.warn_once("rebase", format!("too slow for real time: {lost:.3} s given up so far; {mend}"));
        }
    }

    fn summary(&self) -> String {
        let total = &self.report.total;
        let stamp_ns = self.latest.as_ref().map_or(0, |l| l.stamp_ns);
        format!(
            "simulated {:.3} s in {} control intervals, real-time factor {:.4}\n{}overruns {}, deadline set anew {}, dropped snapshots {}, refused by DDS {}, refused commands {}\n",
            stamp_ns as f64 * 1e-9,
            total.intervals,
            self.report.overall_factor(stamp_ns),
            total.table(),
            total.overruns,
            total.rebases,
            self.end.dropped(),
            self.refused_by_dds(),
            self.live.counts.all_refused(),
        )
    }
}
