//! Worlds on all cores.

use super::document::Document;
use super::row::{End, Plan};
use super::spec::WorldPoint;
use super::table::Table;
use crate::cli::outcome::Progress;
use crate::cli::simulate::{Files, stopped};
use crate::cli::start::Start;
use crate::cli::stopwatch::wall_seconds;
use crate::dynamics::{LaneKind, take_turns};
use crate::model::Bodies;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};

/// Between two lines, where there is no terminal.
const LINE_PERIOD: Duration = Duration::from_secs(10);

/// What is to be done.
pub struct Work<'a> {
    /// What is simulated.
    pub document: &'a Document,
    /// All worlds.
    pub worlds: &'a [WorldPoint],
    /// Their columns.
    pub plan: &'a Plan,
    /// Where their own files go.
    pub places: Places,
    /// Threads.
    pub jobs: usize,
    /// Worlds of a thread that are stepped together.
    pub together: usize,
}

/// Folders of files that each world has for itself.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// A bag each.
    pub bags: Option<PathBuf>,
    /// A table each.
    pub tables: Option<PathBuf>,
}

/// How it went.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Worlds with a row of this run.
    pub made: usize,
    /// Of them, those that diverged.
    pub not_finite: usize,
    /// Of them, those that could not be made.
    pub refused: usize,
}

impl Work<'_> {
    /// Makes the worlds `left`, until all are made or a signal comes.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn run(&self, left: &[usize], table: &mut Table) -> Result<Tally, String> {
        for folder in [&self.places.bags, &self.places.tables].into_iter().flatten() {
            std::fs::create_dir_all(folder)
                .map_err(|e| format!("cannot make the folder '{}': {e}", folder.display()))?;
        }
        let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
        let mut tally = Tally::default();
        std::thread::scope(|scope| {
            let (rows, finished) = channel();
            for _ in 0..self.jobs.clamp(1, left.len().max(1)) {
                let (rows, next, failed) = (rows.clone(), &next, &failed);
                scope.spawn(move || self.worker(left, (next, failed), &rows));
            }
            drop(rows);
            let mut bar = Bar::new(left.len());
            let mut written = Ok(());
            for (row, end) in finished {
                if written.is_ok() {
                    written = end.and_then(|end| {
                        tally.count(end);
                        table.append(&row)
                    });
                    failed.store(written.is_err(), Ordering::Relaxed);
                }
                bar.show(tally.made);
            }
            bar.clear();
            written
        })?;
        Ok(tally)
    }

    /// Several worlds in turns: they share passes of the dynamics.
    fn worker(&self, left: &[usize], (next, failed): (&AtomicUsize, &AtomicBool), rows: &Sender<Finished>) {
        let tell = |(world, outcome): (usize, Outcome)| {
            let world = &self.worlds[world];
            let finished = match outcome {
                Ok(None) => return,
                Ok(Some(end)) => (self.plan.row(world, &end), Ok(state(&end))),
                Err(reason) => (vec![], Err(reason)),
            };
            if rows.send(finished).is_err() {
                failed.store(true, Ordering::Relaxed);
            }
        };
        let mut bodies = Bodies::default();
        let next = || {
            while !failed.load(Ordering::Relaxed) && !stopped() {
                let world = *left.get(next.fetch_add(1, Ordering::Relaxed))?;
                match self.begin(&self.worlds[world], &mut bodies) {
                    Ok((start, out)) => return Some(move || (world, simulate(start, out))),
                    Err(outcome) => tell((world, outcome)),
                }
            }
            None
        };
        take_turns((LaneKind::best(), self.together), wall_seconds, next, tell);
    }

    /// A world before its first step, and the file of its rows. It shares the bodies of the one before it, if they are the same.
    fn begin(&self, world: &WorldPoint, bodies: &mut Bodies) -> Result<(Start, Option<PathBuf>), Outcome> {
        let refused = |(code, reason)| Ok(Some(End::Refused(code, reason)));
        let mut start = self.document.start(world).map_err(refused)?;
        start.world.share(bodies);
        *bodies = start.world.model().bodies.clone();
        let out = self.file(world.index).map_err(Err)?;
        Ok((start, out))
    }

    fn file(&self, world: usize) -> Result<Option<PathBuf>, String> {
        let digits = self.worlds.len().saturating_sub(1).to_string().len();
        let name = format!("world_{world:0digits$}");
        let in_folder = |folder: &Path| folder.join(&name).join(format!("{name}.mcap"));
        let bag = self.places.bags.as_deref().map(in_folder);
        Ok(bag.or_else(|| self.places.tables.as_deref().map(|folder| folder.join(format!("{name}.csv")))))
    }
}

type Finished = (Vec<String>, Result<State, String>);
/// `None`: stopped before its end.
type Outcome = Result<Option<End>, String>;

fn simulate(mut start: Start, out: Option<PathBuf>) -> Outcome {
    let files = Files { out: out.as_deref(), contacts: None };
    let summary = start.run(&files, &mut Progress::silent())?;
    Ok((summary["stopped"] != true).then(|| End::Made(summary, Box::new(start.world))))
}

/// How a world ended, in short.
#[derive(Clone, Copy)]
enum State {
    Finite,
    NotFinite,
    Refused,
}

fn state(end: &End) -> State {
    match end {
        End::Refused(..) => State::Refused,
        End::Made(summary, _) if summary["finite"] == true => State::Finite,
        End::Made(..) => State::NotFinite,
    }
}

impl Tally {
    fn count(&mut self, end: State) {
        self.made += 1;
        self.not_finite += usize::from(matches!(end, State::NotFinite));
        self.refused += usize::from(matches!(end, State::Refused));
    }
}

/// How far it is: a bar on a terminal, else a line now and then.
struct Bar {
    bar: Option<ProgressBar>,
    all: usize,
    start: Instant,
    due: Instant,
}

impl Bar {
    fn new(all: usize) -> Self {
        let template = "{bar:40} {pos} of {len} worlds, {per_sec}, {eta} left";
        let style = || ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = std::io::stderr().is_terminal().then(|| ProgressBar::new(all as u64).with_style(style()));
        Self { bar, all, start: Instant::now(), due: Instant::now() + LINE_PERIOD }
    }

    fn show(&mut self, done: usize) {
        match &self.bar {
            Some(bar) => bar.set_position(done as u64),
            None if Instant::now() >= self.due => {
                let rate = done as f64 / self.start.elapsed().as_secs_f64();
                eprintln!("{done} of {} worlds, {rate:.2} per second", self.all);
                self.due = Instant::now() + LINE_PERIOD;
            }
            None => {}
        }
    }

    fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
