//! `<realnoid>` inside `<link>`: body, proxy, surface, damping, deactivate, monitor.

use super::super::element::{Domain, Element};
use super::super::report::Report;
use super::super::rules::{Attribute, Kind, Tag};
use super::super::{Body, BodyDamping, Deactivate, MOST_FRICTION, MonitorFrame, PlacedShape, Surface};
use super::body::{self, DIMENSION, FLAT_SEGMENTS, LIMIT_SUBDIVISIONS, POLYGONISE, SEGMENTS, THICKNESS};

const NON_NEGATIVE: Kind = Kind::Number(Domain::NonNegative);
const FRICTION: Kind = Kind::Number(Domain::UpTo(MOST_FRICTION));
const UNIT: Kind = Kind::Number(Domain::Unit);

pub(in super::super) const BODY: Tag = Tag {
    name: "body",
    attributes: &[
        Attribute::required("specific_gravity", NON_NEGATIVE),
        DIMENSION,
        THICKNESS,
        Attribute::optional("l_scale", Kind::Number(Domain::Positive)),
        Attribute::optional("zero_exponent", Kind::Number(Domain::Exponent)),
        POLYGONISE,
        SEGMENTS,
        FLAT_SEGMENTS,
        LIMIT_SUBDIVISIONS,
    ],
    children: &["shape"],
};

pub(in super::super) const SURFACE: Tag = Tag {
    name: "surface",
    attributes: &[
        Attribute::optional("friction", FRICTION),
        Attribute::optional("rolling_friction", FRICTION),
        Attribute::optional("spinning_friction", FRICTION),
        Attribute::optional("restitution", UNIT),
        Attribute::optional("margin", NON_NEGATIVE),
    ],
    children: &[],
};

pub(in super::super) const DAMPING: Tag = Tag {
    name: "damping",
    attributes: &[Attribute::optional("linear", UNIT), Attribute::optional("angular", UNIT)],
    children: &[],
};

pub(in super::super) const DEACTIVATE: Tag = Tag {
    name: "deactivate",
    attributes: &[
        Attribute::optional("linear", NON_NEGATIVE),
        Attribute::optional("angular", NON_NEGATIVE),
        Attribute::optional("after", NON_NEGATIVE),
    ],
    children: &[],
};

pub(in super::super) const MONITOR: Tag =
    Tag { name: "monitor", attributes: &[Attribute::optional("frame", Kind::Word(&["body", "world"]))], children: &[] };

/// Names of the tags that may stand here.
pub(in super::super) const NAMES: &[&str] = &["body", "proxy", "surface", "damping", "deactivate", "monitor"];

/// What the tags of one link say.
#[derive(Default)]
pub(in super::super) struct LinkTags {
    pub body: Option<Body>,
    pub proxies: Vec<PlacedShape>,
    pub surface: Option<Surface>,
    pub damping: Option<BodyDamping>,
    pub deactivate: Option<Deactivate>,
    pub monitor: Option<MonitorFrame>,
}

/// Reads the `<realnoid>` elements of a link.
pub(in super::super) fn read(link: &Element, report: &mut Report) -> LinkTags {
    super::refuse_attributes(link, report);
    let mut tags = LinkTags::default();
    for element in super::collect(link, NAMES, &["proxy"], report) {
        match element.tag() {
            "body" => tags.body = read_body(&element, report),
            "proxy" => tags.proxies.extend(body::proxy(&element, report)),
            "surface" => tags.surface = Some(read_surface(&element, report)),
            "damping" => tags.damping = Some(read_damping(&element, report)),
            "deactivate" => tags.deactivate = Some(read_deactivate(&element, report)),
            _ => tags.monitor = Some(read_monitor(&element, report)),
        }
    }
    tags
}

fn read_body(element: &Element, report: &mut Report) -> Option<Body> {
    let values = BODY.read(element, report);
    let gravity = values.number("specific_gravity");
    let substance = body::substance(&values, element, gravity.unwrap_or(1.0), report);
    let base = (&substance, body::subdivision(&values));
    let shapes: Vec<_> = element.all("shape").filter_map(|shape| body::shape(&shape, base, report)).collect();
    Some(Body {
        at: element.place(report).at,
        substance: gravity.map(|_| substance)?,
        l_scale: values.number_or("l_scale", 1.0),
        zero_exponent: values.number("zero_exponent").map(|exponent| exponent as i32),
        misread: element.all("shape").count() - shapes.len(),
        shapes,
    })
}

fn read_surface(element: &Element, report: &mut Report) -> Surface {
    let values = SURFACE.read(element, report);
    Surface {
        at: element.place(report).at,
        friction: values.number("friction"),
        rolling_friction: values.number("rolling_friction"),
        spinning_friction: values.number("spinning_friction"),
        restitution: values.number("restitution"),
        margin: values.number("margin"),
    }
}

fn read_damping(element: &Element, report: &mut Report) -> BodyDamping {
    let values = DAMPING.read(element, report);
    BodyDamping {
        at: element.place(report).at,
        linear: values.number_or("linear", 0.0),
        angular: values.number_or("angular", 0.0),
    }
}

fn read_deactivate(element: &Element, report: &mut Report) -> Deactivate {
    let values = DEACTIVATE.read(element, report);
    Deactivate {
        at: element.place(report).at,
        linear: values.number_or("linear", 0.0),
        angular: values.number_or("angular", 0.0),
        after: values.number_or("after", 0.0),
    }
}

fn read_monitor(element: &Element, report: &mut Report) -> MonitorFrame {
    match MONITOR.read(element, report).word("frame") {
        Some("world") => MonitorFrame::World,
        _ => MonitorFrame::Body,
    }
}
