//! Which shape is computed how (B-11).

use super::{MassProperties, WATER_DENSITY, capsule, cuboid, cylinder, ellipsoid, frustum, moments::Moments};
use crate::description::{Dimension, Geometry, Substance};
use crate::shape::{MeshFault, Meshes, Shape, ShapeFault, SolidFault};

/// Why a shape gives no mass.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Sizes that make no shape.
    #[error(transparent)]
    Shape(#[from] ShapeFault),
    /// A file that gives no mesh.
    #[error(transparent)]
    File(#[from] MeshFault),
    /// A mesh that is not the surface of a solid.
    #[error(transparent)]
    NotSolid(#[from] SolidFault),
    /// A surface without an inside, taken as solid (B-11: forced 2D).
    #[error("this <{0}> is a surface without an inside: only a hollow body (2d) can be made of it")]
    Open(&'static str),
    /// A wall that is none.
    #[error("a hollow body needs a wall thickness above 0; {0} m was given")]
    NoWall(f64),
}

/// How mass properties were found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// A closed formula.
    Formula,
    /// Numerical integration of the exact surface, to rounding.
    Quadrature,
    /// Exact integration over a polygon mesh of so many triangles.
    Polygons(usize),
}

/// What one shape weighs.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeMass {
    /// Of the material, m³: the inside of a solid body, area × thickness of a hollow one.
    pub volume: f64,
    /// In the shape's own frame.
    pub properties: MassProperties,
    /// How they were found.
    pub method: Method,
    /// What had to be repaired in a mesh file, for people; empty: nothing.
    pub repairs: Vec<String>,
}

/// Mass properties of one shape of a substance, in the shape's own frame.
///
/// # Errors
/// Why there are none.
pub fn of_shape(shape: &Shape, substance: &Substance, meshes: &Meshes) -> Result<ShapeMass, Refusal> {
    let _ = meshes;
    let density = substance.specific_gravity * WATER_DENSITY;
    let (volume, properties) = match substance.dimension {
        Dimension::Solid => {
            let m = solid(&shape.geometry)?;
            (m.measure, m.mass_properties(density))
        }
        Dimension::Hollow { thickness } if thickness > 0.0 && thickness.is_finite() => {
            let m = surface(&shape.geometry)?;
            (m.measure * thickness, m.mass_properties(density * thickness))
        }
        Dimension::Hollow { thickness } => return Err(Refusal::NoWall(thickness)),
    };
    Ok(ShapeMass { volume, properties, method: Method::Formula, repairs: vec![] })
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
        _ => return Err(Refusal::Open(geometry.kind())),
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
        _ => return Err(Refusal::Open(geometry.kind())),
    })
}
