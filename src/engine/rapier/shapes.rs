//! Shapes that collide, as rapier has them.

use super::convert::{point, vector};
use crate::engine::outline::{self, AROUND};
use crate::shape::ContactForm;
use rapier3d_f64::math::{Pose, Vector};
use rapier3d_f64::prelude::{SharedShape, TriMeshFlags};
use std::f64::consts::FRAC_PI_2;

/// Bands from pole to pole of a round shape that rapier does not have.
const ALONG: u32 = 24;

/// The shape, and its frame in that of the form. `None` if rapier cannot make it: corners that lie in a plane or so.
pub(super) fn shape(form: &ContactForm) -> Option<(SharedShape, Pose)> {
    // rapier's cylinders and cones stand along y.
    let upright = Pose::rotation(Vector::new(FRAC_PI_2, 0.0, 0.0));
    let plain = |shape| Some((shape, Pose::IDENTITY));
    let up = |half: f64| Vector::new(0.0, 0.0, half);
    match form {
        ContactForm::HalfSpace => plain(SharedShape::halfspace(Vector::Z)),
        ContactForm::Ball { radius } => plain(SharedShape::ball(*radius)),
        ContactForm::Cuboid { half: [x, y, z] } => plain(SharedShape::cuboid(*x, *y, *z)),
        ContactForm::RoundCuboid { half: [x, y, z], radius } => plain(SharedShape::round_cuboid(*x, *y, *z, *radius)),
        ContactForm::Capsule { bottom, top, half } if bottom == top => {
            plain(SharedShape::capsule(up(-half), up(*half), *bottom))
        }
        ContactForm::Capsule { bottom, top, half } => {
            let mut corners = ellipsoid([*bottom; 3], -half);
            corners.extend(ellipsoid([*top; 3], *half));
            plain(SharedShape::convex_hull(&corners)?)
        }
        ContactForm::Ellipsoid { radii } => plain(SharedShape::convex_hull(&ellipsoid(*radii, 0.0))?),
        ContactForm::Cylinder { radius, half } => Some((SharedShape::cylinder(*half, *radius), upright)),
        ContactForm::Cone { radius, half } => Some((SharedShape::cone(*half, *radius), upright)),
        ContactForm::Frustum { radii, top, half } => {
            let mut corners = rim(*radii, -half);
            corners.extend(rim(radii.map(|r| r * top), *half));
            plain(SharedShape::convex_hull(&corners)?)
        }
        ContactForm::Hull(corners) => {
            let corners: Vec<Vector> = corners.iter().map(point).collect();
            plain(SharedShape::convex_hull(&corners)?)
        }
        ContactForm::Surface(mesh) => {
            let corners = mesh.vertices.iter().map(point).collect();
            let flags = TriMeshFlags::FIX_INTERNAL_EDGES;
            plain(SharedShape::trimesh_with_flags(corners, mesh.triangles.clone(), flags).ok()?)
        }
    }
}

/// Does rapier make another shape of it: corners instead of a round surface?
pub(super) fn is_approximate(form: &ContactForm) -> bool {
    match form {
        ContactForm::Capsule { bottom, top, .. } => bottom != top,
        ContactForm::Ellipsoid { .. } | ContactForm::Frustum { .. } => true,
        _ => false,
    }
}

fn rim(radii: [f64; 2], z: f64) -> Vec<Vector> {
    outline::rim(radii, z, AROUND).into_iter().map(vector).collect()
}

fn ellipsoid(radii: [f64; 3], z: f64) -> Vec<Vector> {
    outline::ellipsoid(radii, z, (AROUND, ALONG)).into_iter().map(vector).collect()
}
