//! Creates publishers and subscriptions under resolved names, and remembers them for the start-up report.

use super::names::Names;
use ros2_client::qos::{Durability, History, QosProfile, WhenFull};
use ros2_client::{MessageTypeName, Name, Node, Publisher, Subscription};
use serde::Serialize;

/// Publisher history: a second of a 1 ms loop, for slow but reliable subscribers.
const STREAM_DEPTH: usize = 1000;

/// Reliable and volatile: serves reliable and best-effort subscribers.
pub fn stream_qos() -> QosProfile {
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .history(History::KeepLast { depth: STREAM_DEPTH })
}

/// Reliable, and late joiners get the last message.
pub fn latched_qos() -> QosProfile {
    stream_qos().durability(Durability::TransientLocal).history(History::KeepLast { depth: 1 })
}

/// Reliable; deep enough for bursts of commands.
pub fn command_qos() -> QosProfile {
    stream_qos().history(History::KeepLast { depth: 100 })
}

/// Factory of the node's topics.
pub struct Topics<'a> {
    node: &'a mut Node,
    names: &'a Names,
    /// `/joint_states  sensor_msgs/JointState`, in the order of creation, with `<-` before what is subscribed.
    pub report: Vec<String>,
}

impl<'a> Topics<'a> {
    /// Topics of `node`, named by `names`.
    pub fn new(node: &'a mut Node, names: &'a Names) -> Self {
        Self { node, names, report: vec![] }
    }

    /// Publishes messages of `kind` = `package/Type`.
    pub fn publisher<M: Serialize>(
        &mut self,
        name: &str,
        kind: &str,
        qos: &QosProfile,
    ) -> Result<Publisher<M>, String> {
        let (name, kind_name) = self.resolve(name, kind)?;
        let topic = self.node.create_topic(&name, kind_name, qos).map_err(|e| failed(&name, &e))?;
        self.report.push(format!("-> {name}  {kind}"));
        self.node.create_publisher(&topic, None).map_err(|e| failed(&name, &e))
    }

    /// Subscribes messages of `kind` = `package/Type`.
    pub fn subscription<M: 'static>(
        &mut self,
        name: &str,
        kind: &str,
        qos: &QosProfile,
    ) -> Result<Subscription<M>, String> {
        let (name, kind_name) = self.resolve(name, kind)?;
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
