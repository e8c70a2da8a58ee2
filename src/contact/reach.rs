//! How far colliders reach, and the faces of hulls: for whoever shows them.

use super::polytope::Polytope;
use super::solid::Solid;
use crate::math::{Pose, V3, Vec3};
use crate::shape::{Bounds, ContactForm, TriMesh};
use std::sync::Arc;

/// A collider prepared for [`Reach::bounds`].
#[derive(Clone, Debug)]
pub struct Reach {
    body: Body,
    /// m; the collision margin and what is round.
    around: f64,
}

#[derive(Clone, Debug)]
enum Body {
    Convex(Solid),
    Surface(Arc<TriMesh>),
}

impl Reach {
    /// `None`: without bounds, a half-space.
    pub fn of(form: &ContactForm, margin: f64) -> Option<Self> {
        match form {
            ContactForm::HalfSpace => None,
            ContactForm::Surface(mesh) => Some(Self { body: Body::Surface(mesh.clone()), around: margin }),
            _ => Solid::of(form, margin).map(|solid| Self { around: solid.round, body: Body::Convex(solid) }),
        }
    }

    /// The least box with the axes of frame A around the shape and its margin; `x_as` is the shape's frame in A.
    pub fn bounds(&self, x_as: &Pose) -> Bounds {
        let reach = |axis: usize, sign: f64| {
            let d = x_as.inverse_transform_vector(&Vec3::ith(axis, sign));
            self.furthest(&d) + self.around + sign * x_as.translation.vector[axis]
        };
        Bounds { min: Vec3::from_fn(|axis, _| -reach(axis, -1.0)), max: Vec3::from_fn(|axis, _| reach(axis, 1.0)) }
    }

    /// The greatest coordinate along a unit vector, in the shape's frame, m.
    fn furthest(&self, d: &Vec3) -> f64 {
        match &self.body {
            Body::Convex(solid) => solid.support(V3::from(*d)).dot(V3::from(*d)),
            Body::Surface(mesh) => mesh.vertices.iter().map(|p| p.dot(d)).fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// The faces of the convex hull of these corners, facing outwards; none where they could not be found.
pub fn hull_mesh(corners: &[Vec3]) -> TriMesh {
    let points: Vec<V3<f64>> = corners.iter().map(|c| V3::from(*c)).collect();
    let Some(hull) = Polytope::of(&points) else { return TriMesh::default() };
    let fan =
        |face: &[u32]| (1..face.len().saturating_sub(1)).map(|i| [face[0], face[i], face[i + 1]]).collect::<Vec<_>>();
    let triangles = (0..hull.normals.len()).flat_map(|i| fan(hull.face(i))).collect();
    TriMesh { vertices: hull.points.into_iter().map(Vec3::from).collect(), triangles }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test may panic
    use super::*;

    #[test]
    fn a_turned_box_and_a_capsule_reach_as_far_as_their_corners() {
        let quarter = std::f64::consts::FRAC_PI_4;
        let x_ws = Pose::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 0.0, quarter));
        let cuboid = Reach::of(&ContactForm::Cuboid { half: [0.1, 0.1, 0.5] }, 0.01).unwrap().bounds(&x_ws);
        let diagonal = 0.1 * 2.0_f64.sqrt() + 0.01;
        assert!((cuboid.max - Vec3::new(1.0 + diagonal, 2.0 + diagonal, 3.51)).norm() < 1e-12, "{cuboid:?}");
        assert!((cuboid.min - Vec3::new(1.0 - diagonal, 2.0 - diagonal, 2.49)).norm() < 1e-12, "{cuboid:?}");
        let lying = Pose::new(Vec3::zeros(), Vec3::new(0.0, 2.0 * quarter, 0.0));
        let capsule = ContactForm::Capsule { bottom: 0.1, top: 0.2, half: 0.3 };
        let capsule = Reach::of(&capsule, 0.0).unwrap().bounds(&lying);
        assert!((capsule.min - Vec3::new(-0.4, -0.2, -0.2)).norm() < 1e-12, "{capsule:?}");
        assert!((capsule.max - Vec3::new(0.5, 0.2, 0.2)).norm() < 1e-12, "{capsule:?}");
        assert!(Reach::of(&ContactForm::HalfSpace, 0.0).is_none());
    }

    #[test]
    fn the_hull_of_a_cube_has_twelve_triangles_that_face_outwards() {
        let corner = |i: u32| Vec3::from_fn(|axis, _| if i >> axis & 1 == 1 { 0.5 } else { -0.5 });
        let mesh = hull_mesh(&(0..8).map(corner).collect::<Vec<_>>());
        assert_eq!(mesh.triangles.len(), 12);
        for t in &mesh.triangles {
            let [a, b, c] = mesh.corners(*t);
            assert!((b - a).cross(&(c - a)).dot(&(a + b + c)) > 0.0);
        }
    }
}
