//! What is seen of one shape: the area it covers, and its edges.

use super::lines::{chained, simplified};
use super::parts::Part;
use super::view::{Point, View};
use crate::math::Vec3;
use crate::shape::TriMesh;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::float::simplify::SimplifyShape;
use std::collections::BTreeMap;

/// Two faces that meet at a greater angle make an edge: more than the segments of a round shape do.
const CREASE: f64 = 30.0 * std::f64::consts::PI / 180.0;

/// Points closer to a line than this are left out of it, pixels.
pub(super) const TOLERANCE: f64 = 0.06;

/// In pixels of the page.
pub(super) struct Contour {
    /// Rings around the covered area.
    pub outline: Vec<Vec<Point>>,
    /// Edges that the viewer faces.
    pub edges: Vec<Vec<Point>>,
    /// Edges on the far side.
    pub hidden: Vec<Vec<Point>>,
    /// Mean nearness to the viewer, m.
    pub nearness: f64,
}

/// What is seen of a part.
pub(super) fn contour(part: &Part, view: &View) -> Contour {
    let points: Vec<Point> = part.mesh.vertices.iter().map(|v| view.at(v)).collect();
    let (edges, hidden) = if part.file { Default::default() } else { edges(&part.mesh, &points, view) };
    let count = part.mesh.vertices.len().max(1) as f64;
    let center = part.mesh.vertices.iter().sum::<Vec3>() / count;
    Contour { outline: covered(&part.mesh, &points), edges, hidden, nearness: view.nearness(&center) }
}

/// The union of all triangles on the page.
fn covered(mesh: &TriMesh, points: &[Point]) -> Vec<Vec<Point>> {
    let turned = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| points[i as usize]);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        // Triangles seen from their edge cover nothing.
        (area.abs() > 1e-9).then(|| if area > 0.0 { vec![a, b, c] } else { vec![a, c, b] })
    };
    let triangles: Vec<Vec<Point>> = mesh.triangles.iter().filter_map(turned).collect();
    let shapes = triangles.simplify_shape(FillRule::NonZero);
    shapes.into_iter().flatten().map(|ring| simplified(&ring, TOLERANCE)).filter(|ring| ring.len() > 2).collect()
}

type Lines = Vec<Vec<Point>>;

/// Rims, creases and folds: those that the viewer faces, and the others.
fn edges(mesh: &TriMesh, points: &[Point], view: &View) -> (Lines, Lines) {
    let normals: Vec<Vec3> = mesh.triangles.iter().map(|t| normal(mesh, *t)).collect();
    let mut sides: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        for (p, q) in [(*a, *b), (*b, *c), (*c, *a)] {
            sides.entry((p.min(q), p.max(q))).or_default().push(i);
        }
    }
    let facing = |i: usize| normals[i].dot(&view.side.near) > 1e-6;
    let (mut near, mut far) = (vec![], vec![]);
    for ((a, b), triangles) in &sides {
        let faces = triangles.iter().filter(|i| facing(**i)).count();
        let rim = triangles.len() == 1;
        let fold = faces > 0 && faces < triangles.len();
        let crease = triangles.windows(2).any(|w| normals[w[0]].dot(&normals[w[1]]) < CREASE.cos());
        if rim || fold || crease {
            if faces > 0 || rim { &mut near } else { &mut far }.push([points[*a as usize], points[*b as usize]]);
        }
    }
    (chained(&near, TOLERANCE), chained(&far, TOLERANCE))
}

/// Unit normal; 0 for a triangle without area.
fn normal(mesh: &TriMesh, triangle: [u32; 3]) -> Vec3 {
    let [a, b, c] = mesh.corners(triangle);
    (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or(Vec3::zeros())
}
