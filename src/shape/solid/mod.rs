//! Is a mesh the surface of a solid (B-20)? What can be repaired for certain is repaired, and told.
//!
//! Closed means: at every edge the triangles that run along it one way are as many as those that run the other way. Then
//! the mesh is a boundary, and volume integrals over it mean something, whether or not it touches itself.

mod cracks;
mod edges;
mod orient;
mod parts;
mod winding;

use super::TriMesh;
use crate::math::Vec3;
use edges::Edges;
use std::collections::HashSet;

/// What a sentence of [`closed_solid`] holds if it tells of parts that share space.
pub const COUNTS_TWICE: &str = "counts twice";

/// Why a mesh is not the surface of a solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolidFault {
    /// Holes, or walls that end inside.
    #[error(
        "the mesh is not closed: {} with an odd number of triangles (holes, or loose walls), the first between {} and {}",
        count(*edges, "edge", "edges"), place(&at[0]), place(&at[1])
    )]
    NotClosed {
        /// How many such edges.
        edges: usize,
        /// The ends of the first, m.
        at: [Vec3; 2],
    },
    /// Like a Möbius band or a Klein bottle.
    #[error("the mesh has no inside: its surface comes back to itself turned over, at {}", place(.at))]
    NotOrientable {
        /// Where it was noticed, m.
        at: Vec3,
    },
    /// Walls that meet at an edge and face it in ways that cannot all be right.
    #[error(
        "the mesh contradicts itself: {} where more than two triangles meet and their sides do not match, the first at {}",
        count(*edges, "edge", "edges"), place(at)
    )]
    Contradiction {
        /// How many such edges.
        edges: usize,
        /// The middle of the first, m.
        at: Vec3,
    },
    /// No triangle has an area.
    #[error("all {triangles} triangles of the mesh have no area")]
    Degenerate {
        /// How many there are.
        triangles: usize,
    },
    /// A closed surface around nothing, such as both sides of a sheet.
    #[error("the mesh is closed, but encloses no volume ({volume:e} m³)")]
    NoVolume {
        /// What integration gives, m³.
        volume: f64,
    },
    /// A mesh that was not read from a file: an index or a coordinate is none.
    #[error("triangle {triangle} of the mesh has a corner that does not exist or is no place")]
    Malformed {
        /// Counted from 0.
        triangle: usize,
    },
}

/// "1 part", "2 parts".
fn count(n: usize, one: &str, more: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { more })
}

fn place(p: &Vec3) -> String {
    format!("({:.6}, {:.6}, {:.6})", p.x, p.y, p.z)
}

/// A sheet folded to and fro encloses no volume but rounding errors: those of a sum over the triangles are bounded by
/// the machine's precision × area × diagonal, with some room for their number.
const LEAST_VOLUME: f64 = 1e-12;

/// The mesh as a closed surface facing outwards, and what was repaired, one sentence each; empty: nothing. A sentence
/// may also tell of parts inside one another, whose common space counts twice.
///
/// # Errors
/// What makes it no solid.
pub fn closed_solid(mesh: TriMesh) -> Result<(TriMesh, Vec<String>), SolidFault> {
    let mut mesh = mesh;
    let mut told = Vec::new();
    check(&mesh)?;
    drop_useless(&mut mesh, &mut told);
    mesh = mesh.without_strays();
    let mut edges = Edges::of(&mesh.triangles);
    if edges.odd() > 0
        && let Some(welded) = cracks::weld(&mut mesh, &edges)
    {
        told.push(welded);
        drop_useless(&mut mesh, &mut told);
        mesh = mesh.without_strays();
        edges = Edges::of(&mesh.triangles);
    }
    if let Some(edge) = edges.first_odd() {
        return Err(SolidFault::NotClosed { edges: edges.odd(), at: edge.map(|i| mesh.vertices[i as usize]) });
    }
    if !edges.balanced() {
        orient::agree(&mut mesh, &edges, &mut told)?;
        edges = Edges::of(&mesh.triangles);
    }
    parts::face_outwards(&mut mesh, &edges, &mut told);
    let volume = mesh.triangles.iter().map(|t| six_volumes(&mesh, *t)).sum::<f64>() / 6.0;
    let sound = volume > LEAST_VOLUME * area(&mesh) * diagonal(&mesh) && volume.is_finite();
    if sound { Ok((mesh, told)) } else { Err(SolidFault::NoVolume { volume }) }
}

fn check(mesh: &TriMesh) -> Result<(), SolidFault> {
    let exists = |i: &u32| mesh.vertices.get(*i as usize).is_some_and(|v| v.iter().all(|x| x.is_finite()));
    if let Some(triangle) = mesh.triangles.iter().position(|t| !t.iter().all(exists)) {
        return Err(SolidFault::Malformed { triangle });
    }
    let has_area = |t: &[u32; 3]| {
        let [a, b, c] = mesh.corners(*t);
        (b - a).cross(&(c - a)).norm_squared() > 0.0
    };
    if mesh.triangles.iter().any(has_area) {
        return Ok(());
    }
    Err(SolidFault::Degenerate { triangles: mesh.triangles.len() })
}

/// Drops triangles with two equal corners, and all but one of those that are there more than once.
fn drop_useless(mesh: &mut TriMesh, told: &mut Vec<String>) {
    let before = mesh.triangles.len();
    mesh.triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    let flat = before - mesh.triangles.len();
    if flat > 0 {
        told.push(format!("triangles with two equal corners were left out: {flat} of {before}"));
    }
    let before = mesh.triangles.len();
    let mut seen = HashSet::with_capacity(before);
    let mut kept = mesh.triangles.clone();
    kept.retain(|t| seen.insert(from_least(*t)));
    let twice = before - kept.len();
    if twice == 0 {
        return;
    }
    // Where a surface runs along itself, two equal triangles can both be needed.
    let needed = Edges::of(&mesh.triangles).balanced() && !Edges::of(&kept).balanced();
    if !needed {
        mesh.triangles = kept;
        told.push(format!("triangles that are there more than once were left out: {twice} of {before}"));
    }
}

/// The same triangle, starting with its least corner.
fn from_least([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Six times the signed volume between a triangle and the first vertex of the mesh.
fn six_volumes(mesh: &TriMesh, triangle: [u32; 3]) -> f64 {
    let origin = mesh.vertices[0];
    let [a, b, c] = mesh.corners(triangle).map(|p| p - origin);
    a.dot(&b.cross(&c))
}

fn area(mesh: &TriMesh) -> f64 {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = mesh.corners(*t);
        (b - a).cross(&(c - a)).norm() / 2.0
    };
    mesh.triangles.iter().map(area).sum()
}

/// Of the box around the triangles, m.
fn diagonal(mesh: &TriMesh) -> f64 {
    let used = || mesh.triangles.iter().flatten().map(|i| mesh.vertices[*i as usize]);
    let (min, max) = used().fold((Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)), |(min, max), v| {
        (min.inf(&v), max.sup(&v))
    });
    (max - min).norm()
}
