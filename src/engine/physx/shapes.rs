//! Shapes that collide, as PhysX has them: balls, boxes, capsules, planes, meshes that stand still; what is put together from
//! them; and convex polyhedra of at most 255 corners and faces for the rest.

use super::spec::Form;
use super::sys::{NoHull, cook_hull, cook_mesh};
use crate::engine::outline::{AROUND, ellipsoid, rim};
use crate::math::{Mat3, Pose, Quat, V3, Vec3};
use crate::shape::{ContactForm, TriMesh};
use nalgebra::{SymmetricEigen, Translation3, Unit};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Corners around an ellipsoid and bands from pole to pole: 242 faces, whose middles are about 1 % of the radius too low.
const BANDS: (u32, u32) = (22, 11);
/// Directions of a hull whose corners are kept if it has too many: 128 corners have at most 252 faces.
const FEW: (u32, u32) = (14, 10);
/// A box that is thinner than this is none, m.
const THIN: f64 = 1e-6;
/// Corners are in a plane if they are off it by less than this share of their size.
const LEVEL: f64 = 1e-4;
/// Half the thickness of a plate, as a share of its size.
const PLATE: f64 = 2e-3;

/// What becomes of a shape.
#[derive(Clone, Debug)]
pub struct Made {
    /// Its parts, with their frames in that of the form.
    pub parts: Vec<(Form, Pose)>,
    /// It is not quite the shape: what it is instead.
    pub instead: Option<&'static str>,
}

/// What becomes of a shape. `None` if PhysX cannot make it: corners that lie on a line or so.
pub fn make(form: &ContactForm) -> Option<Made> {
    let exact = |parts| Some(Made { parts, instead: None });
    let at = |z: f64| Pose::translation(0.0, 0.0, z);
    match form {
        ContactForm::HalfSpace => exact(vec![(Form::HalfSpace, along([0.0, 0.0, 1.0]))]),
        ContactForm::Ball { radius } => exact(vec![ball(*radius, Pose::identity())]),
        ContactForm::Cuboid { half } => exact(vec![cuboid(*half)]),
        ContactForm::RoundCuboid { half, radius } => exact(round_cuboid(*half, *radius)),
        ContactForm::Capsule { bottom, top, half } if bottom == top => {
            exact(vec![capsule(*bottom, *half, along([0.0, 0.0, 1.0]))])
        }
        ContactForm::Capsule { bottom, top, half } => {
            let mut parts = vec![ball(*bottom, at(-half)), ball(*top, at(*half))];
            // Where a common tangent touches them.
            let sine = (bottom - top) / (2.0 * half);
            if sine.abs() < 1.0 {
                let cosine = (1.0 - sine * sine).sqrt();
                let ring = |r: f64, z: f64| rim([r * cosine; 2], z + r * sine, AROUND);
                parts.push(hull(&[ring(*bottom, -half), ring(*top, *half)].concat())?);
            }
            Some(Made { parts, instead: Some(ROUND) })
        }
        ContactForm::Ellipsoid { radii } => polyhedron(&ellipsoid(*radii, 0.0, BANDS), Some(ROUND)),
        ContactForm::Cylinder { radius, half } => {
            polyhedron(&[rim([*radius; 2], -half, AROUND), rim([*radius; 2], *half, AROUND)].concat(), Some(ROUND))
        }
        ContactForm::Cone { radius, half } => {
            polyhedron(&[rim([*radius; 2], -half, AROUND), rim([0.0; 2], *half, AROUND)].concat(), Some(ROUND))
        }
        ContactForm::Frustum { radii, top, half } => {
            polyhedron(&[rim(*radii, -half, AROUND), rim(radii.map(|r| r * top), *half, AROUND)].concat(), Some(ROUND))
        }
        ContactForm::Hull(corners) => polyhedron(&corners.iter().map(|p| V3::from(*p)).collect::<Vec<_>>(), None),
        // Surfaces are made by themselves: that is long, and nobody needs it to tell what becomes of them.
        ContactForm::Surface(_) => exact(vec![]),
    }
}

/// A surface of triangles.
///
/// # Errors
/// What PhysX cannot take.
pub fn surface(mesh: &TriMesh) -> Result<Form, String> {
    let corners: Vec<V3<f64>> = mesh.vertices.iter().map(|p| V3::from(*p)).collect();
    cook_mesh(&single(&corners), &mesh.triangles).map(|cooked| Form::Mesh(Arc::new(cooked)))
}

const ROUND: &str = "it collides as a polyhedron";
const COARSE: &str = "it collides as the hull of 128 of its corners";
const FLAT: &str = "it collides as a plate whose thickness is 0.4 % of its size";

fn polyhedron(corners: &[V3<f64>], instead: Option<&'static str>) -> Option<Made> {
    let plate = plate_of(corners);
    let instead = if plate.is_some() { Some(FLAT) } else { instead };
    if plate.as_deref().is_some_and(|plate| plate_of(plate).is_some()) {
        // They lie on a line.
        return None;
    }
    let corners = plate.as_deref().unwrap_or(corners);
    match cook_hull(&single(corners)) {
        Ok(cooked) => Some(Made { parts: vec![(Form::Hull(Arc::new(cooked)), Pose::identity())], instead }),
        Err(NoHull::Flat) => None,
        Err(NoHull::TooMany) => Some(Made { parts: vec![hull(&fewer(corners))?], instead: instead.or(Some(COARSE)) }),
    }
}

/// Corners that lie in a plane, each of them twice: PhysX makes a box of them, in silence. `None` if they do not.
fn plate_of(corners: &[V3<f64>]) -> Option<Vec<V3<f64>>> {
    let all: Vec<Vec3> = corners.iter().map(|p| Vec3::from(*p)).collect();
    let center = all.iter().sum::<Vec3>() / all.len().max(1) as f64;
    let spread: Mat3 = all.iter().map(|p| (p - center) * (p - center).transpose()).sum();
    let eigen = SymmetricEigen::new(spread);
    let normal: Vec3 = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
    let size = all.iter().map(|p| (p - center).norm()).fold(0.0, f64::max);
    let thick = all.iter().map(|p| (p - center).dot(&normal).abs()).fold(0.0, f64::max);
    let up = normal * (PLATE * size);
    let both = || all.iter().flat_map(|p| [V3::from(p - up), V3::from(p + up)]);
    (thick < (LEVEL * size).max(THIN)).then(|| both().collect())
}

fn hull(corners: &[V3<f64>]) -> Option<(Form, Pose)> {
    let cooked = cook_hull(&single(corners)).ok()?;
    Some((Form::Hull(Arc::new(cooked)), Pose::identity()))
}

fn ball(radius: f64, at: Pose) -> (Form, Pose) {
    (Form::Ball(radius as f32), at)
}

fn cuboid(half: [f64; 3]) -> (Form, Pose) {
    (Form::Cuboid(half.map(|x| x as f32)), Pose::identity())
}

/// Along the x of its frame.
fn capsule(radius: f64, half: f64, at: Pose) -> (Form, Pose) {
    if half < THIN { ball(radius, at) } else { (Form::Capsule(radius as f32, half as f32), at) }
}

/// A cross of three boxes, and a capsule along each edge.
fn round_cuboid(half: [f64; 3], radius: f64) -> Vec<(Form, Pose)> {
    let grown = |axis: usize| {
        let mut half = half;
        half[axis] += radius;
        half
    };
    let boxes = [0, 1, 2].map(grown).into_iter().filter(|half| half.iter().all(|x| *x > THIN)).map(cuboid);
    let edge = |axis: usize, side: usize| {
        let (mut turn, mut center) = ([0.0; 3], [0.0; 3]);
        turn[axis] = 1.0;
        for (k, other) in [(axis + 1) % 3, (axis + 2) % 3].into_iter().enumerate() {
            center[other] = if side >> k & 1 == 1 { half[other] } else { -half[other] };
        }
        capsule(radius, half[axis], Pose::from_parts(Translation3::from(center), along(turn).rotation))
    };
    boxes.chain((0..3).flat_map(|axis| (0..4).map(move |side| edge(axis, side)))).collect()
}

/// Turned so that x looks along an axis.
fn along(axis: [f64; 3]) -> Pose {
    let about = Vec3::x().cross(&Vec3::from(axis));
    let turn = Unit::try_new(about, 0.5).map_or(Quat::identity(), |about| Quat::from_axis_angle(&about, FRAC_PI_2));
    Pose::from_parts(Translation3::identity(), turn)
}

/// The outermost corners in some directions.
fn fewer(corners: &[V3<f64>]) -> Vec<V3<f64>> {
    let farthest = |way: V3<f64>| {
        let by_reach = |a: &&V3<f64>, b: &&V3<f64>| way.dot(**a).total_cmp(&way.dot(**b));
        corners.iter().max_by(by_reach).copied()
    };
    ellipsoid([1.0; 3], 0.0, FEW).into_iter().filter_map(farthest).collect()
}

fn single(corners: &[V3<f64>]) -> Vec<[f32; 3]> {
    corners.iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect()
}
