//! `metadata.yaml`, by which a folder is a bag to rosbag2 (version 9 of its format).

use super::schema::MessageType;
use serde::Serialize;
use std::io;
use std::path::Path;

/// The version of the format, that of ROS 2 Jazzy.
const VERSION: u32 = 9;
const ROS_DISTRO: &str = "jazzy";

/// What is in a bag.
#[derive(Clone, Debug, Default)]
pub struct Contents {
    /// Topics.
    pub topics: Vec<Topic>,
    /// Log times of the first and the last message, ns; they do not fall.
    pub span: Option<(u64, u64)>,
}

/// A topic, and how many messages of it there are.
#[derive(Clone, Debug)]
pub struct Topic {
    /// Absolute name.
    pub name: String,
    /// Type.
    pub kind: MessageType,
    /// Subscribers that come late get the last message.
    pub latched: bool,
    /// Messages.
    pub count: u64,
}

impl Topic {
    /// A topic without messages, and without memory.
    pub fn new(name: impl Into<String>, kind: MessageType) -> Self {
        Self { name: name.into(), kind, latched: false, count: 0 }
    }
}

#[derive(Serialize)]
struct Document {
    rosbag2_bagfile_information: Information,
}

#[derive(Serialize)]
struct Information {
    version: u32,
    storage_identifier: &'static str,
    duration: Duration,
    starting_time: StartingTime,
    message_count: u64,
    topics_with_message_count: Vec<TopicCount>,
    compression_format: &'static str,
    compression_mode: &'static str,
    relative_file_paths: Vec<String>,
    files: Vec<FileInformation>,
    custom_data: Option<()>,
    ros_distro: &'static str,
}

#[derive(Clone, Copy, Serialize)]
struct Duration {
    nanoseconds: u64,
}

#[derive(Clone, Copy, Serialize)]
struct StartingTime {
    nanoseconds_since_epoch: u64,
}

#[derive(Serialize)]
struct TopicCount {
    topic_metadata: TopicMetadata,
    message_count: u64,
}

#[derive(Serialize)]
struct TopicMetadata {
    name: String,
    r#type: String,
    serialization_format: &'static str,
    offered_qos_profiles: Vec<Qos>,
    type_description_hash: &'static str,
}

#[derive(Serialize)]
struct FileInformation {
    path: String,
    starting_time: StartingTime,
    duration: Duration,
    message_count: u64,
}

/// A QoS profile; deadline, lifespan and lease never end.
#[derive(Serialize)]
struct Qos {
    history: &'static str,
    depth: u32,
    reliability: &'static str,
    durability: &'static str,
    deadline: QosTime,
    lifespan: QosTime,
    liveliness: &'static str,
    liveliness_lease_duration: QosTime,
    avoid_ros_namespace_conventions: bool,
}

#[derive(Clone, Copy, Serialize)]
struct QosTime {
    sec: i64,
    nsec: i64,
}

/// The text of `metadata.yaml` for a bag of one file.
///
/// # Errors
/// If the file name is no UTF-8.
pub fn yaml(contents: &Contents, file: &Path) -> io::Result<String> {
    let name = file.file_name().and_then(|n| n.to_str());
    let path = name.ok_or_else(|| io::Error::other("the name of the bag is not UTF-8"))?.to_owned();
    let (first, last) = contents.span.unwrap_or_default();
    let duration = Duration { nanoseconds: last - first };
    let starting_time = StartingTime { nanoseconds_since_epoch: first };
    let message_count = contents.topics.iter().map(|t| t.count).sum();
    let information = Information {
        version: VERSION,
        storage_identifier: "mcap",
        duration,
        starting_time,
        message_count,
        topics_with_message_count: contents.topics.iter().map(topic_count).collect(),
        compression_format: "",
        compression_mode: "",
        relative_file_paths: vec![path.clone()],
        files: vec![FileInformation { path, starting_time, duration, message_count }],
        custom_data: None,
        ros_distro: ROS_DISTRO,
    };
    serde_saphyr::to_string(&Document { rosbag2_bagfile_information: information }).map_err(io::Error::other)
}

fn topic_count(topic: &Topic) -> TopicCount {
    let topic_metadata = TopicMetadata {
        name: topic.name.clone(),
        r#type: topic.kind.full_name(),
        serialization_format: "cdr",
        offered_qos_profiles: vec![reliable(topic.latched)],
        type_description_hash: topic.kind.hash,
    };
    TopicCount { topic_metadata, message_count: topic.count }
}

/// The profile under which the messages are to be played, as YAML: a list of one.
///
/// # Errors
/// None that is known: the profile is a constant.
pub fn offered_qos(latched: bool) -> io::Result<String> {
    serde_saphyr::to_string(&[reliable(latched)]).map_err(io::Error::other)
}

fn reliable(latched: bool) -> Qos {
    const SECOND: i64 = 1_000_000_000;
    let endless = QosTime { sec: i64::MAX / SECOND, nsec: i64::MAX % SECOND };
    Qos {
        history: "keep_last",
        depth: if latched { 1 } else { 10 },
        reliability: "reliable",
        durability: if latched { "transient_local" } else { "volatile" },
        deadline: endless,
        lifespan: endless,
        liveliness: "automatic",
        liveliness_lease_duration: endless,
        avoid_ros_namespace_conventions: false,
    }
}
