//! Shape + specific gravity, or `<inertial>` → mass properties (B-2, B-3, B-10 … B-12, B-18).
//!
//! One file per family of shapes; `section`, `lathe_solid` and `lathe_surface` take every other round shape by its outline,
//! `polygons` takes meshes. A solid body is filled; a hollow one (2D dimension) is a wall of the given thickness
//! on the shape's surface, thin against the shape: mass = density × area × thickness, as the source defines it.

mod capsule;
mod cuboid;
mod cylinder;
mod ellipsoid;
mod finding;
mod flat;
mod formulas;
mod frustum;
mod inertials;
mod jacobi;
mod l_scale;
mod lathe_solid;
mod lathe_surface;
mod links;
mod moments;
mod of_shape;
mod oil_tank;
mod polygons;
mod properties;
mod pyramid;
mod rules;
mod section;
mod torus;

pub use inertials::with_inertials;
pub use links::{LinkBody, link_bodies, link_masses};
pub use of_shape::{Method, Refusal, ShapeMass, of_shape};
pub use properties::{MassProperties, Principal};

/// Density of a body of specific gravity 1, kg/m³.
pub const WATER_DENSITY: f64 = 1000.0;
