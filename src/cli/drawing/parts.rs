//! The shapes of all links as meshes in the world.

use super::Drawing;
use crate::description::{Geometry, PlacedShape, Subdivision};
use crate::math::{Pose, Vec3};
use crate::shape::{Bounds, Meshes, Shape, TriMesh, tessellate};

/// Segments of a turn: a chord of a circle of 100 pixels' radius stays within a quarter of a pixel of it.
const SUBDIVISION: Subdivision = Subdivision { around: 48, flat: 1 };

/// Triangles of a file.
const FINE_FILE: usize = 2000;

/// One shape.
pub(super) struct Part {
    /// In the world.
    pub mesh: TriMesh,
    /// Are its edges drawn? Those of a finer mesh would blacken it.
    pub edges: bool,
}

/// All shapes that can be drawn, and why others cannot, one sentence each.
pub(super) fn parts(drawing: &Drawing) -> (Vec<Part>, Vec<String>) {
    let (mut parts, mut missing) = (vec![], vec![]);
    for link in &drawing.links {
        for shape in link.shapes {
            match part(shape, &link.pose, drawing.meshes) {
                Ok(part) => parts.push(part),
                Err(why) => missing.push(format!("{}: {why}", link.name)),
            }
        }
    }
    (parts, missing)
}

fn part(placed: &PlacedShape, x_wl: &Pose, meshes: &Meshes) -> Result<Part, String> {
    let shape = Shape::of(placed).map_err(|fault| fault.to_string())?;
    let polygons = placed.substance.filter(|s| placed.may_be_polygonised(s.dimension)).and_then(|s| s.polygonise);
    // More segments than these, and segments of straight lengths, would not be seen.
    let subdivision =
        polygons.map_or(SUBDIVISION, |s| Subdivision { around: s.around.min(4 * SUBDIVISION.around), flat: 1 });
    let mesh = tessellate(&shape, subdivision, meshes).map_err(|fault| fault.to_string())?;
    let mesh = mesh.placed(&(x_wl * placed.origin.pose()));
    if !mesh.vertices.iter().flatten().all(|x| x.is_finite()) {
        return Err(format!("a corner of its <{}> is at no finite place", shape.geometry.kind()));
    }
    let edges = !matches!(shape.geometry, Geometry::Mesh { .. }) || mesh.triangles.len() <= FINE_FILE;
    Ok(Part { mesh, edges })
}

/// Least box around everything; a small one around the origin if there is nothing.
pub(super) fn extent(parts: &[Part], points: impl Iterator<Item = Vec3>) -> Bounds {
    let vertices = parts.iter().flat_map(|p| p.mesh.vertices.iter().copied()).chain(points);
    let around = vertices.map(|v| Bounds { min: v, max: v }).reduce(|a, b| a.union(&b));
    around.unwrap_or(Bounds { min: Vec3::repeat(-0.1), max: Vec3::repeat(0.1) })
}
