//! Findings: what is wrong or remarkable in a text, where, and how to mend it.

use super::Position;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

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
    /// What to do about it; empty for a note that asks for nothing.
    pub mend: String,
}

/// An element and the spot in the text that a finding is about.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub element: String,
    pub at: Position,
}

impl Finding {
    pub(super) fn error(code: &'static str, place: Place, message: String, mend: impl Into<String>) -> Self {
        Self { severity: Severity::Error, code, message, element: place.element, at: place.at, mend: mend.into() }
    }

    pub(super) fn warning(code: &'static str, place: Place, message: String, mend: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, place, message, mend) }
    }

    pub(super) fn note(code: &'static str, place: Place, message: String, mend: impl Into<String>) -> Self {
        Self { severity: Severity::Note, ..Self::error(code, place, message, mend) }
    }
}

/// The report for people: every finding with its source line underlined and its mend, then a line with the
/// counts. `text` must be the text that was read, `color` adds ANSI colours.
pub fn render(findings: &[Finding], file: &str, text: &str, color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() }.term_width(RENDER_WIDTH);
    let mut report = String::new();
    for finding in findings {
        report.push_str(&render_one(finding, file, text, &renderer));
        report.push_str("\n\n");
    }
    report.push_str(&format!("{file}: {}\n", counts(findings)));
    report
}

/// Columns after which a source line is cut; a constant, so that a report does not depend on the terminal.
const RENDER_WIDTH: usize = 140;

fn render_one(finding: &Finding, file: &str, text: &str, renderer: &Renderer) -> String {
    let level = match finding.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let span = finding.at.start.min(text.len())..finding.at.end.min(text.len());
    let underline = AnnotationKind::Primary.span(span).label(finding.element.as_str());
    let mut group = level
        .primary_title(finding.message.as_str())
        .id(finding.code)
        .element(Snippet::source(text).path(file).annotation(underline));
    if !finding.mend.is_empty() {
        group = group.element(Level::HELP.with_name("mend").message(finding.mend.as_str()));
    }
    renderer.render(&[group])
}

fn counts(findings: &[Finding]) -> String {
    let count = |severity| findings.iter().filter(|f| f.severity == severity).count();
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    let parts = [(Severity::Error, "error"), (Severity::Warning, "warning"), (Severity::Note, "note")];
    parts.map(|(severity, word)| plural(count(severity), word)).join(", ")
}
