//! `realnoid recover`: completes a bag that was cut off.

use crate::record::{file_in, recover};
use std::path::Path;
use std::process::ExitCode;

/// Exit codes: 0 the bag is complete; 1 it cannot be completed; 2 there is none.
pub fn run(bag: &Path) -> ExitCode {
    let file = match file_in(bag) {
        Ok(file) => file,
        Err(reason) => {
            eprintln!("error: {reason}");
            return ExitCode::from(2);
        }
    };
    match recover(&file) {
        Ok(r) if r.was_complete => {
            super::say(&format!("'{}' is complete: {} messages; nothing to do\n", file.display(), r.messages))
        }
        Ok(r) => {
            super::say(&format!("'{}' was cut off; it is complete now: {} messages\n", file.display(), r.messages))
        }
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}
