//! Which shape is computed how (B-11).

use super::{MassProperties, capsule, cuboid, cylinder, ellipsoid, frustum, moments::Moments};
use crate::description::{Dimension, Geometry};

/// Why a shape gives no mass.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Read, but not computed yet.
    #[error("mass from this shape ({0}) comes with a later issue")]
    Later(String),
    /// A size that encloses nothing.
    #[error("{0} encloses no volume: {1}")]
    NoVolume(&'static str, String),
    /// A wall that is none.
    #[error("a hollow body needs a wall thickness above 0; {0} m was given")]
    NoWall(f64),
}

/// Mass properties in the shape's own frame of one shape of `density` in kg/m³. `Err` says why there are none.
pub fn of_shape(geometry: &Geometry, dimension: Dimension, density: f64) -> Result<MassProperties, Refusal> {
    check_sizes(geometry)?;
    match dimension {
        Dimension::Solid => Ok(solid(geometry)?.mass_properties(density)),
        Dimension::Hollow { thickness } if thickness > 0.0 && thickness.is_finite() => {
            Ok(surface(geometry)?.mass_properties(density * thickness))
        }
        Dimension::Hollow { thickness } => Err(Refusal::NoWall(thickness)),
    }
}

fn solid(geometry: &Geometry) -> Result<Moments, Refusal> {
    Ok(match *geometry {
        Geometry::Box { size } => cuboid::solid(size),
        Geometry::Sphere { radius } => ellipsoid::solid([radius; 3]),
        Geometry::Ellipsoid { radii } => ellipsoid::solid(radii),
        Geometry::Cylinder { radius, length } => cylinder::solid(radius, radius, length),
        Geometry::EllipticCylinder { radius_x, radius_y, length } => cylinder::solid(radius_x, radius_y, length),
        Geometry::Capsule { radius_top, radius_bottom, length } => capsule::solid(radius_top, radius_bottom, length),
        Geometry::Tube { outer_radius, inner_radius, length } => {
            cylinder::solid_tube(outer_radius, inner_radius, length)
        }
        Geometry::Cone { radius_x, radius_y, length } => frustum::solid(radius_x, radius_y, 0.0, length),
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => {
            frustum::solid(radius_x, radius_y, top_scale, length)
        }
        Geometry::Mesh { .. } | Geometry::Other { .. } => return Err(later(geometry)),
    })
}

fn surface(geometry: &Geometry) -> Result<Moments, Refusal> {
    Ok(match *geometry {
        Geometry::Box { size } => cuboid::surface(size),
        Geometry::Sphere { radius } => ellipsoid::sphere_surface(radius),
        Geometry::Ellipsoid { radii } => ellipsoid::surface(radii),
        Geometry::Cylinder { radius, length } => cylinder::surface(radius, radius, length),
        Geometry::EllipticCylinder { radius_x, radius_y, length } => cylinder::surface(radius_x, radius_y, length),
        Geometry::Capsule { radius_top, radius_bottom, length } => capsule::surface(radius_top, radius_bottom, length),
        Geometry::Tube { outer_radius, inner_radius, length } => {
            cylinder::tube_surface(outer_radius, inner_radius, length)
        }
        Geometry::Cone { radius_x, radius_y, length } => frustum::surface(radius_x, radius_y, 0.0, length),
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => {
            frustum::surface(radius_x, radius_y, top_scale, length)
        }
        Geometry::Mesh { .. } | Geometry::Other { .. } => return Err(later(geometry)),
    })
}

fn later(geometry: &Geometry) -> Refusal {
    Refusal::Later(kind(geometry).to_owned())
}

/// The element name of a shape.
pub(super) fn kind(geometry: &Geometry) -> &str {
    match geometry {
        Geometry::Box { .. } => "box",
        Geometry::Sphere { .. } => "sphere",
        Geometry::Ellipsoid { .. } => "ellipsoid",
        Geometry::Cylinder { .. } => "cylinder",
        Geometry::EllipticCylinder { .. } => "elliptic_cylinder",
        Geometry::Capsule { .. } => "capsule",
        Geometry::Tube { .. } => "tube",
        Geometry::Cone { .. } => "cone",
        Geometry::Frustum { .. } => "frustum",
        Geometry::Mesh { .. } => "mesh",
        Geometry::Other { kind, .. } => kind,
    }
}

/// Every length must be a positive number; the ends of a capsule or frustum may shrink to a point.
fn check_sizes(geometry: &Geometry) -> Result<(), Refusal> {
    match *geometry {
        Geometry::Box { size: [x, y, z] } => positive("a box", &[("x", x), ("y", y), ("z", z)]),
        Geometry::Sphere { radius } => positive("a sphere", &[("radius", radius)]),
        Geometry::Ellipsoid { radii: [x, y, z] } => {
            positive("an ellipsoid", &[("x radius", x), ("y radius", y), ("z radius", z)])
        }
        Geometry::Cylinder { radius, length } => positive("a cylinder", &[("radius", radius), ("length", length)]),
        Geometry::EllipticCylinder { radius_x, radius_y, length } => {
            positive("an elliptic cylinder", &[("radius_x", radius_x), ("radius_y", radius_y), ("length", length)])
        }
        Geometry::Capsule { radius_top, radius_bottom, length } => {
            not_negative("a capsule", &[("radius_top", radius_top), ("radius_bottom", radius_bottom)])?;
            not_negative("a capsule", &[("length", length)])?;
            positive("a capsule", &[("larger radius", radius_top.max(radius_bottom))])
        }
        Geometry::Tube { outer_radius, inner_radius, length } => {
            positive("a tube", &[("inner_radius", inner_radius), ("length", length)])?;
            positive("a tube", &[("wall, outer_radius − inner_radius,", outer_radius - inner_radius)])
        }
        Geometry::Cone { radius_x, radius_y, length } => {
            positive("a cone", &[("radius_x", radius_x), ("radius_y", radius_y), ("length", length)])
        }
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => {
            positive("a frustum", &[("radius_x", radius_x), ("radius_y", radius_y), ("length", length)])?;
            not_negative("a frustum", &[("top_scale", top_scale)])
        }
        Geometry::Mesh { .. } | Geometry::Other { .. } => Ok(()),
    }
}

fn positive(what: &'static str, sizes: &[(&str, f64)]) -> Result<(), Refusal> {
    refuse_unless(what, sizes, |v| v > 0.0 && v.is_finite())
}

fn not_negative(what: &'static str, sizes: &[(&str, f64)]) -> Result<(), Refusal> {
    refuse_unless(what, sizes, |v| v >= 0.0 && v.is_finite())
}

fn refuse_unless(what: &'static str, sizes: &[(&str, f64)], fits: fn(f64) -> bool) -> Result<(), Refusal> {
    match sizes.iter().find(|(_, value)| !fits(*value)) {
        Some((name, value)) => Err(Refusal::NoVolume(what, format!("its {name} is {value}"))),
        None => Ok(()),
    }
}
