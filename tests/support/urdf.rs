//! URDF texts for tests.
#![allow(clippy::unwrap_used)] // a test may panic

use realnoid::cli::load::{Source, load};
use realnoid::model::{Base, Model};
use std::io::Write;
use std::sync::Arc;

/// The model, or the report.
pub fn load_text(text: &str, base: Base) -> Result<Arc<Model>, String> {
    let mut file = tempfile::Builder::new().suffix(".urdf").tempfile().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    load(Source { urdf: Some(file.path()), packages: &[] }, base).map(|loaded| loaded.model)
}

/// The model of a text that must be sound.
pub fn model(text: &str, base: Base) -> Arc<Model> {
    load_text(text, base).unwrap_or_else(|report| panic!("{report}\n{text}"))
}

/// A link with inertia in every direction, or a massless one.
pub fn link(name: &str, mass: f64, center: &str) -> String {
    if mass == 0.0 {
        return format!("<link name='{name}'/>");
    }
    format!(
        "<link name='{name}'><inertial><origin xyz='{center}' rpy='0.1 0.2 0.3'/><mass value='{mass}'/>\
         <inertia ixx='0.04' ixy='0.001' ixz='0.002' iyy='0.05' iyz='-0.001' izz='0.02'/></inertial></link>"
    )
}

/// `origin` and `axis` as URDF has them; `tag` are attributes of a `<constraint>`.
pub fn joint(name: &str, kind: &str, (parent, child): (&str, &str), (origin, axis): (&str, &str), tag: &str) -> String {
    let tag = if tag.is_empty() { String::new() } else { format!("<realnoid><constraint {tag}/></realnoid>") };
    let limit = if kind == "revolute" { "<limit lower='-1.5' upper='1.5'/>" } else { "" };
    format!(
        "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/><origin xyz='{origin}'/>\
         <axis xyz='{axis}'/>{limit}{tag}</joint>"
    )
}

pub fn robot(parts: &[String]) -> String {
    format!("<robot name='r'>{}</robot>", parts.concat())
}

pub fn group(kind: &str, axes: &str) -> String {
    format!("<realnoid version='1'><joint_group name='g' type='{kind}' {axes}/></realnoid>")
}
