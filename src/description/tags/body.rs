//! What a body is made of, and how its shapes are deformed: attributes of `<body>`, `<shape>` and `<proxy>`.

use super::super::element::{Domain, Element};
use super::super::finding::Finding;
use super::super::report::Report;
use super::super::rules::{Attribute, Kind, Tag, Values};
use super::super::{
    Dimension, Geometry, MOST_FLAT_SEGMENTS, MOST_SEGMENTS, PlacedShape, Scaling, Subdivision, Substance, shapes,
};

/// B-3: 0.001 of the smallest system unit, the millimetre.
const LEAST_THICKNESS: f64 = 1e-6;

/// Segments of a full turn where the text does not say.
const SEGMENTS_OF_A_TURN: u32 = 36;

pub(super) const DIMENSION: Attribute = Attribute::optional("dimension", Kind::Word(&["2d", "3d"]));
pub(super) const THICKNESS: Attribute =
    Attribute::optional("thickness", Kind::Number(Domain::AtLeast(LEAST_THICKNESS)));
pub(super) const POLYGONISE: Attribute = Attribute::optional("polygonise", Kind::Flag);
pub(super) const SEGMENTS: Attribute = Attribute::optional("segments", Kind::Number(Domain::Whole(3, MOST_SEGMENTS)));
pub(super) const FLAT_SEGMENTS: Attribute =
    Attribute::optional("flat_segments", Kind::Number(Domain::Whole(1, MOST_FLAT_SEGMENTS)));
pub(super) const LIMIT_SUBDIVISIONS: Attribute = Attribute::optional("limit_subdivisions", Kind::Flag);
const SCALE: Attribute = Attribute::optional("scale", Kind::Vector(3, Domain::Any));
const SCALE_TOP: Attribute = Attribute::optional("scale_top", Kind::Number(Domain::NonNegative));
const SCALE_BOTTOM: Attribute = Attribute::optional("scale_bottom", Kind::Number(Domain::NonNegative));

/// What is inside of these two is read by `shapes`.
pub(in super::super) const SHAPE: Tag = Tag {
    name: "shape",
    attributes: &[
        SCALE,
        SCALE_TOP,
        SCALE_BOTTOM,
        Attribute::optional("specific_gravity", Kind::Number(Domain::Positive)),
        DIMENSION,
        THICKNESS,
        POLYGONISE,
        SEGMENTS,
        FLAT_SEGMENTS,
        LIMIT_SUBDIVISIONS,
    ],
    children: &[],
};
pub(in super::super) const PROXY: Tag =
    Tag { name: "proxy", attributes: &[SCALE, SCALE_TOP, SCALE_BOTTOM], children: &[] };

/// A `<shape>` of a body that is made of `body`, with its subdivision, unless it says otherwise. `None` is reported.
pub(super) fn shape(
    element: &Element,
    (body, subdivision): (&Substance, Subdivision),
    report: &mut Report,
) -> Option<PlacedShape> {
    let values = SHAPE.read_attributes(element, report);
    let mut shape = shapes::read_placed(element, report)?;
    shape.scaling = scaling(&values, element, &shape.geometry, report);
    let own = merged(&values, element, (body, subdivision), report);
    if own.polygonise.is_some() && !shape.may_be_polygonised(own.dimension) {
        report.add_once(
            shape.geometry.kind(),
            shapes::not_polygonised(element.place_of("polygonise", report), shape.geometry.kind()),
        );
    }
    if own.polygonise.is_none() && (values.number("segments"), values.number("flat_segments")) != (None, None) {
        let message = "segments are for polygonised shapes, and this one is not".to_string();
        let mend = "add polygonise=\"true\", or take the segments out";
        report.add(Finding::warning("segments-ignored", element.place_of("segments", report), message, mend));
    }
    if body.specific_gravity == 0.0 && own.specific_gravity > 0.0 {
        let message = "the <body> is static (specific gravity 0), so this shape adds no mass".to_string();
        let mend = "give the <body> a specific gravity above 0";
        report.add(Finding::warning("static-body", element.place_of("specific_gravity", report), message, mend));
    }
    shape.substance = Some(own);
    Some(shape)
}

/// A `<proxy>`. `None` is reported.
pub(super) fn proxy(element: &Element, report: &mut Report) -> Option<PlacedShape> {
    let values = PROXY.read_attributes(element, report);
    let mut shape = shapes::read_placed(element, report)?;
    shape.scaling = scaling(&values, element, &shape.geometry, report);
    Some(shape)
}

/// What `<body>` says.
pub(super) fn substance(values: &Values, element: &Element, specific_gravity: f64, report: &mut Report) -> Substance {
    let plain = Substance { specific_gravity, dimension: Dimension::Solid, polygonise: None };
    merged(values, element, (&plain, subdivision(values)), report)
}

/// The segments that `<body>` names, whether or not it is polygonised itself: its shapes may be.
pub(super) fn subdivision(values: &Values) -> Subdivision {
    segments(values, Subdivision { around: SEGMENTS_OF_A_TURN, flat: 1 })
}

fn segments(values: &Values, base: Subdivision) -> Subdivision {
    let limited = values.flag_or("limit_subdivisions", false);
    Subdivision {
        around: values.number_or("segments", base.around.into()) as u32,
        flat: if limited { 1 } else { values.number_or("flat_segments", base.flat.into()) as u32 },
    }
}

/// What the element says, and for the rest what the base is.
fn merged(
    values: &Values,
    element: &Element,
    (base, subdivision): (&Substance, Subdivision),
    report: &mut Report,
) -> Substance {
    let polygonise = values.flag_or("polygonise", base.polygonise.is_some());
    Substance {
        specific_gravity: values.number_or("specific_gravity", base.specific_gravity),
        dimension: dimension(values, element, base.dimension, report),
        polygonise: polygonise.then(|| segments(values, subdivision)),
    }
}

fn dimension(values: &Values, element: &Element, base: Dimension, report: &mut Report) -> Dimension {
    let hollow = values.word("dimension").map_or(matches!(base, Dimension::Hollow { .. }), |word| word == "2d");
    match (hollow, values.number("thickness"), base) {
        (true, Some(thickness), _) => Dimension::Hollow { thickness },
        (true, None, Dimension::Hollow { thickness }) => Dimension::Hollow { thickness },
        (false, None, _) => Dimension::Solid,
        (true, None, Dimension::Solid) => {
            if element.value("thickness").is_none() {
                let message = "a hollow body (dimension = 2d) needs the thickness of its wall".to_string();
                let mend = "add thickness=\"0.003\" (metres)";
                report.add(Finding::error("missing-attribute", element.place_of("dimension", report), message, mend));
            }
            Dimension::Solid
        }
        (false, Some(_), _) => {
            let message = "a solid body has no wall thickness".to_string();
            let mend = "write dimension=\"2d\" for a hollow body, or take `thickness` out";
            report.add(Finding::error("thickness", element.place_of("thickness", report), message, mend));
            Dimension::Solid
        }
    }
}

/// S-2 … S-4.
fn scaling(values: &Values, element: &Element, geometry: &Geometry, report: &mut Report) -> Scaling {
    let mut scaling = Scaling {
        factors: values.numbers("scale").and_then(|n| n.try_into().ok()).unwrap_or([1.0; 3]),
        top: values.number_or("scale_top", 1.0),
        bottom: values.number_or("scale_bottom", 1.0),
    };
    let kind = geometry.kind();
    if scaling.factors.contains(&0.0) {
        let mend = "write a factor other than 0; 1 leaves the axis as it is";
        let message = "a scale of 0 flattens the shape".to_string();
        report.add(Finding::error("out-of-range", element.place_of("scale", report), message, mend));
        scaling.factors = [1.0; 3];
    }
    if scaling.factors != [1.0; 3] && !scales(geometry) {
        let message = format!("a <{kind}> takes no scale: it is left as it is");
        let mend = "write its size instead";
        report.add_once(kind, Finding::warning("scale-ignored", element.place_of("scale", report), message, mend));
        scaling.factors = [1.0; 3];
    }
    if scaling.factors.iter().any(|f| *f < 0.0) {
        let message = format!("a negative scale mirrors the <{kind}>");
        report.add(Finding::note("mirrored", element.place_of("scale", report), message, ""));
    }
    if (scaling.top, scaling.bottom) != (1.0, 1.0) && !matches!(geometry, Geometry::Capsule { .. }) {
        let name = if scaling.top == 1.0 { "scale_bottom" } else { "scale_top" };
        let message = format!("{name} is for capsules: the <{kind}> is left as it is");
        let mend = "take it out, or use a <capsule>";
        report.add(Finding::warning("scale-ignored", element.place_of(name, report), message, mend));
        (scaling.top, scaling.bottom) = (1.0, 1.0);
    }
    scaling
}

/// S-1, and our own shapes that are such a primitive after scaling.
fn scales(geometry: &Geometry) -> bool {
    !matches!(
        geometry,
        Geometry::Plane { .. }
            | Geometry::Triangle { .. }
            | Geometry::Quad { .. }
            | Geometry::Terrain { .. }
            | Geometry::SphericalTerrain { .. }
            | Geometry::Mesh { .. }
    )
}
