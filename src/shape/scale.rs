//! Scaling of primitives (S-1 … S-5): the shape deforms, its frame stays.

use crate::description::Geometry;

/// Why a shape cannot take a scale.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScaleError {
    /// S-2: no primitive that scales.
    #[error("a {0} takes no scale; write its size instead")]
    Unscalable(String),
    /// A factor that is no length ratio.
    #[error("scale factor {0} is not a positive number")]
    BadFactor(f64),
    /// The scaled shape is none of ours.
    #[error("a {0} stays a {0} only if its {1} factors are equal; {2} and {3} were given")]
    Unequal(&'static str, &'static str, f64, f64),
}

/// `geometry` stretched by `factors` along its own X, Y, Z: sphere → ellipsoid, cylinder → elliptic cylinder, and so
/// on. `Err` names what does not scale; meshes scale through their own attribute.
pub fn scaled(geometry: &Geometry, factors: [f64; 3]) -> Result<Geometry, ScaleError> {
    if let Some(&bad) = factors.iter().find(|f| !(**f > 0.0 && f.is_finite())) {
        return Err(ScaleError::BadFactor(bad));
    }
    let [x, y, z] = factors;
    Ok(match *geometry {
        Geometry::Box { size: [a, b, c] } => Geometry::Box { size: [a * x, b * y, c * z] },
        Geometry::Sphere { radius } => Geometry::Ellipsoid { radii: [radius * x, radius * y, radius * z] },
        Geometry::Ellipsoid { radii: [a, b, c] } => Geometry::Ellipsoid { radii: [a * x, b * y, c * z] },
        Geometry::Cylinder { radius, length } => {
            Geometry::EllipticCylinder { radius_x: radius * x, radius_y: radius * y, length: length * z }
        }
        Geometry::EllipticCylinder { radius_x, radius_y, length } => {
            Geometry::EllipticCylinder { radius_x: radius_x * x, radius_y: radius_y * y, length: length * z }
        }
        Geometry::Cone { radius_x, radius_y, length } => {
            Geometry::Cone { radius_x: radius_x * x, radius_y: radius_y * y, length: length * z }
        }
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => {
            Geometry::Frustum { radius_x: radius_x * x, radius_y: radius_y * y, top_scale, length: length * z }
        }
        Geometry::Tube { outer_radius, inner_radius, length } => {
            equal("tube", "X and Y", x, y)?;
            Geometry::Tube { outer_radius: outer_radius * x, inner_radius: inner_radius * x, length: length * z }
        }
        Geometry::Capsule { radius_top, radius_bottom, length } => {
            equal("capsule", "X and Y", x, y)?;
            equal("capsule", "X and Z", x, z)?;
            Geometry::Capsule { radius_top: radius_top * x, radius_bottom: radius_bottom * x, length: length * z }
        }
        Geometry::Mesh { .. } => return Err(ScaleError::Unscalable("mesh".into())),
        Geometry::Other { ref kind, .. } => return Err(ScaleError::Unscalable(kind.clone())),
    })
}

fn equal(kind: &'static str, axes: &'static str, one: f64, other: f64) -> Result<(), ScaleError> {
    if one == other { Ok(()) } else { Err(ScaleError::Unequal(kind, axes, one, other)) }
}
