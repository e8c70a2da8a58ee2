//! Who subscribes to what. Without a Spinner (docs/decisions/0005) the node does not follow the ROS graph; what DDS discovery knows
//! is looked at some times a second.

use ros2_client::Context;
use ros2_client::dds::rustdds::GUID;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// How often it is looked at.
const PERIOD: Duration = Duration::from_millis(200);

/// Subscribers of some topics, outside of this process.
#[derive(Debug, Default)]
pub struct Audience {
    /// By the names that DDS has for them.
    topics: Vec<(String, BTreeSet<GUID>)>,
    due: Option<Instant>,
    /// A bag takes what anybody could subscribe to.
    pub recorded: bool,
}

/// A topic of an [`Audience`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seat(usize);

impl Audience {
    /// Watches a topic, by its absolute name.
    pub fn watch(&mut self, topic: &str) -> Seat {
        self.topics.push((format!("rt{topic}"), BTreeSet::new()));
        Seat(self.topics.len() - 1)
    }

    /// Looks, if it is time for it; true if so.
    pub fn look(&mut self, context: &Context, now: Instant) -> bool {
        if self.due.is_some_and(|due| now < due) {
            return false;
        }
        self.due = Some(now + PERIOD);
        self.topics.iter_mut().for_each(|(_, readers)| readers.clear());
        for reader in context.domain_participant().discovered_readers() {
            let name = reader.subscription_topic_data.topic_name();
            if let Some((_, readers)) = self.topics.iter_mut().find(|(topic, _)| topic == name) {
                readers.insert(reader.reader_proxy.remote_reader_guid);
            }
        }
        true
    }

    /// Who subscribed when it was looked at last.
    pub fn of(&self, seat: Seat) -> &BTreeSet<GUID> {
        &self.topics[seat.0].1
    }

    /// Every topic with the number of its subscribers.
    pub fn counts(&self) -> Vec<(String, usize)> {
        self.topics.iter().map(|(topic, readers)| (topic[2..].to_owned(), readers.len())).collect()
    }

    /// Does anybody, or is it recorded?
    pub fn any(&self, seat: Seat) -> bool {
        self.recorded || !self.of(seat).is_empty()
    }
}
