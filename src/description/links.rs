//! `<link>`: inertial, visuals, collisions, and our tags.

use super::element::{Domain, Element};
use super::finding::Finding;
use super::origin;
use super::report::Report;
use super::unknown;
use super::{Finish, Geometry, Inertial, Link, PlacedShape, Scaling, shapes, tags};

/// Elements of a link that mean something here.
const KNOWN: &[&str] = &["inertial", "visual", "collision", "realnoid"];
const TENSOR: &str = "<inertia ixx=\"…\" ixy=\"…\" ixz=\"…\" iyy=\"…\" iyz=\"…\" izz=\"…\"/>";
const INERTIA: [&str; 6] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

/// Reads one link; a fault is reported and read as if the item were not there.
pub(super) fn read(element: &Element, report: &mut Report) -> Link {
    let name = element.required("name", report).unwrap_or_default().to_string();
    unknown::children(element, KNOWN, report);
    unknown::attributes(element, &["name", "type"], report);
    let inertial = element.first("inertial", report).and_then(|e| read_inertial(&e, report));
    let tags = tags::link::read(element, report);
    let needs_visuals = tags.body.as_ref().is_some_and(|body| body.shapes.is_empty());
    Link {
        name,
        at: element.place(report).at,
        inertial,
        visuals: element.all("visual").filter_map(|e| read_shape(&e, needs_visuals, report)).collect(),
        collisions: element.all("collision").filter_map(|e| read_shape(&e, false, report)).collect(),
        body: tags.body,
        proxies: tags.proxies,
        surface: tags.surface,
        damping: tags.damping,
        deactivate: tags.deactivate,
        monitor: tags.monitor,
    }
}

fn read_inertial(element: &Element, report: &mut Report) -> Option<Inertial> {
    unknown::children(element, &["origin", "mass", "inertia"], report);
    let origin = origin::read(element, report);
    let mass = child(element, "mass", "<mass value=\"1.5\"/>", report).and_then(|mass| read_mass(&mass, report));
    let tensor = child(element, "inertia", TENSOR, report);
    let inertia = tensor.and_then(|tensor| read_tensor(&tensor, report));
    Some(Inertial { at: element.place(report).at, origin, mass: mass?, inertia: inertia? })
}

fn read_mass(element: &Element, report: &mut Report) -> Option<f64> {
    unknown::attributes(element, &["value"], report);
    element.required("value", report)?;
    let mass = element.number("value", Domain::Any, report)?;
    if mass < 0.0 {
        let message = format!("the mass is negative: {mass} kg");
        let place = element.place_of("value", report);
        report.add(Finding::error("negative-mass", place, message, "a mass is 0 or greater"));
        return None;
    }
    Some(mass)
}

fn read_tensor(element: &Element, report: &mut Report) -> Option<[f64; 6]> {
    unknown::attributes(element, &INERTIA, report);
    let entries = INERTIA.map(|name| {
        element.required(name, report)?;
        element.number(name, Domain::Any, report)
    });
    let mut tensor = [0.0; 6];
    for (to, from) in tensor.iter_mut().zip(entries) {
        *to = from?;
    }
    Some(tensor)
}

fn child<'a>(element: &Element<'a>, tag: &'static str, example: &str, report: &mut Report) -> Option<Element<'a>> {
    let found = element.first(tag, report);
    if found.is_none() {
        let message = format!("<{}> has no <{tag}>", element.tag());
        report.add(Finding::error("missing-element", element.place(report), message, format!("add {example}")));
    }
    found
}

/// `<visual>` or `<collision>`. Its faults are warnings, unless the mass of the link comes from this shape.
fn read_shape(element: &Element, gives_mass: bool, report: &mut Report) -> Option<PlacedShape> {
    if gives_mass { read_placed(element, report) } else { report.lenient(|report| read_placed(element, report)) }
}

fn read_placed(element: &Element, report: &mut Report) -> Option<PlacedShape> {
    let before = report.len();
    let origin = origin::read(element, report);
    note_material(element, report);
    let geometry = child(element, "geometry", "<geometry><box size=\"0.1 0.1 0.1\"/></geometry>", report)
        .and_then(|geometry| read_geometry(&geometry, report));
    match geometry {
        Some((geometry, finish)) => {
            let at = element.place(report).at;
            Some(PlacedShape { at, origin, geometry, finish, scaling: Scaling::default(), substance: None })
        }
        None => {
            debug_assert!(report.len() > before, "a dropped shape is always reported");
            None
        }
    }
}

fn read_geometry(element: &Element, report: &mut Report) -> Option<(Geometry, Finish)> {
    let Some(shape) = element.children().find(Element::is_plain) else {
        let message = "<geometry> is empty: this shape is left out".to_string();
        let mend = "put a shape inside, for example <box size=\"0.1 0.1 0.1\"/>";
        report.add(Finding::error("missing-shape", element.place(report), message, mend));
        return None;
    };
    let read = shapes::read_shape(&shape, report)?;
    if !shapes::is_urdf(&shape) {
        let message =
            format!("this <{}> is not a shape of URDF: other ROS tools may refuse the whole file", shape.tag());
        let mend = "show a URDF shape or a mesh here, and give this one in <realnoid>: in <proxy>, or in <shape> inside <body>";
        report.add_once(shape.tag(), Finding::warning("shape-beyond-urdf", shape.place(report), message, mend));
    }
    Some(read)
}

fn note_material(element: &Element, report: &mut Report) {
    let Some(material) = element.all("material").next() else { return };
    if material.value("name").is_none_or(|name| name.trim().is_empty()) {
        let message = "a material without a name: some URDF tools refuse the file".to_string();
        let mend = "add name=\"…\" to <material>";
        report.add_once("", Finding::warning("unnamed-material", material.place(report), message, mend));
    }
}
