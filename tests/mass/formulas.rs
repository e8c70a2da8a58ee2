//! Each formula against numerical integration.

use super::quadrature::reference;
use super::random::geometry;
use proptest::prelude::*;
use realnoid::description::{Dimension, Geometry};
use realnoid::mass::{MassProperties, Refusal, of_shape};

/// Greatest deviation of mass, centre and inertia, each against its own scale.
fn deviation(ours: &MassProperties, reference: &MassProperties, extent: f64) -> f64 {
    let mass = (ours.mass - reference.mass).abs() / reference.mass;
    let center = (ours.center - reference.center).norm() / extent;
    let inertia = (ours.inertia - reference.inertia).abs().max() / reference.inertia.abs().max();
    mass.max(center).max(inertia)
}

fn extent(geometry: &Geometry) -> f64 {
    let bounds = realnoid::shape::bounds(geometry, &realnoid::math::Pose::identity()).unwrap();
    (bounds.max - bounds.min).norm()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn solids_agree_with_quadrature(geometry in geometry()) {
        let ours = of_shape(&geometry, Dimension::Solid, 1.0).unwrap();
        let off = deviation(&ours, &reference(&geometry, Dimension::Solid), extent(&geometry));
        prop_assert!(off < 1e-9, "{off:e}");
    }

    #[test]
    fn walls_agree_with_quadrature(geometry in geometry(), thickness in 0.001..0.01) {
        let hollow = Dimension::Hollow { thickness };
        let ours = of_shape(&geometry, hollow, 1.0).unwrap();
        let off = deviation(&ours, &reference(&geometry, hollow), extent(&geometry));
        prop_assert!(off < 1e-6, "{off:e}");
    }

    #[test]
    fn mass_is_proportional_to_density(geometry in geometry(), density in 1.0..8000.0) {
        let one = of_shape(&geometry, Dimension::Solid, 1.0).unwrap();
        let many = of_shape(&geometry, Dimension::Solid, density).unwrap();
        prop_assert!((many.mass / one.mass / density - 1.0).abs() < 1e-14);
        prop_assert!((many.inertia / density - one.inertia).abs().max() <= 1e-14 * one.inertia.abs().max());
        prop_assert_eq!(many.center, one.center);
    }
}

#[test]
fn textbook_values() {
    let sphere = of_shape(&Geometry::Sphere { radius: 0.5 }, Dimension::Solid, 1000.0).unwrap();
    assert!((sphere.mass - 1000.0 * std::f64::consts::PI / 6.0).abs() < 1e-10);
    assert!((sphere.inertia[(0, 0)] / (0.4 * sphere.mass * 0.25) - 1.0).abs() < 1e-14);
    let shell = of_shape(&Geometry::Sphere { radius: 0.5 }, Dimension::Hollow { thickness: 0.01 }, 1000.0).unwrap();
    assert!((shell.inertia[(2, 2)] / (2.0 / 3.0 * shell.mass * 0.25) - 1.0).abs() < 1e-14);
    let cone = of_shape(&Geometry::Cone { radius_x: 1.0, radius_y: 1.0, length: 4.0 }, Dimension::Solid, 1.0).unwrap();
    assert!((cone.center.z + 1.0).abs() < 1e-14, "a quarter of the height above the base at −2");
}

#[test]
fn a_wall_much_thinner_than_the_shape_is_the_difference_of_two_solids() {
    let at = |r: f64| Geometry::Cylinder { radius: r, length: 0.4 - 2.0 * (0.1 - r) };
    let thickness = 1e-6;
    let outer = of_shape(&at(0.1 + thickness / 2.0), Dimension::Solid, 1000.0).unwrap();
    let inner = of_shape(&at(0.1 - thickness / 2.0), Dimension::Solid, 1000.0).unwrap();
    let wall = of_shape(&at(0.1), Dimension::Hollow { thickness }, 1000.0).unwrap();
    assert!((wall.mass / (outer.mass - inner.mass) - 1.0).abs() < 1e-6);
    let difference = outer.inertia - inner.inertia;
    assert!((wall.inertia - difference).abs().max() < 1e-6 * difference.abs().max());
}

#[test]
fn the_surface_of_an_ellipsoid_meets_its_closed_forms() {
    let wall = Dimension::Hollow { thickness: 1.0 };
    let area = |radii: [f64; 3]| of_shape(&Geometry::Ellipsoid { radii }, wall, 1.0).unwrap();
    let round = of_shape(&Geometry::Sphere { radius: 0.3 }, wall, 1.0).unwrap();
    assert!(deviation(&area([0.3; 3]), &round, 0.6) < 1e-13);
    for (a, c) in [(0.5, 1e-6), (0.5, 0.01), (0.5, 0.1), (0.5, 0.499)] {
        let e = (1.0f64 - c * c / (a * a)).sqrt();
        let oblate = std::f64::consts::TAU * (a * a + c * c / e * ((1.0 + e) * a / c).ln());
        assert!((area([a, a, c]).mass / oblate - 1.0).abs() < 1e-12, "oblate {a} {c}");
        let prolate = std::f64::consts::TAU * c * (c + a / e * (c / a).acos());
        assert!((area([c, c, a]).mass / prolate - 1.0).abs() < 1e-12, "prolate {a} {c}");
        assert!((area([c, a, c]).mass / prolate - 1.0).abs() < 1e-12, "prolate along Y {a} {c}");
    }
}

#[test]
fn what_has_no_mass_is_refused_with_its_reason() {
    let solid = |g: &Geometry| of_shape(g, Dimension::Solid, 1000.0).unwrap_err().to_string();
    assert_eq!(solid(&Geometry::Sphere { radius: 0.0 }), "a sphere encloses no volume: its radius is 0");
    let tube = Geometry::Tube { outer_radius: 0.1, inner_radius: 0.1, length: 1.0 };
    assert!(solid(&tube).contains("wall, outer_radius − inner_radius, is 0"));
    assert!(solid(&Geometry::Box { size: [1.0, f64::NAN, 1.0] }).contains("its y is NaN"));
    let torus = Geometry::Other { kind: "torus".into(), values: vec![] };
    assert_eq!(solid(&torus), "mass from this shape (torus) comes with a later issue");
    let paper = of_shape(&Geometry::Sphere { radius: 1.0 }, Dimension::Hollow { thickness: 0.0 }, 1.0);
    assert_eq!(paper, Err(Refusal::NoWall(0.0)));
}
