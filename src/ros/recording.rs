//! Everything that goes out and comes in is noted here; while a recording runs, it goes into the bag.

use super::messages::{DiagnosticStatus, KeyValue, Level, Time};
use crate::record::{Item, MessageType, Report, Session, Topic, to_cdr};
use ros2_client::parameters::raw;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Where ros2-client announces changes of parameters.
pub const PARAMETER_EVENTS: &str = "/parameter_events";

/// Notes messages; clones note on the same tape. Free of cost, but for a look at a flag, while nothing is recorded.
#[derive(Clone, Default)]
pub struct Tape(Arc<Inner>);

#[derive(Default)]
struct Inner {
    runs: AtomicBool,
    /// Recordings begun.
    begun: AtomicU64,
    deck: Mutex<Deck>,
}

#[derive(Default)]
struct Deck {
    tracks: Vec<Track>,
    session: Option<Session>,
    epoch: Option<(u64, Instant)>,
    /// Of the last recording that has ended.
    ended: Option<Report>,
}

/// A topic.
struct Track {
    name: String,
    /// Before namespace and remapping.
    relative: String,
    /// `package/Type`.
    kind: String,
    latched: bool,
    /// Known to the present recording.
    announced: bool,
}

impl Deck {
    fn announce(&mut self, number: usize) -> bool {
        let (Some(track), Some(session)) = (self.tracks.get_mut(number), &self.session) else { return false };
        if !track.announced {
            // A type without a definition: told when it was registered.
            let Some(kind) = MessageType::by_name(&track.kind) else { return false };
            let topic = Topic { latched: track.latched, ..Topic::new(track.name.clone(), kind) };
            track.announced = session.push(Item::Topic { number, topic, relative: track.relative.clone() });
        }
        track.announced
    }

    fn now_ns(&self) -> u64 {
        self.epoch.map_or(0, |(start, since)| start + since.elapsed().as_nanos() as u64)
    }
}

impl Tape {
    fn deck(&self) -> MutexGuard<'_, Deck> {
        self.0.deck.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The number of a topic, under which it is noted; the same one every time.
    pub fn track(&self, name: &str, relative: &str, kind: &str, latched: bool) -> usize {
        let mut deck = self.deck();
        if let Some(known) = deck.tracks.iter().position(|t| t.name == name) {
            return known;
        }
        if MessageType::by_name(kind).is_none() {
            tracing::error!("topic {name} is not recorded: the definition of {kind} is not in this program");
        }
        let track =
            Track { name: name.into(), relative: relative.into(), kind: kind.into(), latched, announced: false };
        deck.tracks.push(track);
        deck.tracks.len() - 1
    }

    /// Notes a message, if something is recorded; never waits for the disk. `false`: it is not in the bag.
    pub fn note(&self, track: usize, message: &impl Serialize) -> bool {
        if !self.runs() {
            return false;
        }
        let mut cdr = vec![];
        if to_cdr(message, &mut cdr).is_err() {
            return false;
        }
        let mut deck = self.deck();
        if !deck.announce(track) {
            return false;
        }
        let time_ns = deck.now_ns();
        deck.session.as_ref().is_some_and(|s| s.push(Item::Message { number: track, time_ns, cdr }))
    }

    /// Notes a message on the topic that is called so before namespace and remapping.
    pub fn note_on(&self, relative: &str, message: &impl Serialize) {
        if !self.runs() {
            return;
        }
        let track = self.deck().tracks.iter().position(|t| t.relative == relative);
        if let Some(track) = track {
            self.note(track, message);
        }
    }

    /// Notes that ros2-client has announced a parameter of `node`.
    pub fn note_event(&self, node: &str, parameter: raw::Parameter) {
        let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let stamp = Time::from_ns(i64::try_from(since_epoch.as_nanos()).unwrap_or(i64::MAX));
        let none: [raw::Parameter; 0] = [];
        // The fields of rcl_interfaces/ParameterEvent.
        self.note_on(PARAMETER_EVENTS, &(stamp, node, none.as_slice(), [parameter].as_slice(), none.as_slice()));
    }

    /// Is the topic in the bag that is being recorded?
    pub fn has(&self, track: usize) -> bool {
        self.deck().tracks.get(track).is_some_and(|t| t.announced)
    }

    /// Is something recorded?
    pub fn runs(&self) -> bool {
        self.0.runs.load(Ordering::Relaxed)
    }

    /// How many recordings have begun, the present one included.
    pub fn begun(&self) -> u64 {
        self.0.begun.load(Ordering::Relaxed)
    }

    /// Messages that the present recording has lost.
    pub fn lost(&self) -> u64 {
        if self.runs() { self.deck().session.as_ref().map_or(0, Session::lost) } else { 0 }
    }

    /// Does the present recording need time? Where nothing is paced, it gets it.
    pub fn is_crowded(&self) -> bool {
        self.runs() && self.deck().session.as_ref().is_some_and(Session::is_crowded)
    }

    /// Begins a recording.
    ///
    /// # Errors
    /// What is wrong with the folder, or that a recording runs.
    pub fn start(&self, folder: &Path) -> Result<Report, String> {
        let mut deck = self.deck();
        if let Some(session) = &deck.session {
            let into = session.report().folder;
            return Err(format!("a recording into '{}' runs already: stop it first", into.display()));
        }
        let session = Session::start(folder)?;
        let report = session.report();
        let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        deck.epoch = Some((since_epoch.as_nanos() as u64, Instant::now()));
        deck.tracks.iter_mut().for_each(|t| t.announced = false);
        deck.session = Some(session);
        self.0.begun.fetch_add(1, Ordering::Relaxed);
        self.0.runs.store(true, Ordering::Relaxed);
        Ok(report)
    }

    /// Ends the recording and completes the bag; waits for that. `None` if nothing was recorded.
    pub fn stop(&self) -> Option<Report> {
        let session = {
            let mut deck = self.deck();
            self.0.runs.store(false, Ordering::Relaxed);
            deck.session.take()?
        };
        let report = session.finish();
        self.deck().ended = Some(report.clone());
        Some(report)
    }

    /// How the present recording gets on, or how the last one went; and whether it still runs.
    pub fn report(&self) -> Option<(Report, bool)> {
        let deck = self.deck();
        let running = deck.session.as_ref().map(|s| (s.report(), true));
        running.or_else(|| deck.ended.clone().map(|r| (r, false)))
    }
}

/// One line for people.
pub fn told(report: &Report) -> String {
    let mut text = format!("recorded {} messages in '{}'", report.written, report.folder.display());
    if report.lost > 0 {
        text += &format!(", {} lost because the disk was too slow", report.lost);
    }
    if let Some(reason) = &report.failed {
        text += &format!("; then it ended: {reason}");
    }
    text
}

/// What `/diagnostics` says of the recording of `node`; nothing before the first one.
pub fn status(tape: &Tape, node: &str, robot: &str) -> Option<DiagnosticStatus> {
    let (report, runs) = tape.report()?;
    let (level, message) = match (&report.failed, report.lost > 0, runs) {
        (Some(reason), ..) => (Level::Error, reason.clone()),
        (_, true, _) => (Level::Warn, "messages were lost: the disk is too slow".into()),
        (.., true) => (Level::Ok, "runs".into()),
        _ => (Level::Ok, "complete".into()),
    };
    let pair = |key: &str, value: String| KeyValue { key: key.into(), value };
    let values = vec![
        pair("folder", report.folder.display().to_string()),
        pair("messages", report.written.to_string()),
        pair("bytes", report.bytes.to_string()),
        pair("waiting messages", report.waiting.to_string()),
        pair("lost messages", report.lost.to_string()),
    ];
    Some(DiagnosticStatus {
        level: level as u8,
        name: format!("{node}: recording"),
        message,
        hardware_id: robot.into(),
        values,
    })
}
