//! Cracks: borders that lie so close to each other that the same border is meant.

use super::{Edges, count, diagonal};
use crate::math::Vec3;
use crate::shape::TriMesh;
use std::collections::HashMap;

/// Vertices on a border nearer than this part of the diagonal become one: the seventh digit, in which files with f32
/// coordinates round.
const CRACK: f64 = 1e-6;

/// Welds vertices at odd edges to each other; the sentence that tells it, or None if there is nothing to weld.
pub(super) fn weld(mesh: &mut TriMesh, edges: &Edges) -> Option<String> {
    let width = CRACK * diagonal(mesh);
    let mut border: Vec<u32> = edges.all_odd().flat_map(|side| side.ends()).collect();
    border.sort_unstable();
    border.dedup();
    let least = border.iter().fold(Vec3::repeat(f64::INFINITY), |least, v| least.inf(&mesh.vertices[*v as usize]));
    let mut kept = Grid { least, width, cells: HashMap::new() };
    let mut moved = HashMap::new();
    let mut widest = 0.0_f64;
    for vertex in border {
        let place = mesh.vertices[vertex as usize];
        match kept.nearest(mesh, place) {
            Some((other, distance)) => {
                moved.insert(vertex, other);
                widest = widest.max(distance);
            }
            None => kept.cells.entry(kept.cell(place)).or_default().push(vertex),
        }
    }
    if moved.is_empty() {
        return None;
    }
    for corner in mesh.triangles.iter_mut().flatten() {
        *corner = moved.get(corner).copied().unwrap_or(*corner);
    }
    let n = count(moved.len(), "vertex", "vertices");
    Some(format!("cracks in the mesh at most {widest:.1e} m wide were closed: {n} welded to a neighbour"))
}

/// Vertices by cubes four cracks wide; no two vertices in it are nearer than a crack, so a cube holds a bounded number.
struct Grid {
    least: Vec3,
    width: f64,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl Grid {
    fn cell(&self, place: Vec3) -> [i64; 3] {
        [0, 1, 2].map(|i| ((place[i] - self.least[i]) / (4.0 * self.width)).floor() as i64)
    }

    /// The vertex that is nearest, if it is within a crack's width; and how far away it is, m.
    fn nearest(&self, mesh: &TriMesh, place: Vec3) -> Option<(u32, f64)> {
        let reach = Vec3::repeat(self.width);
        let (low, high) = (self.cell(place - reach), self.cell(place + reach));
        let cells = (low[0]..=high[0])
            .flat_map(|x| (low[1]..=high[1]).flat_map(move |y| (low[2]..=high[2]).map(move |z| [x, y, z])));
        cells
            .filter_map(|cell| self.cells.get(&cell))
            .flatten()
            .map(|v| (*v, (mesh.vertices[*v as usize] - place).norm()))
            .filter(|(_, distance)| *distance <= self.width)
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }
}
