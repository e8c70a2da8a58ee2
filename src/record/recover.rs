//! Completes a bag that was cut off: index, footer and metadata.yaml.

use super::live::write_metadata;
use super::metadata::{Contents, Topic, yaml};
use super::reader::{BagReader, Stored};
use super::{MessageType, bag::io_error};
use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};
use std::collections::HashMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;

/// What became of a bag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recovered {
    /// Messages in it.
    pub messages: u64,
    /// It had an end already; nothing was changed.
    pub was_complete: bool,
}

/// Gives `file` an end, if it has none, and then a `metadata.yaml` beside it. What is there is written anew, and takes the place of
/// the file once it is whole.
///
/// # Errors
/// Names the file, and what is damaged, or could not be written; it is as it was then.
pub fn recover(file: &Path) -> Result<Recovered, String> {
    let told = |reason: String| format!("'{}' {reason}", file.display());
    let new = file.with_extension("mcap.recovered");
    let written = rewrite(file, &new).map_err(told);
    match written {
        Ok((contents, false)) if !contents.topics.is_empty() => {
            let replaced = std::fs::rename(&new, file);
            let described = replaced.and_then(|()| write_metadata(file, &yaml(&contents, file)?));
            described.map_err(|e| told(format!("cannot be replaced: {e}")))?;
            Ok(Recovered { messages: count(&contents), was_complete: false })
        }
        Ok((contents, was_complete)) => {
            let _ = std::fs::remove_file(&new);
            if was_complete {
                Ok(Recovered { messages: count(&contents), was_complete })
            } else {
                Err(told("has no message".into()))
            }
        }
        Err(reason) => {
            let _ = std::fs::remove_file(&new);
            Err(reason)
        }
    }
}

fn count(contents: &Contents) -> u64 {
    contents.topics.iter().map(|t| t.count).sum()
}

/// Writes all messages of `file` to `new`; what they are, and whether `file` has an end.
fn rewrite(file: &Path, new: &Path) -> Result<(Contents, bool), String> {
    let mut reader = BagReader::open(file)?;
    let mut copy = Copy::new(new)?;
    while let Some(message) = reader.read()? {
        copy.write(&message)?;
    }
    Ok((copy.finish()?, reader.is_complete()))
}

/// A bag of messages of any type.
struct Copy {
    mcap: Writer<BufWriter<File>>,
    /// From the address of a topic to channel and place in the contents.
    channels: HashMap<String, (u16, usize)>,
    contents: Contents,
}

impl Copy {
    fn new(file: &Path) -> Result<Self, String> {
        let failed = |e: std::io::Error| format!("cannot be rewritten as '{}': {e}", file.display());
        let out = BufWriter::new(File::create(file).map_err(failed)?);
        let library = concat!("realnoid ", env!("CARGO_PKG_VERSION"));
        let options = WriteOptions::new().profile("ros2").library(library).compression(None);
        let mcap = options.create(out).map_err(|e| failed(io_error(e)))?;
        Ok(Self { mcap, channels: HashMap::new(), contents: Contents::default() })
    }

    fn write(&mut self, m: &Stored) -> Result<(), String> {
        let failed = |e: mcap::McapError| format!("cannot be rewritten: {}", io_error(e));
        let (channel_id, place) = match self.channels.get(&m.topic.name) {
            Some(known) => *known,
            None => self.add(&m.topic).map_err(failed)?,
        };
        let (log_time, publish_time) = (m.log_time, m.publish_time);
        let header = MessageHeader { channel_id, sequence: m.sequence, log_time, publish_time };
        self.mcap.write_to_known_channel(&header, &m.data).map_err(failed)?;
        if let Some(topic) = self.contents.topics.get_mut(place) {
            topic.count += 1;
        }
        let first = self.contents.span.map_or(log_time, |(first, _)| first);
        self.contents.span = Some((first, log_time));
        Ok(())
    }

    fn add(&mut self, topic: &Arc<super::reader::StoredTopic>) -> Result<(u16, usize), mcap::McapError> {
        let schema = self.mcap.add_schema(&topic.kind, &topic.encoding, &topic.definition)?;
        let channel = self.mcap.add_channel(schema, &topic.name, &topic.message_encoding, &topic.about)?;
        let latched = topic.about.get("offered_qos_profiles").is_some_and(|q| q.contains("transient_local"));
        // Bags of realnoid have known types only; another type is in the file all the same, but not in metadata.yaml.
        let place = match MessageType::by_name(&topic.kind.replace("/msg/", "/")) {
            Some(kind) => {
                self.contents.topics.push(Topic { latched, ..Topic::new(topic.name.clone(), kind) });
                self.contents.topics.len() - 1
            }
            None => usize::MAX,
        };
        self.channels.insert(topic.name.clone(), (channel, place));
        Ok((channel, place))
    }

    fn finish(mut self) -> Result<Contents, String> {
        self.mcap.finish().map_err(|e| format!("cannot be rewritten: {}", io_error(e)))?;
        Ok(self.contents)
    }
}
