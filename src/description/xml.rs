//! Text → XML tree with byte positions; what is not well-formed becomes a finding.

use super::finding::{Finding, Place};
use super::report::Report;
use roxmltree::{Document, Error};
use std::borrow::Cow;

/// Namespace that the reader gives to a prefix which the text uses but never declares.
pub(super) const UNDECLARED: &str = "urn:undeclared:";
/// A file with more undeclared prefixes than this is reported as not well-formed.
const MAX_UNDECLARED: usize = 16;

/// The text with a declaration added for every prefix that it uses but does not declare (old Gazebo
/// extensions, forgotten xacro): positions are mapped back by `report`.
pub(super) fn declare_prefixes<'t>(text: &'t str, report: &mut Report) -> Cow<'t, str> {
    let mut declared = Cow::Borrowed(text);
    let mut declarations = String::new();
    let Some(at) = root_name_end(text) else { return declared };
    for _ in 0..MAX_UNDECLARED {
        let Err(Error::UnknownNamespace(prefix, _)) = Document::parse(&declared) else { break };
        declarations.push_str(&format!(" xmlns:{prefix}=\"{UNDECLARED}{prefix}\""));
        declared = Cow::Owned(format!("{}{declarations}{}", &text[..at], &text[at..]));
    }
    report.set_inserted(at..at + declarations.len());
    declared
}

/// Byte offset after `<robot`, skipping the prolog.
fn root_name_end(text: &str) -> Option<usize> {
    let mut at = 0;
    loop {
        at += text[at..].find('<')?;
        let rest = &text[at..];
        let skip = |end: &str| rest.find(end).map(|i| i + end.len());
        if rest.starts_with("<!--") {
            at += skip("-->")?;
        } else if rest.starts_with("<?") {
            at += skip("?>")?;
        } else {
            return Some(at + rest.find([' ', '\t', '\r', '\n', '>', '/'])?);
        }
    }
}

/// The XML tree, or a finding that says where and why the text is not well-formed XML.
pub(super) fn parse<'d>(declared: &'d str, text: &str, report: &mut Report) -> Option<Document<'d>> {
    match Document::parse(declared) {
        Ok(document) => Some(document),
        Err(error) => {
            report.add(not_well_formed(&error, declared, text, report));
            None
        }
    }
}

fn not_well_formed(error: &Error, declared: &str, text: &str, report: &Report) -> Finding {
    let start = match error {
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => last_character(declared),
        Error::DtdDetected => declared.find("<!DOCTYPE").unwrap_or(0),
        _ => Report::offset(declared, error.pos().row, error.pos().col),
    };
    let end = start + declared[start..].chars().next().map_or(0, char::len_utf8);
    let place = Place { element: "here".into(), at: report.position(start..end) };
    let (message, mend) = explain(error, text, place.at.start);
    Finding::error("not-well-formed", place, message, mend)
}

fn last_character(text: &str) -> usize {
    text.trim_end().char_indices().next_back().map_or(0, |(at, _)| at)
}

fn explain(error: &Error, text: &str, at: usize) -> (String, &'static str) {
    match error {
        Error::NoRootNode if text.trim().is_empty() => {
            ("the file is empty".into(), "give a URDF file: `<robot name=\"…\">` with links and joints")
        }
        Error::UnknownToken(_) if !text.trim_start_matches('\u{feff}').trim_start().starts_with('<') => {
            ("this text is not XML".into(), "give a URDF file, it starts with `<robot`")
        }
        Error::NoRootNode => {
            ("there is no XML element in this text".into(), "give a URDF file, it starts with `<robot`")
        }
        Error::UnexpectedCloseTag(expected, found, _) => (
            format!("`</{found}>` closes an element while `<{expected}>`{} is still open", opened(expected, text, at)),
            "close the inner element first, or mend the misspelt closing tag",
        ),
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => (
            "the text ends while an element is still open".into(),
            "was the file cut off? close every element, at the end with `</robot>`",
        ),
        Error::DtdDetected => (
            "a document type declaration (DTD) is refused: entities are not expanded".into(),
            "take `<!DOCTYPE …>` out",
        ),
        Error::DuplicatedAttribute(name, _) => (format!("attribute `{name}` is given twice"), "keep one of the two"),
        Error::UnknownEntityReference(name, _) => {
            (format!("`&{name};` is not known"), "write `&amp;` for the character `&`")
        }
        Error::InvalidAttributeValue(_) => {
            ("there is a `<` inside an attribute value".into(), "close the quote before it, or write `&lt;`")
        }
        other => (format!("this is not well-formed XML: {}", without_position(other)), "mend the XML at this place"),
    }
}

/// ` of line N`: the last start tag of that name before the fault, which as a rule is the one left open.
fn opened(tag: &str, text: &str, before: usize) -> String {
    let head = text.get(..before).unwrap_or_default();
    let start_tag = format!("<{tag}");
    let is_whole = |at: usize| head[at + start_tag.len()..].starts_with([' ', '\t', '\r', '\n', '>']);
    let starts = head.match_indices(&start_tag).filter(|(at, _)| is_whole(*at));
    starts.last().map_or(String::new(), |(at, _)| format!(" of line {}", head[..at].matches('\n').count() + 1))
}

/// roxmltree's words without its own ` at line:column` (which counts what the reader inserted).
fn without_position(error: &Error) -> String {
    let position = error.pos();
    error.to_string().replace(&format!(" at {position}"), "")
}
