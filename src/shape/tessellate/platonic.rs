//! The five regular polyhedra, and the pyramid.

use super::patch::Patches;
use crate::math::Vec3;
use crate::shape::TriMesh;

/// A regular polyhedron with its corners at distance `radius`; orientations as `tessellate` tells. No faces: none of
/// the five.
pub(super) fn polyhedron(faces: u32, radius: f64) -> TriMesh {
    let corners = corners(faces, radius);
    let mut patches = Patches::default();
    for normal in normals(faces) {
        let face = face(&corners, &normal);
        for i in 2..face.len() {
            patches.triangle([face[0], face[i - 1], face[i]], false);
        }
    }
    patches.mesh()
}

/// The corners of a regular polyhedron, at distance `radius`.
fn corners(faces: u32, radius: f64) -> Vec<Vec3> {
    directions(faces).into_iter().map(|d| d.normalize() * radius).collect()
}

/// Of the faces: towards the corners of the dual polyhedron.
fn normals(faces: u32) -> Vec<Vec3> {
    match faces {
        4 => directions(4).into_iter().map(|d| -d).collect(),
        6 => directions(8),
        8 => directions(6),
        12 => directions(20),
        20 => directions(12),
        _ => vec![],
    }
}

/// Towards the corners of the polyhedron with so many faces.
fn directions(faces: u32) -> Vec<Vec3> {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let signs = [1.0, -1.0];
    let cube = || signs.iter().flat_map(|x| signs.map(|y| signs.map(|z| Vec3::new(*x, y, z)))).flatten();
    let turned = |y: f64, z: f64| {
        let first = signs.into_iter().flat_map(move |s| signs.map(|t| Vec3::new(0.0, s * y, t * z)));
        first.flat_map(|p| [p, Vec3::new(p.z, p.x, p.y), Vec3::new(p.y, p.z, p.x)])
    };
    match faces {
        4 => cube().filter(|p| p.product() > 0.0).collect(),
        6 => cube().collect(),
        8 => (0..3).flat_map(|axis| signs.map(|s| Vec3::ith(axis, s))).collect(),
        12 => cube().chain(turned(golden, 1.0 / golden)).collect(),
        20 => turned(1.0, golden).collect(),
        _ => vec![],
    }
}

/// The corners that lie furthest along `normal`, anticlockwise around it.
fn face(corners: &[Vec3], normal: &Vec3) -> Vec<Vec3> {
    let furthest = corners.iter().map(|c| c.dot(normal)).fold(f64::NEG_INFINITY, f64::max);
    // The next layer of corners lies far below: a fifth of the height at least.
    let mut face: Vec<Vec3> = corners.iter().copied().filter(|c| c.dot(normal) > 0.99 * furthest).collect();
    let center = face.iter().sum::<Vec3>() / face.len() as f64;
    let x = face[0] - center;
    let y = normal.normalize().cross(&x);
    let angle = |p: &Vec3| (p - center).dot(&y).atan2((p - center).dot(&x));
    face.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    face
}

/// A pyramid of full sizes: rectangular base below, tip above, the origin at half its height.
pub(super) fn pyramid(size: [f64; 3]) -> TriMesh {
    let [a, b, c, d, tip] = pyramid_corners(size);
    let mut patches = Patches::default();
    for corners in [[a, c, b], [a, d, c], [a, b, tip], [b, c, tip], [c, d, tip], [d, a, tip]] {
        patches.triangle(corners, false);
    }
    patches.mesh()
}

/// The base, anticlockwise seen from above, and the tip.
fn pyramid_corners(size: [f64; 3]) -> [Vec3; 5] {
    let [x, y, z] = size.map(|s| s / 2.0);
    [Vec3::new(-x, -y, -z), Vec3::new(x, -y, -z), Vec3::new(x, y, -z), Vec3::new(-x, y, -z), Vec3::new(0.0, 0.0, z)]
}
