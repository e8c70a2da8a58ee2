//! `sweep --merge`: the tables of shards as one.

use super::USAGE;
use super::table::{index, read, write};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Writes the rows of `files` to `out`, in the order of worlds; what to tell.
///
/// # Errors
/// Exit code and reason: tables of different sweeps, or two different rows of one world.
pub fn merge(out: &Path, files: &[PathBuf]) -> Result<String, (u8, String)> {
    let usage = |reason: String| (USAGE, reason);
    let Some((first, others)) = files.split_first() else {
        return Err(usage("--merge: name the tables of the shards".into()));
    };
    let (header, rows) = read(first).map_err(usage)?;
    let mut all = vec![(first, rows)];
    for file in others {
        let (columns, rows) = read(file).map_err(usage)?;
        if columns != header {
            return Err(usage(format!("'{}' has other columns than '{}'", file.display(), first.display())));
        }
        all.push((file, rows));
    }
    let sweep = all.iter().flat_map(|(_, rows)| rows).next().and_then(|row| row.get(1)).map(str::to_owned);
    let mut by_world = BTreeMap::new();
    for (file, rows) in all {
        for row in rows {
            let told = |reason: &str| usage(format!("'{}': {reason}", file.display()));
            if row.get(1) != sweep.as_deref() {
                return Err(told("has rows of another sweep than the first one"));
            }
            let world = index(&row).map_err(|reason| told(&reason))?;
            // A world that was made twice has the same row, but for the times.
            let results = header.len() - super::row::TIMES.len();
            if let Some(known) = by_world.insert(world, row.clone())
                && known.iter().take(results).ne(row.iter().take(results))
            {
                return Err(told(&format!("has another row of world {world} than a file before")));
            }
        }
    }
    let last = by_world.keys().next_back().copied();
    let missing = last.map_or(0, |last| last + 1 - by_world.len());
    let rows: Vec<_> = by_world.into_values().collect();
    write(out, &header, &rows).map_err(|reason| (1, reason))?;
    let gap = if missing > 0 { format!("; {missing} worlds before the last one are missing") } else { String::new() };
    Ok(format!("{} worlds of {} files{gap}: '{}'\n", rows.len(), files.len(), out.display()))
}
