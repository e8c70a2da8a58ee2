//! Scaling (S-3 … S-5): a stretched solid is the solid of the stretched space.

use super::random::{geometry, size};
use super::weigh::{solid, weigh};
use proptest::prelude::*;
use realnoid::description::{Dimension, Finish, Geometry, Scaling};
use realnoid::mass::MassProperties;
use realnoid::math::{Mat3, Vec3};
use realnoid::shape::Shape;

/// ∫ r rᵀ dm about the shape's origin.
fn second_moment(p: &MassProperties) -> Mat3 {
    let about = p.inertia_at_origin();
    Mat3::from_diagonal_element(about.trace() / 2.0) - about
}

fn scaled(geometry: Geometry, scaling: Scaling) -> MassProperties {
    weigh(&Shape::finished(geometry, Finish::default(), scaling).unwrap(), Dimension::Solid)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_scaled_body_is_the_body_of_the_scaled_space(
        geometry in geometry(),
        f in [size(), size(), size()],
        mirrored in [any::<bool>(), any::<bool>(), any::<bool>()],
    ) {
        let plain = solid(&geometry);
        let f = [0, 1, 2].map(|i| if mirrored[i] { -f[i] } else { f[i] });
        let stretch = Mat3::from_diagonal(&Vec3::from(f));
        let volume: f64 = f.iter().product::<f64>().abs();
        let big = scaled(geometry, Scaling { factors: f, ..Scaling::default() });
        prop_assert!((big.mass / plain.mass / volume - 1.0).abs() < 1e-12);
        prop_assert!((big.center - stretch * plain.center).norm() < 1e-12);
        let expected = stretch * second_moment(&plain) * stretch * volume;
        prop_assert!((second_moment(&big) - expected).norm() <= 1e-11 * expected.norm());
    }

    #[test]
    fn the_ends_of_a_capsule_scale_alone(r in size(), length in size(), top in 0.0..2.0, bottom in 0.1..2.0) {
        let capsule = |radius_top, radius_bottom| Geometry::Capsule { radius_top, radius_bottom, length };
        let by_scale = scaled(capsule(r, r), Scaling { top, bottom, ..Scaling::default() });
        prop_assert_eq!(by_scale, solid(&capsule(r * top, r * bottom)));
    }
}
