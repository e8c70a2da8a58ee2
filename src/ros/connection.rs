//! One connection to ROS: participant, node, topics, services and the listening thread.

use super::args::RosArgs;
use super::environment::{DiscoveryRange, Environment};
use super::listen::{CommandTopics, Desk, Listener};
use super::log::{self, Logger};
use super::messages::DiagnosticArray;
use super::names::Names;
use super::neighbours::Neighbours;
use super::node::Robot;
use super::parameters::{ParameterServers, Values, declare};
use super::publish::{JOINT_STATES, Outlet};
use super::recording::{PARAMETER_EVENTS, Tape};
use super::ros2_control::Control;
use super::services::Services;
use super::topics::{Outgoing, Topics, report_qos};
use crate::world::Snapshot;
use futures::channel::oneshot;
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::{Context, Node, NodeName, NodeOptions};
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Time for the last discovery message to leave before the sockets close.
const FAREWELL: Duration = Duration::from_millis(200);
/// How the threads of RustDDS are named.
const LIBRARY_THREADS: &str = "RustDDS";

/// What it takes to connect.
#[derive(Clone, Copy)]
pub struct Plan<'a> {
    /// What is simulated.
    pub robot: &'a Robot,
    /// Names, namespace, log level.
    pub args: &'a RosArgs,
    /// Domain and discovery range.
    pub environment: &'a Environment,
    /// For the frames that never move.
    pub initial: &'a Snapshot,
    /// Where messages are noted.
    pub tape: &'a Tape,
    /// How ros2_control speaks with it, if it does.
    pub control: Option<&'a Arc<Control>>,
}

/// A connection. The publishing thread owns it.
pub struct Connection {
    /// Publishers of the state.
    pub outlet: Outlet,
    /// Publisher of `/diagnostics`.
    pub diagnostics: Outgoing<DiagnosticArray>,
    /// The log.
    pub log: Logger,
    /// Topics with their types, for people.
    pub topics: Vec<String>,
    neighbours: Neighbours,
    /// What others should not publish: absolute names.
    own_topics: Vec<String>,
    listening: JoinHandle<Desk>,
    end_listening: oneshot::Sender<()>,
    node: Arc<Node>,
    context: Context,
    library_threads: usize,
}

impl Connection {
    /// Joins the domain, creates everything and starts to listen. `alone`: refuses if somebody else publishes `joint_states` of this name
    /// already, unless the parameter `allow_shared_topics` is true. `Err` says what kept it from that.
    pub fn open(plan: Plan, desk: Desk, alone: bool) -> Result<Self, String> {
        let context = context(plan.environment)?;
        let names = Names::new(&plan.args.namespace, &plan.args.node, &plan.args.remaps);
        let mut neighbours = Neighbours::new(&context)?;
        let mut node = create_node(&context, plan.args, &desk.values)?;
        let log = Logger::new(&mut node, plan.args.log_level, (plan.args.rosout, plan.args.stderr), plan.tape)?;
        let mut topics = Topics::new(&mut node, &names, plan.tape);
        let mut outlet = Outlet::new(&mut topics, &plan, &log)?;
        let diagnostics = topics.publisher("/diagnostics", "diagnostic_msgs/DiagnosticArray", &report_qos())?;
        let command_topics = CommandTopics::new(&mut topics, plan.control)?;
        let services = Services::new(&mut topics, plan.tape)?;
        let (report, own_topics) = (topics.report, topics.own);
        plan.tape.track(PARAMETER_EVENTS, PARAMETER_EVENTS, "rcl_interfaces/ParameterEvent", false);
        let servers = ParameterServers::new(&mut node)?;
        if alone && !desk.values.allow_shared_topics() {
            let refused = neighbours.refuse_to_share(&names.resolve(JOINT_STATES)?.to_string());
            if let Err(reason) = refused {
                drop((outlet, diagnostics, command_topics, services, servers, log, neighbours));
                drop(node);
                thread::sleep(FAREWELL);
                return Err(reason);
            }
        }
        outlet.latch(&plan.robot.urdf, plan.initial);
        let node = Arc::new(node);
        let listener = Listener {
            topics: command_topics,
            servers,
            services,
            node: node.clone(),
            log: log.clone(),
            tape: plan.tape.clone(),
        };
        let (end_listening, stop) = oneshot::channel();
        let model = plan.robot.model.clone();
        let listening = spawn("ros listen", move || listener.run(desk, &model, stop))?;
        let library_threads = library_threads();
        Ok(Self {
            outlet,
            diagnostics,
            log,
            topics: report,
            neighbours,
            own_topics,
            listening,
            end_listening,
            node,
            context,
            library_threads,
        })
    }

    /// False if a thread of the DDS library has ended: RustDDS 0.15 ends its event loops when a system call is
    /// interrupted, which happens when the process was stopped (Ctrl-Z, SIGSTOP) and continues.
    pub fn is_alive(&self) -> bool {
        library_threads() >= self.library_threads
    }

    /// Looks who subscribes, some times a second.
    pub fn look_around(&mut self) {
        self.outlet.audience.look(&self.context, Instant::now());
    }

    /// Topics of ours that others publish, too, and their nodes.
    pub fn shared_topics(&mut self) -> Vec<(String, String)> {
        self.neighbours.publishers(&self.own_topics, false)
    }

    /// Leaves the domain; gives back what was on the desk. `None` if the listening thread has panicked.
    pub fn close(self) -> Option<Desk> {
        drop(self.end_listening);
        let desk = self.listening.join().ok();
        log::leave();
        drop((self.outlet, self.diagnostics, self.log, self.neighbours));
        drop(self.node);
        thread::sleep(FAREWELL);
        drop(self.context);
        desk
    }
}

/// Starts a named thread.
pub fn spawn<T: Send + 'static>(name: &str, run: impl FnOnce() -> T + Send + 'static) -> Result<JoinHandle<T>, String> {
    thread::Builder::new().name(name.into()).spawn(run).map_err(|e| format!("cannot start thread '{name}': {e}"))
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

/// Running threads of the DDS library; 0 where the system does not tell.
fn library_threads() -> usize {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return 0 };
    let name = |task: std::fs::DirEntry| std::fs::read_to_string(task.path().join("comm"));
    tasks.flatten().filter_map(|t| name(t).ok()).filter(|n| n.starts_with(LIBRARY_THREADS)).count()
}
