//! What each shape of a description is to contact.

use super::part::hull_corners;
use crate::description::{Geometry, PlacedShape, Subdivision};
use crate::math::Vec3;
use crate::shape::{ContactForm, MeshFault, Meshes, Shape, ShapeFault, TriMesh, tessellate};
use std::sync::Arc;

/// Segments of a full turn where a round shape becomes polygons.
const AROUND: u32 = 48;

/// What became of a shape.
pub(super) struct Formed {
    pub form: ContactForm,
    /// What differs from the shape as it was written, for people.
    pub instead: Option<String>,
}

/// Why a shape does not collide.
pub(super) enum Fault {
    Shape(ShapeFault),
    File(MeshFault),
    Empty,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shape(fault) => fault.fmt(f),
            Self::File(fault) => fault.fmt(f),
            Self::Empty => f.write_str("it has no corners"),
        }
    }
}

/// The form of a shape; of one that is not convex the surface if it stands still, else the convex hull.
pub(super) fn form(placed: &PlacedShape, stands: bool, meshes: &Meshes) -> Result<Formed, Fault> {
    let shape = Shape::of(placed).map_err(Fault::Shape)?;
    if let Some(form) = exact(&shape) {
        return Ok(Formed { form, instead: None });
    }
    let subdivision = Subdivision { around: AROUND, flat: 1 };
    let mesh = tessellate(&shape, subdivision, meshes).map_err(Fault::File)?.without_strays();
    if mesh.triangles.is_empty() {
        return Err(Fault::Empty);
    }
    let polygons = if straight(&shape) { String::new() } else { format!(", with {AROUND} segments to a turn") };
    let convex = convex(&shape);
    if stands && !convex {
        let instead = (!polygons.is_empty()).then(|| format!("it collides as its polygon mesh{polygons}"));
        return Ok(Formed { form: ContactForm::Surface(Arc::new(mesh)), instead });
    }
    let instead = match (convex, polygons.is_empty()) {
        (true, true) => None,
        (true, false) => Some(format!("it collides as its polygon mesh{polygons}")),
        (false, _) => Some(format!("it moves, and collides as its convex hull{polygons}")),
    };
    Ok(hull(&mesh, instead))
}

fn hull(mesh: &TriMesh, instead: Option<String>) -> Formed {
    match hull_corners(&mesh.vertices) {
        Some(corners) => Formed { form: ContactForm::Hull(corners.into()), instead },
        None => Formed {
            form: ContactForm::Hull(mesh.vertices.clone().into()),
            instead: Some("the faces of its convex hull could not be found: it touches by one point at a time".into()),
        },
    }
}

/// Round shapes without finish, and boxes: taken as they are.
fn exact(shape: &Shape) -> Option<ContactForm> {
    let whole = shape.finish.slice.is_none() && shape.stretch == [1.0; 3];
    let sharp = shape.finish.fillet == 0.0 && shape.finish.top_fillet.is_none_or(|f| f == 0.0);
    if let (Geometry::Box { size }, true) = (&shape.geometry, shape.stretch.map(f64::abs) == [1.0; 3]) {
        let radius = shape.finish.fillet;
        let half = size.map(|s| (0.5 * s - radius).max(0.0));
        return Some(if sharp { ContactForm::Cuboid { half } } else { ContactForm::RoundCuboid { half, radius } });
    }
    if !(whole && sharp) {
        return None;
    }
    let frustum =
        |x: f64, y: f64, top: f64, length: f64| ContactForm::Frustum { radii: [x, y], top, half: 0.5 * length };
    Some(match shape.geometry {
        Geometry::Sphere { radius } => ContactForm::Ball { radius },
        Geometry::Ellipsoid { radii } => ContactForm::Ellipsoid { radii },
        Geometry::Capsule { radius_top, radius_bottom, length } => {
            ContactForm::Capsule { bottom: radius_bottom, top: radius_top, half: 0.5 * length }
        }
        // A mantle without caps is as convex to contact as a closed one.
        Geometry::Cylinder { radius, length } => ContactForm::Cylinder { radius, half: 0.5 * length },
        Geometry::EllipticCylinder { radius_x, radius_y, length } => frustum(radius_x, radius_y, 1.0, length),
        Geometry::Cone { radius_x, radius_y, length } if radius_x == radius_y => {
            ContactForm::Cone { radius: radius_x, half: 0.5 * length }
        }
        Geometry::Cone { radius_x, radius_y, length } => frustum(radius_x, radius_y, 0.0, length),
        Geometry::Frustum { radius_x, radius_y, top_scale, length } if top_scale <= 1.0 => {
            frustum(radius_x, radius_y, top_scale, length)
        }
        Geometry::Disc { outer_radius, inner_radius: 0.0 } => frustum(outer_radius, outer_radius, 1.0, 0.0),
        _ => return None,
    })
}

/// Has no round part: its polygon mesh is the shape itself.
fn straight(shape: &Shape) -> bool {
    matches!(
        shape.geometry,
        Geometry::Box { .. }
            | Geometry::Pyramid { .. }
            | Geometry::Polyhedron { .. }
            | Geometry::Plane { .. }
            | Geometry::Triangle { .. }
            | Geometry::Quad { .. }
            | Geometry::Terrain { .. }
            | Geometry::SphericalTerrain { .. }
            | Geometry::Mesh { .. }
    ) && shape.finish.fillet == 0.0
}

/// Is its own convex hull; a slice of more than a half turn is not.
fn convex(shape: &Shape) -> bool {
    let turn = shape.finish.slice.map_or(0.0, |[from, to]| to - from);
    let kind = match &shape.geometry {
        Geometry::Tube { .. }
        | Geometry::Torus { .. }
        | Geometry::Hemisphere { .. }
        | Geometry::Terrain { .. }
        | Geometry::SphericalTerrain { .. }
        | Geometry::Mesh { .. } => false,
        Geometry::Disc { inner_radius, .. } => *inner_radius == 0.0,
        Geometry::Quad { corners } => flat(corners),
        _ => true,
    };
    kind && turn <= std::f64::consts::PI && !(shape.finish.open && shape.finish.slice.is_some())
}

fn flat(corners: &[[f64; 3]; 4]) -> bool {
    let [a, b, c, d] = corners.map(Vec3::from);
    let normal = (b - a).cross(&(c - a));
    let reflex =
        [(a, b, c), (b, c, d), (c, d, a), (d, a, b)].iter().any(|(p, q, r)| (q - p).cross(&(r - q)).dot(&normal) < 0.0);
    let size = (c - a).norm().max((d - b).norm());
    normal.dot(&(d - a)).abs() <= 1e-9 * normal.norm() * size && !reflex
}
