//! Collects findings while a text is read; knows the way from byte offsets to lines and columns.

use super::Position;
use super::finding::{Finding, Severity};
use std::ops::Range;

/// Lines named in a finding that stands for many of its kind.
const LINES_OF_MANY: usize = 6;

/// The findings of one reading.
pub(super) struct Report<'t> {
    text: &'t str,
    line_starts: Vec<usize>,
    /// What the reader added to the text before parsing it: no position may count it.
    inserted: Range<usize>,
    findings: Vec<Finding>,
    kinds: Vec<Kind>,
    ceiling: Severity,
}

/// Findings that are told once: the index of the first one, and the lines of the others.
struct Kind {
    key: (&'static str, String),
    first: usize,
    others: Vec<u32>,
}

impl<'t> Report<'t> {
    pub fn new(text: &'t str) -> Self {
        let line_starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { text, line_starts, inserted: 0..0, findings: vec![], kinds: vec![], ceiling: Severity::Error }
    }

    /// From here on, offsets are those of the text with `inserted` put in.
    pub fn set_inserted(&mut self, inserted: Range<usize>) {
        self.inserted = inserted;
    }

    /// The place of a byte range of the parsed text.
    pub fn position(&self, range: Range<usize>) -> Position {
        let start = self.original(range.start);
        let end = self.original(range.end).max(start);
        let line = self.line_starts.partition_point(|&s| s <= start).saturating_sub(1);
        let column = self.text[self.line_starts[line]..start].chars().count();
        Position { line: line as u32 + 1, column: column as u32 + 1, start, end }
    }

    /// Byte offset of a line and column (both from 1) of the parsed text, as roxmltree counts them.
    pub fn offset(parsed: &str, row: u32, column: u32) -> usize {
        let line_start = parsed.split_inclusive('\n').take(row.max(1) as usize - 1).map(str::len).sum::<usize>();
        let rest = parsed.get(line_start..).unwrap_or_default();
        line_start + rest.chars().take(column.max(1) as usize - 1).map(char::len_utf8).sum::<usize>()
    }

    fn original(&self, parsed: usize) -> usize {
        let shift = parsed.clamp(self.inserted.start, self.inserted.end) - self.inserted.start;
        let mut at = (parsed - shift).min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }

    /// Adds a finding.
    pub fn add(&mut self, mut finding: Finding) {
        finding.severity = finding.severity.min(self.ceiling);
        self.findings.push(finding);
    }

    /// Adds a finding that is told once per `key`; later ones are only counted, and their lines given.
    pub fn add_once(&mut self, key: &str, finding: Finding) {
        let key = (finding.code, key.to_string());
        match self.kinds.iter_mut().find(|kind| kind.key == key) {
            Some(kind) => kind.others.push(finding.at.line),
            None => {
                self.kinds.push(Kind { key, first: self.findings.len(), others: vec![] });
                self.add(finding);
            }
        }
    }

    /// Runs `read` with every error in it lowered to a warning: for parts that the dynamics can do without.
    pub fn lenient<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.ceiling, Severity::Warning);
        let result = read(self);
        self.ceiling = before;
        result
    }

    /// Has anything been found that keeps the text from being loaded?
    pub fn has_errors(&self) -> bool {
        self.findings.iter().any(|f| f.severity == Severity::Error)
    }

    /// Number of findings so far.
    pub fn len(&self) -> usize {
        self.findings.len()
    }

    /// All findings: errors first, then warnings, then notes, each in the order of the text.
    pub fn finish(mut self) -> Vec<Finding> {
        for kind in self.kinds.iter().filter(|kind| !kind.others.is_empty()) {
            let lines: Vec<_> = kind.others.iter().take(LINES_OF_MANY).map(u32::to_string).collect();
            let more = if kind.others.len() > LINES_OF_MANY { ", …" } else { "" };
            let total = kind.others.len() + 1;
            let word = if lines.len() == 1 { "line" } else { "lines" };
            let tail = format!(" ({total} of them, also in {word} {}{more})", lines.join(", "));
            self.findings[kind.first].message.push_str(&tail);
        }
        self.findings.sort_by_key(|f| (std::cmp::Reverse(f.severity), f.at.start));
        self.findings
    }
}
