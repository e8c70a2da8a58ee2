//! Lines and numbers of text files.

use super::fault::Inside;
use std::borrow::Cow;

/// The lines of a text, with their numbers from 1; ends of line as of Unix, Windows or the old Mac.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    bytes.split(move |b| *b == end).enumerate().map(|(i, line)| (i + 1, String::from_utf8_lossy(line)))
}

/// A number in a line; NaN and infinity are numbers here.
pub(super) fn number(line: usize, word: Option<&str>) -> Result<f64, Inside> {
    let word = word.ok_or_else(|| Inside::line(line, "a number is missing"))?;
    word.parse().map_err(|_| Inside::line(line, format!("\"{}\" is not a number", short(word))))
}

/// A word that may be very long, as it is shown to people.
pub(super) fn short(word: &str) -> Cow<'_, str> {
    match word.char_indices().nth(40) {
        Some((end, _)) => Cow::Owned(format!("{}…", &word[..end])),
        None => Cow::Borrowed(word),
    }
}
