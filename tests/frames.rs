//! Native frame ↔ REP-103: known cases, round trips, and agreement of the conversions with each other.

use approx::assert_relative_eq;
use nalgebra::Rotation3;
use proptest::prelude::*;
use realnoid::math::frames::*;
use realnoid::math::{Mat3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Native elementary rotations in row-vector form, from the definition: positive turns Y→Z, Z→X, X→Y.
fn row_rotation(axis: usize, angle: f64) -> Mat3 {
    let (s, c) = angle.sin_cos();
    let (from, to) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = Mat3::identity();
    m[(from, from)] = c;
    m[(from, to)] = s;
    m[(to, from)] = -s;
    m[(to, to)] = c;
    m
}

/// H about Y, then P about the turned X, then B about the turned Z. With row vectors the innermost stands first.
fn row_hpb(h: f64, p: f64, b: f64) -> Mat3 {
    row_rotation(2, b) * row_rotation(0, p) * row_rotation(1, h)
}

/// REP-103 rotation from yaw, pitch, roll, intrinsic.
fn column_ypr(yaw: f64, pitch: f64, roll: f64) -> Mat3 {
    Rotation3::from_euler_angles(roll, pitch, yaw).into_inner()
}

#[test]
fn forward_up_and_right_keep_their_meaning() {
    assert_eq!(vector_to_rep103(Vec3::z()), Vec3::x(), "forward");
    assert_eq!(vector_to_rep103(Vec3::y()), Vec3::z(), "up");
    assert_eq!(vector_to_rep103(Vec3::x()), -Vec3::y(), "right");
}

#[test]
fn positions_change_unit() {
    let native = Vec3::new(10.0, 150.0, 20.0);
    assert_relative_eq!(position_to_rep103(native, LengthUnit::Centimetre), Vec3::new(0.2, -0.1, 1.5));
    assert_relative_eq!(position_to_rep103(native, LengthUnit::Millimetre), Vec3::new(0.02, -0.01, 0.15));
    assert_relative_eq!(position_to_native(Vec3::new(0.2, -0.1, 1.5), LengthUnit::Metre), Vec3::new(0.1, 1.5, 0.2));
}

#[test]
fn positive_native_heading_turns_forward_to_the_right() {
    let turned = Vec3::z().transpose() * row_hpb(FRAC_PI_2, 0.0, 0.0);
    assert_relative_eq!(turned, Vec3::x().transpose(), epsilon = 1e-15);
    let ypr = hpb_to_rep103(Vec3::new(FRAC_PI_2, 0.0, 0.0));
    assert_relative_eq!(column_ypr(ypr.x, ypr.y, ypr.z) * Vec3::x(), -Vec3::y(), epsilon = 1e-15);
}

#[test]
fn positive_native_pitch_turns_forward_down_in_both_frames() {
    let turned = Vec3::z().transpose() * row_hpb(0.0, 0.3, 0.0);
    assert!(turned.y < 0.0);
    let ypr = hpb_to_rep103(Vec3::new(0.0, 0.3, 0.0));
    assert_relative_eq!(
        column_ypr(ypr.x, ypr.y, ypr.z) * Vec3::x(),
        vector_to_rep103(turned.transpose()),
        epsilon = 1e-15
    );
}

#[test]
fn a_torque_is_axial_and_a_force_is_polar() {
    // Native: a force up, applied to the right of the origin. Its moment is right × up by the left-hand formulas.
    let (arm, force) = (Vec3::x(), Vec3::y());
    let torque = axis_to_rep103(arm.cross(&force));
    assert_eq!(torque, vector_to_rep103(arm).cross(&vector_to_rep103(force)));
    assert_ne!(torque, vector_to_rep103(arm.cross(&force)));
}

fn angle() -> impl Strategy<Value = f64> {
    -PI..PI
}
fn vector() -> impl Strategy<Value = Vec3> {
    [-10.0..10.0, -10.0..10.0, -10.0..10.0f64].prop_map(Vec3::from)
}

proptest! {
    #[test]
    fn round_trips_give_the_same_bits(v in vector(), m in [vector(), vector(), vector()]) {
        let m = Mat3::from_columns(&m);
        prop_assert_eq!(vector_to_native(vector_to_rep103(v)), v);
        prop_assert_eq!(axis_to_native(axis_to_rep103(v)), v);
        prop_assert_eq!(xyz_angles_to_native(xyz_angles_to_rep103(v)), v);
        prop_assert_eq!(hpb_to_native(hpb_to_rep103(v)), v);
        prop_assert_eq!(matrix_to_native(&matrix_to_rep103(&m)), m);
        let there = position_to_rep103(v, LengthUnit::Millimetre);
        prop_assert!((position_to_native(there, LengthUnit::Millimetre) - v).norm() <= 4e-15 * v.norm());
    }

    #[test]
    fn angles_and_matrices_agree(h in angle(), p in angle(), b in angle()) {
        let ypr = hpb_to_rep103(Vec3::new(h, p, b));
        let converted = matrix_to_rep103(&row_hpb(h, p, b));
        prop_assert!((converted - column_ypr(ypr.x, ypr.y, ypr.z)).norm() < 1e-14);
        let rpy = xyz_angles_to_rep103(Vec3::new(p, h, b));
        prop_assert_eq!(rpy, Vec3::new(ypr.z, ypr.y, ypr.x));
    }

    #[test]
    fn matrices_act_as_vectors_convert(v in vector(), h in angle(), p in angle(), b in angle()) {
        let m = row_hpb(h, p, b);
        let native_first = vector_to_rep103((v.transpose() * m).transpose());
        prop_assert!((native_first - matrix_to_rep103(&m) * vector_to_rep103(v)).norm() < 1e-13);
    }

    #[test]
    fn cross_products_are_axial(u in vector(), v in vector()) {
        let direct = vector_to_rep103(u).cross(&vector_to_rep103(v));
        prop_assert_eq!(axis_to_rep103(u.cross(&v)), direct);
    }
}
