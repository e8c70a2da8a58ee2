//! The publishing thread: states to topics, diagnostics once a second, and a look after the connection.

use super::chronicle::Chronicle;
use super::connection::{Connection, Plan};
use super::diagnostics::{Diagnostics, Doings, Latest, Losses};
use super::exchange::PublishEnd;
use super::listen::{Desk, Live};
use super::log;
use super::names::Names;
use super::parameters::show;
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
    /// Command timeouts that have been told.
    timeouts_told: u64,
    chronicle: Chronicle,
    /// Messages that earlier connections refused.
    refused_before: u64,
}

impl<'a> PublishLoop<'a> {
    /// Connects. `Err` says what kept it from that.
    pub fn new(plan: Plan<'a>, desk: Desk, end: PublishEnd) -> Result<Self, String> {
        let node = super::names::join(&plan.args.namespace, &plan.args.node);
        let report = Diagnostics::new(&node, &plan.robot.model)?;
        let live = desk.live.clone();
        let names = Names::new(&plan.args.namespace, &plan.args.node, &plan.args.remaps);
        let parameters = desk.values.iter().map(|(d, v)| (d.name.to_owned(), show(v))).collect();
        let chronicle = Chronicle::new(plan.tape, |name| Ok(names.resolve(name)?.to_string()), parameters)?;
        let connection = Connection::open(plan, desk, true)?;
        Ok(Self { plan, connection, end, live, report, latest: None, timeouts_told: 0, chronicle, refused_before: 0 })
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
        self.connection.outlet.markers.stop();
        let summary = self.summary();
        self.connection.close();
        summary
    }

    fn reconnect(self) -> Result<Self, String> {
        let refused_before = self.refused_by_dds();
        let desk = self.connection.close().ok_or("the listening thread has panicked")?;
        let connection = Connection::open(self.plan, desk, false)?;
        log::stay();
        connection.log.warn("the DDS library had stopped, as it does after SIGSTOP or Ctrl-Z; connected to ROS again");
        Ok(Self { connection, refused_before, ..self })
    }

    /// Publishes every state that waits, up to one ring full, and takes over the timing records.
    fn drain(&mut self) {
        let (tf_rate, paused, markers) = (self.live.tf_rate(), self.live.paused(), self.live.markers.get());
        self.connection.look_around();
        self.connection.outlet.audience.recorded = self.plan.tape.runs();
        let unpaced = self.live.pace().real_time_factor == 0.0;
        for _ in 0..=self.end.waiting() {
            if unpaced && self.plan.tape.is_crowded() {
                // As fast as it goes includes the disk: the control loop waits for room in the ring.
                break;
            }
            let (outlet, latest) = (&mut self.connection.outlet, &mut self.latest);
            let (chronicle, robot, dropped) = (&mut self.chronicle, self.plan.robot, self.end.dropped());
            let any = self.end.next(|s| {
                if chronicle.tell(s, dropped, (&robot.model, &robot.origin)) {
                    outlet.note_latched(&robot.urdf, self.plan.initial);
                }
                outlet.publish(s, tf_rate);
                outlet.show(s, &markers);
                let (stamp_ns, interval, stats, finite, settings) =
                    (s.stamp_ns, s.interval, s.stats, s.finite, s.settings);
                let (before, last) = latest.as_ref().map_or((0, 0), |l| (l.simulated_ns, l.stamp_ns));
                let simulated_ns = before + passed(last, stamp_ns);
                let (contacts, broken) = (s.contacts.len() + s.omitted_contacts, s.broken.clone());
                *latest = Some(Latest {
                    stamp_ns,
                    simulated_ns,
                    interval,
                    stats,
                    settings,
                    contacts,
                    paused,
                    finite,
                    broken,
                });
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
        let outlet = &self.connection.outlet;
        let doings = Doings {
            warnings: self.connection.log.warnings(),
            markers: outlet.markers.made,
            audience: outlet.audience.counts(),
        };
        let mut report = self.report.report(latest, losses, &self.live.counts, &doings);
        report.status.extend(self.report.recording(self.plan.tape));
        let shared = if self.live.allows_shared_topics() { vec![] } else { self.connection.shared_topics() };
        report.status.push(self.report.shared_topics(&shared));
        self.connection.diagnostics.send(report);
        let log = &self.connection.log;
        for (topic, node) in &shared {
            let mend = "what is simulated and what is not cannot be told apart there";
            log.warn_once(&format!("{topic} {node}"), format!("{node} publishes {topic}, too: {mend}"));
        }
        if !latest.finite {
            log.warn_once("finite", "a step would have given values that are not finite: the simulation stands still at the state before it");
        }
        if let Some(reason) = self.plan.tape.report().and_then(|(r, _)| r.failed) {
            log.warn_once(&reason, format!("the recording has ended, the simulation goes on: {reason}"));
        }
        for broken in &latest.broken {
            let joint = &broken.joint;
            log.warn_once(
                &format!("broken {joint}"),
                format!("joint '{joint}' {broken}: more than its break_threshold"),
            );
        }
        self.tell_of_timeouts();
        let log = &self.connection.log;
        if self.report.total.rebases > 0 {
            let lost = self.report.total.lost_ns as f64 * 1e-9;
            let mend = "simulate less per interval, or set real_time_factor below 1";
            log.warn_once("rebase", format!("too slow for real time: {lost:.3} s given up so far; {mend}"));
        }
    }

    /// New command timeouts, and once what they cannot do.
    fn tell_of_timeouts(&mut self) {
        let count = self.live.counts.lapses.timeouts.load(Ordering::Relaxed);
        if count == self.timeouts_told {
            return;
        }
        let pace = self.live.pace();
        let (seconds, policy, more) =
            (pace.command_timeout_ns as f64 * 1e-9, pace.on_timeout, count - self.timeouts_told);
        self.timeouts_told = count;
        let log = &self.connection.log;
        log.warn(format!(
            "no command for {seconds} s of simulated time ({more} more, {count} in all): on_timeout is {}",
            policy.name()
        ));
        if let Some(left_out) = policy.left_out(&self.plan.robot.model, pace.allow_mode_switch) {
            log.warn_once(&left_out, left_out.clone());
        }
    }

    fn summary(&self) -> String {
        let total = &self.report.total;
        let simulated_ns = self.latest.as_ref().map_or(0, |l| l.simulated_ns);
        format!(
            "simulated {:.3} s in {} control intervals, real-time factor {:.4}\n{}{}overruns {}, deadline set anew {}, dropped snapshots {}, refused by DDS {}, refused commands {}\n",
            simulated_ns as f64 * 1e-9,
            total.intervals,
            self.report.overall_factor(simulated_ns),
            total.table(),
            total.lateness_table(),
            total.overruns,
            total.rebases,
            self.end.dropped(),
            self.refused_by_dds(),
            self.live.counts.all_refused(),
        )
    }
}

/// Simulated time between two states, ns; a stamp that goes back is one after a reset of time to 0.
fn passed(from: i64, to: i64) -> i64 {
    if to >= from { to - from } else { to }
}

#[cfg(test)]
mod tests {
    use super::passed;

    #[test]
    fn a_reset_of_time_takes_nothing_back() {
        let stamps = [0, 1, 2, 2, 0, 0, 1, 5];
        let total: i64 = stamps.windows(2).map(|w| passed(w[0], w[1])).sum();
        assert_eq!(total, 7);
    }
}
