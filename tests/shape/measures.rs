//! Volumes and areas of the meshes against closed forms of what is inscribed, and their limits.

use super::family::{SUBDIVISION, capsule, cone, cylinder, finished, frustum, mesh_of, solids, surfaces, torus, tube};
use super::topology::volume;
use approx::assert_relative_eq;
use realnoid::description::{Finish, Geometry, Scaling, Subdivision};
use realnoid::shape::{Shape, TriMesh};
use std::f64::consts::{PI, TAU};

fn area(mesh: &TriMesh) -> f64 {
    mesh.triangles.iter().map(|t| mesh.corners(*t)).map(|[a, b, c]| (b - a).cross(&(c - a)).norm() / 2.0).sum()
}

fn fine(around: u32) -> Subdivision {
    Subdivision { around, flat: 1 }
}

fn with(geometry: Geometry, finish: Finish) -> Shape {
    Shape::finished(geometry, finish, Scaling::default()).unwrap()
}

/// Area of a regular polygon of n corners on the unit circle.
fn polygon(n: u32) -> f64 {
    f64::from(n) / 2.0 * (TAU / f64::from(n)).sin()
}

/// Volume of frusta of round shapes stacked along Z, per area of the unit section: Σ Δz (ρ₁² + ρ₁ρ₂ + ρ₂²)/3.
fn stacked(outline: &[[f64; 2]]) -> f64 {
    outline
        .windows(2)
        .map(|w| (w[1][1] - w[0][1]) * (w[0][0].powi(2) + w[0][0] * w[1][0] + w[1][0].powi(2)) / 3.0)
        .sum()
}

/// Thin and thick: aspects of 1 : 1000 both ways.
#[test]
fn inscribed_volumes_are_those_of_polygons() {
    for n in [3, 8, 36, 101] {
        for (a, b, length) in [(0.3, 0.2, 0.5), (1e-3, 1.0, 0.7), (0.5, 0.4, 5e-4), (1e-3, 1e-3, 1.0)] {
            let cylinder = Geometry::EllipticCylinder { radius_x: a, radius_y: b, length };
            let cone = Geometry::Cone { radius_x: a, radius_y: b, length };
            let frustum = Geometry::Frustum { radius_x: a, radius_y: b, top_scale: 0.25, length };
            let tube = Geometry::Tube { outer_radius: b, inner_radius: 0.999 * b, length };
            let section = polygon(n) * a * b;
            for (geometry, wanted) in [
                (cylinder, section * length),
                (cone, section * length / 3.0),
                (frustum, section * length * (1.0 + 0.25 + 0.0625) / 3.0),
                (tube, polygon(n) * b * b * (1.0 - 0.999_f64.powi(2)) * length),
            ] {
                let name = geometry.kind();
                let found = volume(&mesh_of(&Shape::new(geometry).unwrap(), fine(n)));
                // The tube's wall is a difference of two volumes 500 times larger.
                let rounding = if name == "tube" { 1e-11 } else { 1e-13 };
                assert!((found / wanted - 1.0).abs() < rounding, "{name} {n} {a} {b} {length}: {found} {wanted}");
            }
        }
    }
}

#[test]
fn an_inscribed_ellipsoid_is_a_stack_of_frusta() {
    for n in [6, 12, 48] {
        let ring = |i: u32| {
            let angle = PI * f64::from(i) / f64::from(n / 2) - PI / 2.0;
            [angle.cos(), angle.sin()]
        };
        let stack = stacked(&(0..=n / 2).map(ring).collect::<Vec<_>>()) * polygon(n);
        for radii in [[0.5, 0.5, 0.5], [1e-3, 0.4, 1.0], [1.0, 1e-3, 1e-3]] {
            let found = volume(&mesh_of(&Shape::new(Geometry::Ellipsoid { radii }).unwrap(), fine(n)));
            assert_relative_eq!(found, stack * radii.iter().product::<f64>(), max_relative = 1e-13);
        }
    }
}

/// Steiner's formula: a body grown by a ball of radius f has volume V + S f + M f² + 4π/3 f³ and area S + 2 M f + 4π f²,
/// with M the integral of the mean curvature: π (a + b + c) for a box, π h + π² r for a cylinder.
#[test]
fn fillets_have_the_volume_and_area_of_grown_bodies() {
    let f = 0.05;
    let fillet = Finish { fillet: f, ..Finish::default() };
    let (a, b, c) = (0.4 - 2.0 * f, 0.6 - 2.0 * f, 0.9 - 2.0 * f);
    let (r, h) = (0.3 - f, 0.8 - 2.0 * f);
    let box_ = (a * b * c, 2.0 * (a * b + b * c + c * a), PI * (a + b + c));
    let round = (PI * r * r * h, TAU * r * (r + h), PI * h + PI * PI * r);
    for (geometry, (v, s, m)) in [(Geometry::Box { size: [0.4, 0.6, 0.9] }, box_), (cylinder(), round)] {
        let name = geometry.kind();
        let (volume_of, area_of) =
            (v + s * f + m * f * f + 4.0 / 3.0 * PI * f.powi(3), s + 2.0 * m * f + 4.0 * PI * f * f);
        let shape = with(geometry, fillet);
        let errors = [100, 200].map(|n| {
            let mesh = mesh_of(&shape, fine(n));
            [1.0 - volume(&mesh) / volume_of, 1.0 - area(&mesh) / area_of]
        });
        for (coarse, halved) in errors[0].iter().zip(errors[1]) {
            assert!(halved > 0.0 && halved < 1e-3, "{name}: {halved}");
            assert!((coarse / halved - 4.0).abs() < 0.02, "{name} is not of second order: {}", coarse / halved);
        }
    }
}

/// The limit, from what the true shapes measure: meshes from inside, at second order.
#[test]
fn polygon_meshes_converge_at_second_order() {
    let torus = (torus(), 2.0 * PI * PI * 0.5 * 0.2 * 0.2);
    let ball = (Geometry::Sphere { radius: 0.5 }, 4.0 / 3.0 * PI * 0.125);
    let tube = (tube(), PI * (0.4 * 0.4 - 0.25 * 0.25) * 0.7);
    let half_balls = 2.0 / 3.0 * PI * (0.2_f64.powi(3) + 0.35_f64.powi(3));
    let capsule = (capsule(), half_balls + PI * 0.6 / 3.0 * (0.2 * 0.2 + 0.2 * 0.35 + 0.35 * 0.35));
    let cap = PI * 0.1 / 6.0 * (3.0 * 0.3 * 0.3 + 0.1 * 0.1);
    let tank = (Geometry::OilTank { radius: 0.3, length: 0.7, cap_height: 0.1 }, PI * 0.09 * 0.7 + 2.0 * cap);
    let cone = (cone(), PI * 0.4 * 0.25 * 0.9 / 3.0);
    let frustum = (frustum(), PI * 0.4 * 0.3 * 0.6 * 1.75 / 3.0);
    for (geometry, wanted) in [torus, ball, tube, capsule, tank, cone, frustum] {
        let name = geometry.kind();
        let shape = Shape::new(geometry).unwrap();
        // Angles of the tank's caps divide evenly into none of these: its ratio is that of the numbers of segments used.
        let errors = [256, 512].map(|n| 1.0 - volume(&mesh_of(&shape, fine(n))) / wanted);
        let ratio = errors[0] / errors[1];
        let allowed = if name == "oil_tank" { 0.1 } else { 0.01 };
        assert!(errors[1] > 0.0 && (ratio - 4.0).abs() < allowed, "{name}: {errors:?}, ratio {ratio}");
    }
}

/// 5 of 24 segments of a whole are 5/24 of it; a slice and the rest are the whole.
#[test]
fn slices_are_parts_of_the_whole() {
    let fillet = Finish { fillet: 0.03, ..Finish::default() };
    for (geometry, finish) in [
        (cylinder(), fillet),
        (tube(), fillet),
        (cone(), fillet),
        (frustum(), fillet),
        (capsule(), Finish::default()),
        (torus(), Finish::default()),
        (Geometry::Sphere { radius: 0.4 }, Finish::default()),
    ] {
        let name = geometry.kind();
        let part = |slice| volume(&mesh_of(&with(geometry.clone(), Finish { slice, ..finish }), SUBDIVISION));
        let (from, to) = (0.3, 0.3 + TAU * 5.0 / 24.0);
        let (whole, slice, rest) = (part(None), part(Some([from, to])), part(Some([to, from + TAU])));
        assert!((slice / whole * 24.0 / 5.0 - 1.0).abs() < 1e-13, "{name}: {slice} of {whole}");
        assert!(((slice + rest) / whole - 1.0).abs() < 1e-13, "{name}: {slice} and {rest} are not {whole}");
    }
}

/// A slice's faces are two sections; the mantle of a sliced sphere is its part of the whole.
#[test]
fn a_cut_has_the_area_of_the_section() {
    let slice = Some([0.3, 0.3 + TAU * 5.0 / 24.0]);
    for (geometry, section) in [
        (cylinder(), 0.3 * 0.8),
        (tube(), 0.15 * 0.7),
        (Geometry::Sphere { radius: 0.4 }, 0.16 * polygon(24) / 2.0),
        (torus(), 0.04 * polygon(24)),
    ] {
        let name = geometry.kind();
        let whole = area(&mesh_of(&Shape::new(geometry.clone()).unwrap(), SUBDIVISION));
        let found = area(&mesh_of(&with(geometry, Finish { slice, ..Finish::default() }), SUBDIVISION));
        assert_relative_eq!(found, whole * 5.0 / 24.0 + 2.0 * section, max_relative = 1e-13);
        assert!(found > 0.0, "{name}");
    }
}

/// S-5: scaling a shape moves the vertices of its mesh, and nothing else.
#[test]
fn a_scaled_shape_has_the_stretched_vertices() {
    for (name, shape) in solids() {
        for factors in [[2.0, 0.5, 1.5], [1e-3, 1.0, 1.0], [3.0, 3.0, 3.0]] {
            let scaling = Scaling { factors, ..Scaling::default() };
            let scaled = mesh_of(&Shape::finished(shape.geometry.clone(), shape.finish, scaling).unwrap(), SUBDIVISION);
            let stretched = mesh_of(&shape, SUBDIVISION).stretched(factors);
            assert_eq!(scaled.triangles, stretched.triangles, "{name} {factors:?}");
            let size = factors.iter().fold(0.0, |a: f64, b| a.max(*b));
            let furthest =
                scaled.vertices.iter().zip(&stretched.vertices).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
            assert!(furthest < 1e-15 * size, "{name} {factors:?}: {furthest}");
        }
    }
}

/// B-5: flat segments change neither the volume nor the area.
#[test]
fn flat_segments_change_no_measure() {
    let flat = surfaces().into_iter().map(|(name, shape, _)| (name, shape));
    for (name, shape) in solids().into_iter().chain(finished()).chain(flat) {
        let [one, five] = [1, 5].map(|flat| mesh_of(&shape, Subdivision { around: 24, flat }));
        assert!((area(&five) / area(&one) - 1.0).abs() < 1e-13, "{name}: area");
        if !shape.is_open() {
            assert!((volume(&five) / volume(&one) - 1.0).abs() < 1e-13, "{name}: volume");
        }
    }
}
