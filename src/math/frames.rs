//! Native frame ↔ REP-103 (G-2, G-3).
//!
//! Native: Y up, left-handed, X right, Z forward, row vectors (v′ = v·M). REP-103: X forward, Y left, Z up,
//! right-handed, column vectors (v′ = R·v). So native (x, y, z) is REP-103 (z, −x, y): a mapping C with det C = −1.
//! A positive native angle turns Y→Z, Z→X, X→Y (the same formulas as in a right-handed system, which in a left-handed
//! one is the left-hand rule). The source gives the order of the angles, H → P → B, but not their sign: this is our
//! reading, written down in `tests/frames.rs`.

use super::{Mat3, Vec3};

/// C: native coordinates → REP-103 coordinates of a polar vector. Orthogonal, det −1.
const TO_REP103: Mat3 = Mat3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0);

/// Length unit of native positions (G-9).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthUnit {
    /// 1 m.
    #[default]
    Metre,
    /// 0.01 m.
    Centimetre,
    /// 0.001 m.
    Millimetre,
}

impl LengthUnit {
    /// How many of this unit make a metre.
    fn per_metre(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 100.0,
            Self::Millimetre => 1000.0,
        }
    }
}

/// A direction, velocity or force from native to REP-103; its unit is kept.
pub fn vector_to_rep103(native: Vec3) -> Vec3 {
    Vec3::new(native.z, -native.x, native.y)
}

/// A direction, velocity or force from REP-103 to native; its unit is kept.
pub fn vector_to_native(rep103: Vec3) -> Vec3 {
    Vec3::new(-rep103.y, rep103.z, rep103.x)
}

/// A position from native, in `unit`, to REP-103, in metres.
pub fn position_to_rep103(native: Vec3, unit: LengthUnit) -> Vec3 {
    vector_to_rep103(native) / unit.per_metre()
}

/// A position from REP-103, in metres, to native, in `unit`.
pub fn position_to_native(rep103: Vec3, unit: LengthUnit) -> Vec3 {
    vector_to_native(rep103) * unit.per_metre()
}

/// An axial vector (rotation axis, angular velocity, torque) from native to REP-103: the change of handedness turns
/// its sign over against [`vector_to_rep103`].
pub fn axis_to_rep103(native: Vec3) -> Vec3 {
    -vector_to_rep103(native)
}

/// An axial vector (rotation axis, angular velocity, torque) from REP-103 to native.
pub fn axis_to_native(rep103: Vec3) -> Vec3 {
    -vector_to_native(rep103)
}

/// A 3×3 matrix from native (row vectors; for a rotation the rows are the frame's axes) to REP-103 (column vectors;
/// the columns are the frame's axes).
pub fn matrix_to_rep103(native: &Mat3) -> Mat3 {
    TO_REP103 * native.transpose() * TO_REP103.transpose()
}

/// A 3×3 matrix from REP-103 (column vectors) to native (row vectors).
pub fn matrix_to_native(rep103: &Mat3) -> Mat3 {
    (TO_REP103.transpose() * rep103 * TO_REP103).transpose()
}

/// Angles about native X, Y, Z (turned in the order Y, X, Z: H → P → B), radians, to REP-103 roll, pitch, yaw about
/// X, Y, Z (turned in the order Z, Y, X, intrinsic).
pub fn xyz_angles_to_rep103(native: Vec3) -> Vec3 {
    axis_to_rep103(native)
}

/// REP-103 roll, pitch, yaw, radians, to angles about native X, Y, Z.
pub fn xyz_angles_to_native(rep103: Vec3) -> Vec3 {
    axis_to_native(rep103)
}

/// Native heading, pitch, bank (about Y, X, Z), radians, to REP-103 yaw, pitch, roll (about Z, Y, X, intrinsic).
pub fn hpb_to_rep103(native: Vec3) -> Vec3 {
    Vec3::new(-native.x, native.y, -native.z)
}

/// REP-103 yaw, pitch, roll, radians, to native heading, pitch, bank. The mapping is its own inverse.
pub fn hpb_to_native(rep103: Vec3) -> Vec3 {
    hpb_to_rep103(rep103)
}
