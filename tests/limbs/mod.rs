//! Limbs with a joint group, from URDF text.
#![allow(dead_code)]

use realnoid::cli::load::{Source, load};
use realnoid::engine::State;
use realnoid::model::{Base, Model};
use realnoid::world::{Integrator, Settings, World};
use std::io::Write;
use std::sync::Arc;

/// Loads a text; panics with the report.
pub fn model(text: &str, base: Base) -> Arc<Model> {
    try_model(text, base).unwrap_or_else(|report| panic!("{report}"))
}

/// Loads a text, or tells why not.
pub fn try_model(text: &str, base: Base) -> Result<Arc<Model>, String> {
    let mut file = tempfile::Builder::new().suffix(".urdf").tempfile().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    load(Source { urdf: Some(file.path()), packages: &[] }, base).map(|loaded| loaded.model)
}

/// A joint of a limb.
pub fn joint(name: &str, kind: &str, (parent, child): (&str, &str), axis: &str, origin: &str, inner: &str) -> String {
    format!(
        "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/><origin {origin}/>\
         <axis xyz='{axis}'/>{inner}</joint>"
    )
}

/// An `<inertial>` of a limb.
pub const INERTIAL: &str = "<inertial><origin xyz='0.02 0.01 -0.2' rpy='0.1 0.2 0.3'/><mass value='3'/>\
    <inertia ixx='0.04' ixy='0.001' ixz='0.002' iyy='0.05' iyz='-0.001' izz='0.02'/></inertial>";

/// The limits of a rotary joint of a limb.
pub const WIDE: &str = "<limit lower='-1.5' upper='1.5' effort='40' velocity='20'/>";

/// `base` (with mass) – trunk hinge – torso – h, p, b of the group `hip` (`kind`: 3dof, cardan, combined_hinge) – limb –
/// knee – shin. `rpy` turns the frames of h, p and b; `more` goes into the robot's `<realnoid>`.
pub fn body(kind: &str, rpy: [&str; 3], more: &str) -> String {
    let [h, p, b] = rpy.map(|rpy| format!("rpy='{rpy}'"));
    let link = |name: &str| format!("<link name='{name}'>{INERTIAL}</link>");
    let inner = if kind == "combined_hinge" {
        [link("l1"), link("l2")].concat()
    } else {
        "<link name='l1'/><link name='l2'/>".into()
    };
    let apart = if kind == "combined_hinge" { "xyz='0.01 0.02 -0.03'" } else { "" };
    let last = if kind == "3dof" { "" } else { "xyz='0.03 -0.01 -0.05'" };
    [
        "<robot name='body'>".to_string(),
        format!("<realnoid version='1'><joint_group name='hip' type='{kind}' h='h' p='p' b='b'/>{more}</realnoid>"),
        [link("base"), link("torso"), inner, link("limb"), link("shin")].concat(),
        joint("trunk", "revolute", ("base", "torso"), "0.6 0 0.8", "xyz='0.1 0 0.2' rpy='0.2 0 0.4'", WIDE),
        joint("h", "revolute", ("torso", "l1"), "0 0 1", &format!("xyz='0 0.1 -0.1' {h}"), WIDE),
        joint("p", "revolute", ("l1", "l2"), "0 1 0", &format!("{apart} {p}"), WIDE),
        joint("b", "revolute", ("l2", "limb"), "1 0 0", &format!("{last} {b}"), WIDE),
        joint(
            "knee",
            "prismatic",
            ("limb", "shin"),
            "0 0.6 -0.8",
            "xyz='0 0 -0.4' rpy='0 0.3 0'",
            "<limit lower='-0.2' upper='0.3' effort='900' velocity='2'/>",
        ),
        "</robot>".to_string(),
    ]
    .concat()
}

/// One step per control interval of this length, s.
pub fn settings(integrator: Integrator, interval: f64) -> Settings {
    let control_interval_ns = (interval * 1e9).round() as i64;
    Settings { integrator, control_interval_ns, steps_per_interval: 1, ..Settings::default() }
}

/// A world with positions and speeds of its axes.
pub fn world(m: &Arc<Model>, s: Settings, start: &[(f64, f64)]) -> World {
    let mut w = World::new(m.clone(), s).unwrap();
    let mut state = State::initial(m);
    for (axis, (q, _)) in start.iter().enumerate() {
        state.set_axis(m, axis, *q, 0.0);
    }
    for (axis, (q, v)) in start.iter().enumerate() {
        state.set_axis(m, axis, *q, *v);
    }
    w.set_initial_state(state);
    w
}

/// Position and speed of every axis.
pub fn axes(w: &World) -> Vec<(f64, f64)> {
    (0..w.model().axes.len()).map(|a| w.state().axis(w.model(), a)).collect()
}

/// Advances so many control intervals.
pub fn advance(w: &mut World, intervals: usize) {
    (0..intervals).for_each(|_| w.advance());
}
