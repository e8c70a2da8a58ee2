//! Worlds that take turns on one thread, and share passes of the dynamics, have the bits that they have alone.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::cli::conformance::{Case, Outcome, Rung, files};
use realnoid::dynamics::{Asked, LaneKind, Workspace, aba_hybrid, own_turn, take_turns};
use realnoid::model::{Base, Bodies, JointType, Model};
use realnoid::world::{AxisCommand, EngineKind, Integrator, Settings, World};
use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;
use support::{ALL, Random, tree};

thread_local! {
    static ASKED: Cell<f64> = const { Cell::new(0.0) };
}

type Task<R> = Box<dyn FnOnce() -> R>;

fn kinds() -> impl Iterator<Item = LaneKind> {
    LaneKind::ALL.into_iter().filter(|kind| kind.is_available())
}

/// Tells how often it was asked.
fn clock() -> f64 {
    ASKED.set(ASKED.get() + 1.0);
    ASKED.get()
}

/// What the tasks return, in their order.
fn in_turns<R: 'static>(kind: LaneKind, count: usize, tasks: Vec<Task<R>>) -> Vec<R> {
    watched(kind, count, tasks).0
}

/// The same, and what they have asked for.
fn watched<R: 'static>(kind: LaneKind, count: usize, tasks: Vec<Task<R>>) -> (Vec<R>, Asked) {
    let mut results: Vec<Option<R>> = tasks.iter().map(|_| None).collect();
    let mut tasks = tasks.into_iter().enumerate();
    let next = || tasks.next().map(|(n, task)| move || (n, task()));
    let asked = take_turns((kind, count), clock, next, |(n, result)| results[n] = Some(result));
    (results.into_iter().map(Option::unwrap).collect(), asked)
}

fn humanoid(base: Base) -> Model {
    (*support::urdf::model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), base)).clone()
}

/// Robots of all joints, a chain, the default humanoid: what a world of each is made of.
fn robots() -> Vec<Arc<Model>> {
    let mixed: Vec<JointType> = (0..8).map(|i| ALL[i % 5]).collect();
    let mut all = vec![tree(&mixed, false, 3), tree(&[JointType::Revolute; 6], true, 4)];
    all.extend([humanoid(Base::Free), humanoid(Base::Fixed)]);
    all.into_iter().map(Arc::new).collect()
}

/// Steps of a world under commands that differ from seed to seed, from a state of its own; bits of all that it is then.
fn run(m: &Arc<Model>, integrator: Integrator, seed: u64, steps: u32) -> Vec<u64> {
    let settings = Settings { integrator, steps_per_interval: 2, ..Settings::default() };
    let mut w = World::new(m.clone(), settings).unwrap();
    let (mut rng, mut start) = (Random(seed), w.state().clone());
    (0..m.axes.len()).for_each(|axis| start.set_axis(m, axis, 0.5 * rng.unit(), rng.unit()));
    w.set_initial_state(start);
    let mut commands = w.commands().to_vec();
    for step in 0..steps {
        if step % 5 == 0 {
            commands.iter_mut().for_each(|command| {
                *command = match rng.next() % 4 {
                    0 => AxisCommand::IDLE,
                    1 => AxisCommand::servo(rng.unit()),
                    _ => AxisCommand::torque(20.0 * rng.unit()),
                }
            });
            w.set_commands(&commands).unwrap();
        }
        w.advance();
    }
    let (s, e, work) = (w.state(), w.energy(), w.work());
    let numbers = s.q.iter().chain(&s.v).chain(s.angles.as_flattened()).chain(w.efforts());
    let sums = [e.kinetic, e.potential, work.drives, work.losses, w.stats().halvings as f64, w.stats().steps as f64];
    numbers.chain(&sums).map(|x| x.to_bits()).collect()
}

/// 19 worlds of four robots, in any order: passes with lanes left over, of robots that differ, of axes that stand in one world and slide in
/// the other; some end long before the others.
#[test]
fn worlds_have_the_bits_that_they_have_alone() {
    let robots = robots();
    for (n, (_, integrator)) in Integrator::NAMES.iter().enumerate() {
        let task = |seed: u64| {
            let (m, integrator) = (robots[(seed as usize * 7 / 5) % robots.len()].clone(), *integrator);
            move || run(&m, integrator, seed, 20 + 10 * (seed as u32 % 4))
        };
        let alone: Vec<Vec<u64>> = (0..19).map(|seed| task(seed)()).collect();
        for (kind, count) in kinds().flat_map(|kind| [(kind, kind.width()), (kind, [2, 3, 11, 40][n % 4])]) {
            let tasks = (0..19).map(|seed| Box::new(task(seed)) as Task<_>).collect();
            let (results, asked) = watched(kind, count, tasks);
            assert!(results == alone, "{integrator:?}, {kind:?}, {count} at a time");
            // Of eight worlds of four robots, some two are of one.
            assert!(asked.all > 19 * 20 && (count < 8 || asked.together > 0), "{asked:?}");
        }
    }
}

/// All hard cases with all integrators: contacts, impacts, joints that break, bodies that rest or are damped.
#[test]
fn hard_cases_have_the_figures_that_they_have_alone() {
    let task = |file: &Path, integrator: Integrator| {
        let case = Case::read_at(file, Some(Rung { integrator, step_ns: 5_000_000 })).unwrap();
        let name = format!("{} with {integrator:?}", case.name);
        let figures = move || match case.run(EngineKind::Rbx) {
            Outcome::Done(run) => {
                let values: Vec<u64> = run.figures.iter().flat_map(|f| f.value.iter().map(|x| x.to_bits())).collect();
                (values, format!("{:?}", run.stats))
            }
            _ => panic!("it does not run"),
        };
        (name, figures)
    };
    let all = files(Path::new("tests/hard")).unwrap();
    let runs = || all.iter().flat_map(|file| Integrator::NAMES.map(|(_, integrator)| task(file, integrator)));
    let tasks = runs().map(|(_, figures)| Box::new(figures) as Task<_>).collect();
    let together = in_turns(LaneKind::best(), LaneKind::best().width(), tasks);
    assert!(together.len() >= 100);
    for ((name, figures), together) in runs().zip(together) {
        assert!(figures() == together, "{name}");
    }
}

/// What a common pass costs is not looked at here, but that there is one: worlds ask as often as they compute.
#[test]
fn turns_alternate() {
    let (m, order) = (Arc::new(tree(&[JointType::Revolute; 3], true, 5)), Rc::new(Cell::new(vec![])));
    let task = |n: usize| {
        let (m, order) = (m.clone(), order.clone());
        Box::new(move || {
            let mut w = World::new(m, Settings { integrator: Integrator::Rk4, ..Settings::default() }).unwrap();
            for _ in 0..3 {
                w.advance();
                let mut seen = order.take();
                seen.push(n);
                order.set(seen);
            }
        }) as Task<()>
    };
    in_turns(LaneKind::best(), 4, (0..4).map(task).collect());
    assert_eq!(order.take(), [0, 1, 2, 3].repeat(3));
    in_turns(LaneKind::best(), 1, (0..2).map(task).collect());
    assert_eq!(order.take(), [0, 0, 0, 1, 1, 1]);
}

#[test]
fn nothing_to_do_and_tasks_that_ask_for_nothing() {
    assert!(in_turns(LaneKind::best(), 8, Vec::<Task<i32>>::new()).is_empty());
    let tasks = (0..20).map(|n| Box::new(move || n * n) as Task<i32>).collect();
    assert_eq!(in_turns(LaneKind::best(), 8, tasks), (0..20).map(|n| n * n).collect::<Vec<i32>>());
}

/// A task that panics takes the others with it, and nobody asks through it any more.
#[test]
fn a_panic_is_passed_on() {
    let m = Arc::new(tree(&[JointType::Revolute; 3], true, 5));
    let alone = run(&m, Integrator::Rk4, 1, 5);
    let tasks = |n: u64| {
        let m = m.clone();
        Box::new(move || {
            run(&m, Integrator::Rk4, n, 3);
            assert!(n != 2, "of its own will");
        }) as Task<()>
    };
    let all = (0..6).map(tasks).collect();
    let panic = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| in_turns(LaneKind::best(), 4, all)));
    assert!(panic.unwrap_err().downcast_ref::<&str>() == Some(&"of its own will"));
    assert!(own_turn().is_none());
    assert_eq!(run(&m, Integrator::Rk4, 1, 5), alone);
}

/// Two tasks, one of 2 passes and one of 4, by a clock that is asked at the end of each turn and of each pass: of that of a pass both have
/// half while there are two of them. It was not theirs what passed before their beginning.
#[test]
fn time_is_that_of_the_task() {
    assert!(own_turn().is_none());
    let m = Arc::new(tree(&[JointType::Revolute; 3], true, 5));
    let task = |passes: usize| {
        let m = m.clone();
        Box::new(move || {
            let (mut ws, mut out) = (Workspace::new(&m), vec![0.0; m.nv]);
            for _ in 0..passes {
                aba_hybrid(&m, &mut ws, (&m.neutral(), &vec![0.0; m.nv]), [0.0; 3], &mut out);
            }
            own_turn().unwrap().before
        }) as Task<f64>
    };
    // Turns and halves of passes; then turns and whole passes.
    assert_eq!(in_turns(LaneKind::best(), 3, vec![task(2), task(4)]), [2.0 * 1.5, 2.0 * 1.5 + 2.0 * 2.0]);
    assert!(own_turn().is_none());
}

#[test]
fn bodies_are_shared_until_one_changes_its_own() {
    let m = humanoid(Base::Free);
    let bodies = Bodies::from((*m.bodies).clone());
    let made = |m: &Model| World::new(Arc::new(m.clone()), Settings::default()).unwrap();
    let (mut same, mut other) = (made(&m), m.clone());
    support::scale(&mut other, 3, 2.0);
    let mut other = made(&other);
    let mass = other.model().bodies[3].mass;
    assert!(!same.model().bodies.is_shared_with(&bodies) && same.model().bodies == bodies);
    same.share(&bodies);
    other.share(&bodies);
    assert!(same.model().bodies.is_shared_with(&bodies) && !other.model().bodies.is_shared_with(&bodies));
    assert!(other.model().bodies[3].mass == mass);
    let mut changed = bodies.clone();
    changed[3].mass += 1.0;
    assert!(same.model().bodies == bodies && changed != bodies && bodies[3].mass == m.bodies[3].mass);
}
