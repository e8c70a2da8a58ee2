//! The row of a world.

use super::spec::WorldPoint;
use crate::cli::start::Start;
use crate::record::{CsvWriter, Sample};
use crate::world::World;
use serde_json::Value;

/// What a row begins with, before the varied values.
const KNOWN_BY: [&str; 3] = ["index", "sweep", "seed"];
/// What became of the world; then come the results.
const OUTCOME: [&str; 3] = ["status", "error", "finite"];
/// Of the summary, what no machine does twice in the same way; the last columns.
pub const TIMES: [&str; 3] = ["cpu_seconds", "us_per_step", "real_time_factor"];
/// Parts of the summary that are no numbers, or stand elsewhere.
const LEFT_OUT: [&str; 6] = ["rows", "output", "stopped", "finite", "cpu_seconds", "us_per_step"];

/// What all rows have in common.
pub struct Plan {
    /// Digest of the specification and all that it reads: rows of another one are not mixed with these.
    pub known_by: String,
    /// Names of all columns.
    pub header: Vec<String>,
    /// Names of the results.
    results: Vec<String>,
}

/// How a world ended.
pub enum End {
    /// It was simulated; its summary.
    Made(Value, Box<World>),
    /// It could not be made: exit code of `simulate`, and reason.
    Refused(u8, String),
}

impl Plan {
    /// The columns of worlds like the one that starts so.
    ///
    /// # Errors
    /// If a name is that of two columns.
    pub fn new(known_by: String, varied: Vec<String>, mut start: Start) -> Result<Self, String> {
        // Before its first step a world has all the results already.
        start.intervals = 0;
        let summary = start.run(&Default::default(), &mut crate::cli::outcome::Progress::silent())?;
        let results: Vec<String> = results(&summary, &start.world).into_iter().map(|(name, _)| name).collect();
        let fixed = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>();
        let header = [fixed(&KNOWN_BY), varied, fixed(&OUTCOME), results.clone(), fixed(&TIMES)].concat();
        match header.iter().enumerate().find(|(i, name)| header[..*i].contains(name)) {
            Some((_, name)) => Err(format!("there would be two columns '{name}'; give the varied value another name")),
            None => Ok(Self { known_by, header, results }),
        }
    }

    /// The fields of a row, in the order of the header.
    pub fn row(&self, world: &WorldPoint, end: &End) -> Vec<String> {
        let mut row = vec![world.index.to_string(), self.known_by.clone(), world.seed.to_string()];
        row.extend(world.values.iter().map(field));
        match end {
            End::Refused(code, reason) => {
                row.extend([code.to_string(), reason.trim_end().to_owned(), String::new()]);
                row.resize(self.header.len(), String::new());
            }
            End::Made(summary, world) => {
                let found = results(summary, world);
                if !found.iter().map(|(name, _)| name).eq(&self.results) {
                    let reason = "has other axes or bodies than world 0: sweep them one by one".to_owned();
                    row.extend(["2".into(), reason, String::new()]);
                    row.resize(self.header.len(), String::new());
                    return row;
                }
                let finite = summary["finite"] == true;
                row.extend([u8::from(!finite).to_string(), String::new(), finite.to_string()]);
                row.extend(found.into_iter().map(|(_, value)| value));
                let (simulated, cpu) = (&summary["simulated_seconds"], &summary["cpu_seconds"]);
                let factor = simulated.as_f64().zip(cpu.as_f64()).map(|(s, c)| s / c).filter(|f| f.is_finite());
                row.extend([
                    field(cpu),
                    field(&summary["us_per_step"]),
                    factor.map(|f| f.to_string()).unwrap_or_default(),
                ]);
            }
        }
        row
    }
}

/// As it stands in a table: numbers with all their digits, words without quotes.
fn field(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(s) => s.clone(),
        other => other.to_string(),
    }
}

/// Names and values: the summary of `simulate`, and the last row that it would have written.
fn results(summary: &Value, world: &World) -> Vec<(String, String)> {
    let mut found = vec![];
    flatten("", summary, &mut found);
    if let Some(text) = last_row(world) {
        let mut lines = text.lines().map(|line| line.split(','));
        if let (Some(names), Some(values)) = (lines.next(), lines.next()) {
            found.extend(names.zip(values).map(|(n, v)| (format!("final.{n}"), v.to_owned())));
        }
    }
    found
}

/// Header and row of the present state, as `simulate` writes them.
fn last_row(world: &World) -> Option<String> {
    let mut text = vec![];
    let mut csv = CsvWriter::new(&mut text, world.model()).ok()?;
    csv.row(&Sample::new(world)).and_then(|()| csv.finish()).ok()?;
    String::from_utf8(text).ok()
}

fn flatten(path: &str, value: &Value, found: &mut Vec<(String, String)>) {
    match value {
        Value::Object(map) => {
            for (name, value) in map.iter().filter(|(name, _)| !(path.is_empty() && LEFT_OUT.contains(&name.as_str())))
            {
                let name = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                flatten(&name, value, found);
            }
        }
        Value::Array(list) => found.push((path.to_owned(), list.len().to_string())),
        other => found.push((path.to_owned(), field(other))),
    }
}
