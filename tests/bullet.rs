//! The engine bullet (feature `bullet`): joints, shapes, contacts, ownership.
#![cfg(feature = "bullet")]
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "bullet/contacts.rs"]
mod contacts;
#[path = "bullet/joints.rs"]
mod joints;
#[path = "bullet/ownership.rs"]
mod ownership;
#[path = "bullet/shapes.rs"]
mod shapes;
mod support;
mod touching;

use realnoid::model::Model;
use realnoid::world::{EngineKind, Settings, World};

/// m/s².
const G: f64 = 9.81;

/// One step of Bullet per control interval of `h` seconds.
fn settings(h: f64) -> Settings {
    Settings { engine: EngineKind::Bullet, ..touching::settings(h, Default::default()) }
}

fn world(m: Model, h: f64) -> World {
    touching::world(m, settings(h))
}

fn run(w: &mut World, seconds: f64) {
    let steps = (seconds / (w.settings().control_interval_ns as f64 * 1e-9)).round() as usize;
    (0..steps).for_each(|_| w.advance());
    assert_eq!(w.stats().diverged_steps, 0);
}
