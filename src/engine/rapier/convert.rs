//! Between our vectors and rapier's.

use crate::math::{M3, Pose as OurPose, V3, Vec3};
use rapier3d_f64::math::{Pose, Rotation, Vector};

pub(super) fn vector(v: V3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

pub(super) fn ours(v: Vector) -> V3<f64> {
    V3::new(v.x, v.y, v.z)
}

pub(super) fn point(v: &Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

pub(super) fn pose(p: &OurPose) -> Pose {
    (*p).into()
}

/// A pose from axes and an origin.
pub(super) fn frame(r: &M3<f64>, p: V3<f64>) -> Pose {
    let rotation = rapier3d_f64::math::Matrix::from_cols(vector(r.col0()), vector(r.col1()), vector(r.col2()));
    Pose::from_parts(vector(p), Rotation::from_mat3(&rotation).normalize())
}

/// The axes of a rotation, as columns of a matrix.
pub(super) fn axes(q: &Rotation) -> M3<f64> {
    let [w, x, y, z] = [q.w, q.x, q.y, q.z];
    crate::model::rotation([w, x, y, z])
}

/// A frame at the origin whose x looks along a unit vector.
pub(super) fn facing(x: V3<f64>) -> M3<f64> {
    let away = if x.x.abs() < 0.6 { V3::new(1.0, 0.0, 0.0) } else { V3::new(0.0, 1.0, 0.0) };
    let y = x.cross(away);
    let y = y * (1.0 / y.dot(y).sqrt());
    let z = x.cross(y);
    M3::rows(V3::new(x.x, y.x, z.x), V3::new(x.y, y.y, z.y), V3::new(x.z, y.z, z.z))
}
