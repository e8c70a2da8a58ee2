//! `<joint>`: type, ends, origin, axis, limit, dynamics, mimic, and our tags.

use super::element::{Domain, Element};
use super::finding::Finding;
use super::report::Report;
use super::{Joint, JointKind, Limit, Mimic, Position, origin, suggest, tags, unknown};

const KNOWN: &[&str] = &[
    "origin",
    "parent",
    "child",
    "axis",
    "limit",
    "dynamics",
    "mimic",
    "safety_controller",
    "calibration",
    "realnoid",
];
const TYPES: [(&str, JointKind); 7] = [
    ("fixed", JointKind::Fixed),
    ("revolute", JointKind::Revolute),
    ("continuous", JointKind::Continuous),
    ("prismatic", JointKind::Prismatic),
    ("floating", JointKind::Floating),
    ("planar", JointKind::Planar),
    ("spherical", JointKind::Spherical),
];

/// Reads one joint; `None` if its type or its ends are unknown (reported).
pub(super) fn read(element: &Element, report: &mut Report) -> Option<Joint> {
    let name = element.required("name", report).unwrap_or_default().to_string();
    unknown::children(element, KNOWN, report);
    unknown::attributes(element, &["name", "type"], report);
    let kind = read_kind(element, report);
    let parent = read_end(element, "parent", report);
    let child = read_end(element, "child", report);
    let origin = origin::read(element, report);
    let axis = read_axis(element, kind, report);
    let limit = read_limit(element, kind, report);
    let (damping, friction) = read_dynamics(element, kind, report);
    let mimic = element.first("mimic", report).and_then(|e| read_mimic(&e, report));
    let (drive, constraint) = tags::joint::read(element, kind.unwrap_or(JointKind::Revolute), report);
    let ((parent, parent_at), (child, child_at)) = (parent?, child?);
    let kind = kind?;
    let at = element.place(report).at;
    #[rustfmt::skip]
    let joint = Joint {
        name, at, kind, parent, parent_at, child, child_at, origin, axis, limit, damping, friction, mimic, drive,
        constraint,
    };
    Some(joint)
}

fn read_kind(element: &Element, report: &mut Report) -> Option<JointKind> {
    let name = element.required("type", report)?.trim();
    let place = element.place_of("type", report);
    let Some((_, kind)) = TYPES.iter().find(|(known, _)| *known == name) else {
        let message = format!("'{name}' is not a joint type");
        let mend = suggest::mend(name, TYPES.map(|(known, _)| known), "known types");
        report.add(Finding::error("unknown-joint-type", place, message, mend));
        return None;
    };
    let instead = match kind {
        JointKind::Planar => "write two prismatic joints and a revolute one",
        JointKind::Spherical => "write three revolute joints and group them: <joint_group type=\"3dof\" …>",
        _ => return Some(*kind),
    };
    let message = format!("a {name} joint is not simulated");
    report.add(Finding::error("joint-not-simulated", place, message, instead));
    Some(*kind)
}

fn read_end(element: &Element, tag: &'static str, report: &mut Report) -> Option<(String, Position)> {
    let Some(end) = element.first(tag, report) else {
        let message = format!("the joint has no <{tag}>");
        let mend = format!("add <{tag} link=\"…\"/>");
        report.add(Finding::error("missing-element", element.place(report), message, mend));
        return None;
    };
    let link = end.required("link", report)?;
    Some((link.to_string(), end.place_of("link", report).at))
}

/// The axis at unit length; URDF's default is X.
fn read_axis(element: &Element, kind: Option<JointKind>, report: &mut Report) -> [f64; 3] {
    const DEFAULT: [f64; 3] = [1.0, 0.0, 0.0];
    let moves = has_axis(kind);
    let Some(axis) = element.first("axis", report) else {
        if moves {
            let message = "no <axis>: URDF then takes X".to_string();
            let mend = "write <axis xyz=\"1 0 0\"/> if that is meant";
            report.add_once("", Finding::note("default-axis", element.place(report), message, mend));
        }
        return DEFAULT;
    };
    unknown::attributes(&axis, &["xyz"], report);
    let read = |report: &mut Report| {
        axis.required("xyz", report)?;
        axis.vector("xyz", Domain::Any, report)
    };
    let xyz = if moves { read(report) } else { report.lenient(read) }.unwrap_or(DEFAULT);
    let length = xyz.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        return xyz.map(|x| x / length);
    }
    if moves {
        let message = "the axis of a moving joint is zero".to_string();
        let mend = "give its direction, for example xyz=\"0 0 1\"";
        report.add(Finding::error("zero-axis", axis.place_of("xyz", report), message, mend));
    }
    DEFAULT
}

fn has_axis(kind: Option<JointKind>) -> bool {
    matches!(kind, Some(JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic))
}

fn read_limit(element: &Element, kind: Option<JointKind>, report: &mut Report) -> Option<Limit> {
    let limited = matches!(kind, Some(JointKind::Revolute | JointKind::Prismatic));
    let Some(limit) = element.first("limit", report) else {
        if limited {
            let message = "no <limit>: it is simulated without a range".to_string();
            let mend =
                "add <limit lower=\"…\" upper=\"…\" effort=\"…\" velocity=\"…\"/>, or make a revolute joint continuous";
            report.add_once("", Finding::warning("missing-limit", element.place(report), message, mend));
        }
        return None;
    };
    unknown::attributes(&limit, LIMIT_ATTRIBUTES, report);
    let bound = |name, report: &mut Report| {
        let read = |report: &mut Report| limit.number(name, Domain::Any, report);
        if limited { read(report) } else { report.lenient(read) }
    };
    let (lower, upper) = (bound("lower", report), bound("upper", report));
    let (lower, upper) = if limited { range(&limit, lower, upper, report) } else { UNLIMITED };
    if kind == Some(JointKind::Continuous) && (limit.value("lower").is_some() || limit.value("upper").is_some()) {
        let message = "the range of a continuous joint is ignored, as URDF says".to_string();
        let mend = "write type=\"revolute\" if the range is meant";
        report.add_once("", Finding::note("ignored-range", limit.place(report), message, mend));
    }
    let moves = has_axis(kind);
    let effort = bound_or_placeholder(&limit, "effort", moves, report);
    let velocity = bound_or_placeholder(&limit, "velocity", moves, report);
    let beyond = BEYOND.iter().filter(|name| moves && limit.value(name).is_some()).copied().collect();
    Some(Limit { at: limit.place(report).at, lower, upper, effort, velocity, beyond })
}

const BEYOND: [&str; 3] = ["acceleration", "deceleration", "jerk"];
const LIMIT_ATTRIBUTES: &[&str] = &["lower", "upper", "effort", "velocity", BEYOND[0], BEYOND[1], BEYOND[2]];
const UNLIMITED: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// The range of a revolute or prismatic joint. A bound that is left out is 0 before URDF 1.2, later infinite.
fn range(limit: &Element, lower: Option<f64>, upper: Option<f64>, report: &mut Report) -> (f64, f64) {
    let default = if origin::since(limit, 2) { UNLIMITED } else { (0.0, 0.0) };
    let (low, high) = (lower.unwrap_or(default.0), upper.unwrap_or(default.1));
    let given = [("lower", lower), ("upper", upper)].iter().all(|(name, x)| x.is_some() == limit.value(name).is_some());
    if low > high && given {
        let message = format!("lower = {low} is greater than upper = {high}");
        let mend = "swap the two, or mend a sign";
        report.add(Finding::error("lower-above-upper", limit.place_of("lower", report), message, mend));
    } else if low == high && given {
        let message = format!("the range is {low} to {high}: this axis cannot move");
        let (code, mend) = match low {
            0.0 => ("empty-range", "give lower and upper (what is left out is 0 in URDF), or make the joint fixed"),
            // W-16: an axis that cannot move is not at 0.
            _ => (
                "frozen-transform",
                "make the joint fixed, with this angle in its <origin>: tools that do not hear joint_states show it at 0",
            ),
        };
        report.add_once("", Finding::warning(code, limit.place(report), message, mend));
    }
    (low, high)
}

/// `effort` or `velocity`; `None` where it is left out or the placeholder 0.
fn bound_or_placeholder(limit: &Element, name: &'static str, moves: bool, report: &mut Report) -> Option<f64> {
    if !moves {
        return report.lenient(|report| limit.number(name, Domain::NonNegative, report)).filter(|x| *x > 0.0);
    }
    let Some(text) = limit.value(name) else {
        if !origin::since(limit, 2) {
            let message = format!("no `{name}`: simulated without a bound, but other URDF parsers refuse the file");
            let mend = format!("add {name}=\"…\"");
            report.add_once(name, Finding::warning("missing-bound", limit.place(report), message, mend));
        }
        return None;
    };
    let value = limit.number(name, Domain::NonNegative, report)?;
    if value == 0.0 {
        let message = format!("{name}=\"{text}\" is taken for a placeholder: simulated without a bound");
        let mend = format!("give the real {name} of the drive");
        report.add_once(name, Finding::warning("placeholder-bound", limit.place_of(name, report), message, mend));
        return None;
    }
    Some(value)
}

/// Damping and friction of a joint with one axis; 0 for all others.
fn read_dynamics(element: &Element, kind: Option<JointKind>, report: &mut Report) -> (f64, f64) {
    let Some(dynamics) = element.first("dynamics", report).filter(|_| has_axis(kind)) else { return (0.0, 0.0) };
    unknown::attributes(&dynamics, &["damping", "friction"], report);
    let mut number = |name| dynamics.number(name, Domain::NonNegative, report).unwrap_or(0.0);
    (number("damping"), number("friction"))
}

fn read_mimic(element: &Element, report: &mut Report) -> Option<Mimic> {
    let joint = report.lenient(|report| element.required("joint", report))?.to_string();
    let mut number =
        |name, default| report.lenient(|report| element.number(name, Domain::Any, report)).unwrap_or(default);
    let (multiplier, offset) = (number("multiplier", 1.0), number("offset", 0.0));
    let at = element.place(report).at;
    Some(Mimic { at, joint, multiplier, offset })
}
