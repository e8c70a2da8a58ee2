//! `realnoid inspect`: what is simulated, in numbers and as a picture.

mod engine;
mod groups;
mod json;
mod tables;
mod values;
mod world;

use super::args::InspectArgs;
use super::base_by_name;
use super::drawing::draw_robot;
use super::load::{Loaded, load_or_say};
use super::scene::{Fault, Scene, assemble};
use crate::engine::EngineKind;
use crate::model::Model;
pub(super) use json::effect;
use std::process::ExitCode;
pub use values::Unit;

/// Prints tables, values in full, JSON, or the URDF with inertials.
pub fn run(args: &InspectArgs) -> ExitCode {
    let engine = match args.engine.as_deref().map(chosen).transpose() {
        Ok(engine) => engine,
        Err(reason) => {
            eprintln!("error: --engine: {reason}");
            return ExitCode::from(2);
        }
    };
    let (loaded, world) = match read(args) {
        Ok(both) => both,
        Err(failure) => return failure,
    };
    if let Some(file) = &args.svg
        && let Err(error) = std::fs::write(file, draw_robot(&loaded))
    {
        eprintln!("error: cannot write the drawing to {}: {error}", file.display());
        return ExitCode::FAILURE;
    }
    let unit = Unit::named(&args.unit);
    let whole = world.as_ref().unwrap_or(&loaded.model);
    let effects = whole.listed_effects();
    let text = if args.urdf_with_inertials {
        loaded.published
    } else if args.json {
        let mut all = json::json(&loaded, &effects);
        if let Some(m) = &world {
            all["world"] = world::json(m);
        }
        if let Some(engine) = engine {
            all["engine"] = engine::json(engine, whole);
        }
        format!("{all:#}\n")
    } else if args.full {
        values::full(&loaded, unit)
    } else {
        let about = engine.map(|kind| engine::table(kind, whole)).unwrap_or_default();
        tables::tables(&loaded, unit, &effects) + &world.as_ref().map(world::table).unwrap_or_default() + &about
    };
    super::say(&text)
}

/// An engine of this program.
fn chosen(name: &str) -> Result<EngineKind, String> {
    let kind = super::scene::engine(name)?;
    kind.available().map(|()| kind)
}

/// The robot and, of a scene, everything.
fn read(args: &InspectArgs) -> Result<(Loaded, Option<Model>), ExitCode> {
    let source = args.packages.source(args.urdf.as_deref());
    if args.scene.is_none() && !args.ground {
        return Ok((load_or_say(source, base_by_name(&args.base))?, None));
    }
    let said = |code: u8, reason: &str| {
        eprintln!("error: {}", reason.trim_end());
        ExitCode::from(code)
    };
    let mut scene = Scene::read(args.scene.as_deref()).map_err(|reason| said(2, &reason))?;
    if args.ground {
        scene.lay_ground();
    }
    let stand = (scene.base.unwrap_or(base_by_name(&args.base)), scene.robot.pose);
    match assemble(&scene, source, stand, scene.spare(), &|m| scene.switch_effects(m)) {
        Ok(all) => Ok((all.first, Some(all.model))),
        Err(Fault::Robot(report)) => Err(said(1, &report)),
        Err(Fault::Scene(reason)) => Err(said(2, &reason)),
    }
}
