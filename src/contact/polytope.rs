//! The convex hull of corners, with its faces.

use super::climb::Climb;
use super::vector::{across, norm, unit};
use crate::math::V3;
use parry3d_f64::math::Vector;
use parry3d_f64::shape::ConvexPolyhedron;

/// Corners and faces; a flat one has two faces, a thinner one none.
#[derive(Clone, Debug)]
pub(super) struct Polytope {
    pub points: Vec<V3<f64>>,
    /// Outward normals.
    pub normals: Vec<V3<f64>>,
    /// Where the corners of each face begin in `corners`; one more at the end.
    starts: Vec<u32>,
    /// Indices into `points`, anticlockwise seen from outside.
    corners: Vec<u32>,
    /// Of many corners: the way to the furthest.
    pub climb: Option<Climb>,
}

/// Corners nearer to a plane than this share of the size lie in it.
const FLAT: f64 = 1e-9;

impl Polytope {
    /// The hull; `None` where the corners enclose a volume, but their faces could not be found.
    pub(super) fn of(points: &[V3<f64>]) -> Option<Self> {
        if let Some(normal) = flat(points) {
            return Some(Self::flat(points, normal));
        }
        let list: Vec<Vector> = points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
        let hull = ConvexPolyhedron::from_convex_hull(&list)?;
        let mut made = Self { points: vec![], normals: vec![], starts: vec![0], corners: vec![], climb: None };
        made.points.extend(hull.points().iter().map(|p| V3::new(p.x, p.y, p.z)));
        for face in hull.faces() {
            let first = face.first_vertex_or_edge as usize;
            let around = &hull.vertices_adj_to_face()[first..first + face.num_vertices_or_edges as usize];
            made.add_face(around);
        }
        made.climb = Climb::of(&made.points, (0..made.normals.len()).map(|i| made.face(i)));
        Some(made)
    }

    /// Without faces: only where a hull could not be made.
    pub(super) fn bare(points: &[V3<f64>]) -> Self {
        Self { points: points.to_vec(), normals: vec![], starts: vec![0], corners: vec![], climb: None }
    }

    fn flat(points: &[V3<f64>], normal: V3<f64>) -> Self {
        let around = planar_hull(points, normal);
        let kept = around.iter().map(|i| points[*i]).collect();
        let mut made = Self { points: kept, normals: vec![], starts: vec![0], corners: vec![], climb: None };
        if around.len() > 2 {
            let up: Vec<u32> = (0..around.len() as u32).collect();
            made.add_face(&up);
            made.add_face(&up.iter().rev().copied().collect::<Vec<_>>());
        }
        made
    }

    /// Its normal is that of the whole polygon (Newell), so that a small first corner does not spoil it.
    fn add_face(&mut self, around: &[u32]) {
        let at = |i: usize| self.points[around[i % around.len()] as usize];
        let area = (0..around.len()).fold(V3::default(), |sum, i| sum + (at(i) - at(0)).cross(at(i + 1) - at(0)));
        if let Some(normal) = unit(area) {
            self.normals.push(normal);
            self.corners.extend_from_slice(around);
            self.starts.push(self.corners.len() as u32);
        }
    }

    /// Indices of the corners of a face.
    pub(super) fn face(&self, i: usize) -> &[u32] {
        &self.corners[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// The corner furthest in a direction of any length.
    pub(super) fn support(&self, d: V3<f64>) -> V3<f64> {
        if let Some(climb) = &self.climb {
            return climb.support(&self.points, d);
        }
        let further = |best: (f64, V3<f64>), p: &V3<f64>| {
            let reach = p.dot(d);
            if reach > best.0 { (reach, *p) } else { best }
        };
        self.points.iter().fold((f64::NEG_INFINITY, V3::default()), further).1
    }
}

/// The normal of the plane in which all points lie, if there is one (any, for points on a line).
fn flat(points: &[V3<f64>]) -> Option<V3<f64>> {
    let first = *points.first()?;
    let furthest = |measure: &dyn Fn(V3<f64>) -> f64| {
        let further = |best: (f64, V3<f64>), p: &V3<f64>| {
            let m = measure(*p);
            if m > best.0 { (m, *p) } else { best }
        };
        points.iter().fold((0.0, first), further)
    };
    let (size, far) = furthest(&|p| norm(p - first));
    let Some(line) = unit(far - first) else { return Some(V3::new(0.0, 0.0, 1.0)) };
    let (width, side) = furthest(&|p| norm((p - first).cross(line)));
    if width <= FLAT * size {
        return Some(across(line));
    }
    let normal = unit(line.cross(side - first))?;
    let (depth, _) = furthest(&|p| normal.dot(p - first).abs());
    (depth <= FLAT * size).then_some(normal)
}

/// Indices of the corners of a flat hull, anticlockwise about the normal (Andrew's monotone chain).
fn planar_hull(points: &[V3<f64>], normal: V3<f64>) -> Vec<usize> {
    let u = across(normal);
    let v = normal.cross(u);
    let flat: Vec<[f64; 2]> = points.iter().map(|p| [p.dot(u), p.dot(v)]).collect();
    let size = flat.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| flat[*a][0].total_cmp(&flat[*b][0]).then(flat[*a][1].total_cmp(&flat[*b][1])));
    let turn = |a: usize, b: usize, c: usize| {
        let ([ax, ay], [bx, by], [cx, cy]) = (flat[a], flat[b], flat[c]);
        (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    };
    let mut hull: Vec<usize> = vec![];
    let back = order.iter().rev().skip(1).copied();
    let mut least = 2;
    for (step, i) in order.iter().copied().chain(back).enumerate() {
        if step == order.len() {
            least = hull.len() + 1;
        }
        while hull.len() >= least && turn(hull[hull.len() - 2], hull[hull.len() - 1], i) <= FLAT * size * size {
            hull.pop();
        }
        hull.push(i);
    }
    if hull.len() > 1 {
        hull.pop();
    }
    hull
}
