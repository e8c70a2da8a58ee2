//! Every shape element with its attributes.

use super::super::element::Domain;
use super::super::rules::{Attribute, Kind, Tag};

const LENGTH: Kind = Kind::Number(Domain::Positive);
const NOT_NEGATIVE: Kind = Kind::Number(Domain::NonNegative);

const fn length(name: &'static str) -> Attribute {
    Attribute::required(name, LENGTH)
}

const fn maybe_length(name: &'static str) -> Attribute {
    Attribute::optional(name, LENGTH)
}

const fn point(name: &'static str) -> Attribute {
    Attribute::required(name, Kind::Vector(3, Domain::Any))
}

const fn sizes(count: usize) -> Attribute {
    Attribute::required("size", Kind::Vector(count, Domain::Positive))
}

const fn shape(name: &'static str, attributes: &'static [Attribute]) -> Tag {
    Tag { name, attributes, children: &[] }
}

/// Attributes beside the sizes (tables 6-2 and 6-5): other URDF tools do not know them.
pub(super) const FINISH: [&str; 4] = ["fillet", "top_fillet", "slice", "caps"];
const FILLET: Attribute = Attribute::optional("fillet", NOT_NEGATIVE);
const TOP_FILLET: Attribute = Attribute::optional("top_fillet", NOT_NEGATIVE);
const SLICE: Attribute = Attribute::optional("slice", Kind::Vector(2, Domain::Any));
const CAPS: Attribute = Attribute::optional("caps", Kind::Flag);

/// URDF's own shapes come first.
pub(super) const URDF_SHAPES: usize = 4;

/// Every shape element that is read.
pub(in super::super) const SHAPES: &[Tag] = &[
    shape("box", &[sizes(3), FILLET]),
    shape("cylinder", &[length("radius"), length("length"), FILLET, SLICE, CAPS]),
    shape("sphere", &[length("radius")]),
    shape(
        "mesh",
        &[Attribute::required("filename", Kind::Text), Attribute::optional("scale", Kind::Vector(3, Domain::Any))],
    ),
    shape(
        "capsule",
        &[maybe_length("radius"), maybe_length("radius_top"), maybe_length("radius_bottom"), length("length"), SLICE],
    ),
    shape("ellipsoid", &[Attribute::required("radii", Kind::Vector(3, Domain::Positive))]),
    shape("elliptic_cylinder", &[length("radius_x"), length("radius_y"), length("length"), FILLET, SLICE, CAPS]),
    shape("tube", &[length("outer_radius"), length("inner_radius"), length("length"), FILLET, SLICE]),
    shape(
        "cone",
        &[
            maybe_length("radius"),
            maybe_length("radius_x"),
            maybe_length("radius_y"),
            length("length"),
            FILLET,
            SLICE,
            CAPS,
        ],
    ),
    shape(
        "frustum",
        &[
            maybe_length("radius"),
            maybe_length("radius_x"),
            maybe_length("radius_y"),
            length("top_scale"),
            length("length"),
            FILLET,
            TOP_FILLET,
            SLICE,
            CAPS,
        ],
    ),
    shape("hemisphere", &[length("radius")]),
    shape("torus", &[length("ring_radius"), length("pipe_radius")]),
    shape("oil_tank", &[length("radius"), length("length"), length("cap_height")]),
    shape("pyramid", &[sizes(3)]),
    shape(
        "polyhedron",
        &[Attribute::required("faces", Kind::Number(Domain::OneOf(&[4.0, 6.0, 8.0, 12.0, 20.0]))), length("radius")],
    ),
    shape("disc", &[length("outer_radius"), Attribute::optional("inner_radius", NOT_NEGATIVE), SLICE]),
    shape("plane", &[sizes(2)]),
    shape("triangle", &[point("a"), point("b"), point("c")]),
    shape("quad", &[point("a"), point("b"), point("c"), point("d")]),
    shape(
        "terrain",
        &[
            Attribute::optional("size", Kind::Vector(3, Domain::Positive)),
            maybe_length("radius"),
            Attribute::optional("height", LENGTH),
            Attribute::optional("columns", Kind::Number(Domain::Whole(2, 1_000_000))),
            Attribute::optional("heights", Kind::Numbers),
            Attribute::optional("filename", Kind::Text),
        ],
    ),
];
