//! `realnoid effects`: what each effect of a scene costs, and what leaving it out would change.

mod args;
mod count;
mod measure;
mod show;

use super::args::RunArgs;
use super::start::Start;
use crate::model::{Kind, Listed, Model};
use crate::world::World;
use count::Counts;
use measure::{Error, Time};
use std::process::ExitCode;
use std::sync::Arc;

pub use args::EffectsArgs;

/// One effect with its price; `None` where it has none or nobody could count it.
struct Row {
    pub listed: Listed,
    /// Per physics step: with the effect, less without it.
    pub instructions: Option<f64>,
    pub time: Option<Time>,
    /// Of a run without it.
    pub error: Option<Error>,
}

/// The price list of a scene.
struct Prices {
    pub scene: String,
    /// Physics steps that were counted and timed.
    pub steps: u64,
    /// Simulated time of the runs that errors are taken from, s.
    pub seconds: f64,
    /// Of a step with all that the scene calls for.
    pub instructions: Option<f64>,
    pub ns: f64,
    pub rows: Vec<Row>,
    /// Why instructions were not counted.
    pub uncounted: Option<String>,
}

/// Measures and prints. Exit code 1: not loaded, 2: wrong arguments.
pub fn run(args: &EffectsArgs) -> ExitCode {
    let start = match Start::new(&run_args(args), None, None) {
        Ok(start) => start,
        Err((code, reason)) => {
            eprintln!("error: {}", reason.trim_end());
            return ExitCode::from(code);
        }
    };
    if !(args.seconds.is_finite() && args.seconds > 0.0) {
        eprintln!("error: --seconds {}: must be a finite number of seconds above 0", args.seconds);
        return ExitCode::from(2);
    }
    let full = start.world;
    if args.count {
        let make = |effect: Option<&str>| without(&full, effect);
        count::count_here(make, &in_order(&full.model().listed_effects()), intervals(args, &full));
        return ExitCode::SUCCESS;
    }
    start.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    let prices = prices(args, &full);
    super::say(&match (args.json, args.markdown) {
        (true, _) => show::json(&prices),
        (_, true) => show::markdown(&prices),
        _ => show::table(&prices),
    })
}

fn prices(args: &EffectsArgs, full: &World) -> Prices {
    let (listed, intervals) = (full.model().listed_effects(), intervals(args, full));
    let steps = intervals * u64::from(full.settings().steps_per_interval);
    let counted = if args.no_count { Err("--no-count".into()) } else { count::counts(&in_order(&listed), steps) };
    let (counts, uncounted) = match counted {
        Ok(counts) => (Some(counts), None),
        Err(reason) => (None, Some(reason)),
    };
    let in_run: Vec<&str> = listed.iter().filter(|l| is_switched(l) && l.on).map(|l| l.effect.name).collect();
    let others: Vec<World> = in_run.iter().filter_map(|name| without(full, Some(name))).collect();
    let (ns, times) = measure::times(full, &others, intervals, args.rounds);
    let errors = measure::errors(full, &others, args.seconds);
    let row = |listed: Listed| {
        let at = in_run.iter().position(|name| *name == listed.effect.name);
        Row {
            instructions: counts.as_ref().and_then(|c: &Counts| c.of(listed.effect.name)),
            time: at.and_then(|i| times.get(i)).copied(),
            error: at.and_then(|i| errors.get(i)).cloned(),
            listed,
        }
    };
    let rows = listed.into_iter().map(row).collect();
    let instructions = counts.as_ref().map(|c| c.full);
    Prices { scene: scene_name(args), steps, seconds: args.seconds, instructions, ns, rows, uncounted }
}

fn is_switched(l: &Listed) -> bool {
    l.effect.kind == Kind::Switched
}

/// Those that can be switched, what nothing calls for first: their worlds are of the same size as that with everything, and
/// leave the heap as they found it.
fn in_order(listed: &[Listed]) -> Vec<&'static str> {
    let of = |on: bool| listed.iter().filter(move |l| is_switched(l) && l.on == on).map(|l| l.effect.name);
    of(false).chain(of(true)).collect()
}

/// The same start with the same commands, without an effect. `None` if there is no such world.
fn without(full: &World, effect: Option<&str>) -> Option<World> {
    let mut model = Model::clone(full.model());
    let known = effect.is_none_or(|name| model.effects.switch(name, false));
    let mut world = World::new(Arc::new(model), *full.settings()).ok().filter(|_| known)?;
    world.set_initial_state(full.state().clone());
    world.set_commands(full.commands()).ok()?;
    Some(world)
}

/// Control intervals to count and time.
fn intervals(args: &EffectsArgs, full: &World) -> u64 {
    u64::from(args.steps.div_ceil(full.settings().steps_per_interval))
}

fn scene_name(args: &EffectsArgs) -> String {
    let shown = |path: &std::path::Path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let mut parts: Vec<String> = args.start.urdf.iter().chain(&args.start.scene).map(|path| shown(path)).collect();
    parts.extend(args.start.base.iter().map(|base| format!("{base} base")));
    parts.extend(args.start.ground.then(|| "on the ground".into()));
    parts.extend(args.start.set.iter().map(|set| format!("{set} at the start")));
    parts.extend(args.start.servo.iter().map(|set| format!("servo {set}")));
    parts.extend(args.start.effort.iter().map(|set| format!("effort {set}")));
    parts.join(", ")
}

fn run_args(args: &EffectsArgs) -> RunArgs {
    RunArgs { start: args.start.clone(), duration: args.seconds, ..RunArgs::default() }
}
