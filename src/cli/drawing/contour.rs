//! What is seen of one shape: the area it covers, and its edges.

use super::lines::{chained, simplified, without_spikes};
use super::parts::Part;
use super::view::{Point, View};
use crate::math::Vec3;
use crate::shape::TriMesh;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::simplify::Simplify;
use i_overlay::i_float::int::point::IntPoint;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Two faces that meet at a greater angle make an edge: more than the segments of a round shape do.
const CREASE: f64 = 30.0 * std::f64::consts::PI / 180.0;

/// Points closer to a line than this are left out of it, pixels.
const TOLERANCE: f64 = 0.06;

/// Areas are joined on a grid of so many pixels: far fewer triangles cross each other there by a rounding.
const GRID: f64 = 0.05;

/// Slits and needles that joining leaves behind are narrower than this, pixels.
const SPIKE: f64 = 0.15;

/// So many rings are joined at once.
const FEW: usize = 250;

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
    let (edges, hidden) = if part.edges { edges(&part.mesh, &points, view) } else { Default::default() };
    let count = part.mesh.vertices.len().max(1) as f64;
    let center = part.mesh.vertices.iter().sum::<Vec3>() / count;
    Contour { outline: covered(&part.mesh, &points), edges, hidden, nearness: view.nearness(&center) }
}

/// The union of all triangles on the page: first of those that turn one way and of those that turn the other way, as few
/// of either cross each other.
fn covered(mesh: &TriMesh, points: &[Point]) -> Vec<Vec<Point>> {
    let places: Vec<IntPoint> =
        points.iter().map(|p| p.map(|x| (x / GRID).round() as i32)).map(|[x, y]| IntPoint::new(x, y)).collect();
    let (mut near, mut far) = (vec![], vec![]);
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| places[i as usize]);
        let [ab, ac] = [b, c].map(|p| [i64::from(p.x) - i64::from(a.x), i64::from(p.y) - i64::from(a.y)]);
        // Triangles seen from their edge cover nothing.
        match (ab[0] * ac[1] - ab[1] * ac[0]).cmp(&0) {
            Ordering::Greater => near.push(vec![a, b, c]),
            Ordering::Less => far.push(vec![a, c, b]),
            Ordering::Equal => {}
        }
    }
    let both = union(&near).into_iter().chain(union(&far)).collect();
    let pixels =
        |ring: Vec<IntPoint>| -> Vec<Point> { ring.iter().map(|p| [p.x, p.y].map(|i| f64::from(i) * GRID)).collect() };
    let rings = joined(both).into_iter().map(|ring| simplified(&without_spikes(&pixels(ring), SPIKE), TOLERANCE));
    rings.filter(|ring| ring.len() > 2 && width(ring) > SPIKE).collect()
}

/// Mean width of what a ring encloses: twice the area by the length.
fn width(ring: &[Point]) -> f64 {
    let sides = (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]);
    let (area, length) = sides.fold((0.0, 0.0), |(area, length), [p, q]| {
        (area + (p[0] * q[1] - p[1] * q[0]) / 2.0, length + (q[0] - p[0]).hypot(q[1] - p[1]))
    });
    2.0 * f64::abs(area) / f64::max(length, SPIKE)
}

type Ring = Vec<IntPoint>;

fn joined(rings: Vec<Ring>) -> Vec<Ring> {
    rings.simplify(FillRule::NonZero, Default::default()).into_iter().flatten().collect()
}

/// The union of rings, by halves: neighbours in a list are mostly neighbours on the page, and joining small groups first
/// took a tenth of the time on the meshes of a real robot.
fn union(rings: &[Ring]) -> Vec<Ring> {
    if rings.len() <= FEW {
        return joined(rings.to_vec());
    }
    let (one, other) = rings.split_at(rings.len() / 2);
    joined(union(one).into_iter().chain(union(other)).collect())
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
