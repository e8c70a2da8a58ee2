//! Shapes as polygon meshes (B-4, B-5, B-19).

use super::{MeshFault, Meshes, Shape, TriMesh};
use crate::description::Subdivision;

/// The surface of a shape as triangles, in its own frame; closed and facing outwards where the shape is.
///
/// # Errors
/// A mesh or height file is not found or not read.
pub fn tessellate(shape: &Shape, subdivision: Subdivision, meshes: &Meshes) -> Result<TriMesh, MeshFault> {
    let _ = (shape, subdivision, meshes);
    Err(MeshFault::NotFound("not written yet".into()))
}
