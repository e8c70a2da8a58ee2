//! Triangle meshes.

use crate::math::{Pose, Vec3};

/// Triangles over shared corners; a triangle is anticlockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Corners, m.
    pub vertices: Vec<Vec3>,
    /// Indices of three corners each.
    pub triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// The corners of one triangle.
    pub fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|i| self.vertices[i as usize])
    }

    /// Stretched along the axes; triangles keep facing outwards where the factors mirror.
    pub fn stretched(mut self, factors: [f64; 3]) -> Self {
        if factors != [1.0; 3] {
            self.vertices.iter_mut().for_each(|v| v.component_mul_assign(&Vec3::from(factors)));
        }
        if factors.iter().product::<f64>() < 0.0 {
            self.flip();
        }
        self
    }

    /// Without the vertices that no triangle uses: a stray one would move the middle and the bounds of the mesh.
    pub fn without_strays(mut self) -> Self {
        let mut used = vec![false; self.vertices.len()];
        self.triangles.iter().flatten().for_each(|i| used[*i as usize] = true);
        if used.iter().all(|u| *u) {
            return self;
        }
        let mut kept = 0;
        let index: Vec<u32> = used.iter().map(|u| (kept, kept += u32::from(*u)).0).collect();
        self.triangles.iter_mut().flatten().for_each(|i| *i = index[*i as usize]);
        let mut used = used.into_iter();
        self.vertices.retain(|_| used.next() == Some(true));
        self
    }

    /// Turns every triangle inside out.
    pub fn flip(&mut self) {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }

    /// Seen from frame A; `x_ab` takes coordinates in the present frame B to A.
    pub fn placed(mut self, x_ab: &Pose) -> Self {
        self.vertices.iter_mut().for_each(|v| *v = (x_ab * nalgebra::Point3::from(*v)).coords);
        self
    }
}
