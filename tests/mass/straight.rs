//! Boxes, pyramids and triangles from their definition.

use super::points::{Cloud, gauss, graded, rooted, stretched};
use realnoid::description::Geometry;
use realnoid::math::Vec3;
use realnoid::shape::TriMesh;
use std::f64::consts::FRAC_PI_2;

/// The inside of a box rounded by `f`, or of a pyramid.
pub fn solid(geometry: &Geometry, f: f64) -> Option<Cloud> {
    match *geometry {
        Geometry::Box { size } => Some(rounded_box(size.map(|s| s / 2.0 - f), f)),
        Geometry::Pyramid { size: [x, y, z] } => Some(pyramid(x, y, z)),
        _ => None,
    }
}

/// The surface of a box rounded by `f` and stretched, of a pyramid, or of a flat shape.
pub fn surface(geometry: &Geometry, f: f64, stretch: [f64; 3]) -> Option<Cloud> {
    let corner = |p: [f64; 3]| Vec3::from(p).component_mul(&Vec3::from(stretch));
    Some(match *geometry {
        Geometry::Box { size } => box_surface(size.map(|s| s / 2.0 - f), f, stretch.map(f64::abs)),
        Geometry::Plane { size: [x, y] } => {
            let grows = (stretch[0] * stretch[1]).abs();
            let rows = gauss(-x / 2.0, x / 2.0);
            let points = rows.iter().flat_map(|&(w, x)| {
                gauss(-y / 2.0, y / 2.0).into_iter().map(move |(v, y)| (w * v, Vec3::new(x, y, 0.0)))
            });
            stretched(points.collect(), stretch, grows)
        }
        Geometry::Triangle { corners } => triangle(corners.map(corner)),
        Geometry::Quad { corners } => {
            let [a, b, c, d] = corners.map(corner);
            [triangle([a, b, c]), triangle([a, c, d])].concat()
        }
        Geometry::Pyramid { size: [x, y, z] } => {
            let at = |i: f64, j: f64| corner([i * x / 2.0, j * y / 2.0, -z / 2.0]);
            let base = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
            let tip = corner([0.0, 0.0, z / 2.0]);
            let mut cloud = [triangle([base[0], base[1], base[2]]), triangle([base[0], base[2], base[3]])].concat();
            (0..4).for_each(|k| cloud.extend(triangle([base[k], base[(k + 1) % 4], tip])));
            cloud
        }
        _ => return None,
    })
}

/// All triangles of a mesh.
pub fn mesh_surface(mesh: &TriMesh) -> Cloud {
    mesh.triangles.iter().flat_map(|&t| triangle(mesh.corners(t))).collect()
}

/// Signed cones from a point outside to all triangles of a closed mesh.
pub fn mesh_solid(mesh: &TriMesh, apex: Vec3) -> Cloud {
    let mut cloud = Vec::new();
    for &t in &mesh.triangles {
        let [a, b, c] = mesh.corners(t);
        let normal = (b - a).cross(&(c - a)).normalize();
        let height = (a - apex).dot(&normal);
        for (w, p) in triangle([a, b, c]) {
            cloud.extend(gauss(0.0, 1.0).into_iter().map(|(ws, s)| (w * ws * s * s * height, apex + (p - apex) * s)));
        }
    }
    cloud
}

/// A square folded onto a triangle.
fn triangle([a, b, c]: [Vec3; 3]) -> Cloud {
    let twice = (b - a).cross(&(c - a)).norm();
    let mut cloud = Vec::new();
    for (wu, u) in gauss(0.0, 1.0) {
        cloud.extend(
            gauss(0.0, 1.0).into_iter().map(|(wv, v)| (twice * wu * wv * u, a + (b - a) * u + (c - b) * (u * v))),
        );
    }
    cloud
}

fn pyramid(x: f64, y: f64, z: f64) -> Cloud {
    let mut cloud = Vec::new();
    for (wu, u) in gauss(0.0, 1.0) {
        let (a, b) = (x / 2.0 * (1.0 - u), y / 2.0 * (1.0 - u));
        for (wx, px) in gauss(-a, a) {
            cloud.extend(gauss(-b, b).into_iter().map(|(wy, py)| (wu * z * wx * wy, Vec3::new(px, py, (u - 0.5) * z))));
        }
    }
    cloud
}

/// A box of half edges `p` grown by a ball: at each height a box of two edges grown by a circle.
fn rounded_box(p: [f64; 3], f: f64) -> Cloud {
    let mut cloud = Vec::new();
    for (wz, z, g) in across(p[2], f) {
        for (wy, y, k) in across(p[1], g) {
            cloud.extend(gauss(-p[0] - k, p[0] + k).into_iter().map(|(wx, x)| (wx * wy * wz, Vec3::new(x, y, z))));
        }
    }
    cloud
}

/// Points across a range of half width p grown by f, with the radius by which the next axis grows there.
fn across(p: f64, f: f64) -> Vec<(f64, f64, f64)> {
    let core = gauss(-p, p).into_iter().map(|(w, at)| (w, at, f));
    let beyond = |sign: f64| {
        let rule = if f > 0.0 { rooted(0.0, f) } else { vec![] };
        rule.into_iter().map(move |(w, d)| (w, sign * (p + d), ((f - d) * (f + d)).sqrt()))
    };
    // Square roots need many points only in the rounding.
    core.chain(beyond(-1.0)).chain(beyond(1.0)).collect()
}

fn box_surface(p: [f64; 3], f: f64, s: [f64; 3]) -> Cloud {
    let mut octant = Vec::new();
    let scaled = |v: Vec3| v.component_mul(&Vec3::from(s));
    for axis in 0..3 {
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        let at = |own: f64, other: [f64; 2]| {
            let mut v = Vec3::zeros();
            (v[axis], v[j], v[k]) = (own, other[0], other[1]);
            v
        };
        for (wj, y) in gauss(0.0, p[j]) {
            let row = gauss(0.0, p[k]).into_iter();
            octant.extend(row.map(|(wk, z)| (wj * wk * s[j] * s[k], scaled(at(p[axis] + f, [y, z])))));
        }
        let edge = if f > 0.0 { graded(0.0, FRAC_PI_2) } else { vec![] };
        for (wt, t) in edge {
            let (sin, cos) = t.sin_cos();
            let element = scaled(at(0.0, [-f * sin, f * cos])).norm() * s[axis];
            let place = [p[j] + f * cos, p[k] + f * sin];
            octant.extend(gauss(0.0, p[axis]).into_iter().map(|(w, x)| (wt * w * element, scaled(at(x, place)))));
        }
    }
    if f > 0.0 {
        octant.extend(ball_octant(p, f, s));
    }
    let signs = (0..8u32).map(|i| Vec3::from_fn(|axis, _| if i >> axis & 1 == 0 { 1.0 } else { -1.0 }));
    signs.flat_map(|sign| octant.iter().map(move |(w, p)| (*w, p.component_mul(&sign))).collect::<Vec<_>>()).collect()
}

/// By polar angle, unlike the height that the formula takes.
fn ball_octant(p: [f64; 3], f: f64, s: [f64; 3]) -> Cloud {
    let mut cloud = Vec::new();
    for (wu, u) in graded(0.0, FRAC_PI_2) {
        for (wv, v) in graded(0.0, FRAC_PI_2) {
            let n = Vec3::new(u.sin() * v.cos(), u.sin() * v.sin(), u.cos());
            let du = Vec3::new(u.cos() * v.cos(), u.cos() * v.sin(), -u.sin()).component_mul(&Vec3::from(s)) * f;
            let dv = Vec3::new(-u.sin() * v.sin(), u.sin() * v.cos(), 0.0).component_mul(&Vec3::from(s)) * f;
            cloud.push((wu * wv * du.cross(&dv).norm(), (Vec3::from(p) + n * f).component_mul(&Vec3::from(s))));
        }
    }
    cloud
}
