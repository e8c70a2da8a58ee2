//! A bag that is written while something runs: by a thread of its own, behind a queue that is never waited for.

use super::bag::Bag;
use super::metadata::{Topic, yaml};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Messages that may wait.
const QUEUE: usize = 1 << 16;
/// Bytes that may wait.
const QUEUED_BYTES: u64 = 64 << 20;
/// What is lost at most if the process is killed.
const FLUSH_PERIOD: Duration = Duration::from_millis(900);
/// How long the thread sleeps when nothing waits: it is never woken, so that handing a message over costs next to nothing.
const PAUSE: Duration = Duration::from_millis(10);

/// Something on its way into the bag.
pub enum Item {
    /// A topic; messages name it by this number.
    Topic {
        /// Its number.
        number: usize,
        /// Name and type.
        topic: Topic,
        /// Name before remapping.
        relative: String,
    },
    /// A message.
    Message {
        /// The number of its topic.
        number: usize,
        /// Since the epoch, ns.
        time_ns: u64,
        /// CDR with its header.
        cdr: Vec<u8>,
    },
}

impl Item {
    fn bytes(&self) -> u64 {
        match self {
            Self::Topic { .. } => 0,
            Self::Message { cdr, .. } => cdr.len() as u64,
        }
    }
}

/// How a recording gets on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// The bag.
    pub folder: PathBuf,
    /// Messages written.
    pub written: u64,
    /// Their bytes.
    pub bytes: u64,
    /// Messages that wait.
    pub waiting: u64,
    /// Messages lost because the disk was too slow.
    pub lost: u64,
    /// Why nothing is written any more.
    pub failed: Option<String>,
}

#[derive(Default)]
struct Shared {
    written: AtomicU64,
    bytes: AtomicU64,
    waiting: AtomicU64,
    waiting_bytes: AtomicU64,
    lost: AtomicU64,
    failed: OnceLock<String>,
}

/// A recording.
pub struct Session {
    folder: PathBuf,
    queue: SyncSender<Item>,
    shared: Arc<Shared>,
    thread: JoinHandle<()>,
}

impl Session {
    /// Begins a bag in `folder`, which must not exist yet, or be empty.
    ///
    /// # Errors
    /// Names the folder, and what is wrong with it.
    pub fn start(folder: &Path) -> Result<Self, String> {
        let shown = folder.display();
        let failed = |e: io::Error| format!("cannot record into '{shown}': {e}");
        std::fs::create_dir_all(folder).map_err(failed)?;
        if std::fs::read_dir(folder).map_err(failed)?.next().is_some() {
            return Err(format!(
                "cannot record into '{shown}': it is not empty; name a folder that does not exist yet"
            ));
        }
        let folder = std::fs::canonicalize(folder).map_err(failed)?;
        let name = folder.file_name().map_or_else(|| "bag".into(), |n| n.to_string_lossy().into_owned());
        let file = folder.join(format!("{name}_0.mcap"));
        let out = BufWriter::with_capacity(1 << 20, File::create(&file).map_err(failed)?);
        let bag = Bag::new(out).map_err(failed)?;
        let shared = Arc::new(Shared::default());
        let mut writer = Writer { bag, file, numbers: vec![], last_ns: 0, shared: shared.clone() };
        writer.flush().map_err(failed)?;
        let (queue, items) = sync_channel(QUEUE);
        let run = move || writer.run(&items);
        let thread = thread::Builder::new().name("record".into()).spawn(run).map_err(failed)?;
        Ok(Self { folder, queue, shared, thread })
    }

    /// Hands something over; never waits. `false`: it is lost, and counted.
    pub fn push(&self, item: Item) -> bool {
        let shared = &self.shared;
        let bytes = item.bytes();
        if shared.waiting_bytes.load(Ordering::Relaxed) + bytes > QUEUED_BYTES {
            shared.lost.fetch_add(1, Ordering::Relaxed);
            return false;
        }
        shared.waiting.fetch_add(1, Ordering::Relaxed);
        shared.waiting_bytes.fetch_add(bytes, Ordering::Relaxed);
        match self.queue.try_send(item) {
            Ok(()) => true,
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {
                shared.waiting.fetch_sub(1, Ordering::Relaxed);
                shared.waiting_bytes.fetch_sub(bytes, Ordering::Relaxed);
                shared.lost.fetch_add(1, Ordering::Relaxed);
                false
            }
        }
    }

    /// How it gets on.
    pub fn report(&self) -> Report {
        let count = |a: &AtomicU64| a.load(Ordering::Relaxed);
        let s = &self.shared;
        Report {
            folder: self.folder.clone(),
            written: count(&s.written),
            bytes: count(&s.bytes),
            waiting: count(&s.waiting),
            lost: count(&s.lost),
            failed: s.failed.get().cloned(),
        }
    }

    /// Is the queue more than half full, and still being emptied?
    pub fn is_crowded(&self) -> bool {
        let waiting = |a: &AtomicU64| a.load(Ordering::Relaxed);
        let (messages, bytes) = (waiting(&self.shared.waiting), waiting(&self.shared.waiting_bytes));
        self.shared.failed.get().is_none() && (messages > QUEUE as u64 / 2 || bytes > QUEUED_BYTES / 2)
    }

    /// Messages lost so far.
    pub fn lost(&self) -> u64 {
        self.shared.lost.load(Ordering::Relaxed)
    }

    /// Writes what waits, and completes the bag. Waits for that.
    pub fn finish(self) -> Report {
        let Self { folder, queue, shared, thread } = self;
        drop(queue);
        if thread.join().is_err() {
            let _ = shared.failed.set("the writing thread has panicked".into());
        }
        let count = |a: &AtomicU64| a.load(Ordering::Relaxed);
        let (written, bytes, lost) = (count(&shared.written), count(&shared.bytes), count(&shared.lost));
        Report { folder, written, bytes, waiting: 0, lost, failed: shared.failed.get().cloned() }
    }
}

struct Writer {
    bag: Bag<BufWriter<File>>,
    file: PathBuf,
    /// From the numbers of [`Item::Topic`] to those of the bag.
    numbers: Vec<Option<usize>>,
    last_ns: u64,
    shared: Arc<Shared>,
}

impl Writer {
    fn run(mut self, items: &Receiver<Item>) {
        let (shared, file) = (self.shared.clone(), self.file.clone());
        let written = self.write_all(items).and_then(|()| {
            let contents = self.bag.finish()?;
            write_metadata(&file, &yaml(&contents, &file)?)
        });
        if let Err(e) = written {
            let _ = shared.failed.set(format!("cannot write '{}': {e}", file.display()));
        }
    }

    /// Until nobody hands anything over any more.
    fn write_all(&mut self, items: &Receiver<Item>) -> io::Result<()> {
        let mut due = Instant::now() + FLUSH_PERIOD;
        loop {
            match items.try_recv() {
                Ok(item) => self.write(item)?,
                Err(TryRecvError::Empty) => thread::sleep(PAUSE),
                Err(TryRecvError::Disconnected) => return Ok(()),
            }
            if Instant::now() >= due {
                self.flush()?;
                due = Instant::now() + FLUSH_PERIOD;
            }
        }
    }

    fn write(&mut self, item: Item) -> io::Result<()> {
        match item {
            Item::Topic { number, topic, relative } => {
                let added = self.bag.add(topic, &[("realnoid_name", &relative)])?;
                self.numbers.resize(self.numbers.len().max(number + 1), None);
                self.numbers[number] = Some(added);
                self.shared.waiting.fetch_sub(1, Ordering::Relaxed);
            }
            Item::Message { number, time_ns, cdr } => {
                let topic = self.numbers.get(number).copied().flatten().unwrap_or(usize::MAX);
                // Threads hand over in an order of their own; a reader sorts by time, and must find that order again.
                self.last_ns = time_ns.max(self.last_ns + 1);
                let bytes = cdr.len() as u64;
                self.bag.write(topic, self.last_ns, &cdr)?;
                self.shared.waiting.fetch_sub(1, Ordering::Relaxed);
                self.shared.waiting_bytes.fetch_sub(bytes, Ordering::Relaxed);
                self.shared.written.fetch_add(1, Ordering::Relaxed);
                self.shared.bytes.fetch_add(bytes, Ordering::Relaxed);
            }
        }
        Ok(())
    }

    /// What has been written so far can be read from now on, whatever happens to this process.
    fn flush(&mut self) -> io::Result<()> {
        self.bag.flush()?;
        write_metadata(&self.file, &yaml(self.bag.contents(), &self.file)?)
    }
}

/// Replaces `metadata.yaml` beside `file` as a whole.
pub(super) fn write_metadata(file: &Path, text: &str) -> io::Result<()> {
    let (new, there) = (file.with_file_name(".metadata.yaml.new"), file.with_file_name("metadata.yaml"));
    std::fs::write(&new, text)?;
    std::fs::rename(new, there)
}

#[cfg(test)]
mod tests {
    use super::super::MessageType;
    use super::*;

    fn session(folder: &Path) -> Session {
        let session = Session::start(folder).unwrap();
        let topic = Topic::new("/a", MessageType::by_name("std_msgs/UInt64").unwrap());
        assert!(session.push(Item::Topic { number: 3, topic, relative: "a".into() }));
        session
    }

    fn message(number: usize) -> Item {
        Item::Message { number, time_ns: 7, cdr: vec![0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0] }
    }

    #[test]
    fn what_is_handed_over_is_written_and_times_rise() {
        let dir = tempfile::tempdir().unwrap();
        let session = session(&dir.path().join("bag"));
        for _ in 0..5 {
            assert!(session.push(message(3)));
        }
        let report = session.finish();
        assert_eq!((report.written, report.lost, report.failed), (5, 0, None));
        let bytes = std::fs::read(dir.path().join("bag/bag_0.mcap")).unwrap();
        let times: Vec<u64> = mcap::MessageStream::new(&bytes).unwrap().map(|m| m.unwrap().log_time).collect();
        assert_eq!(times, [7, 8, 9, 10, 11]);
    }

    #[test]
    fn a_folder_with_something_in_it_is_refused_and_left_alone() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("mine"), "").unwrap();
        let reason = Session::start(dir.path()).err().unwrap();
        assert!(reason.contains("it is not empty"), "{reason}");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_does_not_fit_is_lost_and_counted() {
        let dir = tempfile::tempdir().unwrap();
        let session = session(&dir.path().join("bag"));
        let big = || Item::Message { number: 3, time_ns: 1, cdr: vec![0; QUEUED_BYTES as usize + 1] };
        assert!(!session.push(big()) && !session.push(big()));
        assert!(session.push(message(3)));
        let report = session.finish();
        assert_eq!((report.lost, report.written), (2, 1));
    }

    #[test]
    fn a_message_of_an_unknown_topic_ends_it_with_a_reason() {
        let dir = tempfile::tempdir().unwrap();
        let session = session(&dir.path().join("bag"));
        session.push(message(9));
        let failed = session.finish().failed.unwrap();
        assert!(failed.contains("there is no topic"), "{failed}");
    }
}
