//! `realnoid check`: every finding with its line and mend.

use super::load::{Setup, Source, examine_with};
use super::scene::{Fault, Scene, Spare, assemble, engine, inside};
use crate::description::render;
use crate::engine::EngineKind;
use crate::model::Base;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

/// Prints every finding in the robot's text to standard output; failure if one of them is an
/// error, or if the file cannot be read; then what is wrong with the scene, if one is given. `name`: the engine for which it is checked,
/// else that of the scene.
pub fn run(source: Source, scene: Option<&Path>, name: Option<&str>) -> ExitCode {
    let (scene, engine) = match chosen(scene, name) {
        Ok(both) => both,
        Err(reason) => {
            eprintln!("error: {reason}");
            return ExitCode::FAILURE;
        }
    };
    let urdf = source.urdf.or(scene.as_ref().and_then(|s| s.robot.urdf.as_deref()));
    let source = Source { urdf, ..source };
    if let (None, Some(scene)) = (urdf, scene.as_ref().filter(|scene| scene.spare() == Spare::Nobody)) {
        return if is_sound(scene, source) { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    }
    match examine_with(source, Setup { base: Base::Fixed, engine, ..Setup::default() }) {
        Ok(examined) => {
            let mut out = std::io::stdout();
            let report = render(&examined.findings, &examined.file, &examined.text, out.is_terminal());
            // A reader that has gone away (`| head`) is no failure of the check.
            let _ = out.write_all(report.as_bytes());
            let sound = examined.is_sound() && scene.as_ref().is_none_or(|scene| is_sound(scene, source));
            if sound { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(message) => {
            eprintln!("realnoid check: {message}");
            ExitCode::FAILURE
        }
    }
}

/// The scene, with this engine, and the engine.
fn chosen(scene: Option<&Path>, name: Option<&str>) -> Result<(Option<Scene>, EngineKind), String> {
    let mut scene = scene.map(|path| Scene::read(Some(path))).transpose()?;
    let own = scene.as_ref().map_or_else(EngineKind::default, |s| s.settings.engine);
    let engine = name.map_or(Ok(own), engine)?;
    engine.available()?;
    scene.iter_mut().for_each(|s| s.settings.engine = engine);
    Ok((scene, engine))
}

/// Says what is wrong with a scene around a sound robot, or odd about it.
fn is_sound(scene: &Scene, source: Source) -> bool {
    let stand = (scene.base.unwrap_or_default(), scene.robot.pose);
    match assemble(scene, source, stand, scene.spare(), &|m| scene.switch_effects(m)) {
        Ok(all) => {
            all.warnings.iter().chain(&inside(&all.model, &all.initial)).for_each(|w| eprintln!("warning: {w}"));
            true
        }
        Err(Fault::Scene(reason) | Fault::Robot(reason)) => {
            eprintln!("error: {}", reason.trim_end());
            false
        }
    }
}

/// The text of a URDF file; the error says which file and what to do.
pub fn read_text(path: &Path) -> Result<String, String> {
    let shown = path.display();
    if path.is_dir() {
        return Err(format!("'{shown}' is a folder; name a URDF file in it"));
    }
    if let Some(text) = super::texts::instead_of(path) {
        return Ok(text);
    }
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read '{shown}': {error}"))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..at].iter().filter(|b| **b == b'\n').count() + 1;
        format!("'{shown}' is not UTF-8 text (line {line}); save it as UTF-8")
    })?;
    super::texts::remember(path, &text);
    Ok(text)
}
