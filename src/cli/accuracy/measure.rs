//! Runs a case at a point of a ladder: how far it is from what is right, and what it costs.

use super::case::{Case, GRID, GRID_NS, Sample, Seat, Truth, sample};
use super::exact::Exact;
use super::fit::{Fit, diverges, fit};
use super::rung::{Ladder, Point, Rung, Wish};
use crate::cli::bench::cpu_seconds;
use crate::world::{EngineKind, Integrator, Settings, Stats, World};

/// A run that takes longer is not repeated, CPU s.
const ONCE: f64 = 1.0;
/// A run is repeated so often at most.
const REPEATS: u32 = 50;
/// A run of so many times fewer steps stands in for the reference in a hurry.
const QUICK: u32 = 8;

/// What came of one point.
#[derive(Clone, Debug)]
pub struct Run {
    /// Settings.
    pub point: Point,
    /// Root of the mean square over all instants, in the case's unit.
    pub rms: f64,
    /// Greatest.
    pub max: f64,
    /// Half-way, and at the end.
    pub at: [f64; 2],
    /// CPU s per simulated s, of the fastest repetition.
    pub cpu: f64,
    /// Not finite, or an error as large as the motion.
    pub diverged: bool,
    /// Of the world; nothing of other programs.
    pub stats: Stats,
    /// Warnings that the world gave.
    pub warnings: u64,
}

/// A curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Engine and integrator.
    pub label: String,
    /// In CSV.
    pub engine: String,
    /// In CSV; empty where there is no choice.
    pub integrator: String,
    /// What changes along it.
    pub ladder: Ladder,
    /// Of another program.
    pub peer: bool,
    /// From coarse to fine.
    pub runs: Vec<Run>,
}

impl Curve {
    /// Order, of a ladder of steps.
    pub fn fit(&self, size: f64, own: f64) -> Option<Fit> {
        let points: Vec<(f64, f64)> = self.runs.iter().map(|r| (r.point.step(), r.rms)).collect();
        if self.ladder == Ladder::Steps { fit(&points, size, own) } else { None }
    }

    /// The finest step that diverges, s, of a ladder of steps.
    pub fn diverges(&self) -> Option<f64> {
        diverges(self.runs.iter()).filter(|_| self.ladder == Ladder::Steps)
    }
}

/// What is right at all instants.
pub struct Reference {
    /// At the instants of the case.
    pub values: Vec<Sample>,
    /// In words.
    pub words: String,
    /// What it errs by (RMS), as far as a run with half as many steps tells; 0 of a closed form.
    pub own: f64,
}

/// A case with all its curves.
pub struct Measured {
    /// The case.
    pub case: Case,
    /// What it was compared with.
    pub reference: Reference,
    /// In the order of legends.
    pub curves: Vec<Curve>,
    /// Engines without a curve, and why.
    pub left_out: Vec<String>,
}

/// How thorough runs are.
#[derive(Clone, Copy, Debug)]
pub struct Care {
    /// CPU time to spend at least on timing, s.
    pub seconds: f64,
    /// A coarser reference.
    pub quick: bool,
}

impl Measured {
    /// Runs a case.
    ///
    /// # Errors
    /// Why it cannot be run.
    pub fn of(case: Case, wish: &Wish, care: Care) -> Result<Self, String> {
        let told = |reason: String| format!("case '{}': {reason}", case.name);
        let world = (case.make)().map_err(told)?;
        let seats = case.seats(world.model())?;
        let reference = reference(&case, &world, &seats, care).map_err(told)?;
        let (rungs, left_out) = wish.rungs(&case, &world);
        let mut curves = vec![];
        for rung in rungs {
            let mut runs = vec![];
            for point in &rung.points {
                let settings = rung.settings(world.settings(), point);
                let mut world = world.clone();
                world.set_settings(settings).map_err(told)?;
                runs.push(run(&case, &world, (&seats, &reference.values), (*point, care)));
            }
            curves.push(curve(&rung, runs));
        }
        Ok(Self { case, reference, curves, left_out })
    }
}

fn curve(rung: &Rung, runs: Vec<Run>) -> Curve {
    Curve {
        label: rung.label(),
        engine: rung.engine.name().into(),
        integrator: rung.integrator.map_or(String::new(), |i| i.name().into()),
        ladder: rung.ladder,
        peer: false,
        runs,
    }
}

/// What is right.
fn reference(case: &Case, world: &World, seats: &[Seat], care: Care) -> Result<Reference, String> {
    let (values, half, words) = match &case.truth {
        Truth::Closed { words, value } => {
            let values = value(&case.times());
            return Ok(Reference { values, words: format!("closed form: {words}"), own: 0.0 });
        }
        Truth::Exact { steps } => {
            let fine = |steps| exact(case, world, seats, steps);
            let (order, h) = (Exact::ORDER, GRID / f64::from(*steps));
            let words = format!("in twice the digits of f64; Gragg, Bulirsch, Stoer of order {order}, steps of {h} s");
            (fine(*steps)?, fine(steps / 2)?, words)
        }
        Truth::Own { integrator, steps_per_ms } => {
            let steps = if care.quick { steps_per_ms / QUICK } else { *steps_per_ms };
            let name = integrator.name();
            let fine = |steps| own(case, world, seats, (*integrator, steps));
            let words = format!("rbx, {name}, steps of {:.4e} s: {steps} in a millisecond", 1e-3 / f64::from(steps));
            (fine(steps)?, fine(steps / 2)?, words)
        }
    };
    let errors = errors(case, &values, &half);
    Ok(Reference { values, words, own: rms(&errors) })
}

fn exact(case: &Case, world: &World, seats: &[Seat], steps: u32) -> Result<Vec<Sample>, String> {
    let (mut state, mut world, mut snapshot) = (world.state().clone(), world.clone(), world.new_snapshot());
    let model = world.model().clone();
    let mut exact = Exact::new(&model, world.settings().gravity)?;
    let course = exact.run((&state.q, &state.v), (case.instants, GRID, steps));
    let one = |(q, v)| {
        (state.q, state.v) = (q, v);
        world.set_initial_state(state.clone());
        world.write_snapshot(&mut snapshot);
        sample(&snapshot, seats)
    };
    Ok(course.into_iter().map(one).collect())
}

fn own(case: &Case, world: &World, seats: &[Seat], how: (Integrator, u32)) -> Result<Vec<Sample>, String> {
    let mut world = world.clone();
    world.set_settings(Settings {
        engine: EngineKind::Rbx,
        integrator: how.0,
        control_interval_ns: 1_000_000,
        steps_per_interval: how.1,
        ..*world.settings()
    })?;
    let values = course(case, &mut world, Some(seats)).0;
    match values.iter().flatten().all(|x| x.is_finite()) {
        true => Ok(values),
        false => Err("the reference run is not finite".into()),
    }
}

/// Runs a case in a world at its start: the samples, if there are seats, and CPU time of commands and steps alone, s.
fn course(case: &Case, world: &mut World, seats: Option<&[Seat]>) -> (Vec<Sample>, f64) {
    let pieces = GRID_NS / world.settings().control_interval_ns;
    let mut snapshot = world.new_snapshot();
    let (mut values, mut cpu) = (vec![], 0.0);
    for k in 0..case.instants {
        let start = cpu_seconds();
        case.command(world, k);
        (0..pieces).for_each(|_| world.advance());
        cpu += cpu_seconds() - start;
        if let Some(seats) = seats {
            world.write_snapshot(&mut snapshot);
            values.push(sample(&snapshot, seats));
        }
    }
    (values, cpu)
}

fn run(case: &Case, start: &World, (seats, right): (&[Seat], &[Sample]), (point, care): (Point, Care)) -> Run {
    let mut world = start.clone();
    let (values, mut best) = course(case, &mut world, Some(seats));
    let (mut spent, mut repeats) = (best, 1);
    while spent < care.seconds && best < ONCE && repeats < REPEATS {
        let cpu = course(case, &mut start.clone(), None).1;
        (best, spent, repeats) = (best.min(cpu), spent + cpu, repeats + 1);
    }
    let warnings = world.new_snapshot().warnings;
    Run { stats: world.stats(), warnings, ..judged(case, (&values, right), (point, best)) }
}

/// Errors of samples; `cpu`: of the whole run, s.
pub(super) fn judged(case: &Case, (values, right): (&[Sample], &[Sample]), (point, cpu): (Point, f64)) -> Run {
    let errors = errors(case, values, right);
    let greatest = |a: f64, b: &f64| if *b > a || b.is_nan() { *b } else { a };
    let max = errors.iter().fold(0.0, greatest);
    let at = [errors.len().div_ceil(2), errors.len()].map(|n| errors.get(n.max(1) - 1).copied().unwrap_or(f64::NAN));
    let diverged = max.is_nan() || max > case.size;
    let (stats, warnings, cpu) = (Stats::default(), 0, cpu / case.duration());
    Run { point, rms: rms(&errors), max, at, cpu, diverged, stats, warnings }
}

fn errors(case: &Case, a: &[Sample], b: &[Sample]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| case.distance(x, y)).collect()
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt()
}
