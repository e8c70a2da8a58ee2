//! A collider on its body, prepared.

use super::polytope::Polytope;
use super::solid::{Kind, Solid};
use super::surface::Surface;
use super::vector::{Frame, norm};
use crate::dynamics::Kinematics;
use crate::math::{M3, V3};
use crate::model::{Collider, Model, Surface as Friction};
use crate::shape::ContactForm;
use std::sync::Arc;

/// What a collider is to the narrow phase.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    HalfSpace,
    Convex(Solid),
    Surface(Arc<Surface>),
}

/// A collider on its body.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub body: usize,
    pub link: Option<usize>,
    /// In the body's frame.
    pub frame: Frame,
    pub shape: Shape,
    pub margin: f64,
    pub friction: Friction,
    /// Middle and half edges of the box around it, margin and all, in its frame; a half-space has none.
    pub extent: (V3<f64>, V3<f64>),
    /// The middle of the box in the body's frame.
    pub middle: V3<f64>,
    /// Radius of a ball about the middle that holds it, m.
    pub radius: f64,
    /// Least width, m; ∞ where nothing can come out on the other side.
    pub thickness: f64,
}

impl Part {
    pub(super) fn of(m: &Model, c: &Collider) -> Self {
        let (body, pose) = m.seat_of(c);
        let r = M3::from(*pose.rotation.to_rotation_matrix().matrix());
        let frame = Frame { r, p: V3::from(pose.translation.vector) };
        let shape = match (&c.form, Solid::of(&c.form, c.margin)) {
            (_, Some(solid)) => Shape::Convex(solid),
            (ContactForm::Surface(mesh), None) => Shape::Surface(Arc::new(Surface::of(mesh))),
            _ => Shape::HalfSpace,
        };
        let margin = V3::new(c.margin, c.margin, c.margin);
        let (extent, radius, thickness) = match &shape {
            Shape::HalfSpace => ((V3::default(), V3::default()), 0.0, f64::INFINITY),
            Shape::Convex(solid) => {
                let (middle, half) = solid.extent();
                ((middle, half), solid.ball(middle, half), thickness(solid, half))
            }
            Shape::Surface(s) => ((s.middle, s.half + margin), norm(s.half) + c.margin, f64::INFINITY),
        };
        let middle = frame.at(extent.0);
        Self {
            body,
            link: c.link,
            frame,
            shape,
            margin: c.margin,
            friction: c.surface,
            extent,
            middle,
            radius,
            thickness,
        }
    }

    /// Its frame in the world.
    pub(super) fn placed(&self, k: &Kinematics) -> Frame {
        Frame { r: k.r[self.body], p: k.p[self.body] }.after(&self.frame)
    }

    /// The middle of its box in the world.
    pub(super) fn center(&self, k: &Kinematics) -> V3<f64> {
        k.r[self.body].mv(self.middle) + k.p[self.body]
    }

    /// Velocity of the middle in the world, m/s, and how fast it turns, rad/s.
    pub(super) fn speed(&self, k: &Kinematics) -> (V3<f64>, f64) {
        let (w, v) = (k.w[self.body], k.v[self.body]);
        (k.r[self.body].mv(w.cross_add(self.middle, v)), norm(w))
    }
}

/// Least width; of a hull over the directions of its faces, where the least one is found if two faces are parallel.
fn thickness(solid: &Solid, half: V3<f64>) -> f64 {
    let boxed = 2.0 * half.x.min(half.y).min(half.z);
    match &solid.kind {
        Kind::Hull(hull) => {
            let width = |n: &V3<f64>| n.dot(hull.support(*n) - hull.support(-*n)) + 2.0 * solid.round;
            hull.normals.iter().map(width).fold(boxed, f64::min)
        }
        _ => boxed,
    }
}

/// The corners of a convex hull, and whether it could be made.
pub(super) fn hull_corners(points: &[crate::math::Vec3]) -> Option<Vec<crate::math::Vec3>> {
    let list: Vec<V3<f64>> = points.iter().map(|p| V3::from(*p)).collect();
    Polytope::of(&list).map(|hull| hull.points.into_iter().map(crate::math::Vec3::from).collect())
}
