//! Round shapes: their outline, turned.

use super::segments_of_arc;
use crate::math::{Vec3, sin_cos};
use crate::shape::{Lathe, Piece, TriMesh};
use std::f64::consts::TAU;

/// The surface of a round shape: rings of vertices, one per point of the outline; single ones on the axis.
pub(super) fn turned(lathe: &Lathe, around: u32, flat: u32) -> TriMesh {
    let outline = Outline::of(lathe, around, flat);
    let [from, to] = lathe.turn();
    let steps = segments_of_arc(around, (to - from) / TAU);
    let sliced = lathe.slice.is_some();
    let angles = if sliced { steps + 1 } else { steps };
    let mut rings = Rings { mesh: TriMesh::default(), first: Vec::with_capacity(outline.points.len()), angles, steps };
    for point in &outline.points {
        rings.add(*point, |k| from + (to - from) * (f64::from(k) / f64::from(steps)));
    }
    for (i, j) in outline.edges() {
        for k in 0..steps {
            rings.quad(i, j, k);
        }
    }
    if sliced && lathe.closed {
        for k in [0, steps] {
            rings.cut(&outline, k, if k == 0 { from } else { to });
        }
    }
    rings.mesh.stretched(lathe.stretch)
}

/// The outline as points (ρ, z); ρ on the axis is exactly 0.
struct Outline {
    points: Vec<[f64; 2]>,
    /// Does the last point meet the first?
    looped: bool,
}

impl Outline {
    fn of(lathe: &Lathe, around: u32, flat: u32) -> Self {
        let mut points: Vec<[f64; 2]> = lathe.pieces.first().map(|p| p.at(0.0)).into_iter().collect();
        for piece in &lathe.pieces {
            let n = match piece {
                Piece::Line { .. } => flat,
                Piece::Arc { from, to, .. } => segments_of_arc(around, (to - from) / TAU),
            };
            points.extend((1..=n).map(|i| piece.at(f64::from(i) / f64::from(n))));
        }
        let size = points.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        let rounding = 8.0 * f64::EPSILON * size;
        for point in points.iter_mut().filter(|p| p[0].abs() <= rounding) {
            point[0] = 0.0;
        }
        points.dedup_by(|b, a| (a[0] - b[0]).abs() <= rounding && (a[1] - b[1]).abs() <= rounding);
        let looped = lathe.closed && points.first().is_some_and(|p| p[0] > 0.0);
        if looped {
            points.pop();
        }
        Self { points, looped }
    }

    /// Neighbours, in the outline's direction.
    fn edges(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let n = self.points.len();
        let last = if self.looped { n } else { n.saturating_sub(1) };
        (0..last).map(move |i| (i, (i + 1) % n))
    }

    /// All neighbours around a cut: along the axis as well.
    fn border(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let n = self.points.len();
        (0..n).map(move |i| (i, (i + 1) % n))
    }

    /// A point from which every edge of a cut is seen from its inner side: the middle of the region of all such points.
    fn heart(&self) -> [f64; 2] {
        let mut region = self.points.clone();
        for (i, j) in self.border() {
            region = left_of(&region, self.points[i], self.points[j]);
        }
        let n = region.len().max(1) as f64;
        region.iter().fold([0.0; 2], |sum, p| [sum[0] + p[0] / n, sum[1] + p[1] / n])
    }
}

/// The part of a polygon on the left of the line from `a` to `b`.
fn left_of(polygon: &[[f64; 2]], a: [f64; 2], b: [f64; 2]) -> Vec<[f64; 2]> {
    let side = |p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (s, t) = (side(p), side(q));
        if s >= 0.0 {
            part.push(p);
        }
        if s * t < 0.0 {
            let u = s / (s - t);
            part.push([p[0] + (q[0] - p[0]) * u, p[1] + (q[1] - p[1]) * u]);
        }
    }
    part
}

/// The vertices of each point of the outline at each angle.
struct Rings {
    mesh: TriMesh,
    /// Per point of the outline: its first vertex, and whether that is its only one.
    first: Vec<(u32, bool)>,
    angles: u32,
    steps: u32,
}

impl Rings {
    fn add(&mut self, [rho, z]: [f64; 2], angle: impl Fn(u32) -> f64) {
        let pole = rho == 0.0;
        self.first.push((self.mesh.vertices.len() as u32, pole));
        for k in 0..if pole { 1 } else { self.angles } {
            self.mesh.vertices.push(turn([rho, z], angle(k)));
        }
    }

    fn vertex(&self, point: usize, k: u32) -> u32 {
        let (first, pole) = self.first[point];
        if pole { first } else { first + k % self.angles }
    }

    /// Between two points of the outline, from angle k to the next.
    fn quad(&mut self, i: usize, j: usize, k: u32) {
        let [a, b, c, d] = [self.vertex(i, k), self.vertex(i, k + 1), self.vertex(j, k + 1), self.vertex(j, k)];
        if a != b {
            self.mesh.triangles.push([a, b, c]);
        }
        if c != d {
            self.mesh.triangles.push([a, c, d]);
        }
    }

    /// The face where a slice begins (k = 0) or ends.
    fn cut(&mut self, outline: &Outline, k: u32, angle: f64) {
        let heart = self.mesh.vertices.len() as u32;
        self.mesh.vertices.push(turn(outline.heart(), angle));
        for (i, j) in outline.border() {
            let (p, q) = (self.vertex(i, k), self.vertex(j, k));
            self.mesh.triangles.push(if k == self.steps { [heart, q, p] } else { [heart, p, q] });
        }
    }
}

fn turn([rho, z]: [f64; 2], angle: f64) -> Vec3 {
    let (sine, cosine) = sin_cos(angle);
    Vec3::new(rho * cosine, rho * sine, z)
}
