//! What an engine cannot honour is told, never silently dropped (E-2).

use super::{EngineKind, Integrator};
use crate::description::{Description, Finding, Position, Severity};
use crate::model::{JointType, LinkFrame, LinkInfo, Model};
use crate::shape::ContactForm;

/// An item of a model that an engine does not honour.
#[derive(Clone, Debug, PartialEq)]
pub struct Shortfall {
    /// Whose it is: `joint 'hip'`, `link 'foot'`.
    pub element: String,
    /// `<mimic>`.
    pub item: String,
    /// What happens instead.
    pub instead: String,
}

impl Shortfall {
    pub(super) fn new(element: String, item: &str, instead: &str) -> Self {
        Self { element, item: item.into(), instead: instead.into() }
    }

    /// What is said of an engine: `the engine bullet does not honour …`.
    pub fn of(&self, kind: EngineKind) -> String {
        format!("the engine {} does not honour {self}", kind.name())
    }
}

impl std::fmt::Display for Shortfall {
    /// The item, whose it is, and what happens instead.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let instead = if self.instead.is_empty() { String::new() } else { format!(": {}", self.instead) };
        write!(f, "{} of {}{instead}", self.item, self.element)
    }
}

/// What of a model an engine does not honour, each kind of item next to each other.
pub fn shortfalls(kind: EngineKind, m: &Model) -> Vec<Shortfall> {
    let can = kind.capabilities();
    let mut found = vec![];
    let mut tell = |element: String, item: &str, instead: &str| {
        found.push(Shortfall::new(element, item, instead));
    };
    let joint = |name: &str| format!("joint '{name}'");
    if can.joints && !can.couplings {
        for c in m.couplings_in_force() {
            tell(joint(&m.axes[c.follower].name), "<mimic>", "it moves by itself");
        }
    }
    if can.joints && !can.softness {
        for soft in m.softs.iter().filter(|s| s.softness.cfm > 0.0) {
            let body = m.body_of(soft.v).unwrap_or(0);
            let behind = (body..m.bodies.len()).find(|b| carries_link(m, *b)).unwrap_or(body);
            let own = (0..m.axes.len()).find(|axis| m.carrier(*axis) == Some(behind));
            let element = own.map_or_else(|| name_of(m, body), |axis| joint(&m.axes[axis].name));
            tell(element, "<constraint cfm>", "the joint is hard");
        }
    }
    if can.joints && !can.rotor_inertia {
        for a in m.axes.iter().filter(|a| a.drive.rotor_inertia > 0.0) {
            tell(joint(&a.name), "<drive rotor_inertia>", "the rotor has no inertia");
        }
    }
    if can.joints && !can.breaking {
        for b in &m.breakables {
            tell(joint(&b.joint), "<constraint break_threshold>", "it does not come apart");
        }
    }
    if !can.rolling_friction {
        let rolls = |s: &crate::model::Surface| s.rolling > 0.0 || s.spinning > 0.0;
        for c in m.colliders.iter().filter(|c| m.effects.contact && rolls(&c.surface)) {
            tell(format!("link '{}'", c.name), "<surface rolling_friction spinning_friction>", "it rolls without loss");
        }
    }
    match kind {
        EngineKind::Rapier => found.extend(super::rapier::shortfalls(m)),
        #[cfg(feature = "physx")]
        EngineKind::Physx => found.extend(super::physx::shortfalls(m)),
        _ => {}
    }
    found.dedup();
    found
}

/// What an engine calls the shape that it makes of a form, where it is one of its own: rbx collides forms as they are.
pub fn shape_name(kind: EngineKind, form: &ContactForm) -> Option<String> {
    (kind == EngineKind::Rapier).then(|| super::rapier::shape_name(form))
}

/// What an engine has for a joint (tables 6-12 … 6-20).
pub fn constraint_name(kind: EngineKind, joint: JointType) -> &'static str {
    use JointType as J;
    match (kind, joint) {
        (_, J::Floating) => "none: it floats",
        (EngineKind::Rbx, J::Revolute) => "revolute, a coordinate of its own",
        (EngineKind::Rbx, J::Prismatic) => "prismatic, a coordinate of its own",
        (EngineKind::Rbx, J::Universal) => "cardan, two coordinates",
        (EngineKind::Rbx, J::Spherical) => "spherical, a quaternion",
        (EngineKind::Rapier, J::Revolute) => "impulse joint, 5 axes locked",
        (EngineKind::Rapier, J::Prismatic) => "impulse joint, 5 axes locked",
        (EngineKind::Rapier, J::Universal) => "impulse joints, 3 axes and 1 locked",
        (EngineKind::Rapier, J::Spherical) => "impulse joint, 3 axes locked",
        (EngineKind::Bullet, _) => "btGeneric6DofSpring2Constraint",
        (EngineKind::Physx, _) => "none: links are left out",
    }
}

/// An integrator that was chosen, and that an engine with one of its own does not use.
pub fn unused_integrator(kind: EngineKind, integrator: Integrator) -> Option<Shortfall> {
    let unused = !kind.capabilities().integrators && integrator != Integrator::default();
    let item = format!("integrator {}", integrator.name());
    unused.then(|| Shortfall::new("the world".into(), &item, "it has its own"))
}

/// The first of each kind (the same item, the same instead), and how many others there are.
pub fn by_kind<T>(all: impl Iterator<Item = T>, of: impl Fn(&T) -> &Shortfall) -> Vec<(T, usize)> {
    let mut groups: Vec<(T, usize)> = vec![];
    for one in all {
        let same = |(first, _): &&mut (T, usize)| {
            let (first, one) = (of(first), of(&one));
            first.item == one.item && first.instead == one.instead
        };
        match groups.iter_mut().find(same) {
            Some((_, others)) => *others += 1,
            None => groups.push((one, 0)),
        }
    }
    groups
}

/// The link on a body, or the first one behind it.
pub(super) fn name_of(m: &Model, body: usize) -> String {
    let behind = (body..m.bodies.len()).find_map(|b| link_on(m, b));
    behind.map_or_else(|| format!("body {body}"), |l| format!("link '{}'", l.name))
}

fn carries_link(m: &Model, body: usize) -> bool {
    link_on(m, body).is_some()
}

fn link_on(m: &Model, body: usize) -> Option<&LinkInfo> {
    m.links.iter().find(|l| matches!(l.frame, LinkFrame::OnBody { body: b, .. } if b == body))
}

/// What stands in a text and has no effect in an engine: a warning for each kind of item, with the engine, the elements and the
/// item. `m` is the model of the text.
pub fn not_honoured(kind: EngineKind, d: &Description, m: &Model) -> Vec<Finding> {
    let engine = kind.name();
    let limits = d.joints.iter().filter_map(|joint| Some((joint, joint.limit.as_ref()?)));
    let beyond = limits.flat_map(|(joint, limit)| {
        let one = move |item: &&'static str| {
            let shortfall = Shortfall {
                element: format!("joint '{}'", joint.name),
                item: format!("<limit {item}>"),
                instead: String::new(),
            };
            (shortfall, limit.at, "leave it to the controller, which plans the motion")
        };
        limit.beyond.iter().map(one)
    });
    let other = "choose an engine that does (rbx does it all), or take it out";
    let told = shortfalls(kind, m).into_iter().map(|s| (place_of(d, &s.element), s)).map(|(at, s)| (s, at, other));
    let named = |((shortfall, at, mend), others): ((Shortfall, Position, &str), usize)| {
        let mut finding = finding(engine, &shortfall, at, mend);
        if others > 0 {
            finding.message.push_str(&format!(", nor of {others} other{}", if others == 1 { "" } else { "s" }));
        }
        if !shortfall.instead.is_empty() {
            finding.message.push_str(&format!(": {}", shortfall.instead));
        }
        finding
    };
    by_kind(beyond.chain(told), |(s, ..)| s).into_iter().map(named).collect()
}

fn finding(engine: &str, s: &Shortfall, at: Position, mend: &str) -> Finding {
    let tag = s.item.split(' ').next().unwrap_or_default().trim_end_matches('>');
    Finding {
        severity: Severity::Warning,
        code: "not-honoured",
        message: format!("the engine {engine} does not honour {} of {}", s.item, s.element),
        element: format!("{} {tag}>", s.element),
        at,
        mend: mend.into(),
    }
}

/// Where a joint or link stands in the text.
fn place_of(d: &Description, element: &str) -> Position {
    let name = element.split('\'').nth(1).unwrap_or_default();
    let link = || d.links.iter().find(|l| l.name == name).map(|l| l.at);
    let joint = || d.joints.iter().find(|j| j.name == name).map(|j| j.at);
    let first = if element.starts_with("joint") { joint().or_else(link) } else { link().or_else(joint) };
    first.unwrap_or_default()
}
