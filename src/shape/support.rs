//! The point of a shape that lies furthest in a direction: what bounds and contacts ask for.

use super::outline::{Lathe, Piece, lathe};
use super::tessellate::tessellate;
use super::{MeshFault, Meshes, Shape};
use crate::description::{Geometry, Subdivision};
use crate::math::{Vec3, sin_cos};
use std::f64::consts::TAU;

/// A shape prepared for asking its support function many times. Exact for every shape, sliced, filleted, stretched and
/// mirrored ones included, up to rounding: in closed form for round shapes and boxes, by corners for shapes with
/// straight edges, terrains and mesh files.
#[derive(Clone, Debug)]
pub struct Support {
    form: Form,
    stretch: Vec3,
}

#[derive(Clone, Debug)]
enum Form {
    Turned(Lathe),
    /// Balls of radius `fillet` around all points of a box.
    Box {
        half: Vec3,
        fillet: f64,
    },
    /// The convex hull of these.
    Corners(Vec<Vec3>),
}

impl Support {
    /// Of one shape.
    ///
    /// # Errors
    /// A mesh or height file is not found or not read, or holds no triangle.
    pub fn of(shape: &Shape, meshes: &Meshes) -> Result<Self, MeshFault> {
        if let Some(lathe) = lathe(shape) {
            return Ok(Self { stretch: lathe.stretch.into(), form: Form::Turned(lathe) });
        }
        if let Geometry::Box { size } = shape.geometry {
            let fillet = shape.finish.fillet;
            let half = Vec3::from(size).map(|s| (s / 2.0 - fillet).max(0.0));
            return Ok(Self { form: Form::Box { half, fillet }, stretch: shape.stretch.into() });
        }
        let mesh = tessellate(shape, Subdivision { around: 3, flat: 1 }, meshes)?;
        if mesh.vertices.is_empty() {
            return Err(MeshFault::NotFound(format!("a <{}> without a single corner", shape.geometry.kind())));
        }
        // The stretch is in the corners already.
        Ok(Self { form: Form::Corners(mesh.vertices), stretch: Vec3::repeat(1.0) })
    }

    /// A point of the shape that no other point exceeds in `direction` (of any length; 0 gives any point), both in the
    /// shape's frame, metres.
    pub fn point(&self, direction: &Vec3) -> Vec3 {
        // d·(S p) = (S d)·p: the furthest point of the plain shape in the direction S d.
        let pulled = direction.component_mul(&self.stretch);
        let plain = match &self.form {
            Form::Turned(lathe) => furthest_turned(lathe, &pulled),
            Form::Box { half, fillet } => {
                half.zip_map(&pulled, f64::copysign) + pulled.try_normalize(0.0).unwrap_or(Vec3::zeros()) * *fillet
            }
            Form::Corners(corners) => furthest_corner(corners, &pulled),
        };
        plain.component_mul(&self.stretch)
    }
}

fn furthest_corner(corners: &[Vec3], direction: &Vec3) -> Vec3 {
    let further = |best: (Vec3, f64), p: &Vec3| {
        let reach = p.dot(direction);
        if reach > best.1 { (*p, reach) } else { best }
    };
    corners.iter().fold((corners[0], f64::NEG_INFINITY), further).0
}

/// First the best angle about the axis, the same for every point of the outline; then the best point of the outline.
fn furthest_turned(lathe: &Lathe, direction: &Vec3) -> Vec3 {
    let across = direction.x.hypot(direction.y);
    let whole = if across > 0.0 { [direction.x / across, direction.y / across] } else { [1.0, 0.0] };
    let toward = match lathe.slice {
        Some(slice) => nearest_in_slice(whole, slice),
        None => whole,
    };
    // How much one metre along that angle gains: negative where the slice lies on the far side.
    let outward = direction.x * toward[0] + direction.y * toward[1];
    let [rho, z] = furthest_of_outline(&lathe.pieces, [outward, direction.z]);
    Vec3::new(rho * toward[0], rho * toward[1], z)
}

/// The direction within a slice that has the greatest cosine to `toward`; both are unit vectors.
fn nearest_in_slice(toward: [f64; 2], [from, to]: [f64; 2]) -> [f64; 2] {
    let angle = toward[1].atan2(toward[0]);
    if (angle - from).rem_euclid(TAU) <= to - from {
        return toward;
    }
    let ends = [from, to].map(|end| {
        let (sine, cosine) = sin_cos(end);
        [cosine, sine]
    });
    let cosine = |end: [f64; 2]| end[0] * toward[0] + end[1] * toward[1];
    if cosine(ends[0]) >= cosine(ends[1]) { ends[0] } else { ends[1] }
}

fn furthest_of_outline(pieces: &[Piece], direction: [f64; 2]) -> [f64; 2] {
    let ends = pieces.iter().flat_map(|piece| [piece.at(0.0), piece.at(1.0)]);
    let tops = pieces.iter().filter_map(|piece| top_of_arc(piece, direction));
    let further = |best: ([f64; 2], f64), p: [f64; 2]| {
        let reach = p[0] * direction[0] + p[1] * direction[1];
        if reach > best.1 { (p, reach) } else { best }
    };
    ends.chain(tops).fold(([0.0; 2], f64::NEG_INFINITY), further).0
}

/// Where the full circle of an arc reaches furthest, if the arc passes there.
fn top_of_arc(piece: &Piece, direction: [f64; 2]) -> Option<[f64; 2]> {
    let Piece::Arc { center, radius, from, to } = *piece else { return None };
    let length = direction[0].hypot(direction[1]);
    let angle = direction[1].atan2(direction[0]);
    let passes = length > 0.0 && (angle - from).rem_euclid(TAU) <= to - from;
    passes.then(|| [center[0] + radius * direction[0] / length, center[1] + radius * direction[1] / length])
}
