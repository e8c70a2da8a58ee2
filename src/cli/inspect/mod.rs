//! `realnoid inspect`: what is simulated, in numbers and as a picture.

mod groups;
mod json;
mod tables;
mod values;

use super::args::InspectArgs;
use super::base_by_name;
use super::drawing::draw_robot;
use super::load::load_or_say;
use std::process::ExitCode;
pub use values::Unit;

/// Prints tables, values in full, JSON, or the URDF with inertials.
pub fn run(args: &InspectArgs) -> ExitCode {
    let loaded = match load_or_say(args.packages.source(args.urdf.as_deref()), base_by_name(&args.base)) {
        Ok(loaded) => loaded,
        Err(failure) => return failure,
    };
    if let Some(file) = &args.svg
        && let Err(error) = std::fs::write(file, draw_robot(&loaded))
    {
        eprintln!("error: cannot write the drawing to {}: {error}", file.display());
        return ExitCode::FAILURE;
    }
    let unit = Unit::named(&args.unit);
    let text = if args.urdf_with_inertials {
        loaded.published
    } else if args.json {
        format!("{:#}\n", json::json(&loaded))
    } else if args.full {
        values::full(&loaded, unit)
    } else {
        tables::tables(&loaded, unit)
    };
    super::say(&text)
}
