//! `realnoid bench --drop`: what a step costs while a robot falls onto the ground and comes to lie there.

use super::args::BenchArgs;
use super::bench::cpu_seconds;
use super::load::load_or_say;
use super::scene::Scene;
use crate::engine::State;
use crate::model::{Base, Model};
use crate::world::{AxisCommand, Integrator, Settings, World};
use serde_json::json;
use std::process::ExitCode;
use std::sync::Arc;

/// Step, ns.
const STEP: i64 = 1_000_000;

/// Falls from height `z` of the root link, all joints passive, again and again; prints the best round of each integrator.
pub fn run(args: &BenchArgs, z: f64) -> ExitCode {
    let loaded = match load_or_say(args.packages.source(args.urdf.as_deref()), Base::Free) {
        Ok(loaded) => loaded,
        Err(failure) => return failure,
    };
    let Ok(mut scene) = Scene::read(None) else { return ExitCode::FAILURE };
    scene.lay_ground();
    let mut model = Model::clone(&loaded.model);
    let colliders = model.colliders.iter().cloned().chain(scene.ground).collect();
    model.set_colliders(colliders);
    let model = Arc::new(model);
    let mut falls = vec![];
    for name in ["semi_implicit_euler", "implicit_midpoint"] {
        match Fall::new(&model, name, z) {
            Ok(fall) => falls.push(fall),
            Err(reason) => {
                eprintln!("error: {reason}");
                return ExitCode::FAILURE;
            }
        }
    }
    for _ in 0..args.rounds {
        falls.iter_mut().for_each(|fall| fall.measure(args.steps));
    }
    super::say(&if args.json { as_json(&model, &falls) } else { as_table(&model, &falls) })
}

struct Fall {
    name: &'static str,
    fresh: World,
    /// µs per step, of the best round.
    best: f64,
    penetration: f64,
    contacts: f64,
}

impl Fall {
    fn new(m: &Arc<Model>, name: &'static str, z: f64) -> Result<Self, String> {
        let integrator = Integrator::by_name(name).unwrap_or_default();
        let settings = Settings { integrator, steps_per_interval: 1, control_interval_ns: STEP, ..Settings::default() };
        let mut fresh = World::new(m.clone(), settings)?;
        let mut state = State::initial(m);
        state.set_base_pose(m, [0.0, 0.0, z], [0.0, 0.0, 0.0, 1.0]);
        fresh.set_initial_state(state);
        let passive = vec![AxisCommand::IDLE; m.axes.len()];
        fresh.set_commands(&passive).map_err(|axis| format!("axis {axis} takes no command"))?;
        Ok(Self { name, fresh, best: f64::INFINITY, penetration: 0.0, contacts: 0.0 })
    }

    fn measure(&mut self, steps: u32) {
        let mut world = self.fresh.clone();
        let mut contacts = 0;
        let start = cpu_seconds();
        for _ in 0..steps {
            world.advance();
            contacts += world.contacts().len();
        }
        let took = cpu_seconds() - start;
        self.best = self.best.min(took * 1e6 / f64::from(steps));
        self.penetration = world.stats().worst_penetration;
        self.contacts = contacts as f64 / f64::from(steps);
    }
}

fn as_json(m: &Model, falls: &[Fall]) -> String {
    let of = |f: &Fall| {
        let fall = json!({"us_per_step": f.best, "worst_penetration": f.penetration, "contacts": f.contacts});
        (f.name.to_owned(), fall)
    };
    let falls: serde_json::Map<String, serde_json::Value> = falls.iter().map(of).collect();
    format!("{:#}\n", json!({"model": m.name, "nv": m.nv, "colliders": m.colliders.len(), "drop": falls}))
}

fn as_table(m: &Model, falls: &[Fall]) -> String {
    let mut text = format!("{}, {} velocities, {} colliders with the ground\n", m.name, m.nv, m.colliders.len());
    text += &format!("{:<24}{:>12}{:>22}{:>18}\n", "", "µs per step", "worst penetration, m", "contacts, mean");
    for f in falls {
        text += &format!("{:<24}{:>12.3}{:>22.3e}{:>18.2}\n", f.name, f.best, f.penetration, f.contacts);
    }
    text
}
