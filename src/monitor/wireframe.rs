//! Colliders as lines (W-14). Round shapes are shown as polygons that touch them from inside.

use crate::contact::hull_mesh;
use crate::description::{Finish, Geometry, Scaling, Subdivision};
use crate::math::Vec3;
use crate::shape::{ContactForm, Meshes, Shape, TriMesh, tessellate};
use std::collections::BTreeMap;

/// Segments of a full turn.
const AROUND: u32 = 16;
/// Triangles whose normals differ by less are one face, cosine of 0.5°.
const FLAT: f64 = 0.999_962;
/// Half of the square that stands for a half-space, and its mesh, m.
const GROUND: (f64, i32) = (1.0, 5);

/// The edges of a collider's shape in its own frame, two points for each, m. A half-space is a grid of 10 m × 10 m.
pub fn wireframe(form: &ContactForm) -> Vec<Vec3> {
    if let ContactForm::HalfSpace = form {
        return grid();
    }
    let mesh = mesh(form);
    let normals: Vec<Vec3> = mesh.triangles.iter().map(|t| normal(&mesh, *t)).collect();
    let mut sides: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        for (p, q) in [(*a, *b), (*b, *c), (*c, *a)] {
            sides.entry((p.min(q), p.max(q))).or_default().push(i);
        }
    }
    let flat = |faces: &[usize]| faces.len() == 2 && normals[faces[0]].dot(&normals[faces[1]]) > FLAT;
    let edges = sides.iter().filter(|(_, faces)| !flat(faces));
    edges.flat_map(|((a, b), _)| [*a, *b].map(|i| mesh.vertices[i as usize])).collect()
}

/// A line of `length` metres outwards from the middle of each triangle of a collider's shape, in its own frame.
pub fn normals(form: &ContactForm, length: f64) -> Vec<Vec3> {
    if let ContactForm::HalfSpace = form {
        return vec![Vec3::zeros(), Vec3::z() * length];
    }
    let mesh = mesh(form);
    let line = |t: &[u32; 3]| {
        let middle = mesh.corners(*t).iter().sum::<Vec3>() / 3.0;
        [middle, middle + normal(&mesh, *t) * length]
    };
    mesh.triangles.iter().flat_map(line).collect()
}

/// The polygon mesh of a collider's shape.
fn mesh(form: &ContactForm) -> TriMesh {
    let (geometry, fillet) = match form {
        ContactForm::HalfSpace => return TriMesh::default(),
        ContactForm::Hull(corners) => return hull_mesh(corners),
        ContactForm::Surface(mesh) => return TriMesh::clone(mesh),
        ContactForm::Ball { radius } => (Geometry::Sphere { radius: *radius }, 0.0),
        ContactForm::Cuboid { half } => (Geometry::Box { size: half.map(|h| 2.0 * h) }, 0.0),
        ContactForm::RoundCuboid { half, radius } => {
            (Geometry::Box { size: half.map(|h| 2.0 * (h + radius)) }, *radius)
        }
        ContactForm::Capsule { bottom, top, half } => {
            (Geometry::Capsule { radius_top: *top, radius_bottom: *bottom, length: 2.0 * half }, 0.0)
        }
        ContactForm::Ellipsoid { radii } => (Geometry::Ellipsoid { radii: *radii }, 0.0),
        ContactForm::Cylinder { radius, half } => (Geometry::Cylinder { radius: *radius, length: 2.0 * half }, 0.0),
        ContactForm::Cone { radius, half } => {
            (Geometry::Cone { radius_x: *radius, radius_y: *radius, length: 2.0 * half }, 0.0)
        }
        ContactForm::Frustum { radii, half: 0.0, .. } => return disc(*radii),
        ContactForm::Frustum { radii: [radius_x, radius_y], top, half } => {
            let (radius_x, radius_y, length) = (*radius_x, *radius_y, 2.0 * half);
            let whole = Geometry::Frustum { radius_x, radius_y, top_scale: *top, length };
            (if *top == 0.0 { Geometry::Cone { radius_x, radius_y, length } } else { whole }, 0.0)
        }
    };
    // What collides has been checked when it was loaded: there is no fault that could come up here.
    let finish = Finish { fillet, ..Finish::default() };
    let shape = Shape::finished(geometry, finish, Scaling::default()).ok();
    let polygons = shape.map(|s| tessellate(&s, Subdivision { around: AROUND, flat: 1 }, &Meshes::default()));
    polygons.and_then(Result::ok).unwrap_or_default()
}

fn disc([a, b]: [f64; 2]) -> TriMesh {
    let shape = Shape::new(Geometry::Disc { outer_radius: 1.0, inner_radius: 0.0 }).ok();
    let polygons = shape.map(|s| tessellate(&s, Subdivision { around: AROUND, flat: 1 }, &Meshes::default()));
    polygons.and_then(Result::ok).unwrap_or_default().stretched([a, b, 1.0])
}

fn grid() -> Vec<Vec3> {
    let (mesh, count) = GROUND;
    let end = mesh * f64::from(count);
    let lines = (-count..=count).flat_map(|i| {
        let at = mesh * f64::from(i);
        [[at, -end], [at, end], [-end, at], [end, at]].map(|[x, y]| Vec3::new(x, y, 0.0))
    });
    lines.collect()
}

/// Unit normal; 0 for a triangle without area.
fn normal(mesh: &TriMesh, triangle: [u32; 3]) -> Vec3 {
    let [a, b, c] = mesh.corners(triangle);
    (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or(Vec3::zeros())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn a_box_has_its_twelve_edges_and_a_flat_quad_no_diagonal() {
        let edges = wireframe(&ContactForm::Cuboid { half: [0.1, 0.2, 0.3] });
        assert_eq!(edges.len(), 24);
        assert!(edges.iter().all(|p| (p.abs() - Vec3::new(0.1, 0.2, 0.3)).norm() < 1e-12));
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let quad = TriMesh { vertices: corners.into(), triangles: vec![[0, 1, 2], [0, 2, 3]] };
        assert_eq!(wireframe(&ContactForm::Surface(Arc::new(quad))).len(), 8);
    }

    #[test]
    fn every_form_has_lines_on_its_surface_and_normals_that_lead_away() {
        let corner = |i: u32| Vec3::from_fn(|axis, _| if i >> axis & 1 == 1 { 0.5 } else { -0.5 });
        let forms = [
            ContactForm::Ball { radius: 0.5 },
            ContactForm::Cuboid { half: [0.5; 3] },
            ContactForm::RoundCuboid { half: [0.3; 3], radius: 0.2 },
            ContactForm::Capsule { bottom: 0.2, top: 0.3, half: 0.2 },
            ContactForm::Ellipsoid { radii: [0.5, 0.3, 0.2] },
            ContactForm::Cylinder { radius: 0.3, half: 0.5 },
            ContactForm::Cone { radius: 0.3, half: 0.5 },
            ContactForm::Frustum { radii: [0.3, 0.4], top: 0.5, half: 0.5 },
            ContactForm::Frustum { radii: [0.3, 0.4], top: 0.0, half: 0.5 },
            ContactForm::Hull((0..8).map(corner).collect()),
        ];
        for form in &forms {
            let lines = wireframe(form);
            assert!(lines.len() >= 24 && lines.len().is_multiple_of(2), "{form:?}: {}", lines.len());
            assert!(lines.iter().all(|p| p.amax() < 0.5 + 1e-9), "{form:?}");
            for line in normals(form, 0.1).chunks(2) {
                assert!((line[1] - line[0]).dot(&line[0]) > 0.0, "{form:?}");
            }
        }
        // A disc has two sides.
        assert!(!wireframe(&ContactForm::Frustum { radii: [0.3, 0.4], top: 1.0, half: 0.0 }).is_empty());
        assert_eq!(wireframe(&ContactForm::HalfSpace).len(), 44);
    }
}
