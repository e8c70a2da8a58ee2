//! Mass properties of every link of a description, and what there is to say about them.

use super::MassProperties;
use super::finding;
use super::l_scale;
use super::of_shape::{Method, Refusal, ShapeMass, of_shape};
use crate::description::{
    Body, Description, Dimension, Finding, Geometry, Inertial, JointKind, Link, PlacedShape, Substance,
};
use crate::math::{Mat3, Vec3};
use crate::shape::{Meshes, Shape};
use std::path::Path;

/// What one link weighs, and where that comes from.
#[derive(Clone, Debug)]
pub struct LinkBody {
    /// Along the link's axes.
    pub properties: MassProperties,
    /// The same as it is simulated: with what the L scale adds to the inertia (B-18).
    pub simulated: MassProperties,
    /// Of the material, m³; `None` if the mass is only stated (`<inertial>`), or there is none.
    pub volume: Option<f64>,
    /// B-18: factor on the distance in the moment of inertia; not in `properties`.
    pub l_scale: f64,
    /// B-10: the power of ten below which tensor elements are 0; already applied to `properties`.
    pub zero_exponent: Option<i32>,
    /// How the mass of each shape was found, in the order of the shapes.
    pub methods: Vec<Method>,
}

impl LinkBody {
    fn stated(properties: MassProperties) -> Self {
        Self { properties, simulated: properties, volume: None, l_scale: 1.0, zero_exponent: None, methods: vec![] }
    }
}

/// Mass properties per link as they are simulated, in the order of `description.links`, along the link's axes; and
/// findings. Mesh files are looked for beside the file of the description. See [`link_bodies`].
pub fn link_masses(description: &Description) -> (Vec<MassProperties>, Vec<Finding>) {
    let (bodies, findings) = link_bodies(description, &Meshes::beside(Path::new(&*description.file), &[]));
    (bodies.into_iter().map(|b| b.simulated).collect(), findings)
}

/// The bodies of the links, in the order of `description.links`, and findings.
///
/// A `<realnoid><body>` tag wins over `<inertial>`; a link with neither carries no mass. Where a finding is an error,
/// that link's mass is zero and the description must not be simulated.
pub fn link_bodies(description: &Description, meshes: &Meshes) -> (Vec<LinkBody>, Vec<Finding>) {
    let mut findings = Vec::new();
    let moving = moving_links(description);
    let mut bodies: Vec<LinkBody> = description
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
    let idle = l_scale::apply(description, &mut bodies);
    for (link, found) in description.links.iter().zip(&bodies) {
        let overflown = link.body.as_ref().filter(|_| found.properties.is_finite() && !found.simulated.is_finite());
        findings.extend(overflown.map(|body| finding::out_of_range(link, body)));
        let bad = link.proxies.iter().filter_map(|proxy| Some((proxy, Shape::of(proxy).err()?)));
        findings.extend(bad.map(|(proxy, fault)| finding::refused(link, proxy, &fault.into())));
    }
    findings.extend(idle.iter().filter_map(|i| finding::idle_l_scale(&description.links[*i])));
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
        findings.extend(
            thick_wall(shape, body, part.volume, meshes)
                .map(|inside| finding::thick_wall(link, shape, part.volume, inside)),
        );
        findings.extend(part.repairs.iter().map(|repair| finding::repaired(link, shape, repair)));
    }
    composed(link, body, &parts, findings)
}

/// J-6: the parts of a link as one body, with B-10's rounding.
fn composed(link: &Link, body: &Body, parts: &[(&PlacedShape, ShapeMass)], findings: &mut Vec<Finding>) -> LinkBody {
    let masses: Vec<MassProperties> = parts.iter().map(|(_, part)| part.properties).collect();
    let exact = MassProperties::sum(&masses);
    let rounded = body.zero_exponent.map(|exponent| (exact.rounded(exponent), exponent));
    match rounded {
        _ if !(exact.is_finite() && exact.inertia_at_origin().iter().all(|x| x.is_finite())) => {
            findings.push(finding::out_of_range(link, body));
        }
        _ if !exact.is_physical() => findings.push(finding::impossible(link, body)),
        Some((rounded, exponent)) if !(rounded.is_physical() && rounded.inertia.diagonal().min() > 0.0) => {
            findings.push(finding::rounded_away(link, body, exponent));
        }
        _ => (),
    }
    LinkBody {
        volume: Some(parts.iter().map(|(_, part)| part.volume).sum()),
        l_scale: body.l_scale,
        zero_exponent: body.zero_exponent,
        methods: parts.iter().map(|(_, part)| part.method).collect(),
        ..LinkBody::stated(rounded.map_or(exact, |(rounded, _)| rounded))
    }
}

/// The volume inside a shape whose wall takes more than that; mesh files are not asked, they may be open.
fn thick_wall(placed: &PlacedShape, body: &Body, wall: f64, meshes: &Meshes) -> Option<f64> {
    let substance = body.substance_of(placed);
    let shape = Shape::of(placed).ok()?;
    if substance.dimension == Dimension::Solid || matches!(shape.geometry, Geometry::Mesh { .. }) {
        return None;
    }
    let filled = Substance { dimension: Dimension::Solid, polygonise: None, ..substance };
    let inside = of_shape(&shape, &filled, meshes).ok()?.volume;
    (wall > inside).then_some(inside)
}

/// One shape, at its place in the link.
fn from_shape(placed: &PlacedShape, body: &Body, meshes: &Meshes) -> Result<ShapeMass, Refusal> {
    let own = of_shape(&Shape::of(placed)?, &body.substance_of(placed), meshes)?;
    Ok(ShapeMass { properties: own.properties.placed(&placed.origin.pose()), ..own })
}

/// Per link: is there a moving joint between it and the root? A cycle, which the description room reports, ends the
/// walk.
fn moving_links(description: &Description) -> Vec<bool> {
    let above = description.joints_above();
    let moves = |link: &Link| {
        let path = std::iter::successors(above.get(link.name.as_str()), |joint| above.get(joint.parent.as_str()));
        path.take(description.joints.len()).any(|joint| joint.kind != JointKind::Fixed)
    };
    description.links.iter().map(moves).collect()
}
