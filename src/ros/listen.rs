//! The listening thread: command messages and parameter services.

use super::commands::{Command, Rules, apply};
use super::counts::{CommandCounts, CommandTopic};
use super::exchange::CommandEnd;
use super::log::Logger;
use super::messages::{Float64MultiArray, JointState};
use super::parameters::{Change, ParameterServers, Values};
use super::topics::{Topics, command_qos};
use crate::engine::{EngineKind, Integrator, State, shortfalls, unused_integrator};
use crate::model::Model;
use crate::world::AxisCommand;
use futures::StreamExt;
use ros2_client::{Node, Subscription};
use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The three command topics.
pub struct CommandTopics {
    effort: Subscription<Float64MultiArray>,
    servo: Subscription<Float64MultiArray>,
    joint: Subscription<JointState>,
}

impl CommandTopics {
    /// Subscribes them.
    pub fn new(topics: &mut Topics) -> Result<Self, String> {
        let qos = command_qos();
        Ok(Self {
            effort: topics.subscription(CommandTopic::Effort.name(), "std_msgs/Float64MultiArray", &qos)?,
            servo: topics.subscription(CommandTopic::Servo.name(), "std_msgs/Float64MultiArray", &qos)?,
            joint: topics.subscription(CommandTopic::Joint.name(), "sensor_msgs/JointState", &qos)?,
        })
    }
}

/// What the publishing thread reads while the listening thread changes it.
#[derive(Debug, Default)]
pub struct Live {
    /// Counters of commands.
    pub counts: CommandCounts,
    tf_rate_bits: AtomicU64,
    paused: AtomicBool,
}

impl Live {
    /// Parameter `tf_rate`, Hz.
    pub fn tf_rate(&self) -> f64 {
        f64::from_bits(self.tf_rate_bits.load(Ordering::Relaxed))
    }

    /// Parameter `paused`.
    pub fn paused(&self) -> bool {
        self.paused.load(Ordering::Relaxed)
    }

    /// Takes over what the publishing thread needs to know.
    pub fn take(&self, values: &Values) {
        self.tf_rate_bits.store(values.tf_rate().to_bits(), Ordering::Relaxed);
        self.paused.store(values.pace().paused, Ordering::Relaxed);
    }
}

/// What the listening thread decides about; it outlives a connection.
pub struct Desk {
    /// Commands in force, of all axes.
    pub commands: Vec<AxisCommand>,
    /// Parameters in force.
    pub values: Values,
    /// To the control thread.
    pub end: CommandEnd,
    /// To the publishing thread.
    pub live: Arc<Live>,
}

/// What the listening thread needs of one connection.
pub struct Listener {
    /// Subscriptions.
    pub topics: CommandTopics,
    /// Services.
    pub servers: ParameterServers,
    /// For `/parameter_events`.
    pub node: Arc<Node>,
    /// The log.
    pub log: Logger,
}

struct Inbox<'a> {
    model: &'a Model,
    /// Per axis: an excess has been said, so that no later command is looked at for that.
    told: RefCell<Vec<bool>>,
    rules: RefCell<Rules>,
    commands: RefCell<Vec<AxisCommand>>,
    end: RefCell<CommandEnd>,
    live: &'a Live,
    log: &'a Logger,
    engine: Cell<(EngineKind, Integrator)>,
}

impl Listener {
    /// Serves until `stop` is sent or dropped; gives back the desk with what has changed on it.
    pub fn run(self, desk: Desk, model: &Model, stop: futures::channel::oneshot::Receiver<()>) -> Desk {
        let axes = model.axes.iter().map(|a| (a.name.as_str(), a.switchable));
        let inbox = Inbox {
            model,
            told: RefCell::new(vec![false; model.axes.len()]),
            rules: RefCell::new(Rules::new(axes, desk.values.allow_mode_switch())),
            commands: RefCell::new(desk.commands),
            end: RefCell::new(desk.end),
            live: &desk.live,
            log: &self.log,
            engine: Cell::new(chosen(&desk.values)),
        };
        let values = RefCell::new(desk.values);
        let check = |values: &Values| inbox.check_parameters(values);
        let applied = |values: &Values| inbox.take_parameters(values);
        let serve = async {
            futures::join!(
                inbox.listen(&self.topics.effort, CommandTopic::Effort, |m| Command::Effort(&m.data)),
                inbox.listen(&self.topics.servo, CommandTopic::Servo, |m| Command::Servo(&m.data)),
                inbox.listen(&self.topics.joint, CommandTopic::Joint, |m| Command::Joint(m)),
                self.servers.serve(&self.node, &values, Change { check: &check, applied: &applied }),
            );
        };
        let stop = async {
            let _ = stop.await;
        };
        smol::block_on(smol::future::or(stop, serve));
        let (commands, end) = (inbox.commands.into_inner(), inbox.end.into_inner());
        Desk { commands, values: values.into_inner(), end, live: desk.live }
    }
}

impl Inbox<'_> {
    async fn listen<M: serde::de::DeserializeOwned + 'static>(
        &self,
        subscription: &Subscription<M>,
        topic: CommandTopic,
        command: impl for<'m> Fn(&'m M) -> Command<'m>,
    ) {
        let messages = subscription.async_stream();
        futures::pin_mut!(messages);
        while let Some(message) = messages.next().await {
            match message {
                Ok((message, _)) => self.receive(topic, command(&message)),
                Err(e) => self.log.warn_once(topic.name(), format!("{}: cannot read a message: {e}", topic.name())),
            }
        }
    }

    fn receive(&self, topic: CommandTopic, command: Command) {
        let mut commands = self.commands.borrow_mut();
        match apply(&mut commands, command, &self.rules.borrow()) {
            Ok(()) => {
                self.end.borrow_mut().command(&commands);
                self.live.counts.accept(topic);
                self.warn_of_excess(&commands);
            }
            Err(refusal) => {
                if self.live.counts.refuse(topic, refusal.kind) {
                    let (topic, kind) = (topic.name(), refusal.kind.name());
                    let rest = "further ones are counted in /diagnostics";
                    self.log.warn(format!("{topic} refused, {kind}: {} ({rest})", refusal.reason));
                }
            }
        }
    }

    /// Says, once per axis, that a command asks for more than its drive has.
    fn warn_of_excess(&self, commands: &[AxisCommand]) {
        let mut told = self.told.borrow_mut();
        for ((axis, command), told) in
            self.model.axes.iter().zip(commands).zip(told.iter_mut()).filter(|(_, told)| !**told)
        {
            if let Some(excess) = command.beyond(axis, &axis.drive) {
                self.log.warn_once(&format!("beyond {}", axis.name), format!("{excess} (said once per axis)"));
                *told = true;
            }
        }
    }

    /// Another engine is made once on trial: what it cannot take is said in the answer. The control loop could only stay as it is.
    fn check_parameters(&self, values: &Values) -> Result<(), String> {
        let (engine, _) = chosen(values);
        if engine == self.engine.get().0 {
            return Ok(());
        }
        let made = engine.build(self.model, &State::initial(self.model));
        made.map(drop).map_err(|reason| format!("parameter 'engine' = {}: {reason}", engine.name()))
    }

    fn take_parameters(&self, values: &Values) {
        self.rules.borrow_mut().allow_mode_switch = values.allow_mode_switch();
        let (engine, integrator) = chosen(values);
        let before = self.engine.replace((engine, integrator));
        let of_robot = if before.0 == engine { vec![] } else { shortfalls(engine, self.model) };
        let of_settings = unused_integrator(engine, integrator).filter(|_| before != (engine, integrator));
        of_robot.iter().chain(&of_settings).for_each(|s| self.log.warn(s.of(engine)));
        self.end.borrow_mut().set_pace(values.pace());
        self.live.take(values);
    }
}

fn chosen(values: &Values) -> (EngineKind, Integrator) {
    let settings = values.pace().settings;
    (settings.engine, settings.integrator)
}
