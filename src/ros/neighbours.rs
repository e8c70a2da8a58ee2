//! Who else publishes our topics in this domain. A simulation must never be taken for the robot, nor the other way round.

use super::names::join;
use ros2_client::dds::rustdds::no_key::DataReaderCdr;
use ros2_client::dds::rustdds::policy::{Durability, History, Reliability};
use ros2_client::dds::rustdds::{DomainParticipant, Duration as DdsDuration, QosPolicyBuilder, RTPSEntity, TopicKind};
use ros2_client::{Context, Gid};
use serde::Deserialize;
use std::collections::{BTreeMap, HashMap};
use std::thread;
use std::time::{Duration, Instant};

/// How long the topics of those who were there before are waited for at start. Measured: 0.12 s for a node like this one, 0.1 to 1.23 s
/// for rclpy; others take as long to find ours.
const FIRST_LOOK: Duration = Duration::from_millis(1500);
/// How long the name of somebody who publishes our topic is waited for beyond that. Measured: up to 3.2 s after the start.
const ASK_FOR_NAME: Duration = Duration::from_secs(4);
const GLANCE: Duration = Duration::from_millis(10);
/// Announcements that may wait: each node sends one whenever it creates an endpoint.
const ANNOUNCEMENTS: i32 = 1000;

/// rmw_dds_common/ParticipantEntitiesInfo: which nodes a participant has.
#[derive(Debug, Deserialize)]
struct Announcement {
    participant: Gid,
    nodes: Vec<AnnouncedNode>,
}

/// rmw_dds_common/NodeEntitiesInfo.
#[derive(Debug, Deserialize)]
struct AnnouncedNode {
    namespace: String,
    name: String,
    #[allow(dead_code, reason = "a field of the message")]
    readers: Vec<Gid>,
    writers: Vec<Gid>,
}

/// Looks at the graph.
pub struct Neighbours {
    participant: DomainParticipant,
    /// Of looking.
    start: Instant,
    announcements: DataReaderCdr<Announcement>,
    /// By participant.
    nodes: HashMap<Gid, Vec<AnnouncedNode>>,
}

impl Neighbours {
    /// Begins to listen.
    ///
    /// # Errors
    /// What DDS did not want.
    pub fn new(context: &Context) -> Result<Self, String> {
        let participant = context.domain_participant();
        let qos = QosPolicyBuilder::new()
            .durability(Durability::TransientLocal)
            .reliability(Reliability::Reliable { max_blocking_time: DdsDuration::ZERO })
            .history(History::KeepLast { depth: ANNOUNCEMENTS })
            .build();
        let kind = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_".to_string();
        let failed = |e: &dyn std::fmt::Display| format!("cannot listen to ros_discovery_info: {e}");
        let topic = participant
            .create_topic("ros_discovery_info".into(), kind, &qos, TopicKind::NoKey)
            .map_err(|e| failed(&e))?;
        let subscriber = participant.create_subscriber(&qos).map_err(|e| failed(&e))?;
        let announcements = subscriber.create_datareader_no_key_cdr(&topic, None).map_err(|e| failed(&e))?;
        Ok(Self { participant, start: Instant::now(), announcements, nodes: HashMap::new() })
    }

    /// Who else publishes these topics (absolute names): topic and node. A node without a name yet is left out, but if `all`.
    pub fn publishers(&mut self, topics: &[String], all: bool) -> Vec<(String, String)> {
        self.listen();
        let own = self.participant.guid_prefix();
        let mut found = BTreeMap::new();
        for writer in self.participant.discovered_writers() {
            let guid = writer.writer_proxy.remote_writer_guid;
            let name = writer.publication_topic_data.topic_name();
            let Some(topic) = topics.iter().find(|t| name.strip_prefix("rt") == Some(t)) else { continue };
            if guid.prefix == own {
                continue;
            }
            match self.node_of(Gid::from(guid)) {
                Some(node) => drop(found.insert((topic.clone(), node), ())),
                None if all => drop(found.insert((topic.clone(), "a node without a name".into()), ())),
                None => {}
            }
        }
        found.into_keys().collect()
    }

    /// Waits until those who were there before have been heard, and refuses to share `topic`.
    ///
    /// # Errors
    /// Names the node that publishes it.
    pub fn refuse_to_share(&mut self, topic: &str) -> Result<(), String> {
        let topics = [topic.to_string()];
        while self.start.elapsed() < FIRST_LOOK && self.publishers(&topics, true).is_empty() {
            thread::sleep(GLANCE);
        }
        if self.publishers(&topics, true).is_empty() {
            return Ok(());
        }
        let seen = Instant::now();
        while seen.elapsed() < ASK_FOR_NAME && self.publishers(&topics, false).is_empty() {
            thread::sleep(GLANCE);
        }
        let Some((_, node)) = self.publishers(&topics, true).into_iter().next_back() else { return Ok(()) };
        Err(format!(
            "{topic} is published by {node} already: a simulation and a robot must not be taken for each other. Use another \
             ROS_DOMAIN_ID or namespace (-r __ns:=/NAME), or allow it with -p allow_shared_topics:=true"
        ))
    }

    fn listen(&mut self) {
        // One that cannot be read is somebody else's.
        while let Ok(Some(announcement)) = self.announcements.take_next_sample() {
            let announcement = announcement.into_value();
            self.nodes.insert(announcement.participant, announcement.nodes);
        }
    }

    fn node_of(&self, writer: Gid) -> Option<String> {
        let node = self.nodes.values().flatten().find(|n| n.writers.contains(&writer))?;
        Some(join(&node.namespace, &node.name))
    }
}
