//! What is simulated, as a tree of words in which values are put, and the world that it describes.

use super::row::Plan;
use super::spec::{Spec, WorldPoint};
use crate::cli::args::{PackageArgs, RunArgs};
use crate::cli::check::read_text;
use crate::cli::scene::{Scene, SceneFile, plain};
use crate::cli::script::ScriptText;
use crate::cli::start::Start;
use crate::cli::start_args::StartArgs;
use crate::cli::texts::listening;
use crate::record::story::{digest, file_digest};
use serde::Deserialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The tree: `scene` and `run`.
pub struct Document {
    tree: Value,
    /// Where each entry of `vary` goes, and how its column is called.
    places: Vec<(String, String)>,
    /// Of the whole specification.
    words: String,
    /// The file that relative paths of the scene start at.
    scene_file: PathBuf,
    /// The folder that relative paths of `run` start at.
    folder: PathBuf,
}

/// `run`: the options of `simulate`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Options {
    urdf: Option<PathBuf>,
    #[serde(default)]
    packages: BTreeMap<String, PathBuf>,
    #[serde(default)]
    ground: bool,
    duration: f64,
    control_interval: Option<f64>,
    steps: Option<u32>,
    iterations: Option<u32>,
    integrator: Option<String>,
    accuracy: Option<f64>,
    engine: Option<String>,
    gravity: Option<[f64; 3]>,
    time_scale: Option<f64>,
    base: Option<String>,
    base_pose: Option<[f64; 7]>,
    base_twist: Option<[f64; 6]>,
    #[serde(default)]
    set: BTreeMap<String, Numbers>,
    #[serde(default)]
    turn: BTreeMap<String, Numbers>,
    #[serde(default)]
    effort: BTreeMap<String, Numbers>,
    #[serde(default)]
    servo: BTreeMap<String, Numbers>,
    /// A file, or its entries.
    script: Option<Value>,
    #[serde(default)]
    off: Vec<String>,
    #[serde(default)]
    on: Vec<String>,
    every: Option<f64>,
}

/// A number, or a list of them.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Numbers {
    One(f64),
    Many(Vec<f64>),
}

fn joined(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(",")
}

fn assignments(of: &BTreeMap<String, Numbers>) -> Vec<String> {
    let one = |(name, numbers): (&String, &Numbers)| match numbers {
        Numbers::One(x) => format!("{name}={x:?}"),
        Numbers::Many(xs) => format!("{name}={}", joined(xs)),
    };
    of.iter().map(one).collect()
}

impl Document {
    /// The tree of a specification; a scene that is a file is read.
    ///
    /// # Errors
    /// The scene cannot be read.
    pub fn new(spec: &Spec, file: &Path) -> Result<Self, String> {
        let folder = file.parent().unwrap_or(Path::new("")).to_owned();
        let (scene, scene_file) = match &spec.scene {
            Some(Value::String(path)) => {
                let path = folder.join(path);
                let words: Value = serde_saphyr::from_str(&read_text(&path)?)
                    .map_err(|e| format!("{}: {}", path.display(), plain(&e.to_string())))?;
                (words, path)
            }
            Some(words) => (words.clone(), file.to_owned()),
            None => (Value::Object(Map::from_iter([("version".into(), 1.into())])), file.to_owned()),
        };
        let tree = Value::Object(Map::from_iter([
            ("scene".to_owned(), scene),
            ("run".to_owned(), Value::Object(spec.run.clone())),
        ]));
        let places = spec.vary.iter().map(|v| (v.at.clone(), v.name().to_owned())).collect();
        // Never fails: it has been read from such a text.
        let words = serde_json::to_string(spec).unwrap_or_default();
        Ok(Self { tree, places, words, scene_file, folder })
    }

    /// Makes the first world on trial: what is wrong with it is wrong with the specification. The columns of all worlds, and what
    /// their rows are known by.
    ///
    /// # Errors
    /// Exit code and reason.
    pub fn trial(&self, first: &WorldPoint, file: &Path) -> Result<Plan, (u8, String)> {
        let usage = |reason: String| (2, format!("{}: {reason}", file.display()));
        let (start, heard) = listening(|| self.start(first));
        let start = start.map_err(|(code, reason)| (code, format!("{}: world 0: {reason}", file.display())))?;
        let texts: Vec<&String> = heard.texts.values().collect();
        let meshes: Vec<Option<String>> = heard.meshes.iter().map(|f| file_digest(f)).collect();
        let version = env!("CARGO_PKG_VERSION");
        let known_by = digest(&(version, &self.words, &self.tree, texts, meshes));
        let names = self.places.iter().map(|(_, name)| name.clone()).collect();
        Plan::new(known_by, names, start).map_err(usage)
    }

    /// The start of a world.
    ///
    /// # Errors
    /// Exit code and reason.
    pub fn start(&self, world: &WorldPoint) -> Result<Start, (u8, String)> {
        let usage = |reason: String| (2, reason);
        let mut tree = self.tree.clone();
        for ((at, _), value) in self.places.iter().zip(&world.values) {
            put(&mut tree, at, value.clone()).map_err(|reason| usage(format!("vary '{at}': {reason}")))?;
        }
        let words: SceneFile = words(&tree["scene"]).map_err(|r| usage(format!("scene: {r}")))?;
        let scene = Scene::of_words(words, &self.scene_file).map_err(|r| usage(format!("scene: {r}")))?;
        let o: Options = words_of_run(&tree["run"]).map_err(usage)?;
        let script = o.script.as_ref().map(|s| self.script(s)).transpose().map_err(usage)?;
        let start = StartArgs {
            urdf: o.urdf.map(|u| self.folder.join(u)),
            packages: PackageArgs { packages: o.packages.into_iter().map(|(n, p)| (n, self.folder.join(p))).collect() },
            scene: None,
            ground: o.ground,
            integrator: o.integrator,
            base: o.base,
            set: assignments(&o.set),
            base_pose: o.base_pose.map(|p| joined(&p)),
            base_twist: o.base_twist.map(|t| joined(&t)),
            effort: assignments(&o.effort),
            servo: assignments(&o.servo),
            off: o.off,
        };
        let args = RunArgs {
            start,
            duration: o.duration,
            control_interval: o.control_interval,
            steps: o.steps,
            iterations: o.iterations,
            accuracy: o.accuracy,
            gravity: o.gravity.map(|g| joined(&g)),
            time_scale: o.time_scale,
            turn: assignments(&o.turn),
            script: None,
            on: o.on,
        };
        if let Some(base) = args.start.base.as_deref().filter(|b| !["fixed", "free"].contains(b)) {
            return Err(usage(format!("run: base '{base}' does not exist; choose one of: fixed, free")));
        }
        Start::of_scene(&args, (scene, script), o.engine.as_deref(), o.every)
    }

    fn script(&self, script: &Value) -> Result<ScriptText, String> {
        match script {
            Value::String(file) => ScriptText::read(&self.folder.join(file)),
            entries => Ok(ScriptText { label: "run.script".into(), text: entries.to_string() }),
        }
    }
}

/// JSON is YAML: the same reader, with the same refusals.
fn words<T: serde::de::DeserializeOwned>(value: &Value) -> Result<T, String> {
    serde_saphyr::from_str(&value.to_string()).map_err(|e| plain(&e.to_string()))
}

fn words_of_run(value: &Value) -> Result<Options, String> {
    serde_json::from_value(value.clone()).map_err(|e| format!("run: {e}"))
}

/// Puts a value at a path. Entries of lists go by number, or by their name.
fn put(tree: &mut Value, path: &str, value: Value) -> Result<(), String> {
    let mut here = tree;
    for step in path.split('.') {
        here = match here {
            Value::Array(list) => {
                let named = |v: &Value| v.get("name").and_then(Value::as_str) == Some(step);
                let (count, place) = (list.len(), step.parse().ok().or_else(|| list.iter().position(named)));
                let missing = || format!("there is no entry '{step}'; the list has {count}, from 0");
                place.and_then(|k: usize| list.get_mut(k)).ok_or_else(missing)?
            }
            Value::Null => {
                *here = Value::Object(Map::new());
                member(here, step)?
            }
            _ => member(here, step)?,
        };
    }
    *here = value;
    Ok(())
}

/// A member of an object, which is made if it is not there.
fn member<'a>(here: &'a mut Value, step: &str) -> Result<&'a mut Value, String> {
    match here {
        Value::Object(map) => Ok(map.entry(step).or_insert(Value::Null)),
        other => Err(format!("'{step}' cannot be in {other}, which has no parts")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn values_go_where_the_path_says() {
        let mut tree = json!({"scene": {"bodies": [{"name": "ball", "pose": [0, 0, 1]}], "world": {}}, "run": {}});
        put(&mut tree, "scene.bodies.ball.pose.2", json!(2.5)).unwrap();
        put(&mut tree, "scene.bodies.0.mass", json!(3)).unwrap();
        put(&mut tree, "scene.world.effects.contact", json!(false)).unwrap();
        put(&mut tree, "run.set.knee", json!(0.1)).unwrap();
        let expected = json!({
            "scene": {
                "bodies": [{"name": "ball", "pose": [0, 0, 2.5], "mass": 3}],
                "world": {"effects": {"contact": false}},
            },
            "run": {"set": {"knee": 0.1}},
        });
        assert_eq!(tree, expected);
    }

    #[test]
    fn a_path_that_leads_nowhere_is_refused() {
        let mut tree = json!({"scene": {"ground": true, "bodies": []}});
        let reason = put(&mut tree, "scene.ground.friction", json!(1)).unwrap_err();
        assert!(reason.contains("'friction' cannot be in true"), "{reason}");
        let reason = put(&mut tree, "scene.bodies.ball.mass", json!(1)).unwrap_err();
        assert!(reason.contains("no entry 'ball'; the list has 0"), "{reason}");
    }
}
