//! URDF text → model, with every finding on the way.

use crate::contact::{Defaults, colliders};
use crate::description::{self, Description, Finding, Severity, WORLD_ANCHOR};
use crate::dynamics::singular_axes;
use crate::engine::{EngineKind, State, come_apart, not_honoured};
use crate::mass::{LinkBody, MassProperties, link_bodies, with_inertials};
use crate::math::Pose;
use crate::model::{Base, LinkFrame, Model};
use crate::shape::Meshes;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// The default humanoid.
pub const EMBEDDED: &str = include_str!("../../urdf/origin.urdf");
/// How it is called in messages.
pub const EMBEDDED_NAME: &str = "urdf/origin.urdf";

/// Which robot; by default the embedded humanoid.
#[derive(Clone, Copy, Default)]
pub struct Source<'a> {
    /// URDF file; `None`: the embedded humanoid.
    pub urdf: Option<&'a Path>,
    /// Names and folders of packages.
    pub packages: &'a [(String, PathBuf)],
}

/// What loading gives.
pub struct Loaded {
    /// What the text says.
    pub description: Description,
    /// What each link weighs.
    pub bodies: Vec<LinkBody>,
    /// The mesh files that have been read.
    pub meshes: Meshes,
    /// What is simulated.
    pub model: Arc<Model>,
    /// Warnings and notes.
    pub findings: Vec<Finding>,
    /// The text for other tools (`robot_description`): with an exact `<inertial>` where ours came from a tag.
    pub published: String,
}

/// A text with all that could be found out about it.
pub struct Examined {
    /// File name for messages.
    pub file: String,
    /// The text.
    pub text: String,
    /// Everything found; the robot is loaded only if no error is among them.
    pub findings: Vec<Finding>,
    /// Present if nothing found is an error.
    pub robot: Option<(Description, Vec<LinkBody>, Model)>,
    /// The mesh files that have been read.
    pub meshes: Meshes,
}

impl Examined {
    /// True if nothing found is an error.
    pub fn is_sound(&self) -> bool {
        self.robot.is_some()
    }

    /// Findings of at least this severity, for people.
    pub fn report(&self, least: Severity, color: bool) -> String {
        let shown: Vec<Finding> = self.findings.iter().filter(|f| f.severity >= least).cloned().collect();
        if shown.is_empty() { String::new() } else { description::render(&shown, &self.file, &self.text, color) }
    }
}

/// Loads a robot.
///
/// # Errors
/// The printable report: every finding, or why the file could not be read.
pub fn load(source: Source, base: Base) -> Result<Loaded, String> {
    load_at(source, base, Pose::identity())
}

/// As [`load`]; where that fails, the report is printed.
///
/// # Errors
/// The exit code.
pub fn load_or_say(source: Source, base: Base) -> Result<Loaded, ExitCode> {
    load(source, base).map_err(|report| {
        eprint!("{report}");
        ExitCode::FAILURE
    })
}

/// As [`load`], with the root link of a fixed base at `base_pose` in the world.
///
/// # Errors
/// As [`load`].
pub fn load_at(source: Source, base: Base, base_pose: Pose) -> Result<Loaded, String> {
    loaded(examine(source, base, base_pose)?)
}

/// What was examined, if it is sound.
///
/// # Errors
/// The printable report.
pub fn loaded(examined: Examined) -> Result<Loaded, String> {
    let report = || examined.report(Severity::Warning, false);
    let Some((description, bodies, model)) = examined.robot else { return Err(report()) };
    let published = with_inertials(&examined.text, &properties(&bodies), &description);
    let (findings, meshes) = (examined.findings, examined.meshes);
    Ok(Loaded { description, bodies, meshes, model: Arc::new(model), findings, published })
}

/// How a robot stands in the world.
#[derive(Clone, Copy, Default)]
pub struct Setup {
    /// How its root is held.
    pub base: Base,
    /// Root link of a fixed base in the world.
    pub base_pose: Pose,
    /// What its surfaces are like where its tags do not say.
    pub surface: Defaults,
    /// Who simulates it.
    pub engine: EngineKind,
}

/// Reads and checks a robot as far as it goes.
///
/// # Errors
/// Why the file could not be read.
pub fn examine(source: Source, base: Base, base_pose: Pose) -> Result<Examined, String> {
    examine_with(source, Setup { base, base_pose, ..Setup::default() })
}

/// As [`examine`].
///
/// # Errors
/// As [`examine`].
pub fn examine_with(source: Source, setup: Setup) -> Result<Examined, String> {
    let (file, text) = match source.urdf {
        Some(path) => (path.display().to_string(), super::check::read_text(path)?),
        None => (EMBEDDED_NAME.to_owned(), EMBEDDED.to_owned()),
    };
    Ok(examine_text((&file, &text), source.packages, setup))
}

/// Checks the text of a robot as far as it goes; mesh files are looked for beside `file`.
pub fn examine_text((file, text): (&str, &str), packages: &[(String, PathBuf)], setup: Setup) -> Examined {
    let reading = description::read(text, file);
    let meshes = Meshes::beside(Path::new(file), packages);
    let mut findings = reading.findings;
    let robot = reading.description.and_then(|d| {
        let base = if is_static(&d) { Base::Fixed } else { setup.base };
        let (bodies, more) = link_bodies(&d, &meshes);
        findings.extend(more);
        findings.extend(loose_anchors(&d, base));
        if findings.iter().any(|f| f.severity == Severity::Error) {
            return None;
        }
        let simulated: Vec<MassProperties> = bodies.iter().map(|body| body.simulated).collect();
        let mut model = Model::build(&d, &simulated, base, setup.base_pose);
        findings.extend(colliders(&d, &mut model, &meshes, setup.surface));
        findings.extend(not_honoured(setup.engine, &d, &model));
        let singular = singular_axes(&model);
        findings.extend(singular.iter().map(|body| singular_finding(&d, &model, *body)));
        let unsound = if singular.is_empty() { unsound_breaks(&d, &model) } else { vec![] };
        let sound = singular.is_empty() && unsound.is_empty();
        findings.extend(unsound);
        sound.then_some((d, bodies, model))
    });
    super::texts::remember_files(&meshes);
    Examined { file: file.to_owned(), text: text.to_owned(), findings, robot, meshes }
}

/// B-2: a root of specific gravity 0 stands still, whatever holds it.
fn is_static(d: &Description) -> bool {
    let is_root = |link: &&description::Link| !d.joints.iter().any(|joint| joint.child == link.name);
    let root = d.links.iter().find(is_root).and_then(|link| link.body.as_ref());
    root.is_some_and(|body| body.substance.specific_gravity == 0.0)
}

fn properties(bodies: &[LinkBody]) -> Vec<MassProperties> {
    bodies.iter().map(|body| body.properties).collect()
}

/// J-7: a chain anchored to the world stands on a fixed base.
fn loose_anchors(d: &Description, base: Base) -> Vec<Finding> {
    let is_link = d.links.iter().any(|link| link.name == WORLD_ANCHOR);
    let at_world = |chain: &&description::Chain| !is_link && chain.anchor.as_deref() == Some(WORLD_ANCHOR);
    let loose = d.chains.iter().filter(|chain| base == Base::Free && at_world(chain));
    let told = loose.map(|chain| Finding {
        severity: Severity::Error,
        code: "chain-anchor",
        message: format!("the chain of '{}' is anchored to the world, but the base of the robot is free", chain.root),
        element: format!("robot '{}' <chain>", d.name),
        at: chain.at,
        mend: "simulate it with a fixed base (--base fixed, parameter base), or anchor the chain to a link".into(),
    });
    told.collect()
}

/// The joint that carries no inertia, or the root link of a free base, found by the link on its body.
fn singular_finding(d: &Description, m: &Model, body: usize) -> Finding {
    let body = carrier(m, body);
    let carried = |frame: &LinkFrame| matches!(frame, LinkFrame::OnBody { body: b, .. } if *b == body);
    let link = m.links.iter().position(|l| carried(&l.frame));
    let moving = m.links.iter().position(|l| carried(&l.frame) && !l.fixed);
    let joint = moving.or(link).and_then(|l| d.joints.iter().find(|j| j.child == m.links[l].name));
    let (element, at) = match (joint, link) {
        (Some(joint), _) => (format!("joint '{}'", joint.name), joint.at),
        (None, Some(link)) => (format!("link '{}', the free base", d.links[link].name), d.links[link].at),
        (None, None) => (format!("body {body}"), Default::default()),
    };
    Finding {
        severity: Severity::Error,
        code: "singular-joint",
        message: "what moves here has no inertia in a direction in which it moves: its acceleration would be infinite"
            .into(),
        element,
        at,
        mend: "give this link, or those fixed to it, mass and inertia, or make the joint fixed".into(),
    }
}

/// The body itself, or, for a massless one that a soft joint adds, the one that the joint carries.
fn carrier(m: &Model, body: usize) -> usize {
    let has_link = |b: usize| m.links.iter().any(|l| matches!(l.frame, LinkFrame::OnBody { body, .. } if body == b));
    let outwards = |b: &usize| m.bodies.iter().skip(*b + 1).position(|next| next.parent == *b).map(|n| b + 1 + n);
    std::iter::successors(Some(body), outwards).find(|b| has_link(*b)).unwrap_or(body)
}

/// Joints whose break would leave something that cannot be simulated.
fn unsound_breaks(d: &Description, m: &Model) -> Vec<Finding> {
    let unsound = |body| !singular_axes(&come_apart(m, &State::initial(m), body).0).is_empty();
    let found = m.breakables.iter().filter(|b| unsound(b.body)).map(|b| Finding {
        severity: Severity::Error,
        code: "singular-break",
        message:
            "once this joint has come apart, something is left that has no inertia in a direction in which it moves"
                .into(),
        element: format!("joint '{}'", b.joint),
        at: d
            .joints
            .iter()
            .find(|j| j.name == b.joint)
            .and_then(|j| j.constraint.as_ref())
            .map_or_else(Default::default, |c| c.at),
        mend: "give the links on both sides of the joint mass and inertia, or take the break_threshold out".into(),
    });
    found.collect()
}
