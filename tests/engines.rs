//! What all engines that are built in have in common and case files cannot say: copies, exchange, thousands of worlds, robots beside each other.
//! Scenes with what theory says of them are in tests/conformance. An engine skips only what it declares that it cannot.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

#[path = "engines/life.rs"]
mod life;
#[path = "engines/robots.rs"]
mod robots;

use realnoid::cli::load::Source;
use realnoid::cli::scene::{Scene, Spare, assemble};
use realnoid::math::{Pose, Twist};
use realnoid::model::{Base, Model};
use realnoid::world::{EngineKind, Settings, World};
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

const G: f64 = 9.80665;

/// Every engine of this program.
fn engines() -> Vec<EngineKind> {
    let all: Vec<EngineKind> = EngineKind::built().collect();
    assert!(all.contains(&EngineKind::Rbx) && all.contains(&EngineKind::Rapier));
    all
}

/// The scene of a file, in an engine.
fn scene_file(path: &Path, engine: EngineKind) -> World {
    let scene = Scene::read(Some(path)).unwrap();
    let stand = (scene.base.unwrap_or(Base::Fixed), scene.robot.pose);
    let all = assemble(&scene, Source::default(), stand, Spare::Nobody, &|m| scene.switch_effects(m));
    let all = all.unwrap_or_else(|_| panic!("{} cannot be put together", path.display()));
    let mut w = World::new(Arc::new(all.model), Settings { engine, ..scene.settings }).unwrap();
    w.set_initial_state(all.initial);
    w
}

/// The scene of a text.
fn scene(text: &str, engine: EngineKind) -> World {
    let mut file = tempfile::Builder::new().suffix(".yaml").tempfile().unwrap();
    write!(file, "version: 1\n{text}").unwrap();
    scene_file(file.path(), engine)
}

/// A model in an engine, at its initial state.
fn world(m: &Arc<Model>, engine: EngineKind) -> World {
    World::new(m.clone(), Settings { engine, ..Settings::default() }).unwrap()
}

fn weightless(m: &Arc<Model>, engine: EngineKind) -> World {
    let mut w = world(m, engine);
    w.set_settings(Settings { gravity: [0.0; 3], ..*w.settings() }).unwrap();
    w
}

fn run(w: &mut World, seconds: f64) {
    let intervals = (seconds / (w.settings().control_interval_ns as f64 * 1e-9)).round() as usize;
    (0..intervals).for_each(|_| w.advance());
    assert_eq!(w.stats().diverged_steps, 0);
}

/// Pose in the world, and twist in its own frame, of a link.
fn link(w: &World, name: &str) -> (Pose, Twist) {
    let i = w.model().links.iter().position(|l| l.name == name).unwrap_or_else(|| panic!("no link {name}"));
    let s = w.new_snapshot();
    (s.link_pose[i], s.link_twist[i])
}
