//! Creates publishers and subscriptions under resolved names, and remembers them for the start-up report.

use super::names::Names;
use super::recording::Tape;
use super::service::Service;
use ros2_client::qos::{Durability, History, QosProfile, WhenFull};
use ros2_client::{Message, MessageTypeName, Name, Node, Publisher, Subscription};
use serde::Serialize;
use std::time::Duration;

/// Topics that many nodes publish by design; a robot_state_publisher has the description, too.
const SHARED: [&str; 4] = ["/tf", "/tf_static", "/diagnostics", "robot_description"];
/// Publisher history: a second of a 1 ms loop, for slow but reliable subscribers.
const STREAM_DEPTH: usize = 1000;
/// Gives the shortest time between two rounds of repair that RustDDS knows, 1 ms.
const STATE_DEADLINE: Duration = Duration::from_millis(5);

/// Reliable and volatile: serves reliable and best-effort subscribers.
pub fn stream_qos() -> QosProfile {
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .history(History::KeepLast { depth: STREAM_DEPTH })
}

/// As [`stream_qos`], for long messages of which the latest counts: a thousand of them would be megabytes, and a quarter of an hour of
/// growth.
pub fn report_qos() -> QosProfile {
    stream_qos().history(History::KeepLast { depth: 10 })
}

/// As [`stream_qos`], for what is sent in every control interval. RustDDS repairs what a reader has missed in rounds of 8 kB, a fifth
/// of the offered deadline apart, or 10 ms without one: too slow for a reader that has stood still to catch up with 1 kHz, so that
/// the writer fills up and refuses messages for all (docs/decisions/0033).
pub fn state_qos() -> QosProfile {
    stream_qos().deadline(Some(STATE_DEADLINE))
}

/// Reliable, and late joiners get the last message.
pub fn latched_qos() -> QosProfile {
    stream_qos().durability(Durability::TransientLocal).history(History::KeepLast { depth: 1 })
}

/// Reliable; deep enough for bursts of commands.
pub fn command_qos() -> QosProfile {
    stream_qos().history(History::KeepLast { depth: 100 })
}

/// What is published on one topic, and recorded.
pub struct Outgoing<M: Serialize> {
    publisher: Publisher<M>,
    tape: Tape,
    track: usize,
    topic: String,
}

impl<M: Serialize> Outgoing<M> {
    /// Absolute name.
    pub fn topic(&self) -> &str {
        &self.topic
    }

    /// Publishes a message; 1 if DDS refused it, because a reliable subscriber is too far behind.
    pub fn send(&self, message: M) -> u64 {
        self.tape.note(self.track, &message);
        u64::from(self.publisher.publish(message).is_err())
    }
}

impl<M: Serialize> Outgoing<M> {
    /// Puts what was published before the recording began into the bag, as a late subscriber would get it.
    pub fn note_latched(&self, message: impl FnOnce() -> M) {
        if self.tape.runs() && !self.tape.has(self.track) {
            self.tape.note(self.track, &message());
        }
    }
}

/// Factory of the node's topics and services.
pub struct Topics<'a> {
    node: &'a mut Node,
    names: &'a Names,
    tape: &'a Tape,
    /// `-> /joint_states  sensor_msgs/JointState`, in the order of creation, with `<-` before what is subscribed and `<>` before services.
    pub report: Vec<String>,
    /// What is published by nobody else, if all is well: absolute names.
    pub own: Vec<String>,
}

impl<'a> Topics<'a> {
    /// Topics of `node`, named by `names`; what is published is noted on `tape`.
    pub fn new(node: &'a mut Node, names: &'a Names, tape: &'a Tape) -> Self {
        Self { node, names, tape, report: vec![], own: vec![] }
    }

    /// Publishes messages of `kind` = `package/Type`.
    pub fn publisher<M: Serialize>(&mut self, name: &str, kind: &str, qos: &QosProfile) -> Result<Outgoing<M>, String> {
        let relative = name;
        let own = !SHARED.contains(&name);
        let (name, kind_name) = self.resolve(name, kind)?;
        if own {
            self.own.push(name.to_string());
        }
        let topic = self.node.create_topic(&name, kind_name, qos).map_err(|e| failed(&name, &e))?;
        self.report.push(format!("-> {name}  {kind}"));
        let publisher = self.node.create_publisher(&topic, None).map_err(|e| failed(&name, &e))?;
        let track = self.tape.track(&name.to_string(), relative, kind, *qos == latched_qos());
        Ok(Outgoing { publisher, tape: self.tape.clone(), track, topic: name.to_string() })
    }

    /// Serves requests of `kind` = `package/Type`.
    pub fn service<Q, R>(&mut self, name: &str, kind: &str) -> Result<Service<Q, R>, String>
    where
        Q: Message + Clone + 'static,
        R: Message + 'static,
    {
        let name = self.names.resolve(name)?;
        self.report.push(format!("<> {name}  {kind}"));
        Service::new(self.node, &name, kind, &command_qos())
    }

    /// Subscribes messages of `kind` = `package/Type`.
    pub fn subscription<M: 'static>(
        &mut self,
        name: &str,
        kind: &str,
        qos: &QosProfile,
    ) -> Result<Subscription<M>, String> {
        let relative = name;
        let (name, kind_name) = self.resolve(name, kind)?;
        self.tape.track(&name.to_string(), relative, kind, false);
        let topic = self.node.create_topic(&name, kind_name, qos).map_err(|e| failed(&name, &e))?;
        self.report.push(format!("<- {name}  {kind}"));
        self.node.create_subscription(&topic, None).map_err(|e| failed(&name, &e))
    }

    fn resolve(&self, name: &str, kind: &str) -> Result<(Name, MessageTypeName), String> {
        let (package, type_name) = kind.split_once('/').unwrap_or(("", kind));
        Ok((self.names.resolve(name)?, MessageTypeName::new(package, type_name)))
    }
}

fn failed(name: &Name, error: &dyn std::fmt::Display) -> String {
    format!("cannot create topic {name}: {error}")
}
