//! The hot path allocates nothing: a counting allocator watches this thread.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::cli::load::{Source, load};
use realnoid::cli::scene::{Scene, Spare, assemble};
use realnoid::model::Base;
use realnoid::world::{AxisCommand, Integrator, Settings, World};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call goes on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|c| c.set(c.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        COUNT.with(|c| c.set(c.get() + 1));
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn counted(work: impl FnOnce()) -> u64 {
    let before = COUNT.with(Cell::get);
    work();
    COUNT.with(Cell::get) - before
}

#[test]
fn the_counter_counts() {
    assert_eq!(counted(|| drop(std::hint::black_box(vec![1u8; 100]))), 2);
}

/// 1000 steps of the default humanoid with servos, torques, stops and friction, snapshots and new commands: none.
#[test]
fn a_thousand_steps_allocate_nothing() {
    for base in [Base::Fixed, Base::Free] {
        for integrator in [Integrator::SemiImplicitEuler, Integrator::Rk4, Integrator::Extrapolation] {
            let model = load(Source::default(), base).unwrap_or_else(|report| panic!("{report}")).model;
            let settings = Settings { integrator, steps_per_interval: 1, ..Settings::default() };
            let mut world = World::new(model.clone(), settings).unwrap();
            let mut snapshot = world.new_snapshot();
            let mut commands = world.commands().to_vec();
            let n = counted(|| {
                for step in 0..1000 {
                    let axis = step % commands.len();
                    commands[axis] = if step % 3 == 0 { AxisCommand::servo(0.1) } else { AxisCommand::torque(50.0) };
                    world.set_commands(&commands).unwrap();
                    world.advance();
                    world.write_snapshot(&mut snapshot);
                }
                world.reset();
            });
            assert_eq!(n, 0, "{base:?} {integrator:?}");
            assert_eq!(snapshot.stats.steps, 1000);
        }
    }
}

/// Contacts, damped bodies and snapshots of both allocate nothing once there have been as many contacts before.
#[test]
fn contacts_and_damped_bodies_allocate_nothing_once_warm() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/config/leg_and_ball.yaml"));
    let scene = Scene::read(Some(path)).unwrap();
    let stand = (Base::Fixed, scene.robot.pose);
    let all = assemble(&scene, Source::default(), stand, Spare::Nobody, &|m| scene.switch_effects(m));
    let Ok(all) = all else { panic!("the scene cannot be loaded") };
    assert!(all.model.effects.contact && all.model.effects.body_damping);
    let mut world = World::new(Arc::new(all.model), scene.settings).unwrap();
    world.set_initial_state(all.initial);
    let mut snapshot = world.new_snapshot();
    let mut run = |world: &mut World| {
        let mut most = 0;
        for _ in 0..600 {
            world.advance();
            world.write_snapshot(&mut snapshot);
            most = most.max(snapshot.contacts.len());
        }
        most
    };
    assert!(run(&mut world) >= 1, "the ball lies on the ground");
    world.reset();
    let n = counted(|| {
        run(&mut world);
    });
    assert_eq!(n, 0);
}

/// Soft joints, and joints that may break but hold, allocate nothing either; one that breaks does so once.
#[test]
fn soft_and_breakable_joints_allocate_only_when_they_break() {
    let limb = |name: &str| {
        format!(
            "<link name='{name}'><inertial><origin xyz='0 0 -0.2'/><mass value='1'/>\
             <inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>"
        )
    };
    let text = format!(
        "<robot name='r'><link name='stand'/>{}{}\
         <joint name='a' type='continuous'><parent link='stand'/><child link='upper'/><axis xyz='0 1 0'/>\
         <realnoid><constraint erp='0.3' cfm='1e-4' break_threshold='1e9'/></realnoid></joint>\
         <joint name='b' type='continuous'><parent link='upper'/><child link='lower'/><origin xyz='0 0 -0.4'/>\
         <axis xyz='0 1 0'/><realnoid><constraint break_threshold='THRESHOLD'/></realnoid></joint></robot>",
        limb("upper"),
        limb("lower")
    );
    // The lower limb weighs 9.8 N: it holds, or falls in the first step.
    for (threshold, breaks) in [("20", false), ("5", true)] {
        let mut file = tempfile::Builder::new().suffix(".urdf").tempfile().unwrap();
        file.write_all(text.replace("THRESHOLD", threshold).as_bytes()).unwrap();
        let source = Source { urdf: Some(file.path()), packages: &[] };
        let model = load(source, Base::Fixed).unwrap_or_else(|report| panic!("{report}")).model;
        let settings = Settings { steps_per_interval: 1, ..Settings::default() };
        let mut world = World::new(model, settings).unwrap();
        let mut snapshot = world.new_snapshot();
        let first = counted(|| world.advance());
        assert_eq!((first > 0, world.broken().len()), (breaks, usize::from(breaks)));
        let later = counted(|| {
            for _ in 0..500 {
                world.advance();
                world.write_snapshot(&mut snapshot);
            }
        });
        assert_eq!(later, 0, "threshold {threshold}");
        assert_eq!(snapshot.broken, world.broken());
    }
}

/// Couplings too: followers with friction and a stop that their leader's servo runs into, in both integrators.
#[test]
fn couplings_allocate_nothing() {
    let joint = |name: &str, inner: &str| {
        let inertia = "<inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/>";
        format!(
            "<link name='{name}_link'><inertial><origin xyz='0.1 0 0' rpy='0 0 0'/><mass value='1'/>{inertia}</inertial></link>\
             <joint name='{name}' type='revolute'><parent link='base'/><child link='{name}_link'/><axis xyz='0 1 0'/>{inner}</joint>"
        )
    };
    let limit = |bound: f64| format!("<limit lower='-{bound}' upper='{bound}' effort='30' velocity='5'/>");
    let rub = "<dynamics damping='0.1' friction='0.2'/>";
    let text = format!(
        "<robot name='r'><link name='base'/>{}{}{}</robot>",
        joint("a", &limit(1.0)),
        joint("b", &(limit(0.5) + rub + "<mimic joint='a'/>")),
        joint("c", &(limit(3.0) + rub + "<mimic joint='b' multiplier='-2'/>")),
    );
    let mut file = tempfile::Builder::new().suffix(".urdf").tempfile().unwrap();
    std::io::Write::write_all(&mut file, text.as_bytes()).unwrap();
    let model =
        load(Source { urdf: Some(file.path()), packages: &[] }, Base::Fixed).unwrap_or_else(|e| panic!("{e}")).model;
    assert_eq!(model.couplings.len(), 2);
    for integrator in [Integrator::SemiImplicitEuler, Integrator::Rk4, Integrator::Extrapolation] {
        let settings = Settings { integrator, steps_per_interval: 1, ..Settings::default() };
        let mut world = World::new(model.clone(), settings).unwrap();
        let mut commands = world.commands().to_vec();
        let n = counted(|| {
            for step in 0..1000 {
                commands[0] = AxisCommand::servo(if step < 500 { 0.9 } else { -0.3 });
                world.set_commands(&commands).unwrap();
                world.advance();
            }
            world.reset();
        });
        assert_eq!(n, 0, "{integrator:?}");
    }
}
