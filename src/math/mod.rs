//! Aliases over nalgebra's f64 types, frames, and the kernel's own small types.

mod flat;
pub mod frames;
mod lanes;
mod real;
mod sincos;
mod small;
mod twofold;
mod wide;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use flat::Flat;
pub use lanes::{Lane, Lanes4};
pub use real::{Fma, Real};
pub use sincos::sin_cos;
pub use small::{M3, S3, V3};
pub use twofold::Twofold;
pub(crate) use wide::wide;
#[cfg(target_arch = "x86_64")]
pub use x86::{X4, X8};

/// 3-vector.
pub type Vec3 = nalgebra::Vector3<f64>;
/// 3×3 matrix.
pub type Mat3 = nalgebra::Matrix3<f64>;
/// Unit quaternion.
pub type Quat = nalgebra::UnitQuaternion<f64>;
/// Rigid transform `X_AB`: coordinates in B → coordinates in A.
pub type Pose = nalgebra::Isometry3<f64>;

/// Velocity of a frame: angular (rad/s) first, linear (m/s) of its origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// rad/s.
    pub angular: Vec3,
    /// m/s.
    pub linear: Vec3,
}

/// Rotation of fixed-axis roll, pitch, yaw (URDF: R = Rz(yaw) Ry(pitch) Rx(roll)), with the same bits on every machine.
pub fn from_roll_pitch_yaw([roll, pitch, yaw]: [f64; 3]) -> Quat {
    let ((sr, cr), (sp, cp), (sy, cy)) = (sin_cos(0.5 * roll), sin_cos(0.5 * pitch), sin_cos(0.5 * yaw));
    Quat::new_unchecked(nalgebra::Quaternion::new(
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ))
}
