//! The shape room: scaling and bounds.

use super::quadrature::surface;
use super::random::{geometry, pose, size};
use proptest::prelude::*;
use realnoid::description::{Dimension, Geometry};
use realnoid::mass::{MassProperties, of_shape};
use realnoid::math::{Mat3, Vec3};
use realnoid::shape::{ScaleError, bounds, scaled};

/// ∫ r rᵀ dm about the shape's origin.
fn second_moment(p: &MassProperties) -> Mat3 {
    let about = p.inertia_at_origin();
    Mat3::from_diagonal_element(about.trace() / 2.0) - about
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_scaled_body_is_the_body_of_the_scaled_space(geometry in geometry(), f in [size(), size(), size()]) {
        let plain = of_shape(&geometry, Dimension::Solid, 1000.0).unwrap();
        // A capsule and a tube stay what they are only under equal factors.
        let f = match geometry {
            Geometry::Capsule { .. } => [f[0]; 3],
            Geometry::Tube { .. } => [f[0], f[0], f[2]],
            _ => f,
        };
        let stretch = Mat3::from_diagonal(&Vec3::from(f));
        let volume: f64 = f.iter().product();
        let big = of_shape(&scaled(&geometry, f).unwrap(), Dimension::Solid, 1000.0).unwrap();
        prop_assert!((big.mass / plain.mass / volume - 1.0).abs() < 1e-12);
        prop_assert!((big.center - stretch * plain.center).norm() < 1e-12);
        let expected = stretch * second_moment(&plain) * stretch * volume;
        prop_assert!((second_moment(&big) - expected).norm() <= 1e-11 * expected.norm());
    }

    #[test]
    fn bounds_hold_the_shape_and_no_more(geometry in geometry(), x in pose()) {
        let b = bounds(&geometry, &x).unwrap();
        let size = (b.max - b.min).norm();
        let points = surface(&geometry).into_iter().map(|(_, p)| (x * nalgebra::Point3::from(p)).coords);
        let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        for p in points {
            (low, high) = (low.inf(&p), high.sup(&p));
        }
        prop_assert!((low - b.min).min() > -1e-12 && (b.max - high).min() > -1e-12, "a point outside");
        prop_assert!((low - b.min).max() < 0.01 * size && (b.max - high).max() < 0.01 * size, "too wide");
    }
}

#[test]
fn what_does_not_scale_says_so() {
    let capsule = Geometry::Capsule { radius_top: 0.1, radius_bottom: 0.1, length: 0.3 };
    assert_eq!(scaled(&capsule, [1.0, 2.0, 1.0]), Err(ScaleError::Unequal("capsule", "X and Y", 1.0, 2.0)));
    assert!(scaled(&capsule, [2.0; 3]).is_ok());
    assert_eq!(scaled(&capsule, [1.0, 1.0, 0.0]), Err(ScaleError::BadFactor(0.0)));
    let torus = Geometry::Other { kind: "torus".into(), values: vec![] };
    let refusal = scaled(&torus, [2.0; 3]).unwrap_err().to_string();
    assert_eq!(refusal, "a torus takes no scale; write its size instead");
    assert_eq!(
        scaled(&Geometry::Sphere { radius: 2.0 }, [1.0, 2.0, 3.0]),
        Ok(Geometry::Ellipsoid { radii: [2.0, 4.0, 6.0] })
    );
}
