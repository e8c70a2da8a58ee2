//! The file of rows: appended to as worlds finish, gone on with after an interruption.

use super::row::Plan;
use csv::{ReaderBuilder, StringRecord, WriterBuilder};
use std::collections::HashSet;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// A file of rows that nobody else writes meanwhile.
pub struct Table {
    path: PathBuf,
    file: File,
    done: HashSet<usize>,
}

impl Table {
    /// Opens a file, or begins one. A last line that was cut off is taken out.
    ///
    /// # Errors
    /// The file cannot be read or written, belongs to another sweep, or another process writes it.
    pub fn open(path: &Path, plan: &Plan) -> Result<Self, String> {
        let shown = path.display();
        let failed = |e: io::Error| format!("cannot write '{shown}': {e}");
        let mut file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(format!("'{shown}' is being written by another sweep")),
            // Some file systems have no locks.
            Err(TryLockError::Error(_)) => {}
        }
        let mut text = vec![];
        file.read_to_end(&mut text).map_err(failed)?;
        let whole = whole_lines(&text);
        if whole.is_empty() {
            file.set_len(0).map_err(failed)?;
            let mut table = Self { path: path.to_owned(), file, done: HashSet::new() };
            table.append(&plan.header)?;
            return Ok(table);
        }
        let (header, rows) = parse(whole).map_err(|reason| format!("'{shown}' {reason}"))?;
        let other = "rows of another sweep: the specification, a file that it reads, or the version of realnoid has changed; name \
                     another file with --out, or remove this one";
        if header.iter().ne(plan.header.iter().map(String::as_str)) {
            return Err(format!("'{shown}' has {other} (its columns are others)"));
        }
        let mut done = HashSet::new();
        for row in &rows {
            if row.get(1) != Some(&plan.known_by) {
                return Err(format!("'{shown}' has {other}"));
            }
            done.insert(index(row).map_err(|reason| format!("'{shown}' {reason}"))?);
        }
        file.set_len(whole.len() as u64).map_err(failed)?;
        Ok(Self { path: path.to_owned(), file, done })
    }

    /// Is the row of this world there?
    pub fn has(&self, world: usize) -> bool {
        self.done.contains(&world)
    }

    /// Appends a row, at once and as a whole.
    ///
    /// # Errors
    /// What the file system says.
    pub fn append(&mut self, row: &[String]) -> Result<(), String> {
        let failed = |e: io::Error| format!("cannot write '{}': {e}", self.path.display());
        self.file.write_all(&line(row.iter().map(String::as_str)).map_err(failed)?).map_err(failed)
    }

    /// Puts the rows in the order of worlds, in a file that takes the place of this one.
    ///
    /// # Errors
    /// What the file system says.
    pub fn sort(self) -> Result<(), String> {
        let (header, mut rows) = read(&self.path)?;
        let sorted = rows.is_sorted_by_key(|row| index(row).unwrap_or_default());
        if sorted {
            return Ok(());
        }
        rows.sort_by_key(|row| index(row).unwrap_or_default());
        write(&self.path, &header, &rows)
    }
}

/// All rows of a file.
///
/// # Errors
/// It cannot be read, or is no table of a sweep.
pub fn read(path: &Path) -> Result<(StringRecord, Vec<StringRecord>), String> {
    let text = std::fs::read(path).map_err(|e| format!("cannot read '{}': {e}", path.display()))?;
    parse(whole_lines(&text)).map_err(|reason| format!("'{}' {reason}", path.display()))
}

/// Replaces a file by these rows.
///
/// # Errors
/// What the file system says.
pub fn write(path: &Path, header: &StringRecord, rows: &[StringRecord]) -> Result<(), String> {
    let failed = |e: io::Error| format!("cannot write '{}': {e}", path.display());
    let mut text = vec![];
    for row in std::iter::once(header).chain(rows) {
        text.extend(line(row.iter()).map_err(failed)?);
    }
    let mut new = path.as_os_str().to_owned();
    new.push(".new");
    std::fs::write(&new, text).and_then(|()| std::fs::rename(&new, path)).map_err(failed)
}

/// The number of a world.
///
/// # Errors
/// The row has none.
pub fn index(row: &StringRecord) -> Result<usize, String> {
    let first = row.get(0).unwrap_or_default();
    first
        .parse()
        .map_err(|_| format!("is no table of a sweep: a row begins with '{first}', not with the number of a world"))
}

/// Without a last line that has no end. Rows have no line breaks in them.
fn whole_lines(text: &[u8]) -> &[u8] {
    let end = text.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
    &text[..end]
}

fn parse(text: &[u8]) -> Result<(StringRecord, Vec<StringRecord>), String> {
    let mut reader = ReaderBuilder::new().from_reader(text);
    let told = |e: csv::Error| format!("is no table of a sweep: {e}");
    let header = reader.headers().map_err(told)?.clone();
    if header.iter().take(3).ne(["index", "sweep", "seed"]) {
        return Err("is no table of a sweep: it does not begin with the columns index, sweep, seed".into());
    }
    let rows = reader.records().collect::<Result<Vec<_>, _>>().map_err(told)?;
    Ok((header, rows))
}

fn line<'a>(fields: impl Iterator<Item = &'a str>) -> io::Result<Vec<u8>> {
    let mut writer = WriterBuilder::new().flexible(true).from_writer(vec![]);
    // What is read back line by line has no line break in a field.
    writer.write_record(fields.map(|f| f.replace(['\n', '\r'], " "))).map_err(io::Error::other)?;
    writer.into_inner().map_err(|e| io::Error::other(e.to_string()))
}
