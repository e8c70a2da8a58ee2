//! The node from start to end.

use super::args::RosArgs;
use super::control::ControlLoop;
use super::diagnostics::{Diagnostics, Latest, Losses};
use super::environment::{DiscoveryRange, Environment};
use super::exchange::{PublishEnd, exchange};
use super::listen::{CommandTopics, Listener, Live};
use super::log::{self, Logger};
use super::messages::DiagnosticArray;
use super::names::Names;
use super::parameters::{ParameterServers, Values, declare, show};
use super::publish::Outlet;
use super::topics::{Topics, stream_qos};
use super::clock;
use crate::model::{Base, Model};
use crate::world::{AxisCommand, Mode, World};
use futures::channel::oneshot;
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::{Context, Node, NodeName, NodeOptions, Publisher};
use std::net::Ipv4Addr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

const DIAGNOSTICS_PERIOD: Duration = Duration::from_secs(1);
/// Longest sleep of the publishing thread; it is woken earlier by each state.
const PUBLISH_PAUSE: Duration = Duration::from_millis(20);
/// Time for the last discovery message to leave before the sockets close.
const FAREWELL: Duration = Duration::from_millis(200);

/// What is simulated.
#[derive(Clone, Debug)]
pub struct Robot {
    /// File name or label of the URDF.
    pub source: String,
    /// The URDF text, as it is published.
    pub urdf: Arc<str>,
    /// The model.
    pub model: Arc<Model>,
}

/// Simulates `robot` until SIGINT or SIGTERM. `Err` says what kept it from starting.
pub fn run(robot: &Robot, args: &RosArgs, mut values: Values, environment: &Environment) -> Result<(), String> {
    log::show_library_errors();
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signals(&stop)?;
    values.set_axes(robot.model.axes.iter().map(|a| a.name.clone()).collect());

    let mut world = World::new(robot.model.clone(), values.pace().settings)?;
    let commands = initial_commands(&world, values.hold_at_start());
    world.set_commands(&commands).map_err(|axis| format!("axis {axis} cannot be held at its initial position"))?;

    let context = context(environment)?;
    let mut node = create_node(&context, args, &values)?;
    let logger = Logger::new(&mut node, args.log_level, args.rosout, args.stderr)?;
    let names = Names::new(&args.namespace, &args.node, &args.remaps);
    let mut topics = Topics::new(&mut node, &names);
    let mut outlet = Outlet::new(&mut topics, &robot.model, &logger)?;
    let diagnostics = topics.publisher("/diagnostics", "diagnostic_msgs/DiagnosticArray", &stream_qos())?;
    let command_topics = CommandTopics::new(&mut topics)?;
    let topic_report = std::mem::take(&mut topics.report);
    let servers = ParameterServers::new(&mut node)?;
    print!("{}", start_report(robot, &node, environment, &values, &topic_report));
    environment.warnings.iter().for_each(|w| logger.warn(w));

    let (control_end, publish_end, command_end) = exchange(&world, &commands, &values.pace(), stop.clone())?;
    let mut initial = world.new_snapshot();
    world.write_snapshot(&mut initial);
    outlet.latch(&robot.urdf, &initial);

    let live = Arc::new(Live::default());
    live.take(&values);
    let control = ControlLoop::new(world, control_end, thread::current())?;
    let control = spawn_control(control, values.realtime_priority(), &logger)?;
    let (end_listening, stop_listening) = oneshot::channel();
    let node = Arc::new(node);
    let listener = Listener {
        topics: command_topics,
        servers,
        node: node.clone(),
        model: robot.model.clone(),
        commands,
        values,
        end: command_end,
        live: live.clone(),
        log: logger.clone(),
    };
    let listening = spawn("ros listen", move || listener.run(stop_listening))?;

    let mut publisher = PublishLoop {
        outlet,
        end: publish_end,
        live,
        report: Diagnostics::new(&node.fully_qualified_name(), &robot.model.name)?,
        publisher: diagnostics,
        latest: None,
        log: logger.clone(),
    };
    publisher.run(&stop);

    let _ = control.join();
    drop(end_listening);
    let _ = listening.join();
    publisher.drain();
    print!("{}", publisher.summary());
    log::leave();
    drop((publisher, logger));
    drop(node);
    thread::sleep(FAREWELL);
    drop(context);
    Ok(())
}

fn stop_on_signals(stop: &Arc<AtomicBool>) -> Result<(), String> {
    let (stop, main) = (stop.clone(), thread::current());
    ctrlc::set_handler(move || {
        stop.store(true, Ordering::Relaxed);
        main.unpark();
    })
    .map_err(|e| format!("cannot handle SIGINT and SIGTERM: {e}"))
}

fn context(environment: &Environment) -> Result<Context, String> {
    let builder = DomainParticipantBuilder::new(environment.domain);
    let builder = match environment.range {
        DiscoveryRange::Subnet => builder,
        DiscoveryRange::Localhost => builder.with_only_networks([Ipv4Addr::LOCALHOST]),
        DiscoveryRange::Off => builder.with_only_networks([] as [Ipv4Addr; 0]).same_host_loopback(false),
    };
    let failed = |e: &dyn std::fmt::Display| format!("cannot join ROS domain {}: {e}", environment.domain);
    let participant = builder.build().map_err(|e| failed(&e))?;
    Context::from_domain_participant(participant).map_err(|e| failed(&e))
}

fn create_node(context: &Context, args: &RosArgs, values: &Values) -> Result<Node, String> {
    let name = NodeName::new(&args.namespace, &args.node).map_err(|e| e.to_string())?;
    // The log is ours: ros2-client's keeps only the last message.
    let options = declare(NodeOptions::new().enable_rosout(false), values);
    context.new_node(name, options).map_err(|e| e.to_string())
}

/// Hold: every axis that may switch its mode servos where it is. Free: the modes of the drive tags.
fn initial_commands(world: &World, hold: bool) -> Vec<AxisCommand> {
    let mut initial = world.new_snapshot();
    world.write_snapshot(&mut initial);
    let command = |(axis, &position): (&crate::model::Axis, &f64)| match axis.mode {
        _ if hold && axis.switchable => AxisCommand::servo(position),
        Mode::Servo => AxisCommand::servo(position),
        Mode::Torque => AxisCommand::torque(0.0),
        Mode::Idle => AxisCommand::IDLE,
    };
    world.model().axes.iter().zip(&initial.position).map(command).collect()
}

fn spawn_control(control: ControlLoop, priority: i32, log: &Logger) -> Result<JoinHandle<()>, String> {
    let (report, scheduling) = mpsc::channel();
    let thread = spawn("control", move || {
        let _ = report.send(clock::prepare_thread(priority));
        drop(report);
        control.run();
    })?;
    match scheduling.recv() {
        Ok(Err(reason)) => {
            let mend = "raise RLIMIT_RTPRIO or grant CAP_SYS_NICE";
            log.warn(format!("realtime_priority {priority} was refused: {reason}; {mend}. Going on without"));
        }
        _ if priority > 0 => log.info(format!("the control thread runs with SCHED_FIFO priority {priority}")),
        _ => {}
    }
    Ok(thread)
}

fn spawn(name: &str, run: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, String> {
    thread::Builder::new().name(name.into()).spawn(run).map_err(|e| format!("cannot start thread '{name}': {e}"))
}

fn start_report(robot: &Robot, node: &Node, environment: &Environment, values: &Values, topics: &[String]) -> String {
    let model = &robot.model;
    let mut text = format!(
        "{}: '{}' from {}\n  {} links, {} axes, {:.3} kg, base {}\n",
        node.fully_qualified_name(),
        model.name,
        robot.source,
        model.links.len(),
        model.axes.len(),
        model.links.iter().map(|l| l.mass).sum::<f64>(),
        if model.base == Base::Fixed { "fixed" } else { "free" },
    );
    let settings = values.iter().filter(|(d, _)| d.name != "axes").map(|(d, v)| format!("{} {}", d.name, show(v)));
    text += &format!("  {}\n", settings.collect::<Vec<_>>().join(", "));
    text += &format!("  ROS domain {}, discovery range {}\n", environment.domain, environment.range);
    topics.iter().for_each(|t| text += &format!("  {t}\n"));
    text
}

struct PublishLoop {
    outlet: Outlet,
    end: PublishEnd,
    live: Arc<Live>,
    report: Diagnostics,
    publisher: Publisher<DiagnosticArray>,
    latest: Option<Latest>,
    log: Logger,
}

impl PublishLoop {
    fn run(&mut self, stop: &AtomicBool) {
        let mut due = Instant::now() + DIAGNOSTICS_PERIOD;
        while !stop.load(Ordering::Relaxed) {
            self.drain();
            if Instant::now() >= due {
                self.diagnose();
                due += DIAGNOSTICS_PERIOD;
            }
            thread::park_timeout(PUBLISH_PAUSE.min(due.saturating_duration_since(Instant::now())));
        }
    }

    /// Publishes every state that waits, up to one ring full, and takes over the timing records.
    fn drain(&mut self) {
        let tf_rate = self.live.tf_rate();
        for _ in 0..=self.end.waiting() {
            let (outlet, latest) = (&mut self.outlet, &mut self.latest);
            let any = self.end.next(|sample| {
                outlet.publish(sample, tf_rate);
                let s = &sample.snapshot;
                let stats = sample.stats;
                *latest = Some(Latest { stamp_ns: s.stamp_ns, interval: s.interval, stats, finite: s.finite });
            });
            if !any {
                break;
            }
        }
        self.end.timings(|timing| self.report.record(timing));
    }

    fn diagnose(&mut self) {
        let Some(latest) = self.latest else { return };
        let losses = Losses { dropped: self.end.dropped(), refused_by_dds: self.outlet.refused_by_dds };
        let report = self.report.report(&latest, losses, &self.live.counts);
        let _ = self.publisher.publish(report);
        if !latest.finite {
            self.log.warn_once("finite", "the state is not finite any more; joint_states carries what is left of it");
        }
        if self.report.total.rebases > 0 {
            let lost = self.report.total.lost_ns as f64 * 1e-9;
            let mend = "simulate less per interval, or set real_time_factor below 1";
            self.log.warn_once("rebase", format!("too slow for real time: {lost:.3} s given up so far; {mend}"));
        }
    }

    fn summary(&self) -> String {
        let total = &self.report.total;
        let stamp_ns = self.latest.map_or(0, |l| l.stamp_ns);
        format!(
            "simulated {:.3} s in {} control intervals, real-time factor {:.4}\n{}overruns {}, deadline set anew {}, dropped snapshots {}, refused by DDS {}, refused commands {}\n",
            stamp_ns as f64 * 1e-9,
            total.intervals,
            self.report.overall_factor(stamp_ns),
            total.table(),
            total.overruns,
            total.rebases,
            self.end.dropped(),
            self.outlet.refused_by_dds,
            self.live.counts.all_refused(),
        )
    }
}
