//! `realnoid bench`: what one call costs.

use super::args::BenchArgs;
use super::base_by_name;
use super::load::load_or_say;
use super::stopwatch::wall_seconds;
use crate::dynamics::{
    AbaBatch, Kinematics, LaneKind, Limbs, Workspace, aba, aba_fused, aba_hybrid, aba_limbs, crba, kinematics, rnea,
    take_turns,
};
use crate::engine::State;
use crate::math::Vec3;
use crate::model::{Base, Model};
use crate::world::{AxisCommand, Integrator, Settings, World};
use serde_json::json;
use std::hint::black_box;
use std::process::ExitCode;
use std::sync::Arc;

/// Random states that the calls cycle through.
const STATES: usize = 64;
/// Calls between two readings of the clock.
const BATCH: usize = 256;

/// CPU time of this thread, s.
pub fn cpu_seconds() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

/// Measures and prints medians in µs per call.
pub fn run(args: &BenchArgs) -> ExitCode {
    if let Some(z) = args.drop {
        return super::drop::run(args, z);
    }
    let loaded = match load_or_say(args.packages.source(args.urdf.as_deref()), base_by_name(&args.base)) {
        Ok(loaded) => loaded,
        Err(failure) => return failure,
    };
    let m = &loaded.model;
    let rows = measure(m, args.seconds.max(0.001));
    super::say(&if args.json { as_json(m, &args.base, &rows) } else { as_table(m, &args.base, &rows) })
}

fn as_json(m: &Model, base: &str, rows: &[Row]) -> String {
    let us: serde_json::Map<String, serde_json::Value> =
        rows.iter().map(|r| (r.name.to_owned(), json!({"median": r.median, "low": r.low, "high": r.high}))).collect();
    let out = json!({"model": m.name, "base": base, "nv": m.nv, "axes": m.axes.len(), "us_per_call": us});
    format!("{out:#}\n")
}

fn as_table(m: &Model, base: &str, rows: &[Row]) -> String {
    let mut text = format!("{} ({base} base, {} velocities), µs per call, thread CPU time\n", m.name, m.nv);
    text += &format!("{:<34} {:>10} {:>10} {:>10}\n", "", "median", "10 %", "90 %");
    for r in rows {
        text += &format!("{:<34} {:>10.3} {:>10.3} {:>10.3}\n", r.name, r.median, r.low, r.high);
    }
    text
}

struct Row {
    name: &'static str,
    median: f64,
    low: f64,
    high: f64,
}

/// States, torques and results that the measured calls share.
struct Inputs {
    states: Vec<State>,
    tau: Vec<f64>,
    out: Vec<f64>,
    mass: Vec<f64>,
    gravity: [f64; 3],
}

impl Inputs {
    fn new(m: &Model) -> Self {
        let mut seed = 1u64;
        let mut random = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let states = (0..STATES).map(|_| random_state(m, &mut random)).collect();
        let tau = (0..m.nv).map(|_| random()).collect();
        let gravity = Settings::default().gravity;
        Self { states, tau, out: vec![0.0; m.nv], mass: vec![0.0; m.nv * m.nv], gravity }
    }
}

fn random_state(m: &Model, random: &mut impl FnMut() -> f64) -> State {
    let mut s = State::initial(m);
    if m.base == Base::Free {
        let q = nalgebra::Vector4::from_fn(|_, _| random()).normalize();
        s.set_base_pose(m, [random(), random(), random()], [q.x, q.y, q.z, q.w]);
        let mut vector = || Vec3::new(random(), random(), random());
        let (angular, linear) = (vector(), vector());
        s.set_base_twist(m, angular, linear);
    }
    for axis in 0..m.axes.len() {
        s.set_axis(m, axis, random(), random());
    }
    s
}

fn measure(m: &Arc<Model>, seconds: f64) -> Vec<Row> {
    let mut i = Inputs::new(m);
    let (mut ws, mut fused, mut kin) = (Workspace::new(m), Workspace::new(m), Kinematics::new(m));
    let mut rows = vec![
        timed("kinematics", seconds, |n| kinematics(m, &mut kin, &i.states[n].q, &i.states[n].v)),
        timed("rnea", seconds, |n| {
            rnea(m, &mut ws, (&i.states[n].q, &i.states[n].v), &i.tau, i.gravity, black_box(&mut i.out));
        }),
        timed("crba", seconds, |n| crba(m, &mut ws, &i.states[n].q, black_box(&mut i.mass))),
        timed("aba", seconds, |n| {
            aba(m, &mut ws, (&i.states[n].q, &i.states[n].v), &i.tau, i.gravity, black_box(&mut i.out));
        }),
    ];
    if aba_fused(m, &mut fused, (&i.states[0].q, &i.states[0].v), &i.tau, i.gravity, &mut i.out) {
        rows.push(timed("aba_fused", seconds, |n| {
            let s = &i.states[n];
            let _ = aba_fused(m, &mut fused, (&s.q, &s.v), &i.tau, i.gravity, black_box(&mut i.out));
        }));
    }
    if let Some(mut limbs) = Limbs::new(m) {
        rows.push(timed("aba_limbs", seconds, |n| {
            let (s, work) = (&i.states[n], (&mut ws, &mut limbs));
            aba_limbs(m, work, (&s.q, &s.v), &i.tau, i.gravity, black_box(&mut i.out));
        }));
    }
    for (name, copied, kind) in LANES {
        rows.extend(lanes(m, &i, (name, copied, kind), seconds));
    }
    rows.push(step("step_implicit_midpoint", m, (Integrator::ImplicitMidpoint, AxisCommand::IDLE), seconds));
    rows.push(step("step_semi_implicit_euler", m, (Integrator::SemiImplicitEuler, AxisCommand::IDLE), seconds));
    rows.push(step("step_rk4", m, (Integrator::Rk4, AxisCommand::IDLE), seconds));
    rows.push(step("step_servos_hold", m, (Integrator::ImplicitMidpoint, AxisCommand::servo(0.0)), seconds));
    rows.extend(turns(m, &i, seconds));
    rows
}

/// Calls of each robot that takes turns.
const TURNS: usize = 16 * BATCH;

/// Robots in turns, per robot: their hybrid dynamics, and their steps.
fn turns(m: &Arc<Model>, i: &Inputs, seconds: f64) -> Vec<Row> {
    let hybrid = || {
        let (m, states, gravity) = (m.clone(), i.states.clone(), i.gravity);
        move || {
            let (mut ws, mut out) = (Workspace::new(&m), vec![0.0; m.nv]);
            // As a step asks while nothing touches.
            ws.frugal = true;
            for s in states.iter().cycle().take(TURNS) {
                aba_hybrid(&m, &mut ws, (&s.q, &s.v), gravity, black_box(&mut out));
            }
        }
    };
    let steps = |integrator| {
        let settings = Settings { integrator, steps_per_interval: 1, ..Settings::default() };
        let fresh = World::new(m.clone(), settings);
        move || {
            let fresh = fresh.clone();
            move || {
                for mut world in fresh.iter().cycle().take(TURNS / BATCH).cloned() {
                    (0..BATCH).for_each(|_| world.advance());
                }
            }
        }
    };
    let rows = [
        in_turns("aba_turns_4", LaneKind::Four, seconds, hybrid),
        in_turns("aba_turns_8", LaneKind::Eight, seconds, hybrid),
        in_turns("step_implicit_midpoint_turns_8", LaneKind::Eight, seconds, steps(Integrator::ImplicitMidpoint)),
        in_turns("step_rk4_turns_8", LaneKind::Eight, seconds, steps(Integrator::Rk4)),
    ];
    rows.into_iter().flatten().collect()
}

/// As many robots as there are lanes, in turns as the worlds of a sweep: all that goes with it, per robot.
fn in_turns<F: FnOnce() + 'static>(
    name: &'static str,
    kind: LaneKind,
    seconds: f64,
    task: impl Fn() -> F,
) -> Option<Row> {
    let width = kind.is_available().then(|| kind.width())?;
    Some(sampled(name, seconds, TURNS * width, || {
        let mut tasks = std::iter::repeat_with(&task).take(width);
        take_turns((kind, width), wall_seconds, || tasks.next(), |()| {});
    }))
}

/// Rows of robots side by side, per robot: name, with copying each state in and each result out, how.
const LANES: [(&str, bool, LaneKind); 6] = [
    ("aba_lanes_4", false, LaneKind::Four),
    ("aba_lanes_4_fused", false, LaneKind::FourFused),
    ("aba_lanes_8", false, LaneKind::Eight),
    ("aba_lanes_8_fused", false, LaneKind::EightFused),
    ("aba_lanes_8_copied", true, LaneKind::Eight),
    ("aba_lanes_portable", false, LaneKind::Portable),
];
/// Stack frames by which lane kernels are moved from one batch to the next: they spill some kB there, and where that lies
/// relative to what they work on changes their time by a quarter.
const DEPTHS: usize = 8;

fn lanes(m: &Model, i: &Inputs, (name, copied, kind): (&'static str, bool, LaneKind), seconds: f64) -> Option<Row> {
    let mut batch = kind.is_available().then(|| AbaBatch::new(m, STATES, kind))?;
    for (n, s) in i.states.iter().enumerate() {
        batch.set(n, (&s.q, &s.v), &i.tau);
    }
    let (mut out, mut depth) = (vec![0.0; m.nv], 0);
    Some(timed(name, seconds, |n| {
        if copied {
            batch.set(n, (&i.states[n].q, &i.states[n].v), &i.tau);
        }
        if n == 0 {
            depth = (depth + 1) % DEPTHS;
            deeper(depth, &mut || black_box(&mut batch).solve(m, i.gravity));
        }
        if copied {
            batch.accelerations(n, black_box(&mut out));
        }
    }))
}

/// Calls with the stack further down by so many frames of about half a page.
#[inline(never)]
fn deeper(depth: usize, call: &mut dyn FnMut()) {
    let room = black_box([0u8; 448]);
    match depth {
        0 => call(),
        _ => deeper(depth - 1, call),
    }
    black_box(room);
}

/// A step of 1 ms from the initial state on; it starts anew after every batch, so that all batches do the same work.
fn step(name: &'static str, m: &Arc<Model>, (integrator, command): (Integrator, AxisCommand), seconds: f64) -> Row {
    let settings = Settings { integrator, steps_per_interval: 1, ..Settings::default() };
    let Ok(fresh) = World::new(m.clone(), settings) else { return Row { name, median: 0.0, low: 0.0, high: 0.0 } };
    let commands = vec![command; m.axes.len()];
    let mut world = fresh.clone();
    timed(name, seconds, |n| {
        if n == 0 {
            world = fresh.clone();
            let _ = world.set_commands(&commands);
        }
        world.advance();
    })
}

fn timed(name: &'static str, seconds: f64, mut call: impl FnMut(usize)) -> Row {
    sampled(name, seconds, BATCH, || (0..BATCH).for_each(|n| call(n % STATES)))
}

/// µs per call of batches of so many calls.
fn sampled(name: &'static str, seconds: f64, calls: usize, mut batch: impl FnMut()) -> Row {
    let mut times = vec![];
    let mut spent = 0.0;
    while spent < seconds || times.len() < 11 {
        let start = cpu_seconds();
        batch();
        let took = cpu_seconds() - start;
        spent += took;
        times.push(took * 1e6 / calls as f64);
    }
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
    Row { name, median: at(0.5), low: at(0.1), high: at(0.9) }
}
