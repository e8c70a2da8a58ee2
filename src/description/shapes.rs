//! Shapes: URDF's geometry and ours, in `<geometry>`, `<proxy>` and `<shape>`.

use super::element::{Domain, Element};
use super::finding::Finding;
use super::report::Report;
use super::rules::{Attribute, Kind, Tag, Values};
use super::{Geometry, Origin, PlacedShape, suggest};

const LENGTH: Kind = Kind::Number(Domain::Positive);
const POINT: Kind = Kind::Vector(3, Domain::Any);

const fn length(name: &'static str) -> Attribute {
    Attribute::required(name, LENGTH)
}

const fn maybe_length(name: &'static str) -> Attribute {
    Attribute::optional(name, LENGTH)
}

const fn point(name: &'static str) -> Attribute {
    Attribute::required(name, POINT)
}

const fn shape(name: &'static str, attributes: &'static [Attribute]) -> Tag {
    Tag { name, attributes, children: &[] }
}

/// URDF's own shapes come first.
const URDF_SHAPES: usize = 4;

/// Every shape element that is read.
pub(super) const SHAPES: &[Tag] = &[
    shape("box", &[Attribute::required("size", Kind::Vector(3, Domain::Positive))]),
    shape("cylinder", &[length("radius"), length("length")]),
    shape("sphere", &[length("radius")]),
    shape(
        "mesh",
        &[Attribute::required("filename", Kind::Text), Attribute::optional("scale", Kind::Vector(3, Domain::Any))],
    ),
    shape(
        "capsule",
        &[maybe_length("radius"), maybe_length("radius_top"), maybe_length("radius_bottom"), length("length")],
    ),
    shape("ellipsoid", &[Attribute::required("radii", Kind::Vector(3, Domain::Positive))]),
    shape("elliptic_cylinder", &[length("radius_x"), length("radius_y"), length("length")]),
    shape("tube", &[length("outer_radius"), length("inner_radius"), length("length")]),
    shape("cone", &[maybe_length("radius"), maybe_length("radius_x"), maybe_length("radius_y"), length("length")]),
    shape(
        "frustum",
        &[
            maybe_length("radius"),
            maybe_length("radius_x"),
            maybe_length("radius_y"),
            length("top_scale"),
            length("length"),
        ],
    ),
    shape("hemisphere", &[length("radius")]),
    shape("torus", &[length("ring_radius"), length("pipe_radius")]),
    shape("oil_tank", &[length("radius"), length("length"), length("cap_height")]),
    shape("pyramid", &[Attribute::required("size", Kind::Vector(3, Domain::Positive))]),
    shape(
        "polyhedron",
        &[Attribute::required("faces", Kind::Number(Domain::OneOf(&[4.0, 6.0, 8.0, 12.0, 20.0]))), length("radius")],
    ),
    shape("disc", &[length("outer_radius"), Attribute::optional("inner_radius", Kind::Number(Domain::NonNegative))]),
    shape("plane", &[Attribute::required("size", Kind::Vector(2, Domain::Positive))]),
    shape("triangle", &[point("a"), point("b"), point("c")]),
    shape("quad", &[point("a"), point("b"), point("c"), point("d")]),
    shape("terrain", &[Attribute::required("size", Kind::Vector(3, Domain::Positive)), maybe_length("radius")]),
];

/// Attributes of `<origin>`.
pub(super) const ORIGIN: Tag = Tag {
    name: "origin",
    attributes: &[Attribute::optional("xyz", POINT), Attribute::optional("rpy", POINT)],
    children: &[],
};

/// Names of all shape elements.
pub(super) fn names() -> Vec<&'static str> {
    SHAPES.iter().map(|tag| tag.name).collect()
}

/// `<proxy>` or `<shape>`: an optional `<origin>` and one shape. `None` is reported.
pub(super) fn read_placed(element: &Element, report: &mut Report) -> Option<PlacedShape> {
    let origin = match element.first("origin", report) {
        Some(origin) => read_origin(&origin, report),
        None => Origin::default(),
    };
    let mut shapes = element.children().filter(|e| e.is_plain() && e.tag() != "origin");
    let Some(shape) = shapes.next() else {
        let message = format!("<{}> holds no shape", element.tag());
        let mend = format!("put one of these inside: {}", names().join(", "));
        report.add(Finding::error("missing-shape", element.place(report), message, mend));
        return None;
    };
    for further in shapes {
        let message = format!("a second shape in one <{}>", element.tag());
        let mend = format!("write one <{}> for each shape", element.tag());
        report.add(Finding::error("second-shape", further.place(report), message, mend));
    }
    let geometry = read_shape(&shape, report)?;
    Some(PlacedShape { at: element.place(report).at, origin, geometry })
}

fn read_origin(element: &Element, report: &mut Report) -> Origin {
    let values = ORIGIN.read(element, report);
    let vector = |name| values.numbers(name).and_then(|n| n.try_into().ok()).unwrap_or_default();
    Origin { xyz: vector("xyz"), rpy: vector("rpy") }
}

/// One shape element: `<box size="1 2 3"/>`. `None` is reported.
pub(super) fn read_shape(element: &Element, report: &mut Report) -> Option<Geometry> {
    let Some(tag) = SHAPES.iter().find(|tag| tag.name == element.tag()) else {
        let message = format!("<{}> is not a shape", element.tag());
        let mend = suggest::mend(element.tag(), names(), "known shapes");
        report.add(Finding::error("unknown-shape", element.place(report), message, mend));
        return None;
    };
    let values = tag.read(element, report);
    if !values.complete(tag) {
        return None;
    }
    build(tag, &values, element, report)
}

/// Is it a shape that plain URDF parsers know?
pub(super) fn is_urdf(element: &Element) -> bool {
    SHAPES[..URDF_SHAPES].iter().any(|tag| tag.name == element.tag())
}

fn build(tag: &Tag, values: &Values, element: &Element, report: &mut Report) -> Option<Geometry> {
    let number = |name| values.number(name);
    let triple = |name| values.numbers(name).and_then(|n| <[f64; 3]>::try_from(n).ok());
    Some(match tag.name {
        "box" => Geometry::Box { size: triple("size")? },
        "cylinder" => Geometry::Cylinder { radius: number("radius")?, length: number("length")? },
        "sphere" => Geometry::Sphere { radius: number("radius")? },
        "ellipsoid" => Geometry::Ellipsoid { radii: triple("radii")? },
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
        _ => Geometry::Other { kind: tag.name.into(), values: flatten(tag, values) },
    })
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
    let scale = values.numbers("scale").and_then(|n| n.try_into().ok()).unwrap_or([1.0; 3]);
    if scale.contains(&0.0) {
        let message = "a scale of 0 flattens the mesh".to_string();
        report.add(Finding::error("out-of-range", element.place_of("scale", report), message, "write scale=\"1 1 1\""));
        return None;
    }
    Some(Geometry::Mesh { filename: values.word("filename")?.into(), scale })
}

fn flatten(tag: &Tag, values: &Values) -> Vec<(String, f64)> {
    let mut flat = vec![];
    for attribute in tag.attributes {
        match values.numbers(attribute.name) {
            Some([x]) => flat.push((attribute.name.to_string(), *x)),
            Some(xs) => flat.extend(xs.iter().enumerate().map(|(i, x)| (format!("{}.{i}", attribute.name), *x))),
            None => {}
        }
    }
    flat
}
