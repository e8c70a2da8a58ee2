//! Mass properties of every link of a description, and what there is to say about them.

use super::MassProperties;
use super::finding;
use super::of_shape::{Method, Refusal, ShapeMass, of_shape};
use crate::description::{Body, Description, Finding, Inertial, JointKind, Link, PlacedShape};
use crate::math::{Mat3, Vec3};
use crate::shape::{Meshes, Shape};
use std::collections::HashMap;
use std::path::Path;

/// What one link weighs, and where that comes from.
#[derive(Clone, Debug)]
pub struct LinkBody {
    /// Along the link's axes; what is simulated.
    pub properties: MassProperties,
    /// Of the material, m³; `None` if the mass is only stated (`<inertial>`), or there is none.
    pub volume: Option<f64>,
    /// B-18: factor on the distance in the moment of inertia; it is already in `properties`.
    pub l_scale: f64,
    /// B-10: the power of ten below which tensor elements are 0; already applied to `properties`.
    pub zero_exponent: Option<i32>,
    /// How the mass of each shape was found, in the order of the shapes.
    pub methods: Vec<Method>,
}

impl LinkBody {
    fn stated(properties: MassProperties) -> Self {
        Self { properties, volume: None, l_scale: 1.0, zero_exponent: None, methods: vec![] }
    }
}

/// Mass properties per link, in the order of `description.links`, along the link's axes; and findings. Mesh files are
/// looked for beside the file of the description. See [`link_bodies`].
pub fn link_masses(description: &Description) -> (Vec<MassProperties>, Vec<Finding>) {
    let (bodies, findings) = link_bodies(description, &Meshes::beside(Path::new(&*description.file), &[]));
    (bodies.into_iter().map(|b| b.properties).collect(), findings)
}

/// The bodies of the links, in the order of `description.links`, and findings.
///
/// A `<realnoid><body>` tag wins over `<inertial>`; a link with neither carries no mass. Where a finding is an error,
/// that link's mass is zero and the description must not be simulated.
pub fn link_bodies(description: &Description, meshes: &Meshes) -> (Vec<LinkBody>, Vec<Finding>) {
    let mut findings = Vec::new();
    let moving = moving_links(description);
    let bodies = description
        .links
        .iter()
        .zip(moving)
        .map(|(link, moves)| match (&link.body, &link.inertial) {
            (Some(body), written) => {
                let found = from_tag(link, body, moves, meshes, &mut findings);
                let stated = written.as_ref().map(from_inertial);
                findings.extend(stated.and_then(|w| finding::difference(link, body, &found.properties, &w)));
                found
            }
            (None, Some(inertial)) => LinkBody::stated(from_inertial(inertial)),
            (None, None) => LinkBody::stated(MassProperties::ZERO),
        })
        .collect();
    (bodies, findings)
}

/// `<inertial>`, turned to the link's axes.
fn from_inertial(inertial: &Inertial) -> MassProperties {
    let [xx, xy, xz, yy, yz, zz] = inertial.inertia;
    let own = MassProperties {
        mass: inertial.mass,
        center: Vec3::zeros(),
        inertia: Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    };
    own.placed(&inertial.origin.pose())
}

/// The `<body>` tag: every shape at its place, as one body.
fn from_tag(link: &Link, body: &Body, moves: bool, meshes: &Meshes, findings: &mut Vec<Finding>) -> LinkBody {
    let nothing = LinkBody { l_scale: body.l_scale, ..LinkBody::stated(MassProperties::ZERO) };
    let gravity = body.substance.specific_gravity;
    if gravity == 0.0 {
        findings.extend(moves.then(|| finding::static_in_chain(link, body)));
        return nothing;
    }
    if !(gravity > 0.0 && gravity.is_finite()) {
        findings.push(finding::no_density(link, body));
        return nothing;
    }
    let shapes = if body.shapes.is_empty() { &link.visuals } else { &body.shapes };
    if shapes.is_empty() {
        findings.push(finding::no_shape(link, body));
        return nothing;
    }
    let mut parts = Vec::with_capacity(shapes.len());
    let before = findings.len();
    for shape in shapes {
        match from_shape(shape, body, meshes) {
            Ok(part) => parts.push((shape, part)),
            Err(refusal) => findings.push(finding::refused(link, shape, &refusal)),
        }
    }
    if findings.len() > before {
        return nothing;
    }
    for (shape, part) in &parts {
        findings.extend(part.repairs.iter().map(|repair| finding::repaired(link, shape, repair)));
    }
    composed(link, body, &parts, findings)
}

/// J-6: the parts of a link as one body; then B-18, then B-10's rounding.
fn composed(link: &Link, body: &Body, parts: &[(&PlacedShape, ShapeMass)], findings: &mut Vec<Finding>) -> LinkBody {
    let masses: Vec<MassProperties> = parts.iter().map(|(_, part)| part.properties).collect();
    let exact = MassProperties::sum(&masses).l_scaled(body.l_scale);
    let properties = match body.zero_exponent {
        Some(exponent) => exact.rounded(exponent),
        None => exact,
    };
    findings.extend(body.zero_exponent.and_then(|e| finding::rounded_away(link, body, &properties, e)));
    LinkBody {
        properties,
        volume: Some(parts.iter().map(|(_, part)| part.volume).sum()),
        l_scale: body.l_scale,
        zero_exponent: body.zero_exponent,
        methods: parts.iter().map(|(_, part)| part.method).collect(),
    }
}

/// One shape, at its place in the link.
fn from_shape(placed: &PlacedShape, body: &Body, meshes: &Meshes) -> Result<ShapeMass, Refusal> {
    let own = of_shape(&Shape::of(placed)?, &body.substance_of(placed), meshes)?;
    Ok(ShapeMass { properties: own.properties.placed(&placed.origin.pose()), ..own })
}

/// Per link: is there a moving joint between it and the root? A cycle, which the description room reports, ends the
/// walk.
fn moving_links(description: &Description) -> Vec<bool> {
    let to_parent: HashMap<&str, (&str, bool)> = description
        .joints
        .iter()
        .map(|j| (j.child.as_str(), (j.parent.as_str(), j.kind != JointKind::Fixed)))
        .collect();
    let moves = |link: &Link| {
        let steps = std::iter::successors(to_parent.get(link.name.as_str()), |(parent, _)| to_parent.get(parent));
        steps.take(description.joints.len()).any(|&(_, moves)| moves)
    };
    description.links.iter().map(moves).collect()
}
