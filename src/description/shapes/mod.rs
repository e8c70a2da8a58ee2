//! Shapes: URDF's geometry and ours, in `<geometry>`, `<proxy>` and `<shape>`.

mod build;
mod table;
mod terrain;

use super::element::{Domain, Element};
use super::finding::{Finding, Place};
use super::report::Report;
use super::rules::{Attribute, Kind, Tag};
use super::{Finish, Geometry, Origin, PlacedShape, Scaling, suggest};
pub(super) use table::SHAPES;

const POINT: Kind = Kind::Vector(3, Domain::Any);

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
    let (geometry, finish) = read_shape(&shape, report)?;
    let at = element.place(report).at;
    Some(PlacedShape { at, origin, geometry, finish, scaling: Scaling::default(), substance: None })
}

fn read_origin(element: &Element, report: &mut Report) -> Origin {
    let values = ORIGIN.read(element, report);
    let vector = |name| values.numbers(name).and_then(|n| n.try_into().ok()).unwrap_or_default();
    Origin { xyz: vector("xyz"), rpy: vector("rpy") }
}

/// One shape element: `<box size="1 2 3"/>`. `None` is reported.
pub(super) fn read_shape(element: &Element, report: &mut Report) -> Option<(Geometry, Finish)> {
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
    let geometry = build::geometry(&values, element, report);
    let finish = build::finish(&values, element, report);
    Some((geometry?, finish))
}

/// Is it a shape that plain URDF parsers know as it is written?
pub(super) fn is_urdf(element: &Element) -> bool {
    let known = SHAPES[..table::URDF_SHAPES].iter().any(|tag| tag.name == element.tag());
    known && table::FINISH.iter().all(|name| element.value(name).is_none())
}

/// The warning on a shape that cannot be taken as its polygon mesh (B-4).
pub(super) fn not_polygonised(place: Place, kind: &str) -> Finding {
    let message = format!("this <{kind}> is not polygonised: it is taken as it is");
    let mend =
        "polygonise takes solid boxes, spheres, capsules, cylinders, tubes, cones and frusta without slice and fillet";
    Finding::warning("polygonise-ignored", place, message, mend)
}
