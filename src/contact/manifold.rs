//! All points in which two convex shapes touch.

use super::feature::{Feature, Spot};
use super::nearest::{Nearest, Placed, Search, separation};
use super::raw::{Raw, SAME, reduce};
use super::vector::norm;
use crate::math::V3;

/// Memory of the narrow phase; made once.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    pub search: Search,
    features: [Feature; 2],
    polygon: Vec<Spot>,
    clipped: Vec<Spot>,
}

/// Points that are not corners have this bit in their feature.
const CROSSING: u32 = 1 << 29;
/// The nearest point, where no face touches.
const NEAREST: u32 = 1 << 30;
/// The face is that of the second shape.
const SECOND: u32 = 1 << 28;

/// Adds the points whose gap is below `reach`; `size` is that of the smaller shape.
pub(super) fn manifold(s: &mut Scratch, a: &Placed, b: &Placed, limits: (f64, f64), out: &mut Vec<Raw>) {
    manifold_if(s, [a, b], limits, |_| true, out);
}

/// The same, if the nearest points, as the search finds them at first, are `wanted`.
pub(super) fn manifold_if(
    s: &mut Scratch,
    [a, b]: [&Placed; 2],
    (reach, size): (f64, f64),
    wanted: impl Fn(&Nearest) -> bool,
    out: &mut Vec<Raw>,
) {
    let from = out.len();
    let round = [a.solid.round, b.solid.round];
    let found = s.search.nearest(a, b, reach + round[0] + round[1]);
    let Some(mut near) = found.filter(wanted) else { return };
    s.features[0].of(a.solid, &a.frame, near.normal);
    s.features[1].of(b.solid, &b.frame, -near.normal);
    let tolerance = 1e-6 * size + 0.02 * (-near.distance).max(0.0);
    let face = |n: V3<f64>| (separation(a, b, n), n);
    let faces = [s.features[0].normal.map(face), s.features[1].normal.map(|n| face(-n))];
    let (found, mut best) = (near.distance, f64::NEG_INFINITY);
    for (distance, normal) in faces.into_iter().flatten() {
        best = best.max(distance);
        if distance > near.distance {
            near = Nearest { distance, normal, ..near };
        }
    }
    // A face decides where it is what the search has found, and not where the search was inexact.
    let agree = best >= found - 1e-9 * size && best <= found + tolerance;
    let near = if agree { near } else { near.polished(a, b) };
    let good = |side: usize| faces[side].filter(|f| f.0 >= near.distance - tolerance).map(|f| (side, f.1));
    let reference = good(0).or_else(|| good(1));
    if let Some((side, n)) = reference {
        on_face(s, [a, b], (side, n), reach, out);
    }
    let least = out[from..].iter().fold(f64::INFINITY, |m, raw| m.min(raw.gap));
    let gap = near.distance - round[0] - round[1];
    if gap < reach && least > gap + tolerance + 1e-9 {
        out.push(single(s, [a, b], &near));
    }
    reduce(out, from, 1e-4 * size);
}

/// The nearest points alone. Between two corners (or middles of balls) the direction follows them; a point of an edge or of a
/// curved surface is another one as the bodies slide, and its tangent plane, which bounds the whole shape, is what stays.
fn single(s: &Scratch, solids: [&Placed; 2], near: &Nearest) -> Raw {
    let (core, n) = (near.points, near.normal);
    let round = solids.map(|x| x.solid.round);
    let way = core[1] - core[0];
    let straight = norm(way - n * near.distance) <= 1e-6 * near.distance;
    let corners = [0, 1].map(|side: usize| {
        let there = |spot: &Spot| norm(spot.at - core[side]) <= SAME;
        !solids[side].solid.is_smooth() && s.features[side].spots.iter().any(there)
    });
    if near.distance > SAME && straight && round[0] + round[1] > 0.0 && corners == [true; 2] {
        return Raw::between(NEAREST, core, round, n);
    }
    // One spot: a smooth surface, or a corner.
    let curve = |side: usize| match s.features[side].spots.as_slice() {
        [spot] => spot.curve,
        _ => 0.0,
    };
    let [a, b] = [curve(0), curve(1)];
    let side = usize::from(corners == [true, false]);
    Raw::on(NEAREST, (side, n), [core[0] - n * a, core[1] + n * b], [round[0] + a, round[1] + b])
}

/// What of the other shape lies over a face; `n` from the first shape to the second.
fn on_face(s: &mut Scratch, solids: [&Placed; 2], (side, n): (usize, V3<f64>), reach: f64, out: &mut Vec<Raw>) {
    let (own, other) = (solids[side], solids[1 - side]);
    let outward = if side == 0 { n } else { -n };
    s.features[side].of(own.solid, &own.frame, outward);
    s.features[1 - side].of(other.solid, &other.frame, -outward);
    let face = &s.features[side].spots;
    s.polygon.clear();
    s.polygon.extend_from_slice(&s.features[1 - side].spots);
    for k in 0..face.len() {
        let (p, q) = (face[k].at, face[(k + 1) % face.len()].at);
        let edge = q - p;
        let away = edge.cross(outward);
        clip(&s.polygon, (p, away, k as u32), &mut s.clipped);
        std::mem::swap(&mut s.polygon, &mut s.clipped);
    }
    let flag = if side == 0 { 0 } else { SECOND };
    for spot in &s.polygon {
        let height = outward.dot(spot.at - face[0].at);
        let foot = spot.at - outward * height;
        let center = spot.at + outward * spot.curve;
        let radius = [own.solid.round, other.solid.round + spot.curve];
        let raw = if side == 0 {
            Raw::on(spot.id | flag, (0, n), [foot, center], radius)
        } else {
            Raw::on(spot.id | flag, (1, n), [center, foot], [radius[1], radius[0]])
        };
        if raw.gap < reach {
            out.push(raw);
        }
    }
}

/// Sutherland–Hodgman against one plane through `p` with the outward vector `away` (of any length): a polygon, the two
/// ends of an edge, or a point.
fn clip(polygon: &[Spot], (p, away, plane): (V3<f64>, V3<f64>, u32), out: &mut Vec<Spot>) {
    out.clear();
    let length = away.dot(away).sqrt();
    if length == 0.0 {
        return out.extend_from_slice(polygon);
    }
    let beyond = |spot: &Spot| away.dot(spot.at - p) / length;
    // What lies on the border, up to rounding, is inside.
    let inside = |d: f64| d <= 1e-9 * length.max(1e-3);
    for (i, spot) in polygon.iter().enumerate() {
        let d = beyond(spot);
        if inside(d) {
            out.push(*spot);
        }
        let next = i + 1;
        if next == polygon.len() && polygon.len() < 3 {
            break;
        }
        let other = &polygon[next % polygon.len()];
        let e = beyond(other);
        if inside(d) != inside(e) {
            let t = d / (d - e);
            let at = spot.at + (other.at - spot.at) * t;
            let curve = spot.curve + (other.curve - spot.curve) * t;
            out.push(Spot { at, curve, id: crossing(spot.id, other.id, plane) });
        }
    }
}

/// A name for where the edge between two corners crosses a plane; the same seen from either end.
fn crossing(a: u32, b: u32, plane: u32) -> u32 {
    let (low, high) = (a.min(b), a.max(b));
    let mixed = low.wrapping_mul(0x9E37_79B1) ^ high.wrapping_mul(0x85EB_CA6B) ^ plane.wrapping_mul(0xC2B2_AE35);
    CROSSING | ((mixed ^ mixed >> 15) & 0x0FFF_FFFF)
}
