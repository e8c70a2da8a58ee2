//! Axis-aligned bounds of a shape.

use super::{MeshFault, Meshes, Shape, Support};
use crate::math::{Pose, Vec3};

/// Least box around a shape, along the axes of one frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least coordinates.
    pub min: Vec3,
    /// Greatest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The least box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }
}

/// Exact bounds, along the axes of frame A, of a shape placed by `x_as` (shape frame → A): see [`Support`].
///
/// # Errors
/// A mesh or height file is not found or not read.
pub fn bounds(shape: &Shape, x_as: &Pose, meshes: &Meshes) -> Result<Bounds, MeshFault> {
    let support = Support::of(shape, meshes)?;
    let reach = |axis: usize, sign: f64| {
        let point = support.point(&x_as.inverse_transform_vector(&Vec3::ith(axis, sign)));
        (x_as * nalgebra::Point3::from(point))[axis]
    };
    Ok(Bounds { min: Vec3::from_fn(|axis, _| reach(axis, -1.0)), max: Vec3::from_fn(|axis, _| reach(axis, 1.0)) })
}
