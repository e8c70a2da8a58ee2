//! `realnoid check`: every finding with its line and mend.

use crate::description::{self, Severity};
use std::io::IsTerminal;
use std::path::Path;
use std::process::ExitCode;

/// Prints every finding in the file to standard output; failure if one of them is an error, or if the file
/// cannot be read.
pub fn run(path: Option<&Path>) -> ExitCode {
    let Some(path) = path else {
        eprintln!("realnoid check: name a URDF file: realnoid check robot.urdf");
        return ExitCode::FAILURE;
    };
    match read_text(path) {
        Ok(text) => check(&text, &path.display().to_string()),
        Err(message) => {
            eprintln!("realnoid check: {message}");
            ExitCode::FAILURE
        }
    }
}

/// The same for a text; `file` is its name in the report.
pub fn check(text: &str, file: &str) -> ExitCode {
    let findings = description::read(text, file).findings;
    print!("{}", description::render(&findings, file, text, std::io::stdout().is_terminal()));
    if findings.iter().any(|f| f.severity == Severity::Error) { ExitCode::FAILURE } else { ExitCode::SUCCESS }
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
