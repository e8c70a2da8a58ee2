//! What there is to say about the mass of a link.

use super::MassProperties;
use super::of_shape::Refusal;
use crate::description::{Body, Finding, Link, PlacedShape, Severity};
use crate::shape::{COUNTS_TWICE, MeshFault, ShapeFault, SolidFault};

pub(super) fn static_in_chain(link: &Link, body: &Body) -> Finding {
    body_error(
        (link, body),
        "static-link-in-chain",
        "specific gravity 0 makes this link static, but a moving joint carries it".into(),
        "give a specific gravity above 0 (about 1 for a filled limb), or make the joint fixed",
    )
}

pub(super) fn no_density(link: &Link, body: &Body) -> Finding {
    body_error(
        (link, body),
        "specific-gravity",
        format!("specific gravity {} is no density", body.substance.specific_gravity),
        "write a number above 0: 1 is water, 2.7 aluminium, 7.8 steel; 0 makes a link of the stand static",
    )
}

pub(super) fn no_shape(link: &Link, body: &Body) -> Finding {
    body_error(
        (link, body),
        "no-shape-for-mass",
        format!("specific gravity {} needs a shape, and the link has no visual", body.substance.specific_gravity),
        "add a <visual>, or <shape> elements inside <body>, or write <inertial> and drop <body>",
    )
}

fn body_error((link, body): (&Link, &Body), code: &'static str, message: String, mend: &str) -> Finding {
    let element = format!("link '{}' <body>", link.name);
    Finding { severity: Severity::Error, code, message, element, at: body.at, mend: mend.into() }
}

pub(super) fn refused(link: &Link, shape: &PlacedShape, refusal: &Refusal) -> Finding {
    let (code, mend) = match refusal {
        Refusal::Shape(ShapeFault::NoVolume(..)) => {
            ("shape-without-volume", "correct the size that the message names, in metres")
        }
        Refusal::Shape(ShapeFault::Crossing) => {
            ("quad-crosses-itself", "swap two neighbouring corners, or make two <triangle> of it")
        }
        Refusal::Shape(_) => ("shape", "correct the fillet, slice or scale"),
        Refusal::File(fault) => bad_file(fault),
        Refusal::NotSolid(fault) => no_solid(fault),
        Refusal::Open(_) => ("surface-without-inside", "write dimension=\"2d\" and a thickness"),
        Refusal::NoArea(_) => ("shape-without-area", "give the corners of at least one triangle that is not a line"),
        Refusal::NoVolume(_) => ("mesh-without-volume", ANOTHER_BODY),
        Refusal::OutOfRange { .. } => {
            ("mass-out-of-range", "write sizes in metres and the specific gravity as a multiple of water's")
        }
        Refusal::NoWall(_) => ("wall-without-thickness", "write thickness=\"0.003\" (metres), or dimension=\"3d\""),
    };
    Finding {
        severity: Severity::Error,
        code,
        message: refusal.to_string(),
        element: format!("link '{}' <{}>", link.name, shape.geometry.kind()),
        at: shape.at,
        mend: mend.into(),
    }
}

/// What helps when a mesh is no solid.
const ANOTHER_BODY: &str =
    "give a mesh that encloses something, or write dimension=\"2d\" and a thickness, or use a simpler <shape>";

fn no_solid(fault: &SolidFault) -> (&'static str, &'static str) {
    match fault {
        SolidFault::NotClosed { .. } => (
            "mesh-not-closed",
            "close the mesh in a mesh editor, or write dimension=\"2d\" and a thickness, or use a simpler <shape>",
        ),
        SolidFault::NotOrientable { .. } => ("mesh-without-inside", ANOTHER_BODY),
        SolidFault::Contradiction { .. } => (
            "mesh-contradicts-itself",
            "turn the faces in a mesh editor so that all face outwards, or use a simpler <shape>",
        ),
        SolidFault::Degenerate { .. } => ("mesh-without-area", ANOTHER_BODY),
        SolidFault::NoVolume { .. } => ("mesh-without-volume", ANOTHER_BODY),
        SolidFault::Malformed { .. } => ("mesh-unreadable", "save the mesh anew from a mesh editor"),
    }
}

fn bad_file(fault: &MeshFault) -> (&'static str, &'static str) {
    match fault {
        MeshFault::NotFound(_) => {
            ("mesh-not-found", "correct the file name; a relative one starts at the folder of the URDF")
        }
        MeshFault::UnknownPackage { .. } => {
            ("unknown-package", "tell its folder by --package NAME=DIR, or source the workspace that holds it")
        }
        MeshFault::Address { .. } => ("mesh-address", "copy the file to this computer and name it by its path"),
        MeshFault::UnknownFormat { .. } => ("mesh-format", "save the mesh as STL, OBJ or DAE"),
        MeshFault::TooLarge { .. } => ("mesh-too-large", "simplify the mesh in a mesh editor"),
        MeshFault::Unreadable { .. } | MeshFault::NoPlace { .. } | MeshFault::NoTriangles { .. } => {
            ("mesh-unreadable", "save the file anew, or correct what the message names")
        }
        MeshFault::Terrain(_) => ("terrain-heights", "correct the heights"),
    }
}

/// Relative deviation up to which two statements of the same mass properties count as one.
const SAME: f64 = 1e-9;

/// The note on a link that gives both: the tag wins, and by how much the two differ. None if they agree, as in a text
/// that [`super::with_inertials`] wrote.
pub(super) fn difference(link: &Link, body: &Body, tag: &MassProperties, written: &MassProperties) -> Option<Finding> {
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

/// What was mended in a mesh before its mass was computed, or has to be known about it.
pub(super) fn repaired(link: &Link, shape: &PlacedShape, repair: &str) -> Finding {
    Finding {
        severity: Severity::Warning,
        code: if repair.contains(COUNTS_TWICE) { "mesh-overlaps-itself" } else { "mesh-repaired" },
        message: repair.to_owned(),
        element: format!("link '{}' <{}>", link.name, shape.geometry.kind()),
        at: shape.at,
        mend: "repair the file in a mesh editor, so that other programs see the same body".into(),
    }
}

/// A threshold that leaves a tensor that no body has.
pub(super) fn rounded_away(link: &Link, body: &Body, exponent: i32) -> Finding {
    let message =
        format!("zero_exponent = {exponent} takes so much from the inertia tensor that no body has such a one");
    body_error((link, body), "inertia-rounded-away", message, "write a smaller exponent")
}

/// Numbers too large or too small for arithmetic.
pub(super) fn out_of_range(link: &Link, body: &Body) -> Finding {
    let message = "the mass, centre or inertia of this link is too large a number to calculate with".to_owned();
    body_error((link, body), "mass-out-of-range", message, "write sizes and places in metres, and a smaller l_scale")
}

/// A wall that does not fit into its shape.
pub(super) fn thick_wall(link: &Link, shape: &PlacedShape, wall: f64, inside: f64) -> Finding {
    Finding {
        severity: Severity::Warning,
        code: "wall-thicker-than-shape",
        message: format!("the wall has {wall:.3e} m³ on its surface, the whole shape only {inside:.3e} m³"),
        element: format!("link '{}' <{}>", link.name, shape.geometry.kind()),
        at: shape.at,
        mend: "write a smaller thickness, or dimension=\"3d\"".into(),
    }
}

/// A tensor that no body has, from shapes: a fault of ours.
pub(super) fn impossible(link: &Link, body: &Body) -> Finding {
    let message = "the inertia computed from these shapes is that of no body".to_owned();
    body_error(
        (link, body),
        "inertia-impossible",
        message,
        "this is a fault of realnoid: please report it together with the file",
    )
}

/// An L scale beside another one on the same rigid whole.
pub(super) fn idle_l_scale(link: &Link) -> Option<Finding> {
    let body = link.body.as_ref()?;
    Some(Finding {
        severity: Severity::Warning,
        code: "l-scale-ignored",
        message: format!(
            "l_scale = {} has no effect: fixed joints make this link one body with another one nearer to the root, and \
             its l_scale counts",
            body.l_scale
        ),
        element: format!("link '{}' <body>", link.name),
        at: body.at,
        mend: "write the l_scale on the link that the moving joint carries".into(),
    })
}
