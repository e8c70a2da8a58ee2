//! Shapes: how they scale, where they reach, what their surface is; mesh files.

mod bounds;
mod check;
mod collision;
mod contact_form;
mod form;
mod meshes;
mod outline;
mod solid;
mod support;
mod tessellate;
mod trimesh;

pub use bounds::{Bounds, bounds};
pub use check::ShapeFault;
pub use collision::{CollisionSource, collision_shapes};
pub use contact_form::ContactForm;
pub use form::Shape;
pub use meshes::{HeightGrid, LONGEST_FILE, MeshFault, Meshes, SearchPaths};
pub use outline::{Lathe, Piece, lathe};
pub use solid::{COUNTS_TWICE, SolidFault, closed_solid};
pub use support::Support;
pub use tessellate::tessellate;
pub use trimesh::TriMesh;
