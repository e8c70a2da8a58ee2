//! A case on an engine.

use super::case::{Case, Expectation, When};
use super::quantity::{Beginning, Quantity};
use crate::cli::bench::cpu_seconds;
use crate::math::Vec3;
use crate::world::{EngineKind, Settings, Snapshot, Stats, World};

/// An engine that is known to be beyond its tolerance may be so many times further away than its case says. (It may be nearer: what a contact that
/// chatters shows at an instant is different on another processor.)
pub const DRIFT: f64 = 2.0;

/// What became of a case on an engine.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// It cannot do these capabilities.
    Skipped(Vec<&'static str>),
    /// It is not in this program; how to get it.
    NotBuilt(String),
    /// It does not take the scene, and why.
    Refused(String),
    /// It ran.
    Done(Run),
}

/// A case that ran.
#[derive(Clone, Debug)]
pub struct Run {
    /// One for each expectation.
    pub figures: Vec<Figure>,
    /// CPU time per simulated second, s.
    pub cpu: f64,
    /// What the engine counted.
    pub stats: Stats,
}

/// A quantity beside theory, at the instant where it misses it by most, compared with what is allowed there.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// s.
    pub at: f64,
    /// As simulated; a single number is the first of the three.
    pub value: Vec3,
    /// As theory says.
    pub should: Vec3,
    /// Length of the difference.
    pub error: f64,
    /// What it may be.
    pub allowed: f64,
    /// What that makes.
    pub verdict: Verdict,
}

/// What a figure makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The error is allowed.
    Within,
    /// It is not, as the case says.
    Known,
    /// It is not.
    Beyond,
    /// It is, though the case says that it is not.
    Mended,
}

impl Verdict {
    /// In JSON and CSV.
    pub fn name(self) -> &'static str {
        match self {
            Self::Within => "within",
            Self::Known => "known",
            Self::Beyond => "beyond",
            Self::Mended => "mended",
        }
    }
}

impl Figure {
    /// The error, as a multiple of what is allowed.
    pub fn share(&self) -> f64 {
        if self.error == 0.0 { 0.0 } else { self.error / self.allowed }
    }
}

impl Outcome {
    /// True if the case fails: the engine does not take it, or is beyond a tolerance and the case does not say so.
    pub fn fails(&self) -> bool {
        match self {
            Self::Skipped(_) | Self::NotBuilt(_) => false,
            Self::Refused(_) => true,
            Self::Done(run) => run.figures.iter().any(|f| f.verdict == Verdict::Beyond),
        }
    }
}

impl Case {
    /// Runs it on an engine.
    pub fn run(&self, engine: EngineKind) -> Outcome {
        if let Err(how) = engine.available() {
            return Outcome::NotBuilt(how);
        }
        let lacks = self.lacks(engine);
        if !lacks.is_empty() {
            return Outcome::Skipped(lacks);
        }
        let made = World::new(self.model.clone(), Settings { engine, ..self.settings });
        match made {
            Ok(mut world) => {
                world.set_initial_state(self.initial.clone());
                Outcome::Done(self.simulate(world))
            }
            Err(reason) => Outcome::Refused(reason),
        }
    }

    fn simulate(&self, mut world: World) -> Run {
        let (engine, mut script, start) = (world.settings().engine, self.script.clone(), Beginning::of(&world));
        let mut snapshot = world.new_snapshot();
        let mut watches: Vec<Watch> = self.expectations.iter().map(Watch::new).collect();
        let mut cpu = 0.0;
        for interval in 0..=self.intervals {
            world.write_snapshot(&mut snapshot);
            watches.iter_mut().for_each(|w| w.look(engine, (interval, &world), &snapshot, &start));
            if interval < self.intervals {
                script.apply(interval, &mut world);
                let before = cpu_seconds();
                world.advance();
                cpu += cpu_seconds() - before;
            }
        }
        let figures = watches.into_iter().map(|w| w.figure(engine, world.time())).collect();
        Run { figures, cpu: if self.intervals > 0 { cpu / world.time() } else { 0.0 }, stats: world.stats() }
    }
}

/// Watches one quantity while a world moves.
struct Watch<'a> {
    of: &'a Expectation,
    /// The worst of the instants.
    worst: Option<Figure>,
    /// The extremum, and its time.
    extremum: Option<(f64, f64)>,
    /// Time and position of an axis before, and how often it has passed 0.
    before: Option<(f64, f64)>,
    crossings: u32,
    crossed: f64,
}

impl<'a> Watch<'a> {
    fn new(of: &'a Expectation) -> Self {
        Self { of, worst: None, extremum: None, before: None, crossings: 0, crossed: f64::NAN }
    }

    fn look(&mut self, engine: EngineKind, (interval, w): (u64, &World), s: &Snapshot, start: &Beginning) {
        let crossing = self.of.probe.about.quantity == Quantity::CrossingTime;
        let time = w.time();
        let due = match &self.of.when {
            _ if crossing => true,
            When::At(instants) => instants.contains(&interval),
            When::Greatest([from, to]) | When::Least([from, to]) => (from..=to).contains(&&interval),
        };
        if !due {
            return;
        }
        let value = if s.finite { self.of.probe.read(w, s, start) } else { Vec3::repeat(f64::NAN) };
        match self.of.when {
            _ if crossing => self.cross(time, value.x),
            When::At(_) => self.take(self.of.figure(engine, time, value)),
            When::Greatest(_) => self.reach(time, value.x, 1.0),
            When::Least(_) => self.reach(time, value.x, -1.0),
        }
    }

    /// Keeps the worse of two; what is not a number is worst.
    fn take(&mut self, f: Figure) {
        if self.worst.is_none_or(|worst| worst.share() < f.share() || f.share().is_nan()) {
            self.worst = Some(f);
        }
    }

    fn reach(&mut self, time: f64, value: f64, sign: f64) {
        let further = |before: f64| !(sign * value <= sign * before || before.is_nan());
        if self.extremum.is_none_or(|(_, before)| further(before)) {
            self.extremum = Some((time, value));
        }
    }

    fn cross(&mut self, time: f64, value: f64) {
        let before = self.before.replace((time, value));
        let Some((earlier, from)) = before.filter(|(_, from)| from * value < 0.0 || (value == 0.0 && *from != 0.0))
        else {
            return;
        };
        self.crossings += 1;
        if self.crossings == self.of.count {
            self.crossed = earlier + (time - earlier) * from / (from - value);
        }
    }

    fn figure(self, engine: EngineKind, end: f64) -> Figure {
        let one = |x: f64| Vec3::new(x, 0.0, 0.0);
        let at_end = |value: f64| self.of.figure(engine, end, one(value));
        if self.of.probe.about.quantity == Quantity::CrossingTime {
            return at_end(self.crossed);
        }
        self.worst.unwrap_or_else(|| at_end(self.extremum.map_or(f64::NAN, |(_, value)| value)))
    }
}

impl Expectation {
    fn figure(&self, engine: EngineKind, at: f64, value: Vec3) -> Figure {
        let mut names = self.names.clone();
        names.set("t", at);
        let should = self.should(&names);
        let error = (value - should).norm();
        let allowed = self.tolerance(engine).map_or(f64::NAN, |f| f.value(&names));
        let verdict = match self.beyond.get(engine.name()) {
            // What is not a number is not within.
            None if error <= allowed => Verdict::Within,
            Some(_) if error <= allowed => Verdict::Mended,
            Some(known) if error <= DRIFT * known.error => Verdict::Known,
            _ => Verdict::Beyond,
        };
        Figure { at, value, should, error, allowed, verdict }
    }
}
