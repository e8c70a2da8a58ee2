//! Shapes that a lathe makes: an outline in the half plane (ρ, z), turned about Z, then stretched along the axes.
//!
//! One description serves the volume, the surface, the polygon mesh and the support of every round shape.

use super::Shape;
use crate::description::{Finish, Geometry};
use crate::math::sin_cos;
use std::f64::consts::{FRAC_PI_2, TAU};

/// One smooth piece of an outline; points are (ρ, z) in metres, ρ ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the sentence at each variant tells its fields")]
pub enum Piece {
    /// Straight.
    Line { from: [f64; 2], to: [f64; 2] },
    /// Part of a circle: angles in rad from +ρ towards +z, `to` > `from`.
    Arc { center: [f64; 2], radius: f64, from: f64, to: f64 },
}

impl Piece {
    /// Point at `t` from 0 to 1.
    pub fn at(&self, t: f64) -> [f64; 2] {
        match *self {
            Self::Line { from, to } => [from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t],
            Self::Arc { center, radius, from, to } => {
                let angle = from + (to - from) * t;
                let (sine, cosine) = sin_cos(angle);
                [center[0] + radius * cosine, center[1] + radius * sine]
            }
        }
    }

    /// Derivative of [`Self::at`] with respect to t, m.
    pub fn slope(&self, t: f64) -> [f64; 2] {
        match *self {
            Self::Line { from, to } => [to[0] - from[0], to[1] - from[1]],
            Self::Arc { radius, from, to, .. } => {
                let angle = from + (to - from) * t;
                let (sine, cosine) = sin_cos(angle);
                [-radius * (to - from) * sine, radius * (to - from) * cosine]
            }
        }
    }
}

/// An outline to be turned. The inside is on the left of its pieces (anticlockwise with ρ to the right and z up).
#[derive(Clone, Debug, PartialEq)]
pub struct Lathe {
    /// Connected, in order. A closed outline ends where it begins, or begins and ends on the axis.
    pub pieces: Vec<Piece>,
    /// Does the outline enclose an inside (alone, or together with the axis)?
    pub closed: bool,
    /// Only the part between these angles about Z, rad; of a closed outline the two cuts are closed as well.
    pub slice: Option<[f64; 2]>,
    /// Factors along X, Y, Z, applied last.
    pub stretch: [f64; 3],
}

impl Lathe {
    /// The angles about Z, rad.
    pub fn turn(&self) -> [f64; 2] {
        self.slice.unwrap_or([0.0, TAU])
    }
}

/// The outline of a round shape; `None` for the others.
pub fn lathe(shape: &Shape) -> Option<Lathe> {
    let corners = profile(&shape.geometry, &shape.finish);
    let pieces = match corners {
        Some(corners) => rounded(&corners),
        None => arcs(&shape.geometry)?,
    };
    let [x, y, z] = shape.stretch;
    let [own_x, own_y, own_z] = own_stretch(&shape.geometry);
    Some(Lathe {
        pieces,
        closed: !shape.is_open(),
        slice: shape.finish.slice,
        stretch: [x * own_x, y * own_y, z * own_z],
    })
}

/// An elliptic shape is a round one of radius `radius_x`, stretched along Y; an ellipsoid a unit sphere.
fn own_stretch(geometry: &Geometry) -> [f64; 3] {
    match *geometry {
        Geometry::Ellipsoid { radii } => radii,
        Geometry::EllipticCylinder { radius_x, radius_y, .. }
        | Geometry::Cone { radius_x, radius_y, .. }
        | Geometry::Frustum { radius_x, radius_y, .. } => [1.0, radius_y / radius_x, 1.0],
        _ => [1.0; 3],
    }
}

/// A corner of a straight-edged outline and the radius by which it is rounded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    at: [f64; 2],
    fillet: f64,
}

/// The corners of the shapes that have fillets, and of other straight-edged ones. A closed loop repeats its first corner.
pub(super) fn profile(geometry: &Geometry, finish: &Finish) -> Option<Vec<Corner>> {
    let (low, high) = (finish.fillet, finish.top_fillet.unwrap_or(finish.fillet));
    let sharp = |rho: f64, z: f64| Corner { at: [rho, z], fillet: 0.0 };
    let round = |rho: f64, z: f64, fillet: f64| Corner { at: [rho, z], fillet };
    let mantle = |radius: f64, top: f64, length: f64| {
        let h = length / 2.0;
        match (finish.open, top > 0.0) {
            (true, _) => vec![sharp(radius, -h), sharp(top, h)],
            (false, true) => vec![sharp(0.0, -h), round(radius, -h, low), round(top, h, high), sharp(0.0, h)],
            (false, false) => vec![sharp(0.0, -h), round(radius, -h, low), sharp(0.0, h)],
        }
    };
    Some(match *geometry {
        Geometry::Cylinder { radius, length } | Geometry::EllipticCylinder { radius_x: radius, length, .. } => {
            mantle(radius, radius, length)
        }
        Geometry::Cone { radius_x, length, .. } => mantle(radius_x, 0.0, length),
        Geometry::Frustum { radius_x, top_scale, length, .. } => mantle(radius_x, radius_x * top_scale, length),
        Geometry::Tube { outer_radius: o, inner_radius: i, length } => {
            let h = length / 2.0;
            // Starts in the middle of an edge, so that every corner can be rounded.
            let start = sharp(i, 0.0);
            vec![start, round(i, -h, low), round(o, -h, low), round(o, h, low), round(i, h, low), start]
        }
        Geometry::Disc { outer_radius, inner_radius } => vec![sharp(outer_radius, 0.0), sharp(inner_radius, 0.0)],
        _ => return None,
    })
}

fn arcs(geometry: &Geometry) -> Option<Vec<Piece>> {
    let arc = |center: [f64; 2], radius: f64, from: f64, to: f64| Piece::Arc { center, radius, from, to };
    let pieces = match *geometry {
        Geometry::Sphere { radius } => vec![arc([0.0, 0.0], radius, -FRAC_PI_2, FRAC_PI_2)],
        Geometry::Ellipsoid { .. } => vec![arc([0.0, 0.0], 1.0, -FRAC_PI_2, FRAC_PI_2)],
        Geometry::Hemisphere { radius } => vec![arc([0.0, 0.0], radius, 0.0, FRAC_PI_2)],
        Geometry::Torus { ring_radius, pipe_radius } => vec![arc([ring_radius, 0.0], pipe_radius, 0.0, TAU)],
        Geometry::Capsule { radius_top, radius_bottom, length } => {
            let h = length / 2.0;
            vec![
                arc([0.0, -h], radius_bottom, -FRAC_PI_2, 0.0),
                Piece::Line { from: [radius_bottom, -h], to: [radius_top, h] },
                arc([0.0, h], radius_top, 0.0, FRAC_PI_2),
            ]
        }
        Geometry::OilTank { radius, length, cap_height } => {
            let h = length / 2.0;
            // The sphere through the rim and the pole, and the height of its centre above the rim.
            let ball = (radius * radius + cap_height * cap_height) / (2.0 * cap_height);
            let below = ball - cap_height;
            let rim = below.atan2(radius);
            vec![
                arc([0.0, below - h], ball, -FRAC_PI_2, -rim),
                Piece::Line { from: [radius, -h], to: [radius, h] },
                arc([0.0, h - below], ball, rim, FRAC_PI_2),
            ]
        }
        _ => return None,
    };
    Some(pieces.into_iter().filter(has_length).collect())
}

fn has_length(piece: &Piece) -> bool {
    match *piece {
        Piece::Line { from, to } => from != to,
        Piece::Arc { radius, .. } => radius > 0.0,
    }
}

/// Where the rounding of a corner leaves its edges: the distance along both, and the half of its inner angle.
struct Rounding {
    before: [f64; 2],
    after: [f64; 2],
    half: f64,
    leave: f64,
}

fn rounding(corners: &[Corner], i: usize) -> Option<Rounding> {
    let corner = corners[i];
    if corner.fillet == 0.0 {
        return None;
    }
    let before = direction(corner.at, corners[i - 1].at)?;
    let after = direction(corner.at, corners[i + 1].at)?;
    let cosine = before[0] * after[0] + before[1] * after[1];
    let sine = before[0] * after[1] - before[1] * after[0];
    // Not by the cosine alone, which says nothing about the angle of a flat cone's rim.
    let half = sine.abs().atan2(cosine) / 2.0;
    Some(Rounding { before, after, half, leave: corner.fillet / half.tan() })
}

fn direction(from: [f64; 2], to: [f64; 2]) -> Option<[f64; 2]> {
    let (x, z) = (to[0] - from[0], to[1] - from[1]);
    let length = x.hypot(z);
    (length > 0.0).then(|| [x / length, z / length])
}

/// Do all fillets find room on their edges?
pub(super) fn fits(corners: &[Corner]) -> bool {
    let leave = |i: usize| rounding(corners, i).map_or(0.0, |r| r.leave);
    (1..corners.len()).all(|i| {
        let [a, b] = [corners[i - 1].at, corners[i].at];
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        // A fillet of exactly half the edge may miss it by a rounding.
        leave(i - 1) + leave(i) <= length * (1.0 + 4.0 * f64::EPSILON)
    })
}

/// The outline with each corner rounded by an arc that touches both its edges. All corners are convex.
fn rounded(corners: &[Corner]) -> Vec<Piece> {
    let mut pieces = Vec::with_capacity(2 * corners.len());
    let mut from = corners[0].at;
    for i in 1..corners.len() {
        let corner = corners[i];
        let Some(r) = (i + 1 < corners.len()).then(|| rounding(corners, i)).flatten() else {
            pieces.push(Piece::Line { from, to: corner.at });
            from = corner.at;
            continue;
        };
        let along = |d: [f64; 2]| [corner.at[0] + d[0] * r.leave, corner.at[1] + d[1] * r.leave];
        let (start, end) = (along(r.before), along(r.after));
        let inward = [r.before[0] + r.after[0], r.before[1] + r.after[1]];
        let depth = corner.fillet / r.half.sin() / inward[0].hypot(inward[1]);
        let center = [corner.at[0] + inward[0] * depth, corner.at[1] + inward[1] * depth];
        let angle = (start[1] - center[1]).atan2(start[0] - center[0]);
        let sweep = std::f64::consts::PI - 2.0 * r.half;
        pieces.push(Piece::Line { from, to: start });
        pieces.push(Piece::Arc { center, radius: corner.fillet, from: angle, to: angle + sweep });
        from = end;
    }
    pieces.into_iter().filter(has_length).collect()
}
