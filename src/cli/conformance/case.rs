//! A case file, checked.

use super::file::{Beyond, CaseFile, Expected};
use super::formula::{Formula, Names};
use super::list::abilities;
use super::quantity::{About, Owner, PARTS, Part, Probe, QUANTITIES, Quantity, index};
use crate::cli::load::Source;
use crate::cli::scene::{Fault, Scene, Spare, assemble, plain};
use crate::cli::script::Script;
use crate::engine::State;
use crate::math::Vec3;
use crate::model::{AxisKind, Base, Model};
use crate::world::{EngineKind, Integrator, Settings, World};
use serde_json::Value;
use serde_saphyr::Spanned;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An instant is on a control interval if it is this near to it, in intervals: far more than rounding, far less than a mistake.
const ON_INTERVAL: f64 = 1e-6;
/// Unit of rounding of single precision, for engines that compute in it.
const SINGLE: f64 = 5.960_464_477_539_063e-8;

/// A scene with what theory says of it.
#[derive(Debug)]
pub struct Case {
    /// That of the file.
    pub name: String,
    /// What it shows, one sentence.
    pub shows: String,
    /// Capabilities without which an engine skips it.
    pub needs: Vec<&'static str>,
    /// In the order of the file.
    pub expectations: Vec<Expectation>,
    /// Those of the scene, whatever the engine.
    pub settings: Settings,
    /// `name = formula`, as the file has them.
    pub constants: Vec<String>,
    pub(super) model: Arc<Model>,
    pub(super) initial: State,
    pub(super) script: Script,
    /// Control intervals.
    pub(super) intervals: u64,
}

/// With what a case is run instead of what its scene says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rung {
    /// Of rbx.
    pub integrator: Integrator,
    /// Control interval and step in one, ns.
    pub step_ns: i64,
}

/// When an expectation is looked at.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum When {
    /// After these numbers of control intervals.
    At(Vec<u64>),
    /// Extremum from one to the other.
    Greatest([u64; 2]),
    Least([u64; 2]),
}

/// What theory says of one quantity.
#[derive(Debug)]
pub struct Expectation {
    /// In tables; no other one of the case has it.
    pub name: String,
    /// The value in words.
    pub theory: String,
    /// Why an engine may be so far away.
    pub because: String,
    /// Engines that are further away, by name.
    pub beyond: BTreeMap<String, Beyond>,
    pub(super) probe: Probe,
    pub(super) count: u32,
    pub(super) when: When,
    pub(super) value: Vec<Formula>,
    within: BTreeMap<String, Formula>,
    pub(super) names: Names,
}

impl Expectation {
    /// The unit of value and error.
    pub fn unit(&self) -> &'static str {
        self.probe.unit()
    }

    /// How many numbers the value is: 1 or 3.
    pub fn size(&self) -> usize {
        self.value.len()
    }

    /// The value as the file has it.
    pub fn formula(&self) -> String {
        let parts: Vec<&str> = self.value.iter().map(Formula::text).collect();
        if parts.len() == 1 { parts.concat() } else { format!("({})", parts.join(", ")) }
    }

    /// What an engine may miss it by, as the file has it.
    pub fn allowed(&self, engine: EngineKind) -> &str {
        self.tolerance(engine).map_or("", Formula::text)
    }

    pub(super) fn tolerance(&self, engine: EngineKind) -> Option<&Formula> {
        self.within.get(engine.name()).or(self.within.get("others"))
    }

    /// The value, of which a single number is the first of the three.
    pub(super) fn should(&self, names: &Names) -> Vec3 {
        let value = |i: usize| self.value.get(i).map_or(0.0, |f| f.value(names));
        Vec3::new(value(0), value(1), value(2))
    }
}

impl Case {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the file, the line, and what makes no sense there.
    pub fn read(path: &Path) -> Result<Self, String> {
        Self::read_at(path, None)
    }

    /// Reads a file, to be run with this integrator and step.
    ///
    /// # Errors
    /// As [`Self::read`]; also if a time of the case is no multiple of the step.
    pub fn read_at(path: &Path, rung: Option<Rung>) -> Result<Self, String> {
        let told = |reason: String| format!("{}: {reason}", path.display());
        let text = crate::cli::check::read_text(path)?;
        let file: CaseFile = serde_saphyr::from_str(&text).map_err(|e| told(plain(&e.to_string())))?;
        Self::checked(file, path, rung).map_err(told)
    }

    fn checked(file: CaseFile, path: &Path, rung: Option<Rung>) -> Result<Self, String> {
        if file.version != 1 {
            return Err(format!("version is {}; it must be 1", file.version));
        }
        let needs: Result<Vec<&'static str>, String> = file.needs.iter().map(need).collect();
        let needs = needs?;
        let scene = scene(file.scene, file.scene_file, path)?;
        let mut settings = Settings { engine: EngineKind::default(), ..scene.settings };
        if let Some(Rung { integrator, step_ns }) = rung {
            settings = Settings { integrator, control_interval_ns: step_ns, steps_per_interval: 1, ..settings };
        }
        let stand = (scene.base.unwrap_or(Base::Fixed), scene.robot.pose);
        let all = assemble(&scene, Source::default(), stand, Spare::Nobody, &|m| scene.switch_effects(m));
        let all = all.map_err(|(Fault::Robot(reason) | Fault::Scene(reason))| reason)?;
        let (model, mut initial) = (Arc::new(all.model), all.initial);
        start(&model, &mut initial, &file.speeds)?;
        let mut world = World::new(model.clone(), settings)?;
        world.set_initial_state(initial.clone());
        let interval = crate::cli::simulate::interval(&settings);
        let intervals = on_interval(file.duration, interval).map_err(|reason| format!("duration: {reason}"))?;
        let shown = path.display().to_string();
        let script = Script::compile(file.commands, &shown, (&world, &all.first.description), (interval, intervals))?;
        if let Some(odd) = script.warnings.first() {
            return Err(format!("commands: {odd}"));
        }
        let names = constants(&file.constants, &settings)?;
        let mut expectations: Vec<Expectation> = vec![];
        for (i, entry) in file.expect.into_iter().enumerate() {
            let place = format!("line {}: expect[{i}] '{}'", entry.defined.line(), entry.value.quantity);
            let told = |reason: String| format!("{place}: {reason}");
            let integrator = settings.integrator.name();
            let reader = Reader { model: &model, names: &names, needs: &needs, interval, intervals, integrator };
            let expectation = reader.expectation(entry.value).map_err(told)?;
            if expectations.iter().any(|e| e.name == expectation.name) {
                return Err(told(format!("'{}' is there twice; give one of them another name", expectation.name)));
            }
            expectations.push(expectation);
        }
        let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let constants = file.constants.into_iter().map(|c| c.value).collect();
        Ok(Self {
            name,
            shows: file.shows,
            needs,
            expectations,
            settings,
            constants,
            model,
            initial,
            script,
            intervals,
        })
    }

    /// What of [`Case::needs`] an engine cannot.
    pub fn lacks(&self, engine: EngineKind) -> Vec<&'static str> {
        lacking(&self.needs, engine)
    }
}

fn lacking(needs: &[&'static str], engine: EngineKind) -> Vec<&'static str> {
    let can = abilities(&engine.capabilities());
    needs.iter().copied().filter(|name| can.iter().any(|a| a.name == *name && !a.can)).collect()
}

fn need(name: &Spanned<String>) -> Result<&'static str, String> {
    let known = abilities(&EngineKind::default().capabilities());
    known.iter().map(|a| a.name).find(|n| *n == name.value).ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|a| a.name).collect();
        let line = name.defined.line();
        format!("line {line}: needs: there is no capability '{}'; they are: {}", name.value, names.join(", "))
    })
}

fn scene(words: Option<crate::cli::scene::SceneFile>, file: Option<PathBuf>, path: &Path) -> Result<Scene, String> {
    match (words, file) {
        (Some(words), None) => Scene::of_words(words, path).map_err(|reason| format!("scene: {reason}")),
        (None, Some(file)) => Scene::read(Some(&path.parent().unwrap_or(Path::new("")).join(file))),
        _ => Err("give it one of scene (in words) and scene_file (a path)".into()),
    }
}

fn start(m: &Model, s: &mut State, speeds: &BTreeMap<String, f64>) -> Result<(), String> {
    for (name, speed) in speeds {
        let axis = crate::cli::commands::axis(m, "speeds", name)?;
        if !speed.is_finite() {
            return Err(format!("speeds: {name} is {speed}; it must be a finite number"));
        }
        let (position, _) = s.axis(m, axis);
        s.set_axis(m, axis, position, *speed);
    }
    Ok(())
}

/// `name = formula`, after those that every case has.
fn constants(given: &[Spanned<String>], s: &Settings) -> Result<Names, String> {
    let mut names = Names::default();
    let interval = crate::cli::simulate::interval(s);
    names.set("g", Vec3::from(s.gravity).norm());
    names.set("dt", interval);
    names.set("h", interval / f64::from(s.steps_per_interval));
    names.set("n", f64::from(s.solver_iterations));
    names.set("single", SINGLE);
    names.set("t", f64::NAN);
    for entry in given {
        let told = |reason: String| format!("line {}: constants: {reason}", entry.defined.line());
        let (name, text) = entry
            .value
            .split_once('=')
            .map(|(name, text)| (name.trim(), text))
            .ok_or_else(|| told(format!("'{}' must be name = formula", entry.value)))?;
        let sound = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
            && name.starts_with(|c: char| c.is_ascii_alphabetic());
        if !sound || names.has(name) || ["PI", "E", "e", "TAU"].contains(&name) {
            return Err(told(format!("'{name}' is no name, or already has a value")));
        }
        let value = Formula::read(&Value::String(text.into()), &names).map_err(told)?.value(&names);
        if !value.is_finite() {
            return Err(told(format!("{name} is {value}; it must be finite, and without t")));
        }
        names.set(name, value);
    }
    Ok(names)
}

/// Whole control intervals of a time.
fn on_interval(time: f64, interval: f64) -> Result<u64, String> {
    let ratio = time / interval;
    if ratio.is_finite() && ratio >= 0.0 && (ratio - ratio.round()).abs() <= ON_INTERVAL {
        Ok(ratio.round() as u64)
    } else {
        Err(format!("{time} s must be a whole multiple of the control interval, {interval} s"))
    }
}

/// What is the same for all entries of a file.
struct Reader<'a> {
    model: &'a Model,
    names: &'a Names,
    needs: &'a [&'static str],
    interval: f64,
    intervals: u64,
    integrator: &'static str,
}

impl Reader<'_> {
    fn expectation(&self, e: Expected) -> Result<Expectation, String> {
        let about = QUANTITIES.iter().find(|a| a.name == e.quantity).ok_or_else(|| {
            let names: Vec<&str> = QUANTITIES.iter().map(|a| a.name).collect();
            format!("there is no such quantity; they are: {}", names.join(", "))
        })?;
        let part = part(about, e.part.as_deref())?;
        let index = index(self.model, about.owner, e.of.as_deref())?;
        let count = count(about, e.count)?;
        if e.point.is_some() && !matches!(about.quantity, Quantity::Position | Quantity::Velocity) {
            return Err("point: only position and velocity have one".into());
        }
        let linear = about.owner == Owner::Axis && self.model.axes[index].kind == AxisKind::Linear;
        let probe = Probe { about, index, linear, part, point: e.point.map_or(Vec3::zeros(), Vec3::from) };
        let when = self.when(&e, part)?;
        let name = e.name.clone().unwrap_or_else(|| automatic(&e, &when));
        if [&name, &e.theory, &e.because].iter().any(|text| text.contains(['|', '\n'])) {
            return Err("name, theory and because are cells of a table: one line each, without |".into());
        }
        let value = self.value(&e.is, part)?;
        let within = self.within(&e)?;
        if let Some(name) = e.beyond.keys().find(|name| !known(name)) {
            return Err(format!("beyond: there is no engine '{name}'"));
        }
        let (theory, because, beyond) = (e.theory, e.because, self.of_integrator(e.beyond));
        let names = self.names.clone();
        Ok(Expectation { name, theory, because, beyond, probe, count, when, value, within, names })
    }

    fn when(&self, e: &Expected, part: Part) -> Result<When, String> {
        let on = |time: &f64| match on_interval(*time, self.interval)? {
            n if n > self.intervals => Err(format!("{time} s is after the end of the run")),
            n => Ok(n),
        };
        match (&e.at, e.between, e.take.as_deref()) {
            (None, None, None) => Ok(When::At(vec![self.intervals])),
            (Some(at), None, None) if !at.is_empty() => Ok(When::At(at.iter().map(on).collect::<Result<_, _>>()?)),
            (None, Some([from, to]), Some(take)) => {
                let range = [on(&from)?, on(&to)?];
                match take {
                    _ if range[0] > range[1] || part.is_vector() => {
                        Err("between: a single number, from one time to a later one".into())
                    }
                    "greatest" => Ok(When::Greatest(range)),
                    "least" => Ok(When::Least(range)),
                    other => Err(format!("take '{other}' does not exist; choose one of: greatest, least")),
                }
            }
            _ => Err("give it at (a list of times), or between with take, or neither for the end".into()),
        }
    }

    fn value(&self, is: &Value, part: Part) -> Result<Vec<Formula>, String> {
        let told = |reason: String| format!("is: {reason}");
        match (is, part.is_vector()) {
            (Value::Array(three), true) if three.len() == 3 => {
                three.iter().map(|one| Formula::read(one, self.names)).collect::<Result<_, _>>().map_err(told)
            }
            (_, true) => Err("is: must be a list of three, or name a part: x, y, z, length, horizontal".into()),
            (one, false) => Ok(vec![Formula::read(one, self.names).map_err(told)?]),
        }
    }

    /// A tolerance for every engine that does not skip the case.
    fn within(&self, e: &Expected) -> Result<BTreeMap<String, Formula>, String> {
        let mut within = BTreeMap::new();
        for (name, value) in &e.within {
            if name != "others" && !known(name) {
                return Err(format!("within: there is no engine '{name}'"));
            }
            let formula = Formula::read(value, self.names).map_err(|reason| format!("within: {name}: {reason}"))?;
            within.insert(name.clone(), formula);
        }
        let can = |kind: &EngineKind| lacking(self.needs, *kind).is_empty();
        let mut kinds = EngineKind::NAMES.iter().map(|(_, kind)| *kind).filter(can);
        match kinds.find(|kind| !within.contains_key(kind.name()) && !within.contains_key("others")) {
            Some(kind) => Err(format!("within: the engine {} has no tolerance; add it, or others", kind.name())),
            None => Ok(self.of_integrator(within)),
        }
    }

    /// What is said of rbx with the integrator of the run is said of rbx.
    fn of_integrator<T>(&self, mut said: BTreeMap<String, T>) -> BTreeMap<String, T> {
        if let Some(own) = said.remove(self.integrator) {
            said.insert(EngineKind::Rbx.name().into(), own);
        }
        said.retain(|name, _| Integrator::by_name(name).is_none());
        said
    }
}

/// Engines, and integrators of rbx.
fn known(name: &str) -> bool {
    EngineKind::by_name(name).is_some() || Integrator::by_name(name).is_some()
}

fn part(about: &About, name: Option<&str>) -> Result<Part, String> {
    match name {
        None if about.is_vector => Ok(Part::Whole),
        None => Ok(Part::Length),
        Some(_) if !about.is_vector => Err("part: this quantity is a single number; leave it out".into()),
        Some(name) => PARTS.iter().find(|(n, _)| *n == name).map(|(_, part)| *part).ok_or_else(|| {
            let names: Vec<&str> = PARTS.iter().map(|(n, _)| *n).collect();
            format!("part '{name}' does not exist; choose one of: {}", names.join(", "))
        }),
    }
}

fn count(about: &About, given: Option<u32>) -> Result<u32, String> {
    match (about.quantity == Quantity::CrossingTime, given) {
        (true, Some(n)) if n > 0 => Ok(n),
        (true, _) => Err("count is missing: which of the crossings, from 1?".into()),
        (false, None) => Ok(0),
        (false, Some(_)) => Err("count: only crossing_time has one".into()),
    }
}

/// A name made of the other words.
fn automatic(e: &Expected, when: &When) -> String {
    let mut words = vec![e.quantity.replace('_', " ")];
    words.extend(e.of.iter().map(|of| format!("of {of}")));
    words.extend(e.part.iter().cloned());
    words.extend(e.count.iter().map(|n| format!("number {n}")));
    match (&e.at, when) {
        (Some(at), _) => words.push(format!("at {} s", at.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))),
        (_, When::Greatest(_)) => words.push("at most".into()),
        (_, When::Least(_)) => words.push("at least".into()),
        _ => {}
    }
    words.join(" ")
}

/// The cases of a folder in the order of their names, or a single file.
///
/// # Errors
/// Every file that cannot be read, a line each.
pub fn cases(path: &Path) -> Result<Vec<Case>, String> {
    let (good, bad): (Vec<_>, Vec<_>) = files(path)?.iter().map(|f| Case::read(f)).partition(Result::is_ok);
    let reasons: Vec<String> = bad.into_iter().filter_map(Result::err).collect();
    if reasons.is_empty() { Ok(good.into_iter().flatten().collect()) } else { Err(reasons.join("\n")) }
}

/// The case files of a folder in the order of their names, or a single file.
///
/// # Errors
/// There is none, or the folder cannot be read.
pub fn files(path: &Path) -> Result<Vec<PathBuf>, String> {
    let told = |e: std::io::Error| format!("cannot read '{}': {e}", path.display());
    let mut files: Vec<PathBuf> = vec![path.to_owned()];
    if path.is_dir() {
        let entries: Result<Vec<_>, _> = std::fs::read_dir(path).map_err(told)?.collect();
        files = entries.map_err(told)?.into_iter().map(|e| e.path()).collect();
        files.retain(|f| f.extension().is_some_and(|e| e == "yaml") && f.is_file());
        files.sort();
    }
    if files.is_empty() {
        return Err(format!("'{}': there is no case in it, no file NAME.yaml", path.display()));
    }
    Ok(files)
}
