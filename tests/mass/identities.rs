//! What must hold for every rigid body, whatever the formula.

use super::random::{geometry, pose, size};
use super::weigh::{deviation, solid, weigh};
use proptest::prelude::*;
use realnoid::description::{Dimension, Geometry};
use realnoid::mass::MassProperties;
use realnoid::math::{Mat3, Pose, Vec3};
use realnoid::shape::{Meshes, Shape};

fn raised(z: f64) -> Pose {
    Pose::translation(0.0, 0.0, z)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn placing_and_placing_back_is_nothing(geometry in geometry(), x in pose()) {
        let body = solid(&geometry);
        let back = body.placed(&x).placed(&x.inverse());
        prop_assert!(deviation(&back, &body, 1.0 + x.translation.vector.norm()) < 1e-12);
    }

    #[test]
    fn principal_moments_do_not_see_the_frame(geometry in geometry(), x in pose()) {
        let (here, there) = (solid(&geometry).principal(), solid(&geometry).placed(&x).principal());
        prop_assert!((here.moments - there.moments).norm() <= 1e-12 * here.moments.norm());
        let rebuilt = there.axes * Mat3::from_diagonal(&there.moments) * there.axes.transpose();
        let direct = solid(&geometry).placed(&x).inertia;
        prop_assert!((rebuilt - direct).norm() <= 1e-12 * direct.norm());
        prop_assert!((there.axes.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_sum_does_not_see_the_frame(parts in prop::collection::vec((geometry(), pose()), 1..6), x in pose()) {
        let here: Vec<_> = parts.iter().map(|(g, at)| solid(g).placed(at)).collect();
        let there: Vec<_> = here.iter().map(|p| p.placed(&x)).collect();
        let (one, other) = (MassProperties::sum(&here).placed(&x), MassProperties::sum(&there));
        prop_assert!(deviation(&other, &one, 4.0) < 1e-12);
    }

    #[test]
    fn inertia_about_the_origin_adds_up(parts in prop::collection::vec((geometry(), pose()), 1..6)) {
        // The parallel axis, from the other side: about one fixed point, inertias simply add.
        let parts: Vec<_> = parts.iter().map(|(g, at)| solid(g).placed(at)).collect();
        let added: Mat3 = parts.iter().map(|p| p.inertia_at_origin()).sum();
        let whole = MassProperties::sum(&parts).inertia_at_origin();
        prop_assert!((whole - added).norm() <= 1e-12 * added.norm());
    }

    #[test]
    fn kinetic_energy_of_a_turn_is_the_same_by_parts(
        parts in prop::collection::vec((geometry(), pose()), 1..4),
        omega in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0],
    ) {
        let omega = Vec3::from(omega);
        let energy = |p: &MassProperties| {
            let v = omega.cross(&p.center);
            0.5 * p.mass * v.norm_squared() + 0.5 * omega.dot(&(p.inertia * omega))
        };
        let parts: Vec<_> = parts.iter().map(|(g, at)| solid(g).placed(at)).collect();
        let by_parts: f64 = parts.iter().map(energy).sum();
        prop_assert!((energy(&MassProperties::sum(&parts)) - by_parts).abs() <= 1e-12 * by_parts);
    }

    #[test]
    fn a_capsule_is_a_cylinder_and_two_half_spheres(r in size(), length in size(), x in pose()) {
        let half = solid(&Geometry::Capsule { radius_top: r, radius_bottom: 0.0, length: 0.0 });
        let flip = raised(-length / 2.0) * Pose::rotation(Vec3::new(std::f64::consts::PI, 0.0, 0.0));
        let parts = [solid(&Geometry::Cylinder { radius: r, length }), half.placed(&raised(length / 2.0)), half.placed(&flip)];
        let parts: Vec<_> = parts.iter().map(|p| p.placed(&x)).collect();
        let whole = solid(&Geometry::Capsule { radius_top: r, radius_bottom: r, length }).placed(&x);
        prop_assert!(deviation(&MassProperties::sum(&parts), &whole, 3.0) < 1e-12);
    }

    #[test]
    fn a_box_is_its_two_parts(size in [size(), size(), size()], cut in 0.05..0.95, axis in 0usize..3, x in pose()) {
        let part = |from: f64, to: f64| {
            let (mut s, mut t) = (size, [0.0; 3]);
            s[axis] *= to - from;
            t[axis] = size[axis] * ((from + to) / 2.0 - 0.5);
            solid(&Geometry::Box { size: s }).placed(&(x * Pose::translation(t[0], t[1], t[2])))
        };
        let whole = solid(&Geometry::Box { size }).placed(&x);
        prop_assert!(deviation(&MassProperties::sum(&[part(0.0, cut), part(cut, 1.0)]), &whole, 3.0) < 1e-12);
    }

    #[test]
    fn a_cone_is_a_frustum_and_a_smaller_cone(a in size(), b in size(), length in size(), cut in 0.05..0.95) {
        let low = Geometry::Frustum { radius_x: a, radius_y: b, top_scale: 1.0 - cut, length: cut * length };
        let high = Geometry::Cone { radius_x: a * (1.0 - cut), radius_y: b * (1.0 - cut), length: (1.0 - cut) * length };
        let parts = [
            solid(&low).placed(&raised((cut - 1.0) * length / 2.0)),
            solid(&high).placed(&raised(cut * length / 2.0)),
        ];
        let whole = solid(&Geometry::Cone { radius_x: a, radius_y: b, length });
        prop_assert!(deviation(&MassProperties::sum(&parts), &whole, length) < 1e-12);
    }

    #[test]
    fn every_inertia_is_one(parts in prop::collection::vec((geometry(), pose()), 1..6), thickness in 0.001..0.01) {
        for dimension in [Dimension::Solid, Dimension::Hollow { thickness }] {
            let parts: Vec<_> = parts.iter().map(|(g, at)| weigh(&Shape::new(g.clone()).unwrap(), dimension).placed(at)).collect();
            let whole = MassProperties::sum(&parts);
            let m = whole.principal().moments;
            prop_assert!(m[0] > 0.0, "positive definite");
            prop_assert!(m[0] + m[1] >= m[2] * (1.0 - 1e-12), "triangle inequality: {m}");
            prop_assert_eq!(whole.inertia, whole.inertia.transpose());
        }
    }

    #[test]
    fn the_centre_lies_within_the_bounds(geometry in geometry(), x in pose()) {
        let c = solid(&geometry).placed(&x).center;
        let b = realnoid::shape::bounds(&Shape::new(geometry).unwrap(), &x, &Meshes::default()).unwrap();
        prop_assert!((0..3).all(|i| b.min[i] < c[i] && c[i] < b.max[i]));
    }
}
