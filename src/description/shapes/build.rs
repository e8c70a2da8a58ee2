//! Attributes of a shape element → [`Geometry`] and [`Finish`].

use super::super::element::Element;
use super::super::finding::Finding;
use super::super::report::Report;
use super::super::rules::Values;
use super::super::{Finish, Geometry};
use super::terrain;
use std::f64::consts::TAU;

/// `None` is reported.
pub(super) fn geometry(values: &Values, element: &Element, report: &mut Report) -> Option<Geometry> {
    let number = |name| values.number(name);
    Some(match element.tag() {
        "box" => Geometry::Box { size: vector(values, "size")? },
        "cylinder" => Geometry::Cylinder { radius: number("radius")?, length: number("length")? },
        "sphere" => Geometry::Sphere { radius: number("radius")? },
        "ellipsoid" => Geometry::Ellipsoid { radii: vector(values, "radii")? },
        "capsule" => {
            let [radius_top, radius_bottom] = radii(["radius_top", "radius_bottom"], values, element, report)?;
            Geometry::Capsule { radius_top, radius_bottom, length: number("length")? }
        }
        "elliptic_cylinder" => Geometry::EllipticCylinder {
            radius_x: number("radius_x")?,
            radius_y: number("radius_y")?,
            length: number("length")?,
        },
        "tube" => tube(values, element, report)?,
        "cone" => {
            let [radius_x, radius_y] = radii(["radius_x", "radius_y"], values, element, report)?;
            Geometry::Cone { radius_x, radius_y, length: number("length")? }
        }
        "frustum" => {
            let [radius_x, radius_y] = radii(["radius_x", "radius_y"], values, element, report)?;
            Geometry::Frustum { radius_x, radius_y, top_scale: number("top_scale")?, length: number("length")? }
        }
        "mesh" => mesh(values, element, report)?,
        "terrain" => terrain::read(values, element, report)?,
        _ => rarer(values, element)?,
    })
}

fn rarer(values: &Values, element: &Element) -> Option<Geometry> {
    let number = |name| values.number(name);
    Some(match element.tag() {
        "hemisphere" => Geometry::Hemisphere { radius: number("radius")? },
        "torus" => Geometry::Torus { ring_radius: number("ring_radius")?, pipe_radius: number("pipe_radius")? },
        "oil_tank" => Geometry::OilTank {
            radius: number("radius")?,
            length: number("length")?,
            cap_height: number("cap_height")?,
        },
        "pyramid" => Geometry::Pyramid { size: vector(values, "size")? },
        "polyhedron" => Geometry::Polyhedron { faces: number("faces")? as u32, radius: number("radius")? },
        "disc" => Geometry::Disc {
            outer_radius: number("outer_radius")?,
            inner_radius: values.number_or("inner_radius", 0.0),
        },
        "plane" => Geometry::Plane { size: vector(values, "size")? },
        "triangle" => Geometry::Triangle { corners: corners(values, ["a", "b", "c"])? },
        "quad" => Geometry::Quad { corners: corners(values, ["a", "b", "c", "d"])? },
        _ => return None,
    })
}

/// Fillets, slice and caps of a shape element.
pub(super) fn finish(values: &Values, element: &Element, report: &mut Report) -> Finish {
    let slice = vector::<2>(values, "slice").and_then(|[from, to]| {
        if from < to && to - from < TAU {
            return Some([from, to]);
        }
        let message = format!("slice = {from} {to} is no part of a turn");
        let mend = "write the two angles about Z in radians, the smaller one first and less than 2π apart";
        report.add(Finding::error("slice", element.place_of("slice", report), message, mend));
        None
    });
    Finish {
        fillet: values.number_or("fillet", 0.0),
        top_fillet: values.number("top_fillet"),
        slice,
        open: !values.flag_or("caps", true),
    }
}

fn vector<const N: usize>(values: &Values, name: &str) -> Option<[f64; N]> {
    values.numbers(name).and_then(|numbers| numbers.try_into().ok())
}

fn corners<const N: usize>(values: &Values, names: [&str; N]) -> Option<[[f64; 3]; N]> {
    let mut corners = [[0.0; 3]; N];
    for (corner, name) in corners.iter_mut().zip(names) {
        *corner = vector(values, name)?;
    }
    Some(corners)
}

/// Either `radius`, or both of `names`.
fn radii(names: [&str; 2], values: &Values, element: &Element, report: &mut Report) -> Option<[f64; 2]> {
    match (values.number("radius"), names.map(|name| values.number(name))) {
        (Some(radius), [None, None]) => Some([radius, radius]),
        (None, [Some(first), Some(second)]) => Some([first, second]),
        _ if misread(&["radius", names[0], names[1]], values, element) => None,
        _ => {
            let message = format!("<{}> needs either `radius`, or `{}` and `{}`", element.tag(), names[0], names[1]);
            report.add(Finding::error("radius", element.place(report), message, "give one of the two forms"));
            None
        }
    }
}

/// Is one of the numbers given, but wrong (which has been reported)?
fn misread(names: &[&str], values: &Values, element: &Element) -> bool {
    names.iter().any(|name| element.value(name).is_some() && values.number(name).is_none())
}

fn tube(values: &Values, element: &Element, report: &mut Report) -> Option<Geometry> {
    let (outer_radius, inner_radius) = (values.number("outer_radius")?, values.number("inner_radius")?);
    if inner_radius >= outer_radius {
        let message = format!("inner_radius = {inner_radius} is not smaller than outer_radius = {outer_radius}");
        let place = element.place_of("inner_radius", report);
        report.add(Finding::error("tube-without-wall", place, message, "swap them, or use <cylinder>"));
        return None;
    }
    Some(Geometry::Tube { outer_radius, inner_radius, length: values.number("length")? })
}

fn mesh(values: &Values, element: &Element, report: &mut Report) -> Option<Geometry> {
    let scale = vector(values, "scale").unwrap_or([1.0; 3]);
    if scale.contains(&0.0) {
        let message = "a scale of 0 flattens the mesh".to_string();
        report.add(Finding::error("out-of-range", element.place_of("scale", report), message, "write scale=\"1 1 1\""));
        return None;
    }
    if scale.iter().any(|f: &f64| *f < 0.0) {
        let message = "a negative scale mirrors the mesh; its faces are turned with it".to_string();
        report.add_once("<mesh scale>", Finding::note("mirrored", element.place_of("scale", report), message, ""));
    }
    Some(Geometry::Mesh { filename: values.word("filename")?.into(), scale })
}
