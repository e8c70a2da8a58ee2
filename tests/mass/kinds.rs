//! Random parameter sets of every kind of shape.

use proptest::prelude::*;
use realnoid::description::{Finish, Geometry, Scaling};
use realnoid::shape::Shape;

/// What a shape is made from: lengths (m), parts of a whole (0 … 1), angles, factors.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    pub lengths: [f64; 3],
    pub parts: [f64; 3],
    pub slice: [f64; 2],
    pub factors: [f64; 3],
}

/// Lengths and factors within a ratio of about 10.
pub fn ordinary() -> impl Strategy<Value = Draw> {
    let length = || 0.1..1.0f64;
    let part = || 0.1..0.9f64;
    let factor = || prop_oneof![0.3..3.0f64, -3.0..-0.3];
    (
        [length(), length(), length()],
        [part(), part(), part()],
        -3.0..3.0f64,
        0.1..6.2f64,
        [factor(), factor(), factor()],
    )
        .prop_map(|(lengths, parts, from, sweep, factors)| Draw {
            lengths,
            parts,
            slice: [from, from + sweep],
            factors,
        })
}

/// One length, part or factor after the other at 1 : 1000.
pub fn extreme() -> impl Strategy<Value = Draw> {
    (ordinary(), 0..12usize, any::<bool>()).prop_map(|(mut draw, which, both)| {
        let long = both && which < 6;
        match which {
            0..3 => draw.lengths[which] *= 1e-3,
            3..6 => draw.parts[which - 3] = if long { 0.999 } else { 0.001 },
            6..9 => draw.factors[which - 6] = if both { 1e-3 } else { 1e3 },
            9 => draw.slice[1] = draw.slice[0] + 1e-3,
            // Two of three: a needle.
            _ => (draw.lengths[0], draw.lengths[1]) = (draw.lengths[0] * 1e-3, draw.lengths[1] * 1e-3),
        }
        draw
    })
}

/// A geometry with room for fillets: the greatest radius at its rims, bottom and top.
pub type Make = fn(&Draw) -> (Geometry, f64);

pub fn plain(make: Make) -> impl Fn(&Draw) -> Shape {
    move |d| Shape::new(make(d).0).unwrap()
}

pub fn scaled(make: Make) -> impl Fn(&Draw) -> Shape {
    move |d| finished(make(d).0, Finish::default(), d.factors)
}

pub fn sliced(make: Make) -> impl Fn(&Draw) -> Shape {
    move |d| finished(make(d).0, Finish { slice: Some(d.slice), ..Finish::default() }, d.factors)
}

pub fn filleted(make: Make) -> impl Fn(&Draw) -> Shape {
    move |d| {
        let (geometry, room) = make(d);
        finished(geometry, Finish { fillet: room * d.parts[1], ..Finish::default() }, d.factors)
    }
}

pub fn all_at_once(make: Make) -> impl Fn(&Draw) -> Shape {
    move |d| {
        let (geometry, room) = make(d);
        let (fillet, top_fillet) = (room * d.parts[1], Some(room * d.parts[2]));
        let top_fillet = top_fillet.filter(|_| matches!(geometry, Geometry::Frustum { .. }));
        finished(geometry, Finish { fillet, top_fillet, slice: Some(d.slice), open: false }, d.factors)
    }
}

pub fn open(make: Make) -> impl Fn(&Draw) -> Shape {
    move |d| finished(make(d).0, Finish { open: true, ..Finish::default() }, d.factors)
}

fn finished(geometry: Geometry, finish: Finish, factors: [f64; 3]) -> Shape {
    Shape::finished(geometry, finish, Scaling { factors, ..Scaling::default() }).unwrap()
}

pub fn cuboid(d: &Draw) -> (Geometry, f64) {
    let least = d.lengths.iter().fold(f64::INFINITY, |a, b| a.min(*b));
    (Geometry::Box { size: d.lengths }, least / 2.0)
}

pub fn sphere(d: &Draw) -> (Geometry, f64) {
    (Geometry::Sphere { radius: d.lengths[0] }, 0.0)
}

pub fn ellipsoid(d: &Draw) -> (Geometry, f64) {
    (Geometry::Ellipsoid { radii: d.lengths }, 0.0)
}

pub fn hemisphere(d: &Draw) -> (Geometry, f64) {
    (Geometry::Hemisphere { radius: d.lengths[0] }, 0.0)
}

pub fn cylinder(d: &Draw) -> (Geometry, f64) {
    let [radius, _, length] = d.lengths;
    (Geometry::Cylinder { radius, length }, radius.min(length / 2.0))
}

pub fn elliptic_cylinder(d: &Draw) -> (Geometry, f64) {
    let [radius_x, radius_y, length] = d.lengths;
    (Geometry::EllipticCylinder { radius_x, radius_y, length }, radius_x.min(length / 2.0))
}

pub fn capsule(d: &Draw) -> (Geometry, f64) {
    let [radius, _, length] = d.lengths;
    (Geometry::Capsule { radius_top: radius, radius_bottom: radius, length }, 0.0)
}

pub fn tapered_capsule(d: &Draw) -> (Geometry, f64) {
    let [radius_top, radius_bottom, length] = d.lengths;
    (Geometry::Capsule { radius_top, radius_bottom, length }, 0.0)
}

pub fn tube(d: &Draw) -> (Geometry, f64) {
    let [outer_radius, _, length] = d.lengths;
    let inner_radius = outer_radius * d.parts[0];
    (Geometry::Tube { outer_radius, inner_radius, length }, (outer_radius - inner_radius).min(length) / 2.0)
}

pub fn cone(d: &Draw) -> (Geometry, f64) {
    let [radius_x, radius_y, length] = d.lengths;
    let room = rim_room([radius_x, 0.0], length).0 * radius_x.min(radius_x.hypot(length));
    (Geometry::Cone { radius_x, radius_y, length }, room)
}

pub fn frustum(d: &Draw) -> (Geometry, f64) {
    let [radius_x, radius_y, length] = d.lengths;
    let top_scale = 2.5 * d.parts[0];
    let top = radius_x * top_scale;
    let half_slant = (radius_x - top).hypot(length) / 2.0;
    let (low, high) = rim_room([radius_x, top], length);
    let room = (low * radius_x.min(half_slant)).min(high * top.min(half_slant));
    (Geometry::Frustum { radius_x, radius_y, top_scale, length }, room)
}

/// Radius of a fillet per length that it takes from its edges, at the bottom and the top rim.
fn rim_room([a, t]: [f64; 2], length: f64) -> (f64, f64) {
    let angle = length.atan2(a - t);
    ((angle / 2.0).tan(), 1.0 / (angle / 2.0).tan())
}

pub fn torus(d: &Draw) -> (Geometry, f64) {
    (Geometry::Torus { ring_radius: d.lengths[0], pipe_radius: d.lengths[0] * d.parts[0] }, 0.0)
}

pub fn oil_tank(d: &Draw) -> (Geometry, f64) {
    let [radius, _, length] = d.lengths;
    (Geometry::OilTank { radius, length, cap_height: radius * d.parts[0] }, 0.0)
}

pub fn pyramid(d: &Draw) -> (Geometry, f64) {
    (Geometry::Pyramid { size: d.lengths }, 0.0)
}

pub fn polyhedron(d: &Draw) -> (Geometry, f64) {
    let kind = (d.parts[1] * 5.0) as usize;
    (Geometry::Polyhedron { faces: [4, 6, 8, 12, 20][kind], radius: d.lengths[0] }, 0.0)
}

pub fn disc(d: &Draw) -> (Geometry, f64) {
    (Geometry::Disc { outer_radius: d.lengths[0], inner_radius: d.lengths[0] * d.parts[0] }, 0.0)
}

pub fn plane(d: &Draw) -> (Geometry, f64) {
    (Geometry::Plane { size: [d.lengths[0], d.lengths[1]] }, 0.0)
}

pub fn triangle(d: &Draw) -> (Geometry, f64) {
    let [a, b, c, _] = corners(d);
    (Geometry::Triangle { corners: [a, b, c] }, 0.0)
}

pub fn quad(d: &Draw) -> (Geometry, f64) {
    // One so warped that no diagonal splits it into two triangles of the same side is laid flat.
    let warped = Geometry::Quad { corners: corners(d) };
    let flat = || Geometry::Quad { corners: corners(d).map(|[x, y, _]| [x, y, 0.0]) };
    (if Shape::new(warped.clone()).is_ok() { warped } else { flat() }, 0.0)
}

fn corners(d: &Draw) -> [[f64; 3]; 4] {
    let ([x, y, z], [p, q, r]) = (d.lengths, d.parts);
    [[0.0, 0.0, z * p], [x, y * q, 0.0], [x * r, y, z], [-x * q, y * p, z * r]]
}
