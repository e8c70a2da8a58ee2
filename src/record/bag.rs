//! A bag file: MCAP, profile `ros2`, CDR messages.

use super::metadata::{Contents, Topic, offered_qos};
use byteorder::LittleEndian;
use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{self, Seek, Write};

/// Encapsulation header of CDR: plain, little endian, no options.
pub const CDR_LITTLE_ENDIAN: [u8; 4] = [0, 1, 0, 0];
/// Uncompressed bytes in a chunk, unless a flush ends it earlier: the index in memory grows by an entry per chunk.
const CHUNK: u64 = 4 << 20;

/// Writes messages of any number of topics.
pub struct Bag<W: Write + Seek> {
    mcap: Writer<W>,
    channels: Vec<u16>,
    contents: Contents,
}

impl<W: Write + Seek> Bag<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// What the file system says.
    pub fn new(out: W) -> io::Result<Self> {
        let library = concat!("realnoid ", env!("CARGO_PKG_VERSION"));
        let options = WriteOptions::new()
            .profile("ros2")
            .library(library)
            .compression(None)
            .chunk_size(Some(CHUNK))
            .disable_seeking(true);
        let mcap = options.create(out).map_err(io_error)?;
        Ok(Self { mcap, channels: vec![], contents: Contents::default() })
    }

    /// Adds a topic with its message definition; its number in [`Bag::write`]. `about`: what else readers are told of it.
    ///
    /// # Errors
    /// What the file system says.
    pub fn add(&mut self, topic: Topic, about: &[(&str, &str)]) -> io::Result<usize> {
        let definition = topic.kind.definition();
        let schema = self.mcap.add_schema(&topic.kind.full_name(), "ros2msg", definition.as_bytes());
        let mut told = BTreeMap::from([
            ("offered_qos_profiles".to_owned(), offered_qos(topic.latched)?),
            ("topic_type_hash".to_owned(), topic.kind.hash.to_owned()),
        ]);
        told.extend(about.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())));
        let channel = self.mcap.add_channel(schema.map_err(io_error)?, &topic.name, "cdr", &told);
        self.channels.push(channel.map_err(io_error)?);
        self.contents.topics.push(topic);
        Ok(self.channels.len() - 1)
    }

    /// Writes a message: CDR with its header. Times must not fall, ns.
    ///
    /// # Errors
    /// What the file system says; a topic that was not added.
    pub fn write(&mut self, topic: usize, time_ns: u64, cdr: &[u8]) -> io::Result<()> {
        let (Some(channel), Some(about)) = (self.channels.get(topic), self.contents.topics.get_mut(topic)) else {
            return Err(io::Error::other(format!("there is no topic {topic} in the bag")));
        };
        let (sequence, log_time) = (about.count as u32, time_ns);
        let header = MessageHeader { channel_id: *channel, sequence, log_time, publish_time: log_time };
        self.mcap.write_to_known_channel(&header, cdr).map_err(io_error)?;
        about.count += 1;
        let first = self.contents.span.map_or(time_ns, |(first, _)| first);
        self.contents.span = Some((first, time_ns));
        Ok(())
    }

    /// What has been written.
    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    /// Hands everything written so far to the file system.
    ///
    /// # Errors
    /// What the file system says.
    pub fn flush(&mut self) -> io::Result<()> {
        self.mcap.flush().map_err(io_error)
    }

    /// Writes the index and the footer; tells what is in the bag.
    ///
    /// # Errors
    /// What the file system says.
    pub fn finish(mut self) -> io::Result<Contents> {
        self.mcap.finish().map_err(io_error)?;
        self.mcap.into_inner().flush()?;
        Ok(self.contents)
    }
}

/// A message as CDR, behind its header; `into` is cleared first.
///
/// # Errors
/// What cannot be written in CDR.
pub fn to_cdr(message: &impl Serialize, into: &mut Vec<u8>) -> io::Result<()> {
    into.clear();
    into.extend(CDR_LITTLE_ENDIAN);
    cdr_encoding::to_writer::<_, LittleEndian, _>(into, message).map_err(io::Error::other)
}

/// The cause, where the file system is the cause: "No space left on device" says more than "I/O error".
pub(super) fn io_error(error: McapError) -> io::Error {
    match error {
        McapError::Io(cause) => cause,
        other => io::Error::other(other),
    }
}
