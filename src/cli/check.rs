//! `realnoid check`: every finding with its line and mend.

use super::load::{Source, examine};
use crate::description::render;
use crate::math::Pose;
use crate::model::Base;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

/// Prints every finding in the robot's text to standard output; failure if one of them is an
/// error, or if the file cannot be read.
pub fn run(source: Source) -> ExitCode {
    match examine(source, Base::Fixed, Pose::identity()) {
        Ok(examined) => {
            let mut out = std::io::stdout();
            let report = render(&examined.findings, &examined.file, &examined.text, out.is_terminal());
            // A reader that has gone away (`| head`) is no failure of the check.
            let _ = out.write_all(report.as_bytes());
            if examined.is_sound() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(message) => {
            eprintln!("realnoid check: {message}");
            ExitCode::FAILURE
        }
    }
}

/// The text of a URDF file; the error says which file and what to do.
pub fn read_text(path: &Path) -> Result<String, String> {
    let shown = path.display();
    if path.is_dir() {
        return Err(format!("'{shown}' is a folder; name a URDF file in it"));
    }
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read '{shown}': {error}"))?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..at].iter().filter(|b| **b == b'\n').count() + 1;
        format!("'{shown}' is not UTF-8 text (line {line}); save it as UTF-8")
    })
}
