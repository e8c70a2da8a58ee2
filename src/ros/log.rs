//! The node's log: standard error and `/rosout`, in the format of ROS 2.

use super::messages::Time;
use super::recording::Tape;
use ros2_client::qos::{Durability, History, QosProfile, WhenFull};
use ros2_client::{MessageTypeName, Name, Node, Publisher};
use serde::Serialize;
use std::collections::HashSet;
use std::io::Write;
use std::panic::Location;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use tracing_subscriber::filter::filter_fn;
use tracing_subscriber::prelude::*;

/// Severities, with the numbers of rcl_interfaces/Log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Severity {
    /// For developers.
    Debug = 10,
    /// Worth knowing.
    Info = 20,
    /// Worth looking into.
    Warn = 30,
    /// Something does not work.
    Error = 40,
    /// Nothing works.
    Fatal = 50,
}

impl Severity {
    /// From the word of `--log-level`, in upper or lower case.
    pub fn parse(word: &str) -> Option<Self> {
        Some(match word.to_ascii_lowercase().as_str() {
            "debug" => Self::Debug,
            "info" => Self::Info,
            "warn" | "warning" => Self::Warn,
            "error" => Self::Error,
            "fatal" => Self::Fatal,
            _ => return None,
        })
    }

    fn label(self) -> &'static str {
        match self {
            Self::Debug => "DEBUG",
            Self::Info => "INFO",
            Self::Warn => "WARN",
            Self::Error => "ERROR",
            Self::Fatal => "FATAL",
        }
    }
}

const ROSOUT: &str = "/rosout";

/// rcl_interfaces/Log.
#[derive(Clone, Debug, Serialize)]
struct Record {
    stamp: Time,
    level: u8,
    name: String,
    msg: String,
    file: String,
    function: String,
    line: u32,
}

/// Writes the log; clones write to the same one.
#[derive(Clone)]
pub struct Logger(Arc<Inner>);

struct Inner {
    name: String,
    threshold: Severity,
    stderr: bool,
    rosout: Option<Publisher<Record>>,
    tape: Tape,
    track: usize,
    said: Mutex<HashSet<String>>,
    warnings: Mutex<Warnings>,
}

/// What has been logged at Warn or above.
#[derive(Clone, Debug, Default)]
pub struct Warnings {
    /// How much.
    pub count: u64,
    /// The last one.
    pub last: String,
}

impl Logger {
    /// The log of `node`: what is at least `threshold`.
    pub fn new(
        node: &mut Node,
        threshold: Severity,
        (rosout, stderr): (bool, bool),
        tape: &Tape,
    ) -> Result<Self, String> {
        let full_name = node.fully_qualified_name();
        let name = full_name.trim_start_matches('/').replace('/', ".");
        let rosout = if rosout { Some(publisher(node)?) } else { None };
        let (track, tape) = (tape.track(ROSOUT, ROSOUT, "rcl_interfaces/Log", false), tape.clone());
        Ok(Self(Arc::new(Inner {
            name,
            threshold,
            stderr,
            rosout,
            tape,
            track,
            said: Mutex::default(),
            warnings: Mutex::default(),
        })))
    }

    /// What has been warned of since this connection was made.
    pub fn warnings(&self) -> Warnings {
        self.0.warnings.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone()
    }

    fn remember(&self, warning: &str) {
        let mut warnings = self.0.warnings.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        *warnings = Warnings { count: warnings.count + 1, last: warning.to_owned() };
    }

    /// Logs `message`.
    #[track_caller]
    pub fn log(&self, severity: Severity, message: impl Into<String>) {
        let message = message.into();
        if severity >= Severity::Warn {
            self.remember(&message);
        }
        if severity < self.0.threshold {
            return;
        }
        let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        if self.0.stderr {
            let seconds = since_epoch.as_secs_f64();
            // A closed standard error must not stop the node.
            let _ = writeln!(std::io::stderr(), "[{}] [{seconds:.9}] [{}]: {message}", severity.label(), self.0.name);
        }
        let Some(rosout) = &self.0.rosout else { return };
        let at = Location::caller();
        let record = Record {
            stamp: Time::from_ns(i64::try_from(since_epoch.as_nanos()).unwrap_or(i64::MAX)),
            level: severity as u8,
            name: self.0.name.clone(),
            msg: message,
            file: at.file().into(),
            function: String::new(),
            line: at.line(),
        };
        self.0.tape.note(self.0.track, &record);
        // A log that cannot be published cannot be logged either; it has been written to standard error.
        let _ = rosout.publish(record);
    }

    /// Logs at Info.
    #[track_caller]
    pub fn info(&self, message: impl Into<String>) {
        self.log(Severity::Info, message);
    }

    /// Logs at Warn.
    #[track_caller]
    pub fn warn(&self, message: impl Into<String>) {
        self.log(Severity::Warn, message);
    }

    /// Logs at Warn, but only the first time for this `key`.
    #[track_caller]
    pub fn warn_once(&self, key: &str, message: impl Into<String>) {
        let mut said = self.0.said.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if said.insert(key.to_string()) {
            drop(said);
            self.log(Severity::Warn, message);
        }
    }
}

fn publisher(node: &mut Node) -> Result<Publisher<Record>, String> {
    // The QoS of rcl: late joiners get what was said in the last ten seconds.
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .durability(Durability::TransientLocal)
        .history(History::KeepLast { depth: 1000 })
        .lifespan(Some(Duration::from_secs(10)));
    let name = Name::parse(ROSOUT).map_err(|e| e.to_string())?;
    let topic =
        node.create_topic(&name, MessageTypeName::new("rcl_interfaces", "Log"), &qos).map_err(|e| e.to_string())?;
    node.create_publisher(&topic, None).map_err(|e| format!("cannot publish {}: {e}", ROSOUT))
}

static LEAVING: AtomicBool = AtomicBool::new(false);

/// Shows the errors of the DDS library on standard error.
pub fn show_library_errors() {
    let shown = filter_fn(|meta| {
        *meta.level() <= tracing::Level::ERROR && !(LEAVING.load(Ordering::Relaxed) && harmless_at_exit(meta.target()))
    });
    let layer = tracing_subscriber::fmt::layer().with_writer(std::io::stderr).with_filter(shown);
    // Somebody else may have set a subscriber; then theirs decides.
    let _ = tracing_subscriber::registry().with(layer).try_init();
}

/// From now on, hides what RustDDS says when its sockets and threads are closed before its endpoints.
pub fn leave() {
    LEAVING.store(true, Ordering::Relaxed);
}

/// Takes [`leave`] back.
pub fn stay() {
    LEAVING.store(false, Ordering::Relaxed);
}

fn harmless_at_exit(target: &str) -> bool {
    ["rustdds::network", "rustdds::dds::pubsub", "rustdds::discovery"].iter().any(|t| target.starts_with(t))
}
