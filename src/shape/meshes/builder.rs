//! Triangles over welded corners, as a file is read.

use super::fault::{FARTHEST, Inside};
use crate::math::Vec3;
use crate::shape::TriMesh;
use std::collections::HashMap;

/// More triangles, or vertices, are not read: a file may be small and still unfold into any number of them.
pub(super) const MOST_TRIANGLES: usize = 1 << 24;

/// Takes corners and triangles; corners at the very same place become one.
#[derive(Default)]
pub(super) struct Builder {
    mesh: TriMesh,
    known: HashMap<[u64; 3], u32>,
    seen: usize,
}

impl Builder {
    /// The index of a corner at `place`, m.
    pub(super) fn corner(&mut self, place: [f64; 3]) -> Result<u32, Inside> {
        self.seen += 1;
        if !place.iter().all(|x| x.abs() <= FARTHEST) {
            return Err(Inside::NoPlace(self.seen, place));
        }
        // −0 and 0 are one place.
        let key = place.map(|x| (x + 0.0).to_bits());
        let next = self.mesh.vertices.len() as u32;
        let index = *self.known.entry(key).or_insert(next);
        if index == next {
            if self.mesh.vertices.len() >= MOST_TRIANGLES {
                return Err(Inside::TooLarge(format!("more than {MOST_TRIANGLES} vertices")));
            }
            self.mesh.vertices.push(Vec3::from(place));
        }
        Ok(index)
    }

    /// Where a corner is.
    pub(super) fn place(&self, corner: u32) -> Vec3 {
        self.mesh.vertices[corner as usize]
    }

    pub(super) fn triangle(&mut self, corners: [u32; 3]) -> Result<(), Inside> {
        if self.mesh.triangles.len() >= MOST_TRIANGLES {
            return Err(Inside::TooLarge(format!("more than {MOST_TRIANGLES} triangles")));
        }
        self.mesh.triangles.push(corners);
        Ok(())
    }

    pub(super) fn finish(self) -> Result<TriMesh, Inside> {
        if self.mesh.triangles.is_empty() { Err(Inside::Empty) } else { Ok(self.mesh.without_strays()) }
    }
}
