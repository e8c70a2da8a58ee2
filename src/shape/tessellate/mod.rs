//! Shapes as polygon meshes (B-4, B-5, B-19): inscribed, so every vertex lies on the true surface.

mod cuboid;
mod flat;
mod patch;
mod platonic;
mod terrain;
mod turned;

use super::{MeshFault, Meshes, Shape, TriMesh, lathe};
use crate::description::{Geometry, MOST_FLAT_SEGMENTS, MOST_SEGMENTS, Subdivision};

/// The surface of a shape as triangles, in its own frame, facing outwards; metres. Where the shape has an inside
/// ([`Shape::is_open`] says no), each directed edge has its one opposite: the mesh is closed by index. A mesh file is
/// as it was written, scaled.
///
/// The five regular polyhedra stand like this, with their corners on the sphere of their radius:
/// 4 faces: in four corners of a cube along the axes, (1, 1, 1) one of them; 6: the cube along the axes;
/// 8: corners on the axes; 12: (±1, ±1, ±1), (0, ±φ, ±1/φ) and the latter's cyclic permutations;
/// 20: (0, ±1, ±φ) and its cyclic permutations, φ being the golden ratio.
///
/// A subdivision out of its range is taken as the next one in it; the reader of the text refuses such a one.
///
/// # Errors
/// A mesh or height file is not found or not read, or heights make no surface.
pub fn tessellate(shape: &Shape, subdivision: Subdivision, meshes: &Meshes) -> Result<TriMesh, MeshFault> {
    let around = subdivision.around.clamp(3, MOST_SEGMENTS);
    let flat = subdivision.flat.clamp(1, MOST_FLAT_SEGMENTS);
    let plain = match &shape.geometry {
        Geometry::Box { size } => cuboid::cuboid(*size, shape.finish.fillet, segments_of_arc(around, 0.25), flat),
        Geometry::Pyramid { size } => platonic::pyramid(*size),
        Geometry::Polyhedron { faces, radius } => platonic::polyhedron(*faces, *radius),
        Geometry::Plane { size } => flat::plane(*size, flat),
        Geometry::Triangle { corners } => flat::triangle(corners, flat),
        Geometry::Quad { corners } => flat::quad(corners, flat),
        Geometry::Terrain { size, heights } => terrain::field(*size, heights, meshes)?,
        Geometry::SphericalTerrain { radius, height, heights } => terrain::globe(*radius, *height, heights, meshes)?,
        Geometry::Mesh { filename, scale } => (*meshes.mesh(filename)?).clone().stretched(*scale),
        _ => {
            // Every other shape is round; its outline carries the stretch.
            return Ok(lathe(shape).map_or_else(TriMesh::default, |lathe| turned::turned(&lathe, around, flat)));
        }
    };
    Ok(plain.stretched(shape.stretch))
}

/// So many that none turns further than a full turn's segments do; at least 1.
fn segments_of_arc(around: u32, part_of_turn: f64) -> u32 {
    let exact = f64::from(around) * part_of_turn;
    // A sweep that came from an angle may be above the whole number by a rounding.
    ((exact - 1e-9).ceil() as u32).max(1)
}
