//! Textbook values and closed forms, and what is refused.

use super::weigh::{WALL, deviation, solid, substance, weigh, weighed};
use realnoid::description::{Dimension, Finish, Geometry, Heights, Scaling, Substance};
use realnoid::mass::{MassProperties, Method, Refusal, of_shape};
use realnoid::shape::{Meshes, Shape, ShapeFault};
use std::f64::consts::{PI, TAU};

fn shape(geometry: Geometry) -> Shape {
    Shape::new(geometry).unwrap()
}

#[test]
fn textbook_values() {
    let sphere = solid(&Geometry::Sphere { radius: 0.5 });
    assert!((sphere.mass - 1000.0 * PI / 6.0).abs() < 1e-10);
    assert!((sphere.inertia[(0, 0)] / (0.4 * sphere.mass * 0.25) - 1.0).abs() < 1e-14);
    let shell = weigh(&shape(Geometry::Sphere { radius: 0.5 }), WALL);
    assert!((shell.inertia[(2, 2)] / (2.0 / 3.0 * shell.mass * 0.25) - 1.0).abs() < 1e-14);
    let cone = solid(&Geometry::Cone { radius_x: 1.0, radius_y: 1.0, length: 4.0 });
    assert!((cone.center.z + 1.0).abs() < 1e-14, "a quarter of the height above the base at −2");
    let torus = solid(&Geometry::Torus { ring_radius: 0.4, pipe_radius: 0.1 });
    assert!((torus.inertia[(2, 2)] / (torus.mass * (0.16 + 0.75 * 0.01)) - 1.0).abs() < 1e-14);
}

#[test]
fn a_wall_much_thinner_than_the_shape_is_the_difference_of_two_solids() {
    let at = |r: f64| solid(&Geometry::Cylinder { radius: r, length: 0.4 - 2.0 * (0.1 - r) });
    let thickness = 1e-6;
    let (outer, inner) = (at(0.1 + thickness / 2.0), at(0.1 - thickness / 2.0));
    let wall = weigh(&shape(Geometry::Cylinder { radius: 0.1, length: 0.4 }), Dimension::Hollow { thickness });
    assert!((wall.mass / (outer.mass - inner.mass) - 1.0).abs() < 1e-6);
    let difference = outer.inertia - inner.inertia;
    assert!((wall.inertia - difference).abs().max() < 1e-6 * difference.abs().max());
}

#[test]
fn the_surface_of_an_ellipsoid_meets_its_closed_forms() {
    let wall = Dimension::Hollow { thickness: 1.0 };
    let area = |radii: [f64; 3]| weigh(&shape(Geometry::Ellipsoid { radii }), wall);
    let nearly_round = area([0.3, 0.3, 0.3 * (1.0 + 1e-15)]);
    assert!(deviation(&nearly_round, &weigh(&shape(Geometry::Sphere { radius: 0.3 }), wall), 0.6) < 1e-13);
    for (a, c) in [(0.5, 1e-6), (0.5, 0.01), (0.5, 0.1), (0.5, 0.499)] {
        let e = (1.0f64 - c * c / (a * a)).sqrt();
        let oblate = 1000.0 * TAU * (a * a + c * c / e * ((1.0 + e) * a / c).ln());
        assert!((area([a, a, c]).mass / oblate - 1.0).abs() < 1e-12, "oblate {a} {c}");
        let prolate = 1000.0 * TAU * c * (c + a / e * (c / a).acos());
        assert!((area([c, c, a]).mass / prolate - 1.0).abs() < 1e-12, "prolate {a} {c}");
        assert!((area([c, a, c]).mass / prolate - 1.0).abs() < 1e-12, "prolate along Y {a} {c}");
    }
}

#[test]
fn mass_is_proportional_to_density_and_wall() {
    let shape = shape(Geometry::OilTank { radius: 0.4, length: 0.3, cap_height: 0.1 });
    let at = |specific_gravity: f64, dimension: Dimension| {
        of_shape(&shape, &Substance { specific_gravity, ..substance(dimension) }, &Meshes::default()).unwrap()
    };
    let same = |many: MassProperties, one: MassProperties, times: f64| {
        assert!((many.mass / one.mass / times - 1.0).abs() < 1e-14);
        assert!((many.inertia / times - one.inertia).abs().max() <= 1e-14 * one.inertia.abs().max());
        assert_eq!(many.center, one.center);
    };
    for dimension in [Dimension::Solid, WALL] {
        let (one, many) = (at(1.0, dimension), at(7.8, dimension));
        assert_eq!(one.volume, many.volume);
        same(many.properties, one.properties, 7.8);
    }
    let (one, many) = (at(1.0, WALL), at(1.0, Dimension::Hollow { thickness: 0.007 }));
    same(many.properties, one.properties, 7.0);
    assert!((many.volume / one.volume - 7.0).abs() < 1e-14);
}

#[test]
fn every_mass_tells_how_it_was_found() {
    let sliced = Finish { slice: Some([0.0, 1.0]), ..Finish::default() };
    let cylinder = Geometry::Cylinder { radius: 0.2, length: 0.5 };
    let slice = Shape::finished(cylinder.clone(), sliced, Scaling::default()).unwrap();
    let wide = Shape::new(Geometry::EllipticCylinder { radius_x: 0.2, radius_y: 0.3, length: 0.5 }).unwrap();
    let method = |shape: &Shape, dimension| weighed(shape, dimension).unwrap().method;
    assert_eq!(method(&shape(cylinder.clone()), Dimension::Solid), Method::Formula);
    assert_eq!(method(&shape(cylinder), WALL), Method::Formula);
    assert_eq!(method(&slice, Dimension::Solid), Method::Quadrature);
    assert_eq!(method(&wide, Dimension::Solid), Method::Formula);
    assert_eq!(method(&wide, WALL), Method::Quadrature);
    let icosahedron = shape(Geometry::Polyhedron { faces: 20, radius: 0.1 });
    assert_eq!(method(&icosahedron, Dimension::Solid), Method::Polygons(20));
}

#[test]
fn what_has_no_mass_is_refused_with_its_reason() {
    let paper = weighed(&shape(Geometry::Sphere { radius: 1.0 }), Dimension::Hollow { thickness: 0.0 });
    assert_eq!(paper, Err(Refusal::NoWall(0.0)));
    let open = weighed(&shape(Geometry::Hemisphere { radius: 1.0 }), Dimension::Solid);
    assert_eq!(open, Err(Refusal::Open("hemisphere")));
    let line = Geometry::Triangle { corners: [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]] };
    assert_eq!(weighed(&shape(line), WALL), Err(Refusal::NoArea("triangle")));
    for radius in [1e-200, 1e200] {
        let refusal = weighed(&shape(Geometry::Sphere { radius }), Dimension::Solid);
        assert!(matches!(refusal, Err(Refusal::OutOfRange { kind: "sphere", .. })), "{refusal:?}");
        let slice = Finish { slice: Some([0.0, 1.0]), fillet: radius / 10.0, ..Finish::default() };
        let cylinder = Geometry::Cylinder { radius, length: radius };
        let shape = Shape::finished(cylinder, slice, Scaling::default()).unwrap();
        for dimension in [Dimension::Solid, WALL] {
            let refusal = weighed(&shape, dimension);
            assert!(matches!(refusal, Err(Refusal::OutOfRange { .. })), "{refusal:?}");
        }
    }
}

#[test]
fn a_quad_with_a_corner_bent_inwards_is_split_inside() {
    // An arrowhead: the triangle (0,0) (4,0) (2,6) less the triangle (0,0) (4,0) (2,2); areas 12 and 4.
    let corners = [[0.0, 0.0, 0.0], [2.0, 2.0, 0.0], [4.0, 0.0, 0.0], [2.0, 6.0, 0.0]];
    for start in 0..4 {
        let mut turned = corners;
        turned.rotate_left(start);
        let shape = Shape::new(Geometry::Quad { corners: turned }).unwrap();
        let weighed = weighed(&shape, WALL).unwrap();
        assert!((weighed.volume / 0.001 - 8.0).abs() < 1e-14, "{start}: {}", weighed.volume);
        assert!((weighed.properties.center.y - (12.0 * 2.0 - 4.0 * 2.0 / 3.0) / 8.0).abs() < 1e-14);
    }
    let bow = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(Shape::new(Geometry::Quad { corners: bow }), Err(ShapeFault::Crossing));
}

/// The rim of a cone as flat as a leaf has an angle of which the cosine says nothing.
#[test]
fn a_fillet_on_a_flat_cone() {
    let (r, length, f) = (1.0, 1e-7, 1e-8);
    let shape = Shape::finished(
        Geometry::Cone { radius_x: r, radius_y: r, length },
        Finish { fillet: f, ..Finish::default() },
        Scaling::default(),
    );
    // From the base up: the rounding touches the base at r − t and the mantle at t from the rim, then a cone is left.
    let slant = f64::hypot(r, length);
    let t = f * (r + slant) / length;
    let top = t * length / slant;
    let sweep = (1.0 - top / f).acos();
    let n = 20_000;
    let slice = |i: u32| {
        let angle = (f64::from(i) + 0.5) * sweep / f64::from(n);
        (r - t + f * angle.sin()).powi(2) * f * angle.sin() * sweep / f64::from(n)
    };
    let rest = (r * (1.0 - top / length)).powi(2) * (length - top) / 3.0;
    let volume = PI * ((0..n).map(slice).sum::<f64>() + rest);
    let ours = weighed(&shape.unwrap(), Dimension::Solid).unwrap().volume;
    assert!((ours / volume - 1.0).abs() < 1e-7, "{ours:e} {volume:e}");
}

#[test]
fn terrains_weigh_what_plane_and_sphere_do() {
    let level = Heights::Written { columns: 4, values: vec![0.5; 12] };
    let field = weighed(&shape(Geometry::Terrain { size: [2.0, 3.0, 0.4], heights: level }), WALL).unwrap();
    let plate = weighed(&shape(Geometry::Plane { size: [2.0, 3.0] }), WALL).unwrap();
    assert!((field.volume / plate.volume - 1.0).abs() < 1e-14);
    assert!((field.properties.center.z - 0.2).abs() < 1e-14, "half of the height of a value of 1");
    assert!((field.properties.inertia - plate.properties.inertia).norm() < 1e-14);
    // The inscribed polyhedron of a globe: lighter by a part of the order of the square of its step.
    let missing = |columns: usize| {
        let heights = Heights::Written { columns, values: vec![0.5; columns * (columns / 2 + 1)] };
        let globe = shape(Geometry::SphericalTerrain { radius: 0.4, height: 0.2, heights });
        1.0 - weighed(&globe, Dimension::Solid).unwrap().volume / (4.0 / 3.0 * PI * 0.125)
    };
    let (coarse, fine) = (missing(40), missing(80));
    assert!(fine > 0.0 && (coarse / fine - 4.0).abs() < 0.05, "{coarse} {fine}");
}
