//! Mass properties of one shape: which is computed how (B-11).

use super::formulas;
use super::moments::Moments;
use super::polygons;
use super::{MassProperties, WATER_DENSITY};
use crate::description::{Dimension, Geometry, Subdivision, Substance};
use crate::shape::{MeshFault, Meshes, Shape, ShapeFault, SolidFault, closed_solid, tessellate};

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
    /// Triangles whose corners lie on one line, all of them.
    #[error("this <{0}> has no area: the corners of each of its triangles lie on one line")]
    NoArea(&'static str),
    /// A closed mesh that encloses nothing.
    #[error("this <{0}> is closed but encloses no volume: what its triangles enclose cancels out")]
    NoVolume(&'static str),
    /// Numbers too large or too small for arithmetic.
    #[error("the mass of this <{kind}> is no number to calculate with: volume {volume:e} m³, mass {mass:e} kg")]
    OutOfRange {
        /// Element name.
        kind: &'static str,
        /// m³.
        volume: f64,
        /// kg.
        mass: f64,
    },
}

/// How mass properties were found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// A closed formula.
    Formula,
    /// Numerical integration over the exact shape, to rounding.
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
    let kind = shape.geometry.kind();
    let wall = match substance.dimension {
        Dimension::Solid if shape.is_open() => return Err(Refusal::Open(kind)),
        Dimension::Solid => None,
        Dimension::Hollow { thickness } if thickness > 0.0 && thickness.is_finite() => Some(thickness),
        Dimension::Hollow { thickness } => return Err(Refusal::NoWall(thickness)),
    };
    let exact = match (substance.polygonise, wall) {
        (Some(_), _) => None,
        (None, None) => formulas::solid(shape),
        (None, Some(_)) => formulas::surface(shape),
    };
    let found = match exact {
        Some((moments, method)) => Found { moments, method, repairs: vec![] },
        None => by_polygons(shape, substance.polygonise, wall.is_none(), meshes)?,
    };
    let thickness = wall.unwrap_or(1.0);
    let volume = found.moments.measure * thickness;
    let properties = found.moments.mass_properties(substance.specific_gravity * WATER_DENSITY * thickness);
    if found.moments.measure <= 1e-13 * found.moments.covariance.trace()
        && matches!(shape.geometry, Geometry::Triangle { .. } | Geometry::Quad { .. })
    {
        return Err(Refusal::NoArea(kind));
    }
    if !(volume > 0.0 && volume.is_finite() && properties.is_finite()) {
        return Err(Refusal::OutOfRange { kind, volume, mass: properties.mass });
    }
    Ok(ShapeMass { volume, properties, method: found.method, repairs: found.repairs })
}

struct Found {
    moments: Moments,
    method: Method,
    repairs: Vec<String>,
}

fn by_polygons(
    shape: &Shape,
    subdivision: Option<Subdivision>,
    solid: bool,
    meshes: &Meshes,
) -> Result<Found, Refusal> {
    let kind = shape.geometry.kind();
    // Shapes that are polygons anyway do not look at the subdivision; all but meshes from files are closed as made.
    let mesh = tessellate(shape, subdivision.unwrap_or(Subdivision { around: 3, flat: 1 }), meshes)?;
    let (mesh, repairs) = match shape.geometry {
        Geometry::Mesh { .. } if solid => closed_solid(mesh)?,
        _ => (mesh, vec![]),
    };
    let method = Method::Polygons(mesh.triangles.len());
    let moments = match solid {
        true => polygons::solid(&mesh).ok_or(Refusal::NoVolume(kind))?,
        false => polygons::surface(&mesh).ok_or(Refusal::NoArea(kind))?,
    };
    Ok(Found { moments, method, repairs })
}
