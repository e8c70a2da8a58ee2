//! Random shapes and poses.

use proptest::prelude::*;
use realnoid::description::Geometry;
use realnoid::math::{Pose, Quat, Vec3};

/// A length between 2 cm and 1 m.
pub fn size() -> impl Strategy<Value = f64> {
    0.02..1.0
}

/// Any shape with an inside.
pub fn geometry() -> impl Strategy<Value = Geometry> {
    let three = || [size(), size(), size()];
    prop_oneof![
        three().prop_map(|size| Geometry::Box { size }),
        size().prop_map(|radius| Geometry::Sphere { radius }),
        three().prop_map(|radii| Geometry::Ellipsoid { radii }),
        (size(), size()).prop_map(|(radius, length)| Geometry::Cylinder { radius, length }),
        three().prop_map(|[radius_x, radius_y, length]| Geometry::EllipticCylinder { radius_x, radius_y, length }),
        (size(), size()).prop_map(|(r, length)| Geometry::Capsule { radius_top: r, radius_bottom: r, length }),
        three().prop_map(|[radius_top, radius_bottom, length]| Geometry::Capsule { radius_top, radius_bottom, length }),
        (size(), 0.1..0.9, size()).prop_map(|(outer_radius, part, length)| Geometry::Tube {
            outer_radius,
            inner_radius: part * outer_radius,
            length
        }),
        three().prop_map(|[radius_x, radius_y, length]| Geometry::Cone { radius_x, radius_y, length }),
        (size(), 0.1..0.9).prop_map(|(r, part)| Geometry::Torus { ring_radius: r, pipe_radius: part * r }),
        (size(), size(), 0.1..1.0).prop_map(|(radius, length, part)| Geometry::OilTank {
            radius,
            length,
            cap_height: part * radius
        }),
        three().prop_map(|size| Geometry::Pyramid { size }),
        (0..5usize, size()).prop_map(|(i, radius)| Geometry::Polyhedron { faces: [4, 6, 8, 12, 20][i], radius }),
        (size(), size(), 0.0..2.5, size()).prop_map(|(radius_x, radius_y, top_scale, length)| Geometry::Frustum {
            radius_x,
            radius_y,
            top_scale,
            length
        }),
    ]
}

/// Any rotation, and a translation within a metre.
pub fn pose() -> impl Strategy<Value = Pose> {
    let number = || -1.0..1.0f64;
    ([number(), number(), number()], [number(), number(), number()]).prop_map(|(t, r)| {
        Pose::from_parts(Vec3::from(t).into(), Quat::from_scaled_axis(Vec3::from(r) * std::f64::consts::PI))
    })
}
