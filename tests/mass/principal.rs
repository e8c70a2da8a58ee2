//! Principal moments and axes (B-12).

use super::random::pose;
use proptest::prelude::*;
use realnoid::mass::MassProperties;
use realnoid::math::{Mat3, Vec3};

fn body(inertia: Mat3) -> MassProperties {
    MassProperties { mass: 1.0, center: Vec3::zeros(), inertia }
}

/// Order, right hand, orthonormal, and A v = λ v with each residual against √(its own moment × the largest): that is
/// what rounding of the tensor's elements allows.
fn sound(inertia: &Mat3) {
    let p = body(*inertia).principal();
    assert!(p.moments[0] <= p.moments[1] && p.moments[1] <= p.moments[2], "{}", p.moments);
    assert!((p.axes.determinant() - 1.0).abs() < 1e-14);
    assert!((p.axes.transpose() * p.axes - Mat3::identity()).norm() < 1e-14);
    let rebuilt = p.axes * Mat3::from_diagonal(&p.moments) * p.axes.transpose();
    assert!((rebuilt - inertia).norm() < 4e-15 * inertia.norm(), "{inertia}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn axes_turn_with_the_body(x in pose(), m in [0.1..1.0f64, 0.1..1.0, 0.1..1.0]) {
        let r = x.rotation.to_rotation_matrix().into_inner();
        let turned = r * Mat3::from_diagonal(&m.into()) * r.transpose();
        let turned = (turned + turned.transpose()) / 2.0;
        sound(&turned);
        let mut sorted = m;
        sorted.sort_by(f64::total_cmp);
        prop_assert!((body(turned).principal().moments - Vec3::from(sorted)).norm() < 1e-14);
    }

    /// A graded tensor D·M·D, M well conditioned, has small moments that its elements determine to rounding, however
    /// small they are (Demmel and Veselić 1992): ratio 1 : 10¹².
    #[test]
    fn small_moments_keep_their_digits(off in [-0.3..0.3f64, -0.3..0.3, -0.3..0.3]) {
        let m = Mat3::new(1.0, off[0], off[1], off[0], 1.0, off[2], off[1], off[2], 1.0);
        let d = Mat3::from_diagonal(&Vec3::new(1.0, 1e-3, 1e-6));
        let graded = d * m * d;
        sound(&graded);
        let p = body(graded).principal();
        // The determinant is the product of the moments, and known to rounding from the well conditioned factor.
        let determinant = m.determinant() * 1e-18;
        prop_assert!((p.moments.product() / determinant - 1.0).abs() < 1e-13);
        // The least one is 1/(the greatest eigenvalue of the inverse), whose leading element is m⁻¹₂₂ · 10¹².
        let inverse = m.try_inverse().unwrap()[(2, 2)] * 1e12;
        prop_assert!((p.moments[0] * inverse - 1.0).abs() < 1e-5, "second order in the grading of 10⁻³");
    }
}

#[test]
fn tensors_that_need_no_turn_keep_their_bits() {
    for m in [[1.0, 2.0, 3.0], [3.0, 1.0, 2.0], [2.0, 2.0, 2.0], [0.0, 0.0, 0.0], [1e-12, 1.0, 1.0]] {
        let p = body(Mat3::from_diagonal(&m.into())).principal();
        let mut sorted = m;
        sorted.sort_by(f64::total_cmp);
        assert_eq!(p.moments, Vec3::from(sorted));
        assert_eq!(p.axes.determinant(), 1.0);
    }
}

#[test]
fn what_is_no_tensor_does_not_hang() {
    for bad in [f64::NAN, f64::INFINITY, 1e308, -1.0] {
        let _ = body(Mat3::new(bad, 1.0, bad, 1.0, 0.0, 2.0, bad, 2.0, bad)).principal();
    }
}
