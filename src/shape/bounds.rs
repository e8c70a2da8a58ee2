//! Axis-aligned bounds of a shape.

use crate::description::Geometry;
use crate::math::{Mat3, Pose, Vec3};

/// Least box around a shape, along the axes of one frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least coordinates.
    pub min: Vec3,
    /// Greatest coordinates.
    pub max: Vec3,
}

impl Bounds {
    fn around(center: Vec3, half: Vec3) -> Self {
        Self { min: center - half, max: center + half }
    }
    /// The least box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }
}

/// Exact bounds, along the axes of frame A, of a shape placed by `x_as` (shape frame → A). `None` for shapes whose
/// extent is not known here (meshes, `Geometry::Other`).
pub fn bounds(geometry: &Geometry, x_as: &Pose) -> Option<Bounds> {
    let r = x_as.rotation.to_rotation_matrix().into_inner();
    let at = |z: f64| x_as * nalgebra::Point3::new(0.0, 0.0, z);
    let section = |z: f64, a: f64, b: f64| Bounds::around(at(z).coords, ellipsoid_half(&r, [a, b, 0.0]));
    let half_ball = |z: f64, radius: f64, up: f64| {
        let axis: Vec3 = r.column(2) * up;
        let reach = |toward: f64| if toward >= 0.0 { radius } else { radius * (1.0 - toward * toward).max(0.0).sqrt() };
        Bounds { min: at(z).coords - (-axis).map(reach), max: at(z).coords + axis.map(reach) }
    };
    let prism = |a: f64, b: f64, top_scale: f64, length: f64| {
        section(-length / 2.0, a, b).union(&section(length / 2.0, a * top_scale, b * top_scale))
    };
    Some(match *geometry {
        Geometry::Box { size } => Bounds::around(at(0.0).coords, r.abs() * Vec3::from(size) / 2.0),
        Geometry::Sphere { radius } => Bounds::around(at(0.0).coords, Vec3::repeat(radius)),
        Geometry::Ellipsoid { radii } => Bounds::around(at(0.0).coords, ellipsoid_half(&r, radii)),
        Geometry::Cylinder { radius, length } => prism(radius, radius, 1.0, length),
        Geometry::EllipticCylinder { radius_x, radius_y, length } => prism(radius_x, radius_y, 1.0, length),
        Geometry::Tube { outer_radius, length, .. } => prism(outer_radius, outer_radius, 1.0, length),
        Geometry::Cone { radius_x, radius_y, length } => prism(radius_x, radius_y, 0.0, length),
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => prism(radius_x, radius_y, top_scale, length),
        Geometry::Capsule { radius_top, radius_bottom, length } => {
            half_ball(length / 2.0, radius_top, 1.0).union(&half_ball(-length / 2.0, radius_bottom, -1.0))
        }
        _ => return None,
    })
}

/// Half extents along A's axes of an ellipsoid (or, with one semi-axis 0, an ellipse) turned by `r`: the support
/// function of an ellipsoid in direction d is |D Rᵀ d|.
fn ellipsoid_half(r: &Mat3, radii: [f64; 3]) -> Vec3 {
    let scaled = r * Mat3::from_diagonal(&radii.into());
    Vec3::from_fn(|i, _| scaled.row(i).norm())
}
