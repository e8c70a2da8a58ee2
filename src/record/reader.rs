//! Reads a bag from its first message to its last, also one that was cut off.

use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, parse_record};
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Nothing in a bag is longer, bytes: a damaged file must not ask for more memory.
const LONGEST_RECORD: usize = 1 << 30;

/// A topic of a bag.
#[derive(Debug)]
pub struct StoredTopic {
    /// Absolute name.
    pub name: String,
    /// `package/msg/Type`.
    pub kind: String,
    /// Definition.
    pub definition: Vec<u8>,
    /// How the definition is written.
    pub encoding: String,
    /// How messages are written.
    pub message_encoding: String,
    /// What else is told of it.
    pub about: BTreeMap<String, String>,
}

/// A message of a bag.
#[derive(Clone, Debug)]
pub struct Stored {
    /// Its topic.
    pub topic: Arc<StoredTopic>,
    /// ns.
    pub log_time: u64,
    /// ns.
    pub publish_time: u64,
    /// In the topic.
    pub sequence: u32,
    /// CDR with its header.
    pub data: Vec<u8>,
}

/// Reads messages in the order of the file; never holds more than a chunk of it.
pub struct BagReader<R: Read = BufReader<File>> {
    input: R,
    reader: LinearReader,
    schemas: HashMap<u16, (String, String, Vec<u8>)>,
    topics: HashMap<u16, Arc<StoredTopic>>,
    ended: bool,
    complete: bool,
}

impl BagReader {
    /// Opens a file.
    ///
    /// # Errors
    /// Names the file and says why not.
    pub fn open(file: &Path) -> Result<Self, String> {
        let input = File::open(file).map_err(|e| format!("cannot read '{}': {e}", file.display()))?;
        Ok(Self::new(BufReader::with_capacity(1 << 20, input)))
    }
}

impl<R: Read> BagReader<R> {
    /// Reads `input`.
    pub fn new(input: R) -> Self {
        // A chunk's checksum counts before its messages do.
        let options = LinearReaderOptions::default()
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(LONGEST_RECORD);
        let reader = LinearReader::new_with_options(options);
        Self { input, reader, schemas: HashMap::new(), topics: HashMap::new(), ended: false, complete: false }
    }

    /// The next message; `None` at the end, or where the file was cut off.
    ///
    /// # Errors
    /// What is damaged.
    pub fn read(&mut self) -> Result<Option<Stored>, String> {
        while !self.ended {
            let record = match self.reader.next_event() {
                None => break,
                Some(Ok(LinearReadEvent::ReadRequest(need))) => {
                    let read = self.input.read(self.reader.insert(need)).map_err(|e| format!("cannot read: {e}"))?;
                    self.reader.notify_read(read);
                    continue;
                }
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    parse_record(opcode, data).map(Record::into_owned)
                }
                Some(Err(McapError::UnexpectedEof)) => break,
                Some(Err(e)) => Err(e),
            };
            let record = record.map_err(|e| format!("is damaged, or no MCAP file: {e}"))?;
            if let Some(message) = self.take(record)? {
                return Ok(Some(message));
            }
        }
        self.ended = true;
        Ok(None)
    }

    /// After the last message: does the file have an end? Else it was cut off.
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    fn take(&mut self, record: Record) -> Result<Option<Stored>, String> {
        match record {
            Record::Schema { header, data } => {
                self.schemas.insert(header.id, (header.name, header.encoding, data.into_owned()));
            }
            Record::Channel(c) => {
                let (kind, encoding, definition) = self.schemas.get(&c.schema_id).cloned().unwrap_or_default();
                let (name, message_encoding, about) = (c.topic, c.message_encoding, c.metadata);
                let topic = StoredTopic { name, kind, definition, encoding, message_encoding, about };
                self.topics.entry(c.id).or_insert_with(|| Arc::new(topic));
            }
            Record::Message { header, data } => {
                let Some(topic) = self.topics.get(&header.channel_id).cloned() else {
                    return Err(format!(
                        "is damaged: a message of channel {}, which it does not have",
                        header.channel_id
                    ));
                };
                let (log_time, publish_time) = (header.log_time, header.publish_time);
                let (sequence, data) = (header.sequence, data.into_owned());
                return Ok(Some(Stored { topic, log_time, publish_time, sequence, data }));
            }
            Record::Footer(_) => self.complete = true,
            _ => {}
        }
        Ok(None)
    }
}

/// The bag file that `path` means: itself, or the only `.mcap` in this folder.
///
/// # Errors
/// Names the path, and what is there instead.
pub fn file_in(path: &Path) -> Result<PathBuf, String> {
    let shown = path.display();
    if !path.is_dir() {
        return if path.exists() { Ok(path.to_owned()) } else { Err(format!("'{shown}' does not exist")) };
    }
    let failed = |e: io::Error| format!("cannot read the folder '{shown}': {e}");
    let entries: Result<Vec<_>, io::Error> = std::fs::read_dir(path).map_err(failed)?.map(|e| Ok(e?.path())).collect();
    let is_bag = |p: &PathBuf| p.extension().is_some_and(|e| e == "mcap");
    let mut files: Vec<PathBuf> = entries.map_err(failed)?.into_iter().filter(is_bag).collect();
    match (files.pop(), files.len()) {
        (Some(file), 0) => Ok(file),
        (Some(_), more) => Err(format!("'{shown}' has {} .mcap files; name the one that is meant", more + 1)),
        (None, _) => Err(format!("'{shown}' has no .mcap file")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bag, MessageType, Topic};
    use super::*;
    use std::io::Cursor;

    fn bag() -> Vec<u8> {
        let mut out = Cursor::new(vec![]);
        let mut bag = Bag::new(&mut out).unwrap();
        let topic = bag.add(Topic::new("/a", MessageType::by_name("std_msgs/UInt64").unwrap()), &[("k", "v")]).unwrap();
        for n in 0..100 {
            bag.write(topic, n, &[n as u8; 12]).unwrap();
            if n % 10 == 9 {
                bag.flush().unwrap();
            }
        }
        bag.finish().unwrap();
        out.into_inner()
    }

    fn all(bytes: &[u8]) -> Result<(usize, bool), String> {
        let mut reader = BagReader::new(bytes);
        let mut count = 0;
        while let Some(m) = reader.read()? {
            assert_eq!((m.log_time, m.data), (count as u64, vec![count as u8; 12]));
            assert_eq!((m.topic.name.as_str(), m.topic.about["k"].as_str()), ("/a", "v"));
            count += 1;
        }
        Ok((count, reader.is_complete()))
    }

    #[test]
    fn a_bag_cut_off_anywhere_is_read_up_to_there_without_a_panic() {
        let bytes = bag();
        assert_eq!(all(&bytes), Ok((100, true)));
        let mut most = 0;
        for end in 0..bytes.len() {
            let (count, _) = all(&bytes[..end]).unwrap();
            assert!(count >= most && count % 10 == 0, "{end}: {count}");
            most = count;
        }
        assert_eq!(most, 100);
    }

    #[test]
    fn no_changed_byte_of_a_message_goes_unnoticed_or_panics() {
        let bytes = bag();
        let at = bytes.windows(12).position(|w| w == [42; 12]).unwrap();
        let mut changed = bytes.clone();
        changed[at + 3] ^= 1;
        assert!(all(&changed).is_err());
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 0x81;
            let mut reader = BagReader::new(&changed[..]);
            while let Ok(Some(_)) = reader.read() {}
        }
    }
}
