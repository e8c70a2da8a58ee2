//! A surface of triangles that stands still, against convex shapes.
//!
//! Each triangle near the shape is a convex shape of its own; what it says counts only if the direction from its point to
//! the shape belongs to that corner, edge or face of the *surface*: a ball that rolls over a flat floor meets no edges.

use super::manifold::{Scratch, manifold_if};
use super::nearest::{Nearest, Placed};
use super::raw::{Raw, reduce};
use super::solid::{Kind, Solid};
use super::vector::{Frame, norm, unit};
use crate::math::{M3, V3};
use crate::shape::TriMesh;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use std::collections::HashMap;

/// A surface prepared for questions.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    corners: Vec<[V3<f64>; 3]>,
    normals: Vec<V3<f64>>,
    /// Per edge of each triangle: the direction, in the plane of the neighbour there, that leads away from the edge.
    inward: Vec<[Option<V3<f64>>; 3]>,
    /// Per triangle and corner: its vertex.
    vertices: Vec<[u32; 3]>,
    /// Per vertex: the vertices that an edge joins to it (from `starts`).
    around: Vec<V3<f64>>,
    starts: Vec<u32>,
    tree: Bvh,
    pub middle: V3<f64>,
    pub half: V3<f64>,
}

/// Sine up to which directions count as the same.
const TILT: f64 = 1e-6;
/// The same where the search has not been made better yet, or where a direction only tells who answers for a place.
const LOOSE: f64 = 0.05;

impl Surface {
    /// Without the triangles that have no area.
    pub(super) fn of(mesh: &TriMesh) -> Self {
        let mut s = Self {
            corners: vec![],
            normals: vec![],
            inward: vec![],
            vertices: vec![],
            around: vec![],
            starts: vec![0],
            tree: Bvh::new(),
            middle: V3::default(),
            half: V3::default(),
        };
        let point = |i: u32| V3::from(mesh.vertices[i as usize]);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(point);
            if let Some(n) = unit((b - a).cross(c - a)) {
                s.corners.push([a, b, c]);
                s.normals.push(n);
                s.vertices.push(*triangle);
            }
        }
        s.join(mesh.vertices.len(), point);
        let boxes: Vec<Aabb> = s.corners.iter().map(|c| Aabb::from_points(c.map(vector))).collect();
        s.tree = Bvh::from_leaves(BvhBuildStrategy::default(), &boxes);
        let all = s.corners.iter().flatten();
        let (low, high) =
            all.fold((V3::new(1.0, 1.0, 1.0) * f64::MAX, V3::new(1.0, 1.0, 1.0) * f64::MIN), |(l, h), p| {
                (V3::new(l.x.min(p.x), l.y.min(p.y), l.z.min(p.z)), V3::new(h.x.max(p.x), h.y.max(p.y), h.z.max(p.z)))
            });
        if !s.corners.is_empty() {
            (s.middle, s.half) = (low * 0.5 + high * 0.5, high * 0.5 - low * 0.5);
        }
        s
    }

    /// Finds what lies beside each edge and around each vertex.
    fn join(&mut self, count: usize, point: impl Fn(u32) -> V3<f64>) {
        let mut owners: HashMap<(u32, u32), Vec<(usize, usize)>> = HashMap::new();
        for (t, v) in self.vertices.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (v[k], v[(k + 1) % 3]);
                owners.entry((a.min(b), a.max(b))).or_default().push((t, k));
            }
        }
        let away = |(t, k): (usize, usize)| {
            let c = self.corners[t];
            unit(self.normals[t].cross(c[(k + 1) % 3] - c[k]))
        };
        self.inward = (self.vertices.iter().enumerate())
            .map(|(t, v)| {
                [0, 1, 2].map(|k| {
                    let (a, b) = (v[k], v[(k + 1) % 3]);
                    owners[&(a.min(b), a.max(b))].iter().find(|(other, _)| *other != t).and_then(|o| away(*o))
                })
            })
            .collect();
        let mut beside = vec![vec![]; count];
        for v in &self.vertices {
            for k in 0..3 {
                let (a, b) = (v[k], v[(k + 1) % 3]);
                beside[a as usize].push(b);
                beside[b as usize].push(a);
            }
        }
        for (v, list) in beside.iter_mut().enumerate() {
            list.sort_unstable();
            list.dedup();
            self.around.extend(list.iter().filter_map(|w| unit(point(*w) - point(v as u32))));
            self.starts.push(self.around.len() as u32);
        }
    }

    /// Does the surface meet the direction `n` at the point `p` of this triangle, up to the sine `tilt`? (All in the surface's
    /// frame.)
    fn owns(&self, t: usize, (p, n): (V3<f64>, V3<f64>), tilt: f64) -> bool {
        if self.normals[t].dot(n) > 1.0 - 0.5 * tilt * tilt {
            return true;
        }
        let c = &self.corners[t];
        let size = norm(c[1] - c[0]).max(norm(c[2] - c[0]));
        let near = 1e-7 * size;
        if let Some(k) = (0..3).find(|k| norm(p - c[*k]) <= near) {
            let v = self.vertices[t][k] as usize;
            let beside = &self.around[self.starts[v] as usize..self.starts[v + 1] as usize];
            return beside.iter().all(|w| w.dot(n) <= tilt);
        }
        let on_edge = |k: &usize| {
            let along = unit(c[(k + 1) % 3] - c[*k]);
            along.is_some_and(|u| norm((p - c[*k]).cross(u)) <= near)
        };
        match (0..3).find(on_edge) {
            Some(k) => self.inward[t][k].is_none_or(|w| w.dot(n) <= tilt),
            // Inside the face, across it: only by rounding, or where it is overlapped.
            None => false,
        }
    }

    /// Whatever becomes of nearest points that were found at a distance: is another triangle nearer, or do they lie behind?
    fn is_elsewhere(&self, t: usize, near: &Nearest) -> bool {
        let (p, n) = (near.points[0], near.normal);
        let up = self.normals[t].dot(n);
        if up > 1.0 - 0.5 * LOOSE * LOOSE {
            return false;
        }
        let c = &self.corners[t];
        let close = 1e-3 * norm(c[1] - c[0]).max(norm(c[2] - c[0]));
        let nearer = |k: usize| {
            let at = |u: V3<f64>| norm((p - c[k]).cross(u)) <= close;
            let there = unit(c[(k + 1) % 3] - c[k]).is_some_and(at);
            there && self.inward[t][k].is_some_and(|w| w.dot(n) > LOOSE)
        };
        up < -LOOSE || (0..3).any(nearer)
    }
}

fn vector(v: V3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

/// What is asked of a surface.
pub(super) struct Query<'a> {
    pub surface: &'a Surface,
    pub frame: Frame,
    pub margin: f64,
    pub solid: &'a Solid,
    /// Of the solid, in the same frame as `frame`.
    pub place: Frame,
    /// Middle and half edges of the box around the solid, in the solid's frame.
    pub extent: (V3<f64>, V3<f64>),
    /// Least width of the solid, m.
    pub thickness: f64,
}

/// Adds the points whose gap is below `reach`; side 0 is the surface.
pub(super) fn on_surface(s: &mut Scratch, q: &Query, (reach, size): (f64, f64), out: &mut Vec<Raw>) {
    let from = out.len();
    // In the surface's frame.
    let place = Frame { r: turned(&q.frame, &q.place), p: q.frame.inside(q.place.p) };
    let middle = place.at(q.extent.0);
    let h = q.extent.1;
    let wide = |row: V3<f64>| row.x.abs() * h.x + row.y.abs() * h.y + row.z.abs() * h.z + reach + q.margin;
    let half = V3::new(wide(place.r.r[0]), wide(place.r.r[1]), wide(place.r.r[2]));
    let area = Aabb::new(vector(middle - half), vector(middle + half));
    let own = Frame { r: M3::identity(), p: V3::default() };
    let solid = Placed { solid: q.solid, frame: place };
    for t in q.surface.tree.intersect_aabb(&area) {
        let corners = q.surface.corners[t as usize];
        let triangle = Solid { kind: Kind::Triangle(corners), round: q.margin };
        let begin = out.len();
        let flat = Placed { solid: &triangle, frame: own };
        let wanted = |near: &Nearest| near.distance <= 1e-6 * size || !q.surface.is_elsewhere(t as usize, near);
        manifold_if(s, [&flat, &solid], (reach, size), wanted, out);
        let mut kept = begin;
        for i in begin..out.len() {
            if let Some(raw) = judged(q, (t as usize, &solid), out[i]).filter(|raw| raw.gap < reach) {
                out[kept] = Raw { feature: name(t, raw.feature), ..raw };
                kept += 1;
            }
        }
        out.truncate(kept);
    }
    reduce(out, from, 1e-4 * size);
    for raw in &mut out[from..] {
        raw.core = raw.core.map(|c| q.frame.at(c));
        if let super::Normal::On(side, n) = raw.normal {
            raw.normal = super::Normal::On(side, q.frame.r.mv(n));
        }
    }
}

/// What a triangle says, if it is the surface that says it; where the solid overlaps the triangle, along its face.
fn judged(q: &Query, (t, solid): (usize, &Placed), raw: Raw) -> Option<Raw> {
    let n = raw.direction();
    let face = q.surface.normals[t];
    let foot = raw.core[0];
    if face.dot(n) > 0.0 && q.surface.owns(t, (foot, n), TILT) {
        return Some(raw);
    }
    // Out at an edge of the surface, as on top of a wall: what lies beyond the edge answers for that.
    if face.dot(n) < 1.0 - 0.5 * LOOSE * LOOSE && q.surface.owns(t, (foot, n), LOOSE) {
        return None;
    }
    let overlap = raw.gap + raw.radius[0] + raw.radius[1] < 0.0;
    let corners = &q.surface.corners[t];
    let lowest = solid.support(-face);
    let height = face.dot(lowest - corners[0]);
    let beside = (0..3).any(|k| (corners[(k + 1) % 3] - corners[k]).cross(face).dot(lowest - corners[k]) > 0.0);
    if !overlap || beside || height < -0.5 * q.thickness {
        return None;
    }
    Some(Raw::on(raw.feature, (0, face), [lowest - face * height, lowest], [q.margin, q.solid.round]))
}

fn turned(a: &Frame, b: &Frame) -> M3<f64> {
    let column = |c: V3<f64>| a.r.tv(c);
    let (x, y, z) = (column(b.r.col0()), column(b.r.col1()), column(b.r.col2()));
    M3::rows(V3::new(x.x, y.x, z.x), V3::new(x.y, y.y, z.y), V3::new(x.z, y.z, z.z))
}

/// Triangle and point of it in one number.
fn name(t: u32, feature: u32) -> u32 {
    let mixed = feature.wrapping_mul(0x9E37_79B1) >> 24;
    t.wrapping_mul(256).wrapping_add(mixed)
}
