//! Triangles that find their shared corners by their coordinates.

use crate::math::Vec3;
use crate::shape::TriMesh;
use std::collections::HashMap;

/// Collects triangles; corners with the same coordinates, to the bit, become one vertex. Triangles with two corners
/// in one place are left out.
#[derive(Default)]
pub(super) struct Patches {
    mesh: TriMesh,
    known: HashMap<[u64; 3], u32>,
}

impl Patches {
    /// The mesh so far.
    pub fn mesh(self) -> TriMesh {
        self.mesh
    }

    /// Anticlockwise seen from outside; `flipped`: clockwise.
    pub fn triangle(&mut self, corners: [Vec3; 3], flipped: bool) {
        let [a, b, c] = corners.map(|p| self.vertex(p));
        if a != b && b != c && c != a {
            self.mesh.triangles.push(if flipped { [a, c, b] } else { [a, b, c] });
        }
    }

    /// A grid of `rows` × `columns` cells over the corners `at(row, column)`; columns × rows is outwards.
    pub fn grid(&mut self, [rows, columns]: [u32; 2], at: impl Fn(u32, u32) -> Vec3, flipped: bool) {
        for i in 0..rows {
            for j in 0..columns {
                let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
                self.triangle([a, b, c], flipped);
                self.triangle([a, c, d], flipped);
            }
        }
    }

    /// A triangular grid with `rows` rows of cells: row r has `rows − r` + 1 corners, `at(r, 0 ..= rows − r)`; columns ×
    /// rows is outwards.
    pub fn triangular_grid(&mut self, rows: u32, at: impl Fn(u32, u32) -> Vec3, flipped: bool) {
        for r in 0..rows {
            for i in 0..rows - r {
                self.triangle([at(r, i), at(r, i + 1), at(r + 1, i)], flipped);
                if i + 1 < rows - r {
                    self.triangle([at(r, i + 1), at(r + 1, i + 1), at(r + 1, i)], flipped);
                }
            }
        }
    }

    fn vertex(&mut self, p: Vec3) -> u32 {
        // Adding 0 makes −0 and 0 the same.
        let key = [p.x + 0.0, p.y + 0.0, p.z + 0.0].map(f64::to_bits);
        let next = self.mesh.vertices.len() as u32;
        let index = *self.known.entry(key).or_insert(next);
        if index == next {
            self.mesh.vertices.push(p);
        }
        index
    }
}
