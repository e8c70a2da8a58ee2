//! What a case file may say, word by word. Unknown keys are refused, with their line.

use crate::cli::scene::SceneFile;
use crate::cli::script::Entry;
use serde::Deserialize;
use serde_json::Value;
use serde_saphyr::Spanned;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CaseFile {
    /// Version of the format: 1.
    pub version: u32,
    /// What the case shows, one sentence.
    pub shows: String,
    /// What an engine must be able to do, by the names of its capabilities.
    #[serde(default)]
    pub needs: Vec<Spanned<String>>,
    /// The scene, in the words of a scene file …
    pub scene: Option<SceneFile>,
    /// … or the file itself; a relative path starts at the case file.
    pub scene_file: Option<PathBuf>,
    /// Speeds of axes at start, rad/s or m/s.
    #[serde(default)]
    pub speeds: BTreeMap<String, f64>,
    /// Commands over time, as `--script` takes them.
    #[serde(default)]
    pub commands: Vec<Spanned<Entry>>,
    /// Simulated time, s.
    pub duration: f64,
    /// `name = formula`, each of which may use those before it.
    #[serde(default)]
    pub constants: Vec<Spanned<String>>,
    /// What theory says.
    pub expect: Vec<Spanned<Expected>>,
}

/// An entry of `expect:`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Expected {
    /// Name in tables; made of the other words if it is absent.
    pub name: Option<String>,
    /// What is looked at.
    pub quantity: String,
    /// Of which link or axis.
    pub of: Option<String>,
    /// Of a vector: x, y, z, length, horizontal or direction; all of it if absent.
    pub part: Option<String>,
    /// A point in the frame of the link, m, instead of its origin.
    pub point: Option<[f64; 3]>,
    /// Which of the crossings, from 1.
    pub count: Option<u32>,
    /// Instants, s; the end if absent.
    pub at: Option<Vec<f64>>,
    /// From here to there, s; with `take`.
    pub between: Option<[f64; 2]>,
    /// greatest or least.
    pub take: Option<String>,
    /// The value: a formula, or a list of three.
    pub is: Value,
    /// The same in words.
    pub theory: String,
    /// How far each engine may be away: a formula per name; `others` for those that are not named.
    pub within: BTreeMap<String, Value>,
    /// Why so far.
    pub because: String,
    /// Engines that are further away, and by how much.
    #[serde(default)]
    pub beyond: BTreeMap<String, Beyond>,
}

/// An engine that is known to miss its tolerance.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beyond {
    /// Its error, as it was measured.
    pub error: f64,
    /// Why.
    pub because: String,
}
