//! A run as a bag: MCAP, profile `ros2`, CDR messages stamped and logged in simulated time.

use super::Sample;
use super::messages::{Clock, Header, JointState, Odometry, Time, WithCovariance};
use super::metadata::{Contents, Topic, offered_qos};
use super::schema::{CLOCK, JOINT_STATE, MessageType, ODOMETRY};
use crate::model::Model;
use crate::world::Snapshot;
use byteorder::LittleEndian;
use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{self, Seek, Write};

/// Frame in which the base moves.
const WORLD: &str = "world";
/// Encapsulation header of CDR: plain, little endian, no options.
const CDR_LITTLE_ENDIAN: [u8; 4] = [0, 1, 0, 0];

/// Writes `/clock`, `/joint_states` and, for a free base, `/odom` (root link in `world`) per sample; `/NAME/odom` for whatever
/// else floats.
pub struct BagWriter<W: Write + Seek> {
    mcap: Writer<W>,
    clock: u16,
    joint_states: u16,
    odometry: Vec<FreeBase>,
    axes: Vec<String>,
    contents: Contents,
    payload: Vec<u8>,
}

/// A free base: channel of its odometry, index and name of the root link.
struct FreeBase {
    channel: u16,
    link: usize,
    frame: String,
}

impl<W: Write + Seek> BagWriter<W> {
    /// Writes the header and the message definitions.
    ///
    /// # Errors
    /// What the file system says.
    pub fn new(out: W, model: &Model) -> io::Result<Self> {
        let library = concat!("realnoid ", env!("CARGO_PKG_VERSION"));
        let options = WriteOptions::new().profile("ros2").library(library).compression(None);
        let mut mcap = options.create(out).map_err(io_error)?;
        let mut contents = Contents::default();
        let mut add = |topic: &str, kind: MessageType| {
            contents.topics.push(Topic { name: topic.to_owned(), kind });
            add_channel(&mut mcap, topic, kind)
        };
        let clock = add("/clock", CLOCK)?;
        let joint_states = add("/joint_states", JOINT_STATE)?;
        let floats = |(name, link): (&str, usize)| {
            let topic = if link == model.root_link { "/odom".to_owned() } else { format!("/{name}/odom") };
            Ok(FreeBase { channel: add(&topic, ODOMETRY)?, link, frame: model.links[link].name.clone() })
        };
        let odometry = model.floating().map(floats).collect::<io::Result<Vec<_>>>()?;
        let axes = model.axes.iter().map(|a| a.name.clone()).collect();
        Ok(Self { mcap, clock, joint_states, odometry, axes, contents, payload: Vec::new() })
    }

    /// Writes one message per topic.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&mut self, sample: &Sample) -> io::Result<()> {
        let s = &sample.snapshot;
        let Self { mcap, payload, contents, .. } = self;
        let mut messages =
            Messages { mcap, payload, stamp_ns: s.stamp_ns.unsigned_abs(), sequence: contents.samples as u32 };
        let stamp = Time::from_ns(s.stamp_ns);
        messages.write(self.clock, &Clock { clock: stamp })?;
        messages.write(self.joint_states, &joint_state(stamp, &self.axes, s))?;
        for base in &self.odometry {
            messages.write(base.channel, &odometry(stamp, base, s))?;
        }
        self.contents.count(s.stamp_ns);
        Ok(())
    }

    /// Writes the index and the footer; tells what is in the bag.
    ///
    /// # Errors
    /// What the file system says.
    pub(super) fn finish(mut self) -> io::Result<Contents> {
        self.mcap.finish().map_err(io_error)?;
        self.mcap.into_inner().flush()?;
        Ok(self.contents)
    }
}

/// The messages of one instant.
struct Messages<'a, W: Write + Seek> {
    mcap: &'a mut Writer<W>,
    payload: &'a mut Vec<u8>,
    stamp_ns: u64,
    sequence: u32,
}

impl<W: Write + Seek> Messages<'_, W> {
    fn write(&mut self, channel_id: u16, message: &impl Serialize) -> io::Result<()> {
        self.payload.clear();
        self.payload.extend(CDR_LITTLE_ENDIAN);
        cdr_encoding::to_writer::<_, LittleEndian, _>(&mut *self.payload, message).map_err(io::Error::other)?;
        let (sequence, time) = (self.sequence, self.stamp_ns);
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        self.mcap.write_to_known_channel(&header, self.payload).map_err(io_error)
    }
}

fn add_channel<W: Write + Seek>(mcap: &mut Writer<W>, topic: &str, kind: MessageType) -> io::Result<u16> {
    let definition = kind.definition();
    let schema = mcap.add_schema(&kind.full_name(), "ros2msg", definition.as_bytes()).map_err(io_error)?;
    let about = BTreeMap::from([
        ("offered_qos_profiles".to_owned(), offered_qos()?),
        ("topic_type_hash".to_owned(), kind.hash.to_owned()),
    ]);
    mcap.add_channel(schema, topic, "cdr", &about).map_err(io_error)
}

fn joint_state<'a>(stamp: Time, name: &'a [String], s: &'a Snapshot) -> JointState<'a> {
    let header = Header { stamp, frame_id: "" };
    JointState { header, name, position: &s.position, velocity: &s.velocity, effort: &s.effort }
}

fn odometry<'a>(stamp: Time, base: &'a FreeBase, s: &Snapshot) -> Odometry<'a> {
    Odometry {
        header: Header { stamp, frame_id: WORLD },
        child_frame_id: &base.frame,
        pose: WithCovariance::exact((&s.link_pose[base.link]).into()),
        twist: WithCovariance::exact((&s.link_twist[base.link]).into()),
    }
}

/// The cause, where the file system is the cause: "No space left on device" says more than "I/O error".
fn io_error(error: McapError) -> io::Error {
    match error {
        McapError::Io(cause) => cause,
        other => io::Error::other(other),
    }
}
