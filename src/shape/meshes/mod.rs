//! Mesh and height files: where they are, what is in them. Each is read once, and only when something asks for it.

mod builder;
mod dae;
mod fault;
mod heights;
mod obj;
mod places;
mod polygon;
mod stl;
mod text;

pub use fault::MeshFault;
pub use heights::HeightGrid;
pub use places::SearchPaths;

use super::TriMesh;
use fault::Inside;
use places::Places;
use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Longer files are not read, bytes.
pub const LONGEST_FILE: u64 = 512 << 20;

type Slot<T> = Arc<OnceLock<Result<Arc<T>, MeshFault>>>;
type Cache<T> = Mutex<HashMap<PathBuf, Slot<T>>>;

/// The files that a robot's shapes name.
#[derive(Debug, Default)]
pub struct Meshes {
    places: Places,
    meshes: Cache<TriMesh>,
    heights: Cache<HeightGrid>,
}

impl Meshes {
    /// Files of the robot in `urdf`; `packages` are names and folders told by the user. Other packages are looked for
    /// by the environment of this process.
    pub fn beside(urdf: &Path, packages: &[(String, PathBuf)]) -> Self {
        Self::with_paths(urdf, packages, SearchPaths::of_environment())
    }

    /// Files of the robot in `urdf`; `packages` are names and folders told by the user, `paths` say where others are.
    pub fn with_paths(urdf: &Path, packages: &[(String, PathBuf)], paths: SearchPaths) -> Self {
        let folder = urdf.parent().unwrap_or(Path::new("")).to_path_buf();
        Self { places: Places { folder, packages: packages.to_vec(), paths }, ..Self::default() }
    }

    /// The files that have been read, or looked for in vain.
    pub fn files(&self) -> Vec<PathBuf> {
        fn names<T>(cache: &Cache<T>) -> Vec<PathBuf> {
            cache.lock().unwrap_or_else(PoisonError::into_inner).keys().cloned().collect()
        }
        [names(&self.meshes), names(&self.heights)].concat()
    }

    /// The mesh in a file (STL, OBJ or DAE), its corners welded where they are at the very same place, in metres, as the
    /// file has it (not scaled, not repaired). `filename` is a path relative to the URDF or absolute, or `file:///…`, or
    /// `package://NAME/…`.
    ///
    /// # Errors
    /// The file is not found or not read.
    pub fn mesh(&self, filename: &str) -> Result<Arc<TriMesh>, MeshFault> {
        once(&self.meshes, self.places.find(filename)?, read_mesh)
    }

    /// The heights in a file: a PNG picture, or a text of numbers.
    ///
    /// # Errors
    /// The file is not found or not read.
    pub fn heights(&self, filename: &str) -> Result<Arc<HeightGrid>, MeshFault> {
        once(&self.heights, self.places.find(filename)?, read_heights)
    }
}

/// What `read` makes of a file; others that ask for the same file meanwhile wait, for other files they do not.
fn once<T>(cache: &Cache<T>, path: PathBuf, read: fn(&Path) -> Result<T, MeshFault>) -> Result<Arc<T>, MeshFault> {
    let slot = cache.lock().unwrap_or_else(PoisonError::into_inner).entry(path.clone()).or_default().clone();
    slot.get_or_init(|| read(&path).map(Arc::new)).clone()
}

fn read_mesh(path: &Path) -> Result<TriMesh, MeshFault> {
    let bytes = bytes_of(path)?;
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let shown = path.display().to_string();
    // What a file is called may be wrong, its bytes are not; where they do not tell, the name does.
    let read = match extension.as_str() {
        _ if dae::looks_like(&bytes) => dae::read,
        _ if stl::looks_like(&bytes) => stl::read,
        "stl" | "stlb" => stl::read,
        "obj" => obj::read,
        "dae" => dae::read,
        "" if obj::looks_like(&bytes) => obj::read,
        "" => return Err(MeshFault::UnknownFormat { path: shown, extension: "its name has no extension".into() }),
        other => return Err(MeshFault::UnknownFormat { path: shown, extension: format!("its name ends in .{other}") }),
    };
    read(&bytes).map_err(|fault| fault.of(shown))
}

fn read_heights(path: &Path) -> Result<HeightGrid, MeshFault> {
    let bytes = bytes_of(path)?;
    let heights = if heights::is_picture(&bytes) { heights::picture(&bytes) } else { heights::table(&bytes) };
    heights.map_err(|fault| fault.of(path.display().to_string()))
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, MeshFault> {
    let shown = || path.display().to_string();
    let failed = |e: std::io::Error| Inside::At("opening it".into(), e.to_string()).of(shown());
    let file = std::fs::File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    let too_large = |n: u64| Inside::TooLarge(format!("{n} bytes; {LONGEST_FILE} (512 MiB) are read")).of(shown());
    if length > LONGEST_FILE {
        return Err(too_large(length));
    }
    let mut bytes = Vec::with_capacity(length as usize);
    file.take(LONGEST_FILE + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LONGEST_FILE { Err(too_large(bytes.len() as u64)) } else { Ok(bytes) }
}
