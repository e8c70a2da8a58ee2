//! Findings: what is wrong or remarkable in a text, where, and how to mend it.

use super::Position;

/// How bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing; nothing to mend.
    Note,
    /// Suspicious; simulated as written.
    Warning,
    /// Makes the dynamics meaningless; not loaded.
    Error,
}

/// One finding.
#[derive(Clone, Debug)]
pub struct Finding {
    /// How bad.
    pub severity: Severity,
    /// Stable, greppable, kebab-case: `two-parents`.
    pub code: &'static str,
    /// What is wrong, in one sentence, with the values.
    pub message: String,
    /// The element: `joint 'left_knee' <limit>`.
    pub element: String,
    /// Where.
    pub at: Position,
    /// What to do about it.
    pub mend: String,
}
