//! The specification of a sweep: a YAML file. Unknown keys are refused, with their line.

use super::draw::Draw;
use super::vary::Vary;
use crate::cli::scene::plain;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::path::Path;

/// Worlds of a sweep at most.
const MOST_WORLDS: usize = 10_000_000;

/// The file.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// Version of the format: 1.
    pub version: u32,
    /// The words of a scene file, or the path of one, beside this file.
    pub scene: Option<Value>,
    /// What else is simulated: the options of `simulate`, by their names.
    pub run: Map<String, Value>,
    /// grid (every value with every other) or random.
    #[serde(default)]
    pub combine: Combine,
    /// Number of worlds, if they are random.
    pub samples: Option<usize>,
    /// How often each point of a grid is simulated, with other random values each time.
    pub repeat: Option<usize>,
    /// Of all random values.
    #[serde(default)]
    pub seed: u64,
    /// What differs from world to world.
    #[serde(default)]
    pub vary: Vec<Vary>,
}

/// How values are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Combine {
    /// Every value with every other.
    #[default]
    Grid,
    /// Each drawn by itself.
    Random,
}

/// A world: what is put where.
#[derive(Clone, Debug)]
pub struct WorldPoint {
    /// From 0.
    pub index: usize,
    /// Of its random values.
    pub seed: u64,
    /// In the order of `vary`.
    pub values: Vec<Value>,
}

impl Spec {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the file, the line and the key.
    pub fn read(file: &Path) -> Result<Self, String> {
        let text = crate::cli::check::read_text(file)?;
        let told = |reason: String| format!("{}: {reason}", file.display());
        let spec: Self = serde_saphyr::from_str(&text).map_err(|e| told(plain(&e.to_string())))?;
        spec.check().map_err(told)?;
        Ok(spec)
    }

    fn check(&self) -> Result<(), String> {
        if self.version != 1 {
            return Err(format!("version is {}; it must be 1", self.version));
        }
        for (i, vary) in self.vary.iter().enumerate() {
            vary.check().map_err(|reason| format!("vary[{i}] '{}': {reason}", vary.at))?;
            if self.vary[..i].iter().any(|v| v.at == vary.at || v.name() == vary.name()) {
                return Err(format!("vary[{i}] '{}': is varied twice, or has the name of another one", vary.at));
            }
        }
        match (self.combine, self.samples, self.repeat) {
            (Combine::Random, None | Some(0), _) => Err("combine: random needs samples: how many worlds".into()),
            (Combine::Random, _, Some(_)) => {
                Err("repeat is for combine: grid; random worlds are as many as samples".into())
            }
            (Combine::Grid, Some(_), _) => {
                Err("samples is for combine: random; a grid has as many worlds as its values say".into())
            }
            (Combine::Grid, _, Some(0)) => Err("repeat is 0: there would be no world".into()),
            _ => Ok(()),
        }
    }

    /// All worlds.
    ///
    /// # Errors
    /// There are too many.
    pub fn worlds(&self) -> Result<Vec<WorldPoint>, String> {
        let lists: Vec<Option<Vec<Value>>> = self.vary.iter().map(|v| self.list(v)).collect();
        let sizes = lists.iter().flatten().map(Vec::len);
        let points = match self.combine {
            Combine::Random => self.samples,
            Combine::Grid => sizes.chain(self.repeat).try_fold(1_usize, usize::checked_mul),
        };
        let count =
            points.filter(|n| *n <= MOST_WORLDS).ok_or(format!("there would be more than {MOST_WORLDS} worlds"))?;
        Ok((0..count).map(|index| self.world(index, &lists)).collect())
    }

    /// The values of a grid; none if they are drawn.
    fn list(&self, vary: &Vary) -> Option<Vec<Value>> {
        if self.combine == Combine::Grid { vary.list() } else { None }
    }

    /// The last entry changes fastest; repeats are next to each other.
    fn world(&self, index: usize, lists: &[Option<Vec<Value>>]) -> WorldPoint {
        let mut rest = index / self.repeat.unwrap_or(1);
        let mut values = vec![Value::Null; self.vary.len()];
        for (k, vary) in self.vary.iter().enumerate().rev() {
            values[k] = match &lists[k] {
                Some(list) => {
                    let value = list[rest % list.len()].clone();
                    rest /= list.len();
                    value
                }
                None => vary.draw(&mut Draw::of(self.seed, index as u64, &vary.at)),
            };
        }
        WorldPoint { index, seed: Draw::of(self.seed, index as u64, "").next_u64(), values }
    }
}
