//! The shapes of all links as meshes in the world.

use super::Drawing;
use crate::description::{Geometry, PlacedShape, Subdivision};
use crate::math::{Pose, Vec3};
use crate::shape::{Bounds, Meshes, Shape, TriMesh, tessellate};

/// Segments of a turn: a chord of a circle of 100 pixels stays within half a pixel of it.
const SUBDIVISION: Subdivision = Subdivision { around: 48, flat: 1 };

/// One shape.
pub(super) struct Part {
    /// In the world.
    pub mesh: TriMesh,
    /// From a file: too fine for its edges to be drawn.
    pub file: bool,
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
    let mesh = tessellate(&shape, SUBDIVISION, meshes).map_err(|fault| fault.to_string())?;
    let file = matches!(shape.geometry, Geometry::Mesh { .. });
    Ok(Part { mesh: mesh.placed(&(x_wl * placed.origin.pose())), file })
}

/// Least box around everything; a small one around the origin if there is nothing.
pub(super) fn extent(parts: &[Part], points: impl Iterator<Item = Vec3>) -> Bounds {
    let vertices = parts.iter().flat_map(|p| p.mesh.vertices.iter().copied()).chain(points);
    let finite = vertices.filter(|v| v.iter().all(|x| x.is_finite()));
    let around = finite.map(|v| Bounds { min: v, max: v }).reduce(|a, b| a.union(&b));
    around.unwrap_or(Bounds { min: Vec3::repeat(-0.1), max: Vec3::repeat(0.1) })
}
