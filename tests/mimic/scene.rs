//! Robots for the tests: joints as text, each with a link of its own.

use realnoid::cli::load::{Source, examine, load};
use realnoid::engine::State;
use realnoid::math::Pose;
use realnoid::model::{Base, Model};
use realnoid::world::{Integrator, Settings, World};
use std::io::Write;
use std::sync::Arc;

pub const IMPLICIT: [Integrator; 2] = [Integrator::ImplicitMidpoint, Integrator::SemiImplicitEuler];
pub const ALL_INTEGRATORS: [Integrator; 4] =
    [Integrator::ImplicitMidpoint, Integrator::SemiImplicitEuler, Integrator::Rk4, Integrator::Extrapolation];

/// A joint of a test robot: the link it carries is named as the joint, with `_link`.
pub struct Part<'a> {
    pub name: &'a str,
    pub parent: &'a str,
    /// Type, axis, limit, mimic, dynamics.
    pub kind: &'a str,
    pub axis: &'a str,
    pub inner: &'a str,
    pub mass: f64,
    /// About the centre of mass, all axes.
    pub inertia: f64,
    /// Centre of mass in the link.
    pub center: &'a str,
}

impl Default for Part<'_> {
    fn default() -> Self {
        Self {
            name: "",
            parent: "base",
            kind: "continuous",
            axis: "0 0 1",
            inner: "",
            mass: 1.0,
            inertia: 0.1,
            center: "0 0 0",
        }
    }
}

pub fn text(parts: &[Part], tags: &str) -> String {
    let base = "<inertial><mass value='5'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    let mut text = format!("<robot name='coupled'>{tags}\n<link name='base'>{base}</link>\n");
    for p in parts {
        let parent = if p.parent == "base" { "base".into() } else { format!("{}_link", p.parent) };
        let (i, m) = (p.inertia, p.mass);
        text += &format!(
            "<link name='{0}_link'><inertial><origin xyz='{1}' rpy='0 0 0'/><mass value='{m}'/>\
             <inertia ixx='{i}' ixy='0' ixz='0' iyy='{i}' iyz='0' izz='{i}'/></inertial></link>\n\
             <joint name='{0}' type='{2}'><parent link='{parent}'/><child link='{0}_link'/>\
             <origin xyz='0.1 0 0' rpy='0 0 0'/><axis xyz='{3}'/>{4}</joint>\n",
            p.name, p.center, p.kind, p.axis, p.inner
        );
    }
    text + "</robot>\n"
}

fn file(text: &str) -> tempfile::NamedTempFile {
    let mut file = tempfile::Builder::new().suffix(".urdf").tempfile().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    file
}

pub fn model_on(text: &str, base: Base) -> Arc<Model> {
    let file = file(text);
    let source = Source { urdf: Some(file.path()), packages: &[] };
    load(source, base).unwrap_or_else(|report| panic!("{report}")).model
}

pub fn model(parts: &[Part]) -> Arc<Model> {
    model_on(&text(parts, ""), Base::Fixed)
}

/// Codes and lines of what is said about a text, without notes about axes and bounds.
pub fn said(text: &str) -> Vec<(&'static str, u32, String)> {
    let file = file(text);
    let source = Source { urdf: Some(file.path()), packages: &[] };
    let examined = examine(source, Base::Fixed, Pose::identity()).unwrap();
    let about = |code: &str| code.contains("mimic") || code == "unknown-joint" || code == "ignored-element";
    let found = examined.findings.into_iter().filter(|f| about(f.code));
    found.map(|f| (f.code, f.at.line, f.message)).collect()
}

pub fn settings(integrator: Integrator, h: f64, gravity: [f64; 3]) -> Settings {
    let control_interval_ns = (h * 1e9).round() as i64;
    Settings { integrator, control_interval_ns, steps_per_interval: 1, gravity, ..Settings::default() }
}

/// A world whose axes start at these positions and speeds.
pub fn world(m: &Arc<Model>, s: Settings, start: &[(&str, f64, f64)]) -> World {
    let mut w = World::new(m.clone(), s).unwrap();
    let mut state = State::initial(m);
    let given: Vec<usize> = start.iter().map(|(name, ..)| m.axis(name).unwrap()).collect();
    for (axis, (_, q, v)) in given.iter().zip(start) {
        state.set_axis(m, *axis, *q, *v);
    }
    state.couple_given(m, &given).unwrap();
    w.set_initial_state(state);
    w
}

pub fn advance(w: &mut World, steps: usize) {
    (0..steps).for_each(|_| w.advance());
}

pub fn axis(w: &World, name: &str) -> (f64, f64) {
    w.state().axis(w.model(), w.model().axis(name).unwrap())
}

pub fn effort(w: &World, name: &str) -> f64 {
    w.new_snapshot().effort[w.model().axis(name).unwrap()]
}

/// The largest deviation of a follower from where its leader puts it.
pub fn deviation(w: &World) -> f64 {
    let (m, s) = (w.model(), w.state());
    let of = |c: &realnoid::model::Coupling| (s.axis(m, c.follower).0 - c.position(s.axis(m, c.leader).0)).abs();
    m.couplings.iter().map(of).fold(0.0, f64::max)
}
