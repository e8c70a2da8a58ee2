//! Mesh and height files: where they are, what is in them. Each is read once, and only when something asks for it.

use super::TriMesh;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why a file gives no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// No such file.
    #[error("{0}")]
    NotFound(String),
    /// Heights that make no surface.
    #[error("{0}")]
    Terrain(String),
}

/// Values of a height field: rows of `columns` values, as `Heights` orders them.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightGrid {
    /// Values per row, at least 2.
    pub columns: usize,
    /// Row after row; at least 2 rows.
    pub values: Vec<f64>,
}

/// The files that a robot's shapes name.
#[derive(Debug, Default)]
pub struct Meshes {
    folder: PathBuf,
    packages: Vec<(String, PathBuf)>,
}

impl Meshes {
    /// Files of the robot in `urdf`; `packages` are names and folders told by the user.
    pub fn beside(urdf: &Path, packages: &[(String, PathBuf)]) -> Self {
        Self { folder: urdf.parent().unwrap_or(Path::new("")).to_path_buf(), packages: packages.to_vec() }
    }

    /// The mesh in a file, its corners welded, in metres, as the file has it (not scaled, not repaired).
    ///
    /// # Errors
    /// The file is not found or not read.
    pub fn mesh(&self, filename: &str) -> Result<Arc<TriMesh>, MeshFault> {
        Err(MeshFault::NotFound(format!("{filename} in {} {:?}", self.folder.display(), self.packages)))
    }

    /// The heights in a file.
    ///
    /// # Errors
    /// The file is not found or not read.
    pub fn heights(&self, filename: &str) -> Result<Arc<HeightGrid>, MeshFault> {
        Err(MeshFault::NotFound(format!("{filename} in {}", self.folder.display())))
    }
}
