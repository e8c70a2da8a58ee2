//! Is a mesh the surface of a solid (B-20)? What can be repaired for certain is repaired, and told.

use super::TriMesh;

/// Why a mesh is not the surface of a solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolidFault {
    /// Edges with a triangle on one side only.
    #[error("not written yet")]
    NotClosed,
}

/// The mesh as a closed surface facing outwards, and what was repaired, one sentence each; empty: nothing.
///
/// # Errors
/// What makes it no solid.
pub fn closed_solid(mesh: TriMesh) -> Result<(TriMesh, Vec<String>), SolidFault> {
    let _ = mesh;
    Err(SolidFault::NotClosed)
}
