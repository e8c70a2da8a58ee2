//! Text → [`Description`]: URDF through urdf-rs, our tags through a positioned XML pass, findings.

mod finding;
mod types;

pub use finding::{Finding, Severity};
pub use types::*;
