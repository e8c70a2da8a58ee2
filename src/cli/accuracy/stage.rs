//! Worlds of cases, out of texts.

use crate::cli::load::{EMBEDDED, EMBEDDED_NAME, Setup, Source, examine_text, loaded};
use crate::cli::scene::{Fault, Scene, Spare, assemble, plain};
use crate::contact::Detector;
use crate::dynamics::{Kinematics, kinematics};
use crate::engine::State;
use crate::math::Pose;
use crate::model::{Base, Model};
use crate::world::{Settings, World};
use std::path::Path;
use std::sync::Arc;

/// Where bisection begins: so far below and above, m.
const REACH: f64 = 5.0;
/// Halvings of it: 10 m to below a nanometre.
const HALVINGS: u32 = 40;

/// Puts a model that has just been loaded into its state at start.
pub(super) type Start<'a> = &'a dyn Fn(&Model, &mut State) -> Result<(), String>;

/// A robot of this URDF text on a fixed or free base.
pub(super) fn robot(text: &str, base: Base, gravity: [f64; 3], start: Start) -> Result<World, String> {
    of_model(model(("case.urdf", text), base)?, gravity, start)
}

/// The embedded humanoid; with a free base, above the flat ground.
pub(super) fn humanoid(base: Base, gravity: [f64; 3], start: Start) -> Result<World, String> {
    let mut m = model((EMBEDDED_NAME, EMBEDDED), base)?;
    if base == Base::Free {
        let mut scene = Scene::read(None)?;
        scene.lay_ground();
        let colliders = m.colliders.iter().cloned().chain(scene.ground).collect();
        m.set_colliders(colliders);
    }
    of_model(m, gravity, start)
}

fn model((file, text): (&str, &str), base: Base) -> Result<Model, String> {
    let loaded = loaded(examine_text((file, text), &[], Setup { base, ..Setup::default() }))?;
    Ok(Model::clone(&loaded.model))
}

fn of_model(m: Model, gravity: [f64; 3], start: Start) -> Result<World, String> {
    let mut state = State::initial(&m);
    start(&m, &mut state)?;
    let mut world = World::new(Arc::new(m), Settings { gravity, ..Settings::default() })?;
    world.set_initial_state(state);
    Ok(world)
}

/// Bodies of a scene file's text.
pub(super) fn scene(text: &str, gravity: [f64; 3]) -> Result<World, String> {
    let words = serde_saphyr::from_str(text).map_err(|e| plain(&e.to_string()))?;
    let scene = Scene::of_words(words, Path::new(""))?;
    let stand = (Base::Fixed, Pose::identity());
    let all = assemble(&scene, Source::default(), stand, Spare::Nobody, &|m| scene.switch_effects(m));
    let all = all.map_err(|(Fault::Robot(reason) | Fault::Scene(reason))| reason)?;
    let mut world = World::new(Arc::new(all.model), Settings { gravity, ..Settings::default() })?;
    world.set_initial_state(all.initial);
    Ok(world)
}

/// Moves a free base up or down until the lowest point is `gap` (m) above what is under it.
pub(super) fn set_down(m: &Model, s: &mut State, gap: f64) -> Result<(), String> {
    let mut detector = Detector::new(m).ok_or("nothing of the robot collides")?;
    let mut k = Kinematics::new(m);
    let still = vec![0.0; m.nv];
    let (mut low, mut high) = (-REACH, REACH);
    let mut touches = vec![];
    for _ in 0..HALVINGS {
        let z = 0.5 * (low + high);
        s.set_base_pose(m, [0.0, 0.0, z], [0.0, 0.0, 0.0, 1.0]);
        kinematics(m, &mut k, &s.q, &still);
        touches.clear();
        detector.find(&k, 0.0, &mut touches);
        let inside = |t: &crate::contact::Touch| t.pair.iter().any(|c| m.colliders[*c as usize].link.is_none());
        if touches.iter().any(|t| inside(t) && t.placed(&k).gap < 0.0) { low = z } else { high = z }
    }
    s.set_base_pose(m, [0.0, 0.0, high + gap], [0.0, 0.0, 0.0, 1.0]);
    Ok(())
}
