//! What happens to an engine: it is copied, exchanged, dropped, fed with nonsense, and tells what it cannot do.

use super::{engines, run, scene, support, world};
use realnoid::cli::load::{Setup, examine_text};
use realnoid::model::Base;
use realnoid::world::{AxisCommand, EngineKind, Settings, World};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use support::urdf::model;

struct Counting;

thread_local! {
    static LIVE: Cell<i64> = const { Cell::new(0) };
}

// SAFETY: every call goes on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LIVE.with(|c| c.set(c.get() + layout.size() as i64));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.with(|c| c.set(c.get() - layout.size() as i64));
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const SCENE: &str = "ground: {friction: 0.7}\nbodies:\n  - {name: a, mass: 1, shape: {box: {size: [0.2, 0.3, 0.1]}}, \
    pose: [0, 0, 0.4, 0.6, 0, 0, 0.8], angular_velocity: [1, 2, 3]}\n  - {name: b, mass: 1, shape: {sphere: {radius: 0.1}}, \
    pose: [0.1, 0, 0.8, 0, 0, 0, 1]}\nrobot: {urdf: URDF, base: free, pose: [1, 0, 0.9, 0, 0, 0, 1]}\n";

/// The humanoid falls beside two bodies.
fn crowd(engine: EngineKind) -> World {
    let urdf = std::env::current_dir().unwrap().join("urdf/origin.urdf");
    scene(&SCENE.replace("URDF", urdf.to_str().unwrap()), engine)
}

#[test]
fn a_copy_goes_on_with_the_same_bits() {
    for engine in engines().into_iter().filter(|e| e.capabilities().exact_copy) {
        let mut w = crowd(engine);
        run(&mut w, 0.2);
        let mut copy = w.clone();
        for _ in 0..60 {
            w.advance();
            copy.advance();
            assert_eq!(w.state(), copy.state(), "{}", engine.name());
        }
        assert_eq!((w.work(), w.efforts()), (copy.work(), copy.efforts()));
        // And so does a world that has been reset.
        let mut fresh = crowd(engine);
        w.reset();
        (0..60).for_each(|_| w.advance());
        (0..60).for_each(|_| fresh.advance());
        assert_eq!(w.state(), fresh.state(), "{}", engine.name());
    }
}

#[test]
fn another_engine_goes_on_from_the_same_state() {
    let with_robots = || engines().into_iter().filter(|e| e.capabilities().joints);
    for from in with_robots() {
        for to in with_robots() {
            let mut w = crowd(from);
            run(&mut w, 0.15);
            let (state, energy, time) = (w.state().clone(), w.energy(), w.time());
            let settings = Settings { engine: to, ..*w.settings() };
            w.set_settings(settings).unwrap();
            assert_eq!(*w.state(), state, "{} {}", from.name(), to.name());
            assert_eq!(w.time(), time);
            assert!((w.energy().kinetic - energy.kinetic).abs() < 1e-9 * energy.kinetic);
            w.advance();
            // 1 ms: nothing jumps.
            let moved = w.state().q.iter().zip(&state.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(moved < 0.05, "{} {} {moved}", from.name(), to.name());
            run(&mut w, 0.1);
        }
    }
}

#[test]
fn a_thousand_worlds_leave_nothing_behind() {
    let m = model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Fixed);
    for engine in engines() {
        let once = || {
            let mut w = world(&m, engine);
            w.advance();
            drop(std::hint::black_box(w));
        };
        // The first ones may fill tables of the thread.
        (0..10).for_each(|_| once());
        let before = LIVE.with(Cell::get);
        (0..1000).for_each(|_| once());
        assert_eq!(LIVE.with(Cell::get), before, "{}", engine.name());
    }
}

#[test]
fn nonsense_is_told_and_not_taken() {
    let m = model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Fixed);
    for engine in engines() {
        let mut w = world(&m, engine);
        for axis in 0..m.axes.len() {
            let drive = realnoid::model::DriveLimits { max_torque: f64::INFINITY, ..*w.drive(axis).unwrap() };
            w.set_drive(axis, drive).unwrap();
        }
        w.set_commands(&vec![AxisCommand::torque(1e300); m.axes.len()]).unwrap();
        (0..20).for_each(|_| w.advance());
        let finite = w.state().q.iter().chain(&w.state().v).all(|x| x.is_finite());
        assert!(finite, "{}", engine.name());
    }
}

#[test]
fn what_an_engine_cannot_is_said_at_load_time() {
    let text = "<robot name='r'><link name='base'/>\
        <link name='a'><inertial><mass value='1'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>\
        <link name='b'><inertial><mass value='1'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>\
        <joint name='lead' type='continuous'><parent link='base'/><child link='a'/>\
        <realnoid><constraint erp='0.2' cfm='1e-5'/></realnoid></joint>\
        <joint name='follow' type='continuous'><parent link='a'/><child link='b'/><mimic joint='lead'/></joint></robot>";
    for engine in engines().into_iter().filter(|e| e.capabilities().joints) {
        let told = examine_text(("r.urdf", text), &[], Setup { engine, base: Base::Fixed, ..Setup::default() });
        let about = |item: &str, joint: &str| {
            let names = [engine.name(), item, joint];
            told.findings.iter().any(|f| f.code == "not-honoured" && names.iter().all(|n| f.message.contains(n)))
        };
        let can = engine.capabilities();
        assert_eq!(about("<mimic>", "'follow'"), !can.couplings, "{}", engine.name());
        assert_eq!(about("<constraint cfm>", "'lead'"), !can.softness, "{}", engine.name());
        assert!(told.is_sound());
    }
}
