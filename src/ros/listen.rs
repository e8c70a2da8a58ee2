//! The listening thread: command messages and parameter services.

use super::commands::{Command, Refusal, Rules, apply};
use super::counts::{CommandCounts, CommandTopic};
use super::exchange::{CommandEnd, Pace};
use super::log::Logger;
use super::markers::LiveSettings;
use super::messages::{Float64MultiArray, JointState};
use super::parameters::{Change, ParameterServers, Setter, Values};
use super::recording::Tape;
use super::ros2_control::Control;
use super::services::{Office, Services};
use super::topics::{Topics, command_qos};
use crate::engine::{EngineKind, Integrator, State, shortfalls, unused_integrator};
use crate::model::Model;
use crate::world::AxisCommand;
use futures::StreamExt;
use ros2_client::{Node, Subscription};
use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::Thread;

/// The command topics.
pub struct CommandTopics {
    effort: Subscription<Float64MultiArray>,
    servo: Subscription<Float64MultiArray>,
    joint: Subscription<JointState>,
    control: Option<(Subscription<JointState>, Arc<Control>)>,
}

impl CommandTopics {
    /// Subscribes them.
    ///
    /// # Errors
    /// Names the one that cannot be created.
    pub fn new(topics: &mut Topics, control: Option<&Arc<Control>>) -> Result<Self, String> {
        let qos = command_qos();
        let mut controlled = |control: &Arc<Control>| -> Result<_, String> {
            Ok((topics.subscription(&control.commands_topic, "sensor_msgs/JointState", &qos)?, control.clone()))
        };
        let control = control.map(&mut controlled).transpose()?;
        Ok(Self {
            effort: topics.subscription(CommandTopic::Effort.name(), "std_msgs/Float64MultiArray", &qos)?,
            servo: topics.subscription(CommandTopic::Servo.name(), "std_msgs/Float64MultiArray", &qos)?,
            joint: topics.subscription(CommandTopic::Joint.name(), "sensor_msgs/JointState", &qos)?,
            control,
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
    stopped: AtomicBool,
    allows_shared_topics: AtomicBool,
    pace: Mutex<Pace>,
    /// Parameters of `debug/markers`.
    pub markers: LiveSettings,
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

    /// Is the simulation paused because it was stopped, with everything at its start?
    pub fn stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// Has it been stopped?
    pub fn set_stopped(&self, stopped: bool) {
        self.stopped.store(stopped, Ordering::Relaxed);
    }

    /// Parameter `allow_shared_topics`.
    pub fn allows_shared_topics(&self) -> bool {
        self.allows_shared_topics.load(Ordering::Relaxed)
    }

    /// The parameters of the loop.
    pub fn pace(&self) -> Pace {
        *self.pace.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes over what the publishing thread needs to know.
    pub fn take(&self, values: &Values) {
        self.allows_shared_topics.store(values.allow_shared_topics(), Ordering::Relaxed);
        *self.pace.lock().unwrap_or_else(PoisonError::into_inner) = values.pace();
        if !values.pace().paused {
            self.set_stopped(false);
        }
        self.tf_rate_bits.store(values.tf_rate().to_bits(), Ordering::Relaxed);
        self.paused.store(values.pace().paused, Ordering::Relaxed);
        self.markers.set(&values.markers());
    }
}

/// Ends the node, as SIGINT does.
#[derive(Clone, Debug)]
pub struct Quit {
    /// The flag that every loop looks at.
    pub stop: Arc<AtomicBool>,
    /// The main thread, which may sleep.
    pub main: Thread,
}

impl Quit {
    /// Does it.
    pub fn now(&self) {
        self.stop.store(true, Ordering::Relaxed);
        self.main.unpark();
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
    /// To end the node.
    pub quit: Quit,
}

/// What the listening thread needs of one connection.
pub struct Listener {
    /// Subscriptions.
    pub topics: CommandTopics,
    /// Services of the parameters.
    pub servers: ParameterServers,
    /// All others.
    pub services: Services,
    /// For `/parameter_events`.
    pub node: Arc<Node>,
    /// The log.
    pub log: Logger,
    /// Where messages are noted.
    pub tape: Tape,
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
    tape: &'a Tape,
    engine: Cell<(EngineKind, Integrator)>,
    /// Do stamps count?
    lockstep: Cell<bool>,
}

impl Listener {
    /// Serves until `stop` is sent or dropped; gives back the desk with what has changed on it.
    pub fn run(self, desk: Desk, model: &Model, stop: futures::channel::oneshot::Receiver<()>) -> Desk {
        let axes = model.axes.iter().map(|a| (a.name.as_str(), a.switchable));
        let asks = desk.end.asks.clone();
        let mut rules = Rules::new(axes, desk.values.allow_mode_switch());
        rules.control = self.topics.control.as_ref().map(|(_, control)| control.clone());
        let inbox = Inbox {
            model,
            told: RefCell::new(vec![false; model.axes.len()]),
            rules: RefCell::new(rules),
            commands: RefCell::new(desk.commands),
            end: RefCell::new(desk.end),
            live: &desk.live,
            log: &self.log,
            tape: &self.tape,
            engine: Cell::new(chosen(&desk.values)),
            lockstep: Cell::new(desk.values.pace().lockstep),
        };
        let values = RefCell::new(desk.values);
        let check = |values: &Values| inbox.check_parameters(values);
        let applied = |values: &Values| inbox.take_parameters(values);
        let announced = |parameter| self.tape.note_event(&self.node.fully_qualified_name(), parameter);
        let change = Change { check: &check, applied: &applied, announced: &announced };
        let setter = Setter { node: &self.node, values: &values, change };
        let office = Office { asks: &asks, setter, live: &desk.live, quit: &desk.quit };
        let serve = async {
            futures::join!(
                inbox.listen(&self.topics.effort, CommandTopic::Effort, |m| Command::Effort(&m.data)),
                inbox.listen(&self.topics.servo, CommandTopic::Servo, |m| Command::Servo(&m.data)),
                inbox.listen(&self.topics.joint, CommandTopic::Joint, |m| Command::Joint(m)),
                inbox.listen_to_control(self.topics.control.as_ref().map(|(subscription, _)| subscription)),
                self.servers.serve(setter),
                self.services.serve(&office),
            );
        };
        let stop = async {
            let _ = stop.await;
        };
        smol::block_on(smol::future::or(stop, serve));
        let (commands, end) = (inbox.commands.into_inner(), inbox.end.into_inner());
        Desk { commands, values: values.into_inner(), end, live: desk.live, quit: desk.quit }
    }
}

impl Inbox<'_> {
    async fn listen_to_control(&self, subscription: Option<&Subscription<JointState>>) {
        if let Some(subscription) = subscription {
            self.listen(subscription, CommandTopic::Control, |m| Command::Control(m)).await;
        }
    }

    async fn listen<M: serde::Serialize + serde::de::DeserializeOwned + 'static>(
        &self,
        subscription: &Subscription<M>,
        topic: CommandTopic,
        command: impl for<'m> Fn(&'m M) -> Command<'m>,
    ) {
        let messages = subscription.async_stream();
        futures::pin_mut!(messages);
        while let Some(message) = messages.next().await {
            match message {
                Ok((message, _)) => {
                    self.tape.note_on(topic.name(), &message);
                    let command = command(&message);
                    let time = command.stamp_ns().filter(|_| self.lockstep.get());
                    if let Err(refusal) = self.receive(topic, command, time) {
                        self.refuse(topic, &refusal);
                    }
                }
                Err(e) => self.log.warn_once(topic.name(), format!("{}: cannot read a message: {e}", topic.name())),
            }
        }
    }

    /// `stamp`, ns: in lock-step, what leads the world on from the state of this time; 0, but for the state at time 0: nothing.
    fn receive(&self, topic: CommandTopic, command: Command, stamp: Option<i64>) -> Result<(), Refusal> {
        let gate = &self.end.borrow().gate.clone();
        let leads = stamp.filter(|stamp| *stamp != 0 || gate.shown() == 0);
        if let Some(stamp) = leads {
            gate.reserve(stamp).map_err(|untimely| untimely.refusal(stamp, gate.shown()))?;
        }
        let accepted = self.accept(topic, command);
        match leads {
            Some(_) if accepted.is_ok() => {
                gate.go();
                self.end.borrow().asks.wake();
            }
            Some(stamp) => gate.give_back(stamp),
            None => {}
        }
        accepted
    }

    fn accept(&self, topic: CommandTopic, command: Command) -> Result<(), Refusal> {
        let mut commands = self.commands.borrow_mut();
        if let Some(in_force) = self.end.borrow_mut().overruled() {
            commands.copy_from_slice(in_force);
        }
        apply(&mut commands, command, &self.rules.borrow())?;
        self.end.borrow_mut().command(&commands);
        self.live.counts.accept(topic);
        self.warn_of_excess(&commands);
        Ok(())
    }

    fn refuse(&self, topic: CommandTopic, refusal: &Refusal) {
        if self.live.counts.refuse(topic, refusal.kind) {
            let (topic, kind) = (topic.name(), refusal.kind.name());
            let rest = "further ones are counted in /diagnostics";
            self.log.warn(format!("{topic} refused, {kind}: {} ({rest})", refusal.reason));
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
        self.lockstep.set(values.pace().lockstep);
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
