//! A rung: an engine with an integrator, and the ladder of settings on which its accuracy and its price climb.

use super::case::{Case, GRID_NS};
use crate::world::{EngineKind, Integrator, Settings, World};

/// Of the ladder of steps, if none are given: 8 ms … 0.125 ms by halves, s.
pub const STEPS: [f64; 7] = [0.008, 0.004, 0.002, 0.001, 0.000_5, 0.000_25, 0.000_125];
/// Of the same, in a hurry.
const QUICK_STEPS: [f64; 3] = [0.004, 0.002, 0.001];
/// Of the ladder of solver iterations (W-6).
pub const ITERATIONS: [u32; 7] = [1, 2, 5, 10, 20, 50, 100];
/// Step on that ladder, s.
pub const ITERATED_STEP: f64 = 0.001;
/// Control interval of a ladder of steps, ns: coarse steps fit into it, so that the steps in an interval (W-5) are the ladder.
const INTERVAL_NS: i64 = 8_000_000;
/// The shortest control interval that a world takes, ns.
const LEAST_INTERVAL_NS: i64 = 1000;
/// W-5 at most.
const MOST_STEPS: i64 = 1000;

/// Of the ladder of accuracies, where the integrator chooses its pieces itself.
pub const ACCURACIES: [f64; 10] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12];
/// Of the same, in a hurry.
const QUICK_ACCURACIES: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Control interval on that ladder, ns, with one step in it, where commands come or the solver iterates. Elsewhere it is as long as from one
/// instant that is looked at to the next: the method chooses its pieces itself.
const COMMANDED_INTERVAL_NS: i64 = 10_000_000;

/// What is changed from point to point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ladder {
    /// The step: steps per control interval (W-5).
    Steps,
    /// What the integrator may err by, at one step per control interval.
    Accuracy,
    /// Iterations of the solver (W-6) at a step of [`ITERATED_STEP`].
    Iterations,
}

impl Ladder {
    /// In tables and CSV.
    pub fn name(self) -> &'static str {
        match self {
            Self::Steps => "step",
            Self::Accuracy => "accuracy",
            Self::Iterations => "iterations",
        }
    }
}

/// One point of a ladder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Control interval, ns.
    pub interval_ns: i64,
    /// W-5.
    pub steps: u32,
    /// W-6.
    pub iterations: u32,
    /// Of the integrator that has one.
    pub accuracy: f64,
}

impl Point {
    /// Step, s.
    pub fn step(&self) -> f64 {
        self.interval_ns as f64 * 1e-9 / f64::from(self.steps)
    }

    /// With steps of `h` (s) and the default iterations.
    ///
    /// # Errors
    /// Names a step that does not divide 0.04 s.
    pub fn of_step(h: f64) -> Result<Self, String> {
        let Settings { solver_iterations: iterations, accuracy, .. } = Settings::default();
        let divides = |ns: i64| {
            let steps = (ns as f64 * 1e-9 / h).round();
            let fits =
                (1.0..=MOST_STEPS as f64).contains(&steps) && (steps * h / (ns as f64 * 1e-9) - 1.0).abs() < 1e-9;
            fits.then_some(Self { interval_ns: ns, steps: steps as u32, iterations, accuracy })
        };
        let intervals = [INTERVAL_NS, GRID_NS, (h * 1e9).round() as i64, INTERVAL_NS / 80];
        let found = intervals.into_iter().filter(|ns| *ns >= LEAST_INTERVAL_NS && GRID_NS % ns == 0).find_map(divides);
        found.ok_or_else(|| {
            format!("--dt {h}: must be a step in s of which a whole number makes 0.04 s, from 1e-7 to 0.04 s")
        })
    }
}

/// A curve in a diagram.
#[derive(Clone, Debug)]
pub struct Rung {
    /// Engine.
    pub engine: EngineKind,
    /// Of engines that leave the choice.
    pub integrator: Option<Integrator>,
    /// What changes along the curve.
    pub ladder: Ladder,
    /// From coarse to fine.
    pub points: Vec<Point>,
}

impl Rung {
    /// In legends: engine and integrator.
    pub fn label(&self) -> String {
        match self.integrator {
            Some(i) => format!("{} {}", self.engine.name(), i.name()),
            None => self.engine.name().into(),
        }
    }

    /// Settings of a point over those of the case.
    pub fn settings(&self, s: &Settings, p: &Point) -> Settings {
        Settings {
            engine: self.engine,
            integrator: self.integrator.unwrap_or_default(),
            control_interval_ns: p.interval_ns,
            steps_per_interval: p.steps,
            solver_iterations: p.iterations,
            accuracy: p.accuracy,
            ..*s
        }
    }
}

/// What is asked for: which engines, integrators and steps.
#[derive(Clone, Debug)]
pub struct Wish {
    /// Engines.
    pub engines: Vec<EngineKind>,
    /// Of rbx.
    pub integrators: Vec<Integrator>,
    /// Points of a ladder of steps.
    pub steps: Vec<Point>,
    /// Of the ladder of accuracies.
    pub accuracies: Vec<f64>,
    /// Of W-6.
    pub iterations: Vec<u32>,
}

impl Wish {
    /// Of the names of engines and integrators and of steps (s); empty: all.
    ///
    /// # Errors
    /// Names what does not exist.
    pub fn new(engines: &[String], integrators: &[String], (dt, quick): (&[f64], bool)) -> Result<Self, String> {
        let engines =
            crate::cli::compare::kinds(engines).map_err(|reason| reason.replace("--engine ", "--engines "))?;
        let by_name =
            |name: &String| crate::cli::scene::integrator(name).map_err(|reason| format!("--integrators: {reason}"));
        let integrators = match integrators.is_empty() {
            true => Integrator::NAMES.iter().map(|(_, i)| *i).collect(),
            false => integrators.iter().map(by_name).collect::<Result<_, _>>()?,
        };
        let dt = match (dt.is_empty(), quick) {
            (false, _) => dt,
            (true, true) => &QUICK_STEPS[..],
            (true, false) => &STEPS[..],
        };
        let mut steps = dt.iter().map(|h| Point::of_step(*h)).collect::<Result<Vec<_>, _>>()?;
        steps.sort_by(|a, b| b.step().total_cmp(&a.step()));
        let iterations = if quick { vec![1, 10] } else { ITERATIONS.to_vec() };
        let accuracies = if quick { QUICK_ACCURACIES.to_vec() } else { ACCURACIES.to_vec() };
        Ok(Self { engines, integrators, steps, accuracies, iterations })
    }

    /// The curves of a case, and why an engine has none.
    pub fn rungs(&self, case: &Case, world: &World) -> (Vec<Rung>, Vec<String>) {
        let (mut rungs, mut left_out) = (vec![], vec![]);
        for engine in &self.engines {
            if let Err(reason) = takes(world, *engine) {
                left_out.push(format!("{}: {reason}", engine.name()));
                continue;
            }
            let chosen: Vec<Option<Integrator>> = match engine.capabilities().integrators {
                true => self.integrators.iter().copied().map(Some).collect(),
                false => vec![None],
            };
            let of = |integrator, ladder, points| Rung { engine: *engine, integrator, ladder, points };
            rungs.extend(chosen.iter().map(|i| match i {
                Some(Integrator::Extrapolation) => of(*i, Ladder::Accuracy, self.accurate(case)),
                _ => of(*i, Ladder::Steps, self.steps.clone()),
            }));
            if case.iterates {
                // What the iterations give does not depend on the integrator: where something touches, RK4 falls back.
                rungs.extend(chosen.first().map(|i| of(*i, Ladder::Iterations, self.iterated())));
            }
        }
        rungs.sort_by_key(|r| r.ladder == Ladder::Iterations);
        (rungs, left_out)
    }

    fn iterated(&self) -> Vec<Point> {
        let (steps, accuracy) = (8, Settings::default().accuracy);
        let at = |n: &u32| Point { interval_ns: INTERVAL_NS, steps, iterations: *n, accuracy };
        self.iterations.iter().map(at).collect()
    }

    fn accurate(&self, case: &Case) -> Vec<Point> {
        let iterations = Settings::default().solver_iterations;
        let interval_ns = if case.orders.is_some() || case.iterates { COMMANDED_INTERVAL_NS } else { GRID_NS };
        let at = |x: &f64| Point { interval_ns, steps: 1, iterations, accuracy: *x };
        self.accuracies.iter().map(at).collect()
    }
}

/// Whether an engine can have the scene.
fn takes(world: &World, engine: EngineKind) -> Result<(), String> {
    if !engine.capabilities().joints && !world.model().axes.is_empty() {
        return Err("it has no joints".into());
    }
    world.clone().set_settings(Settings { engine, ..*world.settings() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_divide_the_instants() {
        for h in STEPS.into_iter().chain([0.04, 0.02, 0.01, 0.005, 1e-4, 1e-5, 1e-6, 1e-7]) {
            let p = Point::of_step(h).unwrap();
            assert!((p.step() / h - 1.0).abs() < 1e-9 && GRID_NS % p.interval_ns == 0 && p.steps <= 1000, "{h}: {p:?}");
        }
        for h in [0.003, 0.05, 1e-9, 0.0, -0.001, f64::NAN] {
            assert!(Point::of_step(h).unwrap_err().contains("--dt"), "{h}");
        }
    }
}
