//! A polygonised shape (B-4) converges to the exact one at second order in its segments.

use super::weigh::{WALL, polygonised, weigh};
use realnoid::description::{Dimension, Geometry};
use realnoid::shape::Shape;

const SEGMENTS: [u32; 5] = [16, 32, 64, 128, 256];

/// Slope of the line of least squares through (ln n, ln error).
fn order(errors: &[f64]) -> f64 {
    let points: Vec<_> = SEGMENTS.iter().zip(errors).map(|(n, e)| (f64::from(*n).ln(), e.ln())).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (over, under) = points.iter().fold((0.0, 0.0), |(o, u), p| (o + (p.0 - x) * (p.1 - y), u + (p.0 - x).powi(2)));
    -over / under
}

fn kinds() -> Vec<(&'static str, Geometry)> {
    vec![
        ("sphere", Geometry::Sphere { radius: 0.3 }),
        ("ellipsoid", Geometry::Ellipsoid { radii: [0.3, 0.2, 0.5] }),
        ("capsule", Geometry::Capsule { radius_top: 0.2, radius_bottom: 0.2, length: 0.6 }),
        ("tapered capsule", Geometry::Capsule { radius_top: 0.1, radius_bottom: 0.2, length: 0.6 }),
        ("cylinder", Geometry::Cylinder { radius: 0.2, length: 0.7 }),
        ("elliptic cylinder", Geometry::EllipticCylinder { radius_x: 0.2, radius_y: 0.4, length: 0.7 }),
        ("tube", Geometry::Tube { outer_radius: 0.4, inner_radius: 0.3, length: 0.5 }),
        ("cone", Geometry::Cone { radius_x: 0.3, radius_y: 0.2, length: 0.6 }),
        ("frustum", Geometry::Frustum { radius_x: 0.3, radius_y: 0.2, top_scale: 0.6, length: 0.6 }),
    ]
}

#[test]
fn polygons_converge_at_second_order() {
    for (name, geometry) in kinds() {
        let shape = Shape::new(geometry).unwrap();
        for dimension in [Dimension::Solid, WALL] {
            let exact = weigh(&shape, dimension);
            let bodies = SEGMENTS.map(|n| polygonised(&shape, dimension, n));
            let mass = bodies.map(|b| (b.mass / exact.mass - 1.0).abs());
            let inertia = bodies.map(|b| (b.inertia - exact.inertia).norm());
            for (what, errors) in [("mass", mass), ("inertia", inertia)] {
                let order = order(&errors);
                assert!((order - 2.0).abs() < 0.05, "{name} {dimension:?} {what}: order {order}, {errors:?}");
            }
        }
    }
}

#[test]
fn a_polygonised_box_is_the_box() {
    let shape = Shape::new(Geometry::Box { size: [0.3, 0.5, 0.0005] }).unwrap();
    for dimension in [Dimension::Solid, WALL] {
        let (exact, polygons) = (weigh(&shape, dimension), polygonised(&shape, dimension, 16));
        assert!((polygons.mass / exact.mass - 1.0).abs() < 1e-13);
        assert!((polygons.inertia - exact.inertia).norm() < 1e-13 * exact.inertia.norm());
    }
}
