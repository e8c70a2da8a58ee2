//! SPEC section 6: where the source's formula is wrong, ours and an independent integration agree, and its own does not.
//!
//! The source's axis of round shapes is Y, ours Z: its x, y, z are our x, z, y.

use super::points::{Cloud, Moments};
use super::round::Round;
use super::straight;
use super::weigh::{WALL, solid, weigh, weigh_mesh};
use realnoid::description::{Dimension, Finish, Geometry, Scaling};
use realnoid::mass::MassProperties;
use realnoid::math::{Mat3, Pose, Vec3};
use realnoid::shape::{Shape, TriMesh};

/// The tensor per mass that integration gives.
fn tensor(cloud: &Cloud) -> Mat3 {
    let c = Moments::of(cloud).covariance;
    Mat3::from_diagonal_element(c.trace()) - c
}

fn round(geometry: &Geometry, stretch: [f64; 3]) -> Mat3 {
    tensor(&Round::of(geometry, &Finish::default(), stretch).unwrap().solid())
}

fn agree(ours: &MassProperties, integrated: &Mat3) {
    let off = (ours.inertia / ours.mass - integrated).norm() / integrated.norm();
    assert!(off < 1e-11, "{off:e}");
}

#[test]
fn x1_the_half_ellipsoid_of_the_source_holds_only_for_equal_semi_axes() {
    let ball = Geometry::Capsule { radius_top: 1.0, radius_bottom: 0.0, length: 0.0 };
    for (a, b, h) in [(0.3, 0.3, 0.3), (0.4, 0.3, 0.2), (0.2, 0.1, 0.5)] {
        let integrated = round(&ball, [a, b, h]);
        let scaling = Scaling { factors: [a, b, h], ..Scaling::default() };
        let shape = Shape::finished(ball.clone(), Finish::default(), scaling).unwrap();
        agree(&weigh(&shape, Dimension::Solid), &integrated);
        let (source_x, source_other) = (83.0 / 320.0 * b * h, 83.0 / 320.0 * a * h);
        let right = [b * b / 5.0 + 19.0 / 320.0 * h * h, a * a / 5.0 + 19.0 / 320.0 * h * h];
        assert!((right[0] / integrated[(0, 0)] - 1.0).abs() < 1e-12);
        assert!((right[1] / integrated[(1, 1)] - 1.0).abs() < 1e-12);
        let equal = a == b && b == h;
        assert_eq!((source_x / integrated[(0, 0)] - 1.0).abs() < 1e-12, equal);
        assert_eq!((source_other / integrated[(1, 1)] - 1.0).abs() < 1e-12, equal);
    }
}

#[test]
fn x2_the_triangle_plate_of_the_source_has_no_product_of_inertia() {
    // b c along X, as the source turns it; a stands not above the middle.
    let [a, b, c] = [[0.05, 0.3, 0.0], [0.0, 0.0, 0.0], [0.4, 0.0, 0.0]];
    let geometry = Geometry::Triangle { corners: [a, b, c] };
    let integrated = tensor(&straight::surface(&geometry, 0.0, [1.0; 3]).unwrap());
    agree(&weigh(&Shape::new(geometry).unwrap(), WALL), &integrated);
    // The source: I = h²/18 along bc, (L1² + L2² + L3²)/12 across the plate, their difference, and zeros.
    let center = (Vec3::from(a) + Vec3::from(b) + Vec3::from(c)) / 3.0;
    let polar = [a, b, c].iter().map(|p| (Vec3::from(*p) - center).norm_squared()).sum::<f64>() / 12.0;
    let along = 0.3 * 0.3 / 18.0;
    let source = Mat3::from_diagonal(&Vec3::new(along, polar - along, polar));
    assert!((source - integrated).diagonal().norm() < 1e-14, "its diagonal is right");
    let product = integrated[(0, 1)];
    assert!(product.abs() > 0.1 * integrated[(0, 0)], "and the missing product is not small: {product}");
}

#[test]
fn x3_the_link_of_the_source_takes_the_whole_mass_at_each_parts_origin() {
    // Two boxes as one link, and the same as one cloud of points.
    let boxes = [([0.1, 0.2, 0.3], [0.2, 0.0, 0.1]), ([0.3, 0.1, 0.1], [-0.1, 0.3, 0.0])];
    let parts = boxes.map(|(size, [x, y, z])| solid(&Geometry::Box { size }).placed(&Pose::translation(x, y, z)));
    let mut cloud = Cloud::new();
    for (size, at) in boxes {
        let own = straight::solid(&Geometry::Box { size }, 0.0).unwrap();
        cloud.extend(own.into_iter().map(|(w, p)| (w, p + Vec3::from(at))));
    }
    let link = MassProperties::sum(&parts);
    agree(&link, &tensor(&cloud));
    // The source: I' with the mass of the link, and the way from the root's origin to the part's origin.
    let square = |d: Vec3| Mat3::from_diagonal_element(d.norm_squared()) - d * d.transpose();
    let source: Mat3 = parts.iter().map(|p| p.inertia + square(p.center) * link.mass).sum();
    let right = link.inertia_at_origin();
    assert!((source - right).norm() > 0.5 * right.norm(), "{source} {right}");
    assert!((source - link.inertia).norm() > 0.5 * link.inertia.norm());
}

#[test]
fn x6_the_second_radius_of_an_elliptic_cone_is_across_its_axis() {
    let (a, b, h) = (0.3, 0.2, 0.9);
    let geometry = Geometry::Cone { radius_x: a, radius_y: b, length: h };
    let integrated = round(&geometry, [1.0; 3]);
    agree(&solid(&geometry), &integrated);
    // Read as written, b = r.y lies along the axis Y: half the height of the cone's box.
    let source = |b: f64| [3.0 / 20.0 * (a * a + b * b), 3.0 / 20.0 * b * b + (3.0 / 5.0 - 9.0 / 16.0) * h * h];
    let ours = [integrated[(2, 2)], integrated[(0, 0)]];
    for (i, right) in ours.into_iter().enumerate() {
        assert!((source(b)[i] / right - 1.0).abs() < 1e-12, "across the axis it is right");
        assert!((source(h / 2.0)[i] / right - 1.0).abs() > 0.3, "along the axis it is not");
    }
}

/// B-12's grid: cell by cell, whether its middle is inside. A cell at the boundary counts wholly or not at all; over
/// all of the boundary that is less than one layer of cells in `n`.
fn grid(low: Vec3, high: Vec3, n: u32, inside: impl Fn(Vec3) -> bool) -> Cloud {
    let cell = (high - low) / f64::from(n);
    let mut cloud = Cloud::new();
    for i in 0..n.pow(3) {
        let index = Vec3::new(f64::from(i % n), f64::from(i / n % n), f64::from(i / n / n)).add_scalar(0.5);
        let p = low + index.component_mul(&cell);
        if inside(p) {
            cloud.push((cell.product(), p));
        }
    }
    cloud
}

const CELLS: u32 = 120;

fn agrees_with_grid(ours: &MassProperties, cloud: &Cloud) {
    let off = Moments::from_mass(ours, 1000.0).deviation(&Moments::of(cloud));
    assert!(off < 1.0 / f64::from(CELLS), "{off:e}");
}

#[test]
fn x7_the_elliptic_frustum_derived_here_agrees_with_the_grid() {
    for (a, b, top, h) in [(0.4, 0.2, 0.5, 0.6), (0.2, 0.3, 1.5, 0.4), (0.3, 0.1, 0.0, 0.5)] {
        let wide = 1.0f64.max(top);
        let corner = Vec3::new(a * wide, b * wide, h / 2.0);
        let cloud = grid(-corner, corner, CELLS, |p| {
            let s = 1.0 + (top - 1.0) * (p.z / h + 0.5);
            (p.x / a).powi(2) + (p.y / b).powi(2) < s * s
        });
        let geometry = Geometry::Frustum { radius_x: a, radius_y: b, top_scale: top, length: h };
        agrees_with_grid(&solid(&geometry), &cloud);
        agree(&solid(&geometry), &round(&geometry, [1.0; 3]));
    }
}

#[test]
fn x7_the_tetrahedron_derived_here_agrees_with_the_grid() {
    let corners = [[0.0, 0.0, 0.1], [0.5, 0.1, 0.0], [0.1, 0.6, 0.2], [0.2, 0.1, 0.7]].map(Vec3::from);
    let mesh = TriMesh { vertices: corners.to_vec(), triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]] };
    let (low, high) = corners.iter().fold((corners[0], corners[0]), |(l, h), p| (l.inf(p), h.sup(p)));
    let beyond = |t: [u32; 3], p: Vec3| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(&(c - a)).dot(&(p - a)) > 0.0
    };
    let cloud = grid(low, high, CELLS, |p| !mesh.triangles.iter().any(|t| beyond(*t, p)));
    let ours = weigh_mesh(&mesh, Dimension::Solid).unwrap().properties;
    agrees_with_grid(&ours, &cloud);
    agree(&ours, &tensor(&straight::mesh_solid(&mesh, Vec3::new(1.0, -1.0, 0.5))));
}

#[test]
fn the_grid_sees_fillets_slices_and_stretches_alike() {
    let tube = Geometry::Tube { outer_radius: 0.4, inner_radius: 0.2, length: 0.5 };
    let frustum = Geometry::Frustum { radius_x: 0.3, radius_y: 0.4, top_scale: 0.6, length: 0.5 };
    let torus = Geometry::Torus { ring_radius: 0.4, pipe_radius: 0.15 };
    for (geometry, fillet) in [(tube, 0.07), (frustum, 0.08), (torus, 0.0)] {
        let finish = Finish { fillet, slice: Some([0.3, 4.1]), ..Finish::default() };
        let factors = [1.2, -0.8, 0.9];
        let shape = Shape::finished(geometry, finish, Scaling { factors, ..Scaling::default() }).unwrap();
        let round = Round::of(&shape.geometry, &finish, shape.stretch).unwrap();
        let (low, high) = round.box_around();
        agrees_with_grid(&weigh(&shape, Dimension::Solid), &grid(low, high, CELLS, |p| round.contains(p)));
    }
}
