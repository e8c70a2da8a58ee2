//! `debug/markers` (W-14, B-17, J-17): made, and memory taken for them, only while somebody subscribes.
//!
//! What moves with a link is sent in the frame of that link, so that it is sent once and followed by /tf.

mod fixed;
mod kinds;
mod marker;
mod moving;

use super::audience::{Audience, Seat};
use super::messages::{Marker, MarkerArray};
use super::topics::{Outgoing, Topics, report_qos};
use crate::model::Model;
use crate::world::Snapshot;
use fixed::fixed;
use kinds::Kind;
pub use kinds::{KIND_NAMES, LiveSettings, MarkerSettings};
use marker::all_deleted;
use moving::{Boxes, contacts};
use ros2_client::dds::rustdds::GUID;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How often what does not change is sent again: a subscriber that was discovered may not have listened yet.
const REPEAT: Duration = Duration::from_secs(2);

/// The publisher.
pub struct Markers {
    model: Arc<Model>,
    out: Outgoing<MarkerArray>,
    seat: Seat,
    shown: Option<Shown>,
    /// Messages made since the start.
    pub made: u64,
}

/// What subscribers have been shown.
struct Shown {
    settings: MarkerSettings,
    readers: BTreeSet<GUID>,
    /// Joints that had come apart.
    broken: usize,
    fixed: Vec<Marker>,
    boxes: Option<Boxes>,
    touching: bool,
    /// `None`: nothing has been sent yet.
    due: Option<Instant>,
    repeat: Instant,
}

impl Markers {
    /// Creates the publisher, and has its subscribers watched.
    ///
    /// # Errors
    /// The topic cannot be created.
    pub fn new(topics: &mut Topics, model: &Arc<Model>, audience: &mut Audience) -> Result<Self, String> {
        let out = topics.publisher("debug/markers", "visualization_msgs/MarkerArray", &report_qos())?;
        let seat = audience.watch(out.topic());
        Ok(Self { model: model.clone(), out, seat, shown: None, made: 0 })
    }

    /// Publishes if somebody subscribes and it is time for it; the number of messages that DDS refused.
    pub fn publish(&mut self, snapshot: &Snapshot, settings: &MarkerSettings, audience: &Audience) -> u64 {
        let readers = audience.of(self.seat);
        if readers.is_empty() || settings.rate == 0.0 {
            return self.stop();
        }
        let now = Instant::now();
        let stale = |s: &Shown| s.settings != *settings || s.broken != snapshot.broken.len();
        if self.shown.as_ref().is_none_or(stale) {
            self.shown = Some(Shown::new(&self.model, snapshot, settings));
        }
        let Some(shown) = &mut self.shown else { return 0 };
        if shown.due.is_some_and(|due| now < due) {
            return 0;
        }
        let mut markers = vec![];
        if shown.due.replace(now + Duration::from_secs_f64(1.0 / settings.rate)).is_none() {
            markers.push(all_deleted());
        }
        if shown.readers != *readers || now >= shown.repeat {
            markers.extend(shown.fixed.iter().cloned());
            shown.readers.clone_from(readers);
            shown.repeat = now + REPEAT;
        }
        if let Some(boxes) = &shown.boxes {
            boxes.show(snapshot, &mut markers);
        }
        contacts(snapshot, settings, &mut shown.touching, &mut markers);
        self.send(markers)
    }

    /// Takes back what was shown, and gives the memory free.
    pub fn stop(&mut self) -> u64 {
        match self.shown.take() {
            Some(_) => self.send(vec![all_deleted()]),
            None => 0,
        }
    }

    fn send(&mut self, markers: Vec<Marker>) -> u64 {
        if markers.is_empty() {
            return 0;
        }
        self.made += 1;
        self.out.send(MarkerArray { markers })
    }
}

impl Shown {
    fn new(model: &Model, snapshot: &Snapshot, settings: &MarkerSettings) -> Self {
        Self {
            settings: *settings,
            readers: BTreeSet::new(),
            broken: snapshot.broken.len(),
            fixed: fixed(model, snapshot, settings),
            boxes: settings.shows(Kind::Aabbs).then(|| Boxes::new(model)),
            touching: false,
            due: None,
            repeat: Instant::now(),
        }
    }
}
