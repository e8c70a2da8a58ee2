//! Mass properties of every link of a description, and what there is to say about them.

use super::of_shape::{Refusal, kind, of_shape};
use super::{MassProperties, WATER_DENSITY};
use crate::description::{Body, Description, Finding, Inertial, JointKind, Link, PlacedShape, Severity};
use crate::math::{Mat3, Pose, Vec3};
use std::collections::HashMap;

/// Mass properties per link, in the order of `description.links`, along the link's axes; and findings.
///
/// A `<realnoid><body>` tag wins over `<inertial>`; a link with neither carries no mass. Where a finding is an error,
/// that link's mass is zero and the description must not be simulated.
pub fn link_masses(description: &Description) -> (Vec<MassProperties>, Vec<Finding>) {
    let mut findings = Vec::new();
    let moving = moving_links(description);
    let masses = description
        .links
        .iter()
        .zip(moving)
        .map(|(link, moves)| match (&link.body, &link.inertial) {
            (Some(body), written) => {
                let mass = from_tag(link, body, moves, &mut findings);
                findings.extend(written.as_ref().and_then(|w| difference(link, body, &mass, &from_inertial(w))));
                mass
            }
            (None, Some(inertial)) => from_inertial(inertial),
            (None, None) => MassProperties::ZERO,
        })
        .collect();
    (masses, findings)
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
fn from_tag(link: &Link, body: &Body, moves: bool, findings: &mut Vec<Finding>) -> MassProperties {
    if body.specific_gravity == 0.0 {
        findings.extend(moves.then(|| static_in_chain(link, body)));
        return MassProperties::ZERO;
    }
    if !(body.specific_gravity > 0.0 && body.specific_gravity.is_finite()) {
        findings.push(no_density(link, body));
        return MassProperties::ZERO;
    }
    let shapes = if body.shapes.is_empty() { &link.visuals } else { &body.shapes };
    if shapes.is_empty() {
        findings.push(no_shape(link, body));
        return MassProperties::ZERO;
    }
    let mut parts = Vec::with_capacity(shapes.len());
    let before = findings.len();
    for shape in shapes {
        match from_shape(shape, body) {
            Ok(part) => parts.push(part),
            Err(refusal) => findings.push(refused(link, shape, &refusal)),
        }
    }
    if findings.len() > before { MassProperties::ZERO } else { MassProperties::sum(&parts).l_scaled(body.l_scale) }
}

fn from_shape(placed: &PlacedShape, body: &Body) -> Result<MassProperties, Refusal> {
    let density = body.specific_gravity * WATER_DENSITY;
    let own = of_shape(&placed.geometry, body.dimension, density)?;
    let x_ls: Pose = placed.origin.pose();
    Ok(own.placed(&x_ls))
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

fn static_in_chain(link: &Link, body: &Body) -> Finding {
    body_error(
        (link, body),
        "static-link-in-chain",
        "specific gravity 0 makes this link static, but a moving joint carries it".into(),
        "give a specific gravity above 0 (about 1 for a filled limb), or make the joint fixed",
    )
}

fn no_density(link: &Link, body: &Body) -> Finding {
    body_error(
        (link, body),
        "specific-gravity",
        format!("specific gravity {} is no density", body.specific_gravity),
        "write a number above 0: 1 is water, 2.7 aluminium, 7.8 steel; 0 makes a link of the stand static",
    )
}

fn no_shape(link: &Link, body: &Body) -> Finding {
    body_error(
        (link, body),
        "no-shape-for-mass",
        format!("specific gravity {} needs a shape, and the link has no visual", body.specific_gravity),
        "add a <visual>, or <shape> elements inside <body>, or write <inertial> and drop <body>",
    )
}

fn body_error((link, body): (&Link, &Body), code: &'static str, message: String, mend: &str) -> Finding {
    let element = format!("link '{}' <body>", link.name);
    Finding { severity: Severity::Error, code, message, element, at: body.at, mend: mend.into() }
}

fn refused(link: &Link, shape: &PlacedShape, refusal: &Refusal) -> Finding {
    let (code, mend) = match refusal {
        Refusal::Later(_) => (
            "mass-from-shape-later",
            "describe the mass by <body><shape> children (box, sphere, ellipsoid, cylinder, elliptic_cylinder, \
             capsule, tube, cone, frustum), or write <inertial> and drop <body>",
        ),
        Refusal::NoVolume(..) => ("shape-without-volume", "write a size above 0, in metres"),
        Refusal::NoWall(_) => ("wall-without-thickness", "write thickness=\"0.003\" (metres), or dimension=\"3d\""),
    };
    Finding {
        severity: Severity::Error,
        code,
        message: refusal.to_string(),
        element: format!("link '{}' <{}>", link.name, kind(&shape.geometry)),
        at: shape.at,
        mend: mend.into(),
    }
}

/// Relative deviation up to which two statements of the same mass properties count as one.
const SAME: f64 = 1e-9;

/// The note on a link that gives both: the tag wins, and by how much the two differ. None if they agree, as in a text
/// that [`super::with_inertials`] wrote.
fn difference(link: &Link, body: &Body, tag: &MassProperties, written: &MassProperties) -> Option<Finding> {
    let mass = tag.mass - written.mass;
    let center = (tag.center - written.center).norm();
    let inertia = (tag.inertia - written.inertia).abs().max();
    let largest = written.inertia.abs().max();
    let agree = mass.abs() <= SAME * written.mass && center <= SAME && inertia <= SAME * largest;
    if tag.mass == 0.0 || agree {
        return None;
    }
    let message = format!(
        "both <body> and <inertial>: the tag wins. Against <inertial>, mass is {:.6} kg instead of {:.6} kg ({}), the \
         centre of mass is {:.2} mm away, and inertia elements differ by up to {inertia:.3e} kg·m² ({} of the largest)",
        tag.mass,
        written.mass,
        if written.mass > 0.0 { format!("{:+.1} %", 100.0 * mass / written.mass) } else { "from none".into() },
        center * 1e3,
        if largest > 0.0 { format!("{:.1} %", 100.0 * inertia / largest) } else { "more than all".into() },
    );
    Some(Finding {
        severity: Severity::Note,
        code: "inertial-and-body",
        message,
        element: format!("link '{}' <body>", link.name),
        at: body.at,
        mend: "keep one of the two: <body> to compute mass from shape, <inertial> to state it".into(),
    })
}
