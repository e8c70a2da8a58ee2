//! The world of a bag, made again and led through what happened to it.

use super::check::{Checks, decode, stamp_ns};
use super::verdict::{Difference, Verdict};
use crate::cli::run::build;
use crate::cli::scene::Fault;
use crate::cli::texts::standing_in;
use crate::engine::State;
use crate::model::Model;
use crate::record::story::{
    AxisCommands, Beginning, LOST, Lost, Origin, SETTINGS, START, WorldEvent, digest, file_digest, state_digest,
};
use crate::record::{CsvWriter, Sample, Stored};
use crate::ros::messages::Header;
use crate::world::{AxisCommand, Order, Settings, World};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fs::File;
use std::path::PathBuf;
use std::sync::Arc;

/// std_msgs/UInt64.
#[derive(Deserialize)]
struct Number {
    data: u64,
}

/// What the bag has told so far, and the world.
pub struct Stage {
    out: Option<PathBuf>,
    /// Model and initial state, until the first settings have come.
    prepared: Option<(Arc<Model>, State)>,
    play: Option<Play>,
    verdict: Verdict,
    /// The state differs, and it is not said yet in what.
    suspicion: Option<Difference>,
}

struct Play {
    world: World,
    sample: Sample,
    commands: Vec<AxisCommand>,
    checks: Checks,
    csv: Option<(CsvWriter<File>, PathBuf)>,
}

impl Stage {
    /// Rows go to `out`.
    pub fn new(out: Option<PathBuf>) -> Self {
        Self { out, prepared: None, play: None, verdict: Verdict::default(), suspicion: None }
    }

    /// Has the bag told what it was made of?
    pub fn has_begun(&self) -> bool {
        self.play.is_some() || self.prepared.is_some()
    }

    /// Takes the next message. After a difference or a gap only losses count.
    ///
    /// # Errors
    /// Why the bag cannot be replayed at all.
    pub fn take(&mut self, m: &Stored) -> Result<(), String> {
        let Some(relative) = m.topic.about.get("realnoid_name").map(String::as_str) else { return Ok(()) };
        match relative {
            "world_events" => self.event(&decode(&m.data).map_err(|e| format!("{relative}: {e}"))?),
            _ if self.is_over() => Ok(()),
            "axis_commands" => self.advance(&decode(&m.data).map_err(|e| format!("{relative}: {e}"))?),
            "state_digest" => {
                let digest: Number = decode(&m.data).map_err(|e| format!("{relative}: {e}"))?;
                self.compare_digest(digest.data);
                Ok(())
            }
            other => {
                self.compare_message(other, &m.data);
                Ok(())
            }
        }
    }

    /// What came out.
    ///
    /// # Errors
    /// The bag has no beginning, or the rows cannot be written.
    pub fn finish(mut self) -> Result<Verdict, String> {
        self.settle();
        if !self.has_begun() {
            return Err(
                "was not recorded by realnoid run --record, or was cut off before its first flush: it does not tell how the run began (topic world_events)"
                    .into(),
            );
        }
        if let Some((csv, path)) = self.play.and_then(|p| p.csv) {
            csv.finish().map_err(|e| format!("cannot write '{}': {e}", path.display()))?;
        }
        Ok(self.verdict)
    }

    fn is_over(&self) -> bool {
        self.verdict.difference.is_some() || self.verdict.gap.is_some()
    }

    fn event(&mut self, e: &WorldEvent<Header, String>) -> Result<(), String> {
        match e.kind.as_str() {
            START => self.begin(&json(e)?),
            LOST => {
                let lost: Lost = json(e)?;
                self.verdict.lost = lost;
                Ok(())
            }
            _ if self.is_over() => Ok(()),
            SETTINGS => self.set(json(e)?),
            _ => self.order(&json(e)?),
        }
    }

    fn begin(&mut self, b: &Beginning) -> Result<(), String> {
        if self.has_begun() {
            return Err("tells of two beginnings; it was put together of several bags".into());
        }
        if !b.from_start {
            return Err("begins in the middle of a run: what the engine remembers of the part before (contact forces, axes at rest, \
                        where everything goes back to at a reset) is not in it. A bag that can be replayed is made by realnoid run \
                        --record, or by the service record before time runs"
                .into());
        }
        self.verdict.recorder = Some(b.program.clone());
        let assembly = standing_in(b.origin.texts.clone(), || build(&b.origin)).map_err(|fault| match fault {
            Fault::Robot(reason) | Fault::Scene(reason) => format!("what was simulated cannot be loaded: {reason}"),
        })?;
        if digest(&assembly.model) != b.model {
            return Err(other_model(b));
        }
        self.prepared = Some((Arc::new(assembly.model), assembly.initial));
        Ok(())
    }

    fn set(&mut self, settings: Settings) -> Result<(), String> {
        if !self.verdict.engines.contains(&settings.engine) {
            self.verdict.engines.push(settings.engine);
        }
        match (&mut self.play, self.prepared.take()) {
            (Some(play), _) => play.world.set_settings(settings),
            (None, Some((model, initial))) => {
                self.play = Some(Play::new(model, initial, settings, self.out.take())?);
                Ok(())
            }
            (None, None) => Err("tells of settings before it tells what was simulated".into()),
        }
    }

    fn order(&mut self, order: &Order) -> Result<(), String> {
        self.settle();
        let Some(play) = &mut self.play else { return Err("tells of an order before it tells of settings".into()) };
        self.verdict.orders += 1;
        if let Err(reason) = play.world.execute(order) {
            self.differ(format!("the order {} was done then, and is refused now: {reason}", order.name()));
        }
        Ok(())
    }

    fn advance(&mut self, message: &AxisCommands<Header>) -> Result<(), String> {
        self.settle();
        if self.is_over() {
            return Ok(());
        }
        let Some(play) = &mut self.play else { return Err("tells of commands before it tells of settings".into()) };
        let told = message.commands()?;
        if !told.is_empty() {
            play.commands = told;
        }
        play.world.set_commands(&play.commands).map_err(|axis| format!("the commands do not fit axis {axis}"))?;
        play.sample.take(&play.world);
        let here = play.sample.snapshot.interval;
        if message.interval == here + 1 {
            play.world.advance();
            play.sample.take(&play.world);
            self.verdict.intervals += 1;
        } else if message.interval != here {
            self.verdict.gap = Some(format!("control interval {} follows {here} in the bag", message.interval));
            return Ok(());
        }
        if let Some((csv, path)) = &mut play.csv {
            csv.row(&play.sample).map_err(|e| format!("cannot write '{}': {e}", path.display()))?;
        }
        (self.verdict.states, self.verdict.stamp_ns) = (self.verdict.states + 1, play.sample.snapshot.stamp_ns);
        Ok(())
    }

    fn compare_digest(&mut self, recorded: u64) {
        let Some(play) = &self.play else { return };
        let s = &play.sample.snapshot;
        if state_digest(s) != recorded && self.suspicion.is_none() {
            let what = "the state is another one, in something that joint_states do not show: a pose, a twist or the contact \
                        forces of a link, or the energy";
            self.suspicion = Some(Difference { interval: s.interval, stamp_ns: s.stamp_ns, what: what.into() });
        }
    }

    fn compare_message(&mut self, relative: &str, cdr: &[u8]) {
        let Some(play) = &self.play else { return };
        let (stamp, here) = (stamp_ns(cdr), play.sample.snapshot.stamp_ns);
        if play.checks.knows(relative) && stamp.is_some_and(|stamp| stamp != here) {
            let stamp = stamp.unwrap_or_default();
            self.verdict.gap =
                Some(format!("{relative} of {stamp} ns follows the commands of {here} ns: messages are missing"));
            // What was suspected was of the state whose commands are missing.
            self.suspicion = None;
            return;
        }
        match play.checks.check(relative, cdr, (play.world.model(), &play.sample.snapshot)) {
            None => {}
            Some(Ok(())) => self.verdict.messages += 1,
            Some(Err(what)) => self.differ(what),
        }
    }

    fn differ(&mut self, what: String) {
        let s = self.play.as_ref().map(|p| &p.sample.snapshot);
        let (interval, stamp_ns) = s.map_or((0, 0), |s| (s.interval, s.stamp_ns));
        self.verdict.difference.get_or_insert(Difference { interval, stamp_ns, what });
    }

    /// All messages of the present state have come: what is suspected is what it is.
    fn settle(&mut self) {
        if let Some(suspicion) = self.suspicion.take() {
            self.verdict.difference.get_or_insert(suspicion);
        }
    }
}

impl Play {
    fn new(model: Arc<Model>, initial: State, settings: Settings, out: Option<PathBuf>) -> Result<Self, String> {
        let checks = Checks::new(&model);
        let mut world = World::new(model, settings)?;
        world.set_initial_state(initial);
        let open = |path: PathBuf| -> Result<_, String> {
            let failed = |e: std::io::Error| format!("cannot write '{}': {e}", path.display());
            let csv = CsvWriter::new(File::create(&path).map_err(failed)?, world.model()).map_err(failed)?;
            Ok((csv, path))
        };
        let csv = out.map(open).transpose()?;
        Ok(Self { sample: Sample::new(&world), commands: world.commands().to_vec(), world, checks, csv })
    }
}

fn json<T: DeserializeOwned>(e: &WorldEvent<Header, String>) -> Result<T, String> {
    serde_json::from_str(&e.data).map_err(|reason| format!("event {} at interval {}: {reason}", e.kind, e.interval))
}

/// Why the same texts have given another model.
fn other_model(b: &Beginning) -> String {
    let this = crate::record::story::Program::this();
    let changed: Vec<String> = changed(&b.origin).map(|f| f.display().to_string()).collect();
    match changed.is_empty() {
        false => format!("these files are not what they were when it was recorded: {}", changed.join(", ")),
        true => format!(
            "this program makes another model of the recorded texts: it was recorded by realnoid {} on {}, this is {} on {}",
            b.program.version, b.program.target, this.version, this.target
        ),
    }
}

fn changed(origin: &Origin) -> impl Iterator<Item = &PathBuf> {
    let other = |(file, then): &(&PathBuf, &Option<String>)| then.is_some() && file_digest(file) != **then;
    origin.meshes.iter().filter(other).map(|(file, _)| file)
}
