//! One run of those that are compared.

use super::difference::{Differences, MEASURES, Worst, differences};
use crate::cli::bench::cpu_seconds;
use crate::cli::script::Script;
use crate::dynamics::{Kinematics, Momentum, kinematics, momentum_of};
use crate::model::{JointType, Model};
use crate::world::{EngineKind, Integrator, Settings, Snapshot, World};

/// W-5 at most; finer runs divide the control interval, too.
const STEPS_AT_MOST: u32 = 1000;

/// A world on its way.
pub(super) struct Contender {
    /// In tables, CSV and JSON.
    pub name: String,
    pub engine: EngineKind,
    pub world: World,
    script: Script,
    /// How often the world is advanced in a control interval.
    pieces: u32,
    /// The present state.
    pub snapshot: Snapshot,
    /// CPU time of the steps, s.
    pub cpu: f64,
    /// All values looked at were finite.
    pub finite: bool,
    pub momentum: Momentum,
    /// J, kinetic and potential.
    pub energy: f64,
    pub record: Record,
}

/// What is remembered of a run against the reference.
#[derive(Default)]
pub(super) struct Record {
    /// For each of [`MEASURES`].
    pub measures: [Course; MEASURES.len()],
    /// Greatest difference of the energy, J.
    pub energy: f64,
    /// Of the linear momentum of what floats, N·s.
    pub momentum: f64,
    /// Of the angular momentum of what floats, N·m·s.
    pub angular: f64,
}

/// Of one kind of difference.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Course {
    pub last: Worst,
    pub greatest: Worst,
    /// Time of the greatest, s.
    pub greatest_at: f64,
    /// When the bound was first exceeded, s, and by what.
    pub beyond: Option<(f64, Worst)>,
}

impl Course {
    fn take(&mut self, w: Worst, time: f64, within: f64) {
        self.last = w;
        if w.value > self.greatest.value || w.value.is_nan() {
            (self.greatest, self.greatest_at) = (w, time);
        }
        if self.beyond.is_none() && (w.value > within || w.value.is_nan()) {
            self.beyond = Some((time, w));
        }
    }
}

impl Contender {
    /// The same start in an engine.
    ///
    /// # Errors
    /// What the engine cannot take.
    pub fn new(name: &str, start: &World, script: &Script, settings: Settings) -> Result<Self, String> {
        let mut world = start.clone();
        world.set_settings(settings).map_err(|reason| format!("{name}: {reason}"))?;
        let snapshot = world.new_snapshot();
        let mut contender = Self {
            name: name.into(),
            engine: settings.engine,
            script: script.clone(),
            pieces: 1,
            snapshot,
            cpu: 0.0,
            finite: true,
            momentum: Momentum::default(),
            energy: 0.0,
            record: Record::default(),
            world,
        };
        contender.look();
        Ok(contender)
    }

    /// rbx with RK4 and steps `finer` times shorter; `finer` is a power of two.
    ///
    /// # Errors
    /// Steps that are too short.
    pub fn fine(name: &str, start: &World, script: &Script, finer: u32) -> Result<Self, String> {
        let (settings, pieces) = refined(start.settings(), finer);
        let mut contender = Self::new(name, start, script, settings)?;
        contender.pieces = pieces;
        Ok(contender)
    }

    /// Makes a control interval.
    pub fn advance(&mut self, interval: u64) {
        self.script.apply(interval, &mut self.world);
        let start = cpu_seconds();
        (0..self.pieces).for_each(|_| self.world.advance());
        self.cpu += cpu_seconds() - start;
        self.look();
    }

    fn look(&mut self) {
        self.world.write_snapshot(&mut self.snapshot);
        let s = &self.snapshot;
        self.energy = s.kinetic_energy + s.potential_energy;
        self.momentum = of_what_floats(&self.world);
        let momenta = self.momentum.linear.iter().chain(self.momentum.angular.iter());
        self.finite &= s.finite && self.energy.is_finite() && momenta.chain(&s.position).all(|x| x.is_finite());
    }

    /// Takes the present differences from the reference.
    pub fn measure(&mut self, reference: &Self, links: &[usize], within: f64) -> Differences {
        let now = differences(&self.snapshot, &reference.snapshot, links);
        let time = reference.world.time();
        let r = &mut self.record;
        r.measures.iter_mut().zip(now).for_each(|(course, worst)| course.take(worst, time, within));
        let (p, q) = (&self.momentum, &reference.momentum);
        r.energy = greater(r.energy, (self.energy - reference.energy).abs());
        r.momentum = greater(r.momentum, (p.linear - q.linear).norm());
        r.angular = greater(r.angular, (p.angular - q.angular).norm());
        now
    }

    /// Length of a step, s.
    pub fn step(&self) -> f64 {
        let s = self.world.settings();
        s.control_interval_ns as f64 * 1e-9 * s.time_scale / f64::from(s.steps_per_interval)
    }
}

/// As `f64::max`, but what is not a number stays.
fn greater(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// Settings of a finer run, and into how many pieces the control interval is divided because it can have so many steps at most. A
/// smaller time scale makes the pieces: powers of two divide it without rounding.
fn refined(s: &Settings, finer: u32) -> (Settings, u32) {
    let fits = |pieces: &u32| s.steps_per_interval * (finer / pieces) <= STEPS_AT_MOST;
    let pieces = (0..=finer.trailing_zeros()).map(|n| 1 << n).find(fits).unwrap_or(finer);
    let settings = Settings {
        engine: EngineKind::Rbx,
        integrator: Integrator::Rk4,
        steps_per_interval: s.steps_per_interval * (finer / pieces),
        time_scale: s.time_scale / f64::from(pieces),
        ..*s
    };
    (settings, pieces)
}

/// The momentum of the bodies whose chain of joints begins with a floating one, about their common centre of mass.
fn of_what_floats(world: &World) -> Momentum {
    let (m, s) = (world.model(), world.state());
    let floating = floating_bodies(m);
    if floating.is_empty() {
        return Momentum::default();
    }
    let mut k = Kinematics::new(m);
    kinematics(m, &mut k, &s.q, &s.v);
    momentum_of(m, &k, floating.into_iter())
}

/// Bodies that nothing but contacts connects with the world.
pub(super) fn floating_bodies(m: &Model) -> Vec<usize> {
    let mut floats = vec![false; m.bodies.len()];
    for i in 1..m.bodies.len() {
        let b = &m.bodies[i];
        floats[i] = b.joint == JointType::Floating || floats[b.parent];
    }
    (1..m.bodies.len()).filter(|i| floats[*i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finer_run_has_steps_that_are_shorter_by_just_that() {
        for steps in [1, 5, 15, 16, 100, 1000] {
            for finer in [1, 2, 32, 64] {
                let coarse = Settings { steps_per_interval: steps, time_scale: 0.7, ..Settings::default() };
                let (s, pieces) = refined(&coarse, finer);
                assert!(s.check().is_ok() && s.steps_per_interval * pieces == steps * finer);
                assert_eq!(s.time_scale * f64::from(pieces), coarse.time_scale);
            }
        }
    }

    #[test]
    fn the_first_time_beyond_the_bound_is_kept() {
        let mut c = Course::default();
        let values = [0.0, 0.5, 2.0, 3.0, 1.0];
        for (i, value) in values.into_iter().enumerate() {
            c.take(Worst { value, index: i }, i as f64, 1.0);
        }
        assert_eq!(c.beyond, Some((2.0, Worst { value: 2.0, index: 2 })));
        assert_eq!((c.greatest.value, c.greatest_at, c.last.value), (3.0, 3.0, 1.0));
    }
}
