//! Loading: what only the whole model shows.
#![allow(clippy::unwrap_used)] // a test may panic

use realnoid::cli::load::{Source, examine};
use realnoid::math::Pose;
use realnoid::model::Base;
use std::io::Write;

/// Codes of the errors that a robot of one moving link gives, and the lines they point at.
fn errors(link: &str, axis: &str, base: Base) -> Vec<(String, u32)> {
    errors_on("", link, axis, base)
}

fn errors_on(root: &str, link: &str, axis: &str, base: Base) -> Vec<(String, u32)> {
    let text = format!(
        "<robot name='r'>\n<link name='a'>{root}</link>\n<link name='b'>{link}</link>\n<joint name='j' type='continuous'>\
         <parent link='a'/><child link='b'/><axis xyz='{axis}'/></joint>\n</robot>\n"
    );
    let mut file = tempfile::Builder::new().suffix(".urdf").tempfile().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    let examined = examine(Source { urdf: Some(file.path()), packages: &[] }, base, Pose::identity()).unwrap();
    let errors = examined.findings.iter().filter(|f| f.severity == realnoid::description::Severity::Error);
    let found: Vec<_> = errors.map(|f| (f.code.to_owned(), f.at.line)).collect();
    assert_eq!(found.is_empty(), examined.is_sound());
    found
}

fn link(at: &str, ixx: f64, iyy: f64, izz: f64) -> String {
    format!(
        "<inertial><origin xyz='{at}'/><mass value='1'/>\
         <inertia ixx='{ixx}' ixy='0' ixz='0' iyy='{iyy}' iyz='0' izz='{izz}'/></inertial>"
    )
}

/// An axis that carries no inertia would accelerate infinitely: refused at the joint, but only if it is really so.
#[test]
fn a_joint_without_inertia_is_refused() {
    let singular = vec![("singular-joint".to_owned(), 4)];
    assert_eq!(errors(&link("0 0 0", 0.0, 0.0, 0.0), "0 1 0", Base::Fixed), singular, "a point on the axis");
    assert_eq!(errors(&link("0 0.3 0", 0.1, 0.0, 0.1), "0 1 0", Base::Fixed), singular, "a thin rod along the axis");
    assert_eq!(errors(&link("0 0.3 0", 0.1, 0.0, 0.1), "1 0 0", Base::Fixed), vec![], "a thin rod across the axis");
    assert_eq!(errors(&link("0.1 0 0", 0.0, 0.0, 0.0), "0 1 0", Base::Fixed), vec![], "a point beside the axis");
    assert_eq!(errors(&link("0 0 0", 1e-9, 1e-9, 1e-9), "0 1 0", Base::Fixed), vec![], "a tiny inertia is one");
}

/// A free base needs inertia in all directions, too: a massless one could turn about its hinge without effort.
#[test]
fn a_free_base_without_inertia_is_refused() {
    let solid = link("0.1 0 0", 0.1, 0.1, 0.1);
    assert_eq!(errors(&solid, "0 1 0", Base::Free), vec![("singular-joint".to_owned(), 2)]);
    assert_eq!(errors_on(&solid, &solid, "0 1 0", Base::Free), vec![]);
    assert_eq!(errors(&solid, "0 1 0", Base::Fixed), vec![]);
}
