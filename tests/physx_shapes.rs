//! The engine physx: every shape rests at its outside, on a plane and on a mesh; and which pairs never touch.
#![cfg(feature = "physx")]
#![allow(clippy::unwrap_used)] // a test may panic

mod touching;

use realnoid::engine::{EngineKind, shortfalls};
use realnoid::math::{Quat, Vec3};
use realnoid::model::{Collider, Model};
use realnoid::shape::{ContactForm, TriMesh};
use realnoid::world::{Settings, World};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;
use touching::*;

fn physx(m: Model) -> World {
    world(m, Settings { engine: EngineKind::Physx, ..settings(1e-3, Default::default()) })
}

/// A free body of this form, turned about x, over a floor; heavy damping of its turning brings it to rest.
fn dropped(form: ContactForm, floor: Collider, at: f64, turned: f64) -> World {
    let mut m = free_body(2.0, [0.01, 0.01, 0.01]);
    let own = on_link(&m, "b", form, surface(1.0));
    m.set_colliders(vec![floor, own]);
    let turn = Quat::from_axis_angle(&Vec3::x_axis(), turned);
    let mut w = physx(m);
    let mut state = w.state().clone();
    state.q[..7].copy_from_slice(&[0.01, 0.02, at, turn.w, turn.i, turn.j, turn.k]);
    w.set_initial_state(state);
    w
}

fn height(w: &World) -> f64 {
    w.state().q[2]
}

/// 0.2 m · 0.2 m · 0.4 m with more corners than PhysX takes: a grid on its sides.
fn many_corners() -> ContactForm {
    let corner = |i: u32| {
        let (around, up) = (f64::from(i % 20) * PI / 10.0, f64::from(i / 20) / 19.0 - 0.5);
        Vec3::new(0.1 * around.cos(), 0.1 * around.sin(), 0.4 * up)
    };
    // 400 points, of which those of the two rims are corners; and a ball's worth on the upper end.
    let cap = |i: u32| {
        let (around, up) = (f64::from(i % 30) * PI / 15.0, f64::from(i / 30) * FRAC_PI_2 / 11.0);
        Vec3::new(0.1 * up.cos() * around.cos(), 0.1 * up.cos() * around.sin(), 0.2 + 0.1 * up.sin())
    };
    ContactForm::Hull((0..400).map(corner).chain((0..330).map(cap)).collect())
}

/// Two triangles, at z = 0.
fn square() -> Collider {
    let vertices = vec![[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]];
    let vertices = vertices.into_iter().map(|[x, y]| Vec3::new(x, y, 0.0)).collect();
    let form = ContactForm::Surface(Arc::new(TriMesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] }));
    Collider { form, ..ground(1.0) }
}

/// Form, turn about x, height of its origin at rest, and by how much a polyhedron of it may be too low: 48 corners around 1 − cos(π/48)
/// = 0.2 % of the radius, 22 by 11 of an ellipsoid 2 %.
fn rows() -> Vec<(&'static str, ContactForm, f64, f64, f64)> {
    let lying = FRAC_PI_2;
    let corners = [[1.0, 0.0], [-0.5, 0.75_f64.sqrt()], [-0.5, -(0.75_f64.sqrt())]];
    let prism = corners.iter().flat_map(|[x, y]| [-0.1, 0.1].map(|z| Vec3::new(0.2 * x, 0.2 * y, z))).collect();
    let flat = corners.map(|[x, y]| Vec3::new(0.2 * x, 0.2 * y, 0.0));
    vec![
        ("ball", ContactForm::Ball { radius: 0.1 }, 0.0, 0.1, 0.0),
        ("box", ContactForm::Cuboid { half: [0.2, 0.15, 0.1] }, 0.0, 0.1, 0.0),
        ("round box", ContactForm::RoundCuboid { half: [0.15, 0.1, 0.08], radius: 0.02 }, 0.0, 0.1, 0.0),
        ("round plate", ContactForm::RoundCuboid { half: [0.15, 0.1, 0.0], radius: 0.02 }, 0.0, 0.02, 0.0),
        ("capsule", ContactForm::Capsule { bottom: 0.1, top: 0.1, half: 0.15 }, lying, 0.1, 0.0),
        ("standing capsule", ContactForm::Capsule { bottom: 0.1, top: 0.05, half: 0.15 }, 0.0, 0.25, 0.0),
        ("ellipsoid", ContactForm::Ellipsoid { radii: [0.15, 0.12, 0.08] }, 0.0, 0.08, 2e-2 * 0.08),
        ("cylinder", ContactForm::Cylinder { radius: 0.1, half: 0.15 }, 0.0, 0.15, 0.0),
        ("lying cylinder", ContactForm::Cylinder { radius: 0.1, half: 0.15 }, lying, 0.1, 2.2e-3 * 0.1),
        ("cone", ContactForm::Cone { radius: 0.1, half: 0.1 }, 0.0, 0.1, 0.0),
        ("frustum", ContactForm::Frustum { radii: [0.1, 0.15], top: 0.5, half: 0.1 }, 0.0, 0.1, 0.0),
        ("prism", ContactForm::Hull(prism), 0.0, 0.1, 0.0),
        // Plates are 0.2 % of their size thicker on each side than they are.
        ("disc", ContactForm::Frustum { radii: [0.1, 0.1], top: 1.0, half: 0.0 }, 0.0, 2e-3 * 0.1, 0.0),
        ("triangle", ContactForm::Hull(flat.into()), 0.0, 2e-3 * 0.2, 0.0),
        ("many corners", many_corners(), 0.0, 0.2, 2e-2 * 0.2),
    ]
}

#[test]
fn shapes_rest_at_their_outside() {
    for (name, form, turned, rest, low) in rows() {
        for (floor, on) in [(ground(1.0), "plane"), (square(), "mesh")] {
            let mut w = dropped(form.clone(), floor, rest + 0.01, turned);
            // What stands on a ball falls over in the end.
            let steps = if name == "standing capsule" { 300 } else { 1000 };
            (0..steps).for_each(|_| w.advance());
            assert_eq!(w.stats().diverged_steps, 0);
            let off = height(&w) - rest;
            println!("{name} on a {on}: {off:e} m");
            assert!(off < 1e-4 && off > -1e-4 - low, "{name} on a {on}: {off}");
        }
    }
}

/// A tapered capsule is exact at its ends and within 0.2 % between them: it lies on its side as the tangent of both balls does.
#[test]
fn a_tapered_capsule_lies_on_both_ends() {
    let form = ContactForm::Capsule { bottom: 0.1, top: 0.05, half: 0.15 };
    let sine: f64 = 0.05 / 0.3;
    let mut w = dropped(form, ground(1.0), 0.08, -FRAC_PI_2 - sine.asin());
    (0..1000).for_each(|_| w.advance());
    let (q, rest) = (w.state().q.clone(), 0.1 - 0.15 * sine);
    let axis = Quat::new_normalize(nalgebra::Quaternion::new(q[3], q[4], q[5], q[6])) * Vec3::z();
    assert!((q[2] - rest).abs() < 2e-4 && (axis.z.abs() - sine).abs() < 2e-3, "{} {rest} {axis}", q[2]);
}

/// What is not quite the shape is told, and so is what does not collide.
#[test]
fn polyhedra_are_told() {
    let told = |form: ContactForm| {
        let m = { dropped(form, ground(1.0), 1.0, 0.0).model().clone() };
        shortfalls(EngineKind::Physx, &m).into_iter().map(|s| s.instead).collect::<Vec<_>>()
    };
    assert!(told(ContactForm::Ball { radius: 0.1 }).is_empty());
    assert!(told(ContactForm::RoundCuboid { half: [0.1; 3], radius: 0.02 }).is_empty());
    assert_eq!(told(ContactForm::Ellipsoid { radii: [0.1, 0.2, 0.3] }), ["it collides as a polyhedron"]);
    assert_eq!(told(many_corners()), ["it collides as the hull of 128 of its corners"]);
    let flat = ContactForm::Hull([Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::x() + Vec3::y()].into());
    assert_eq!(told(flat), ["it collides as a plate whose thickness is 0.4 % of its size"]);
    let line = ContactForm::Hull([Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0, Vec3::x() * 3.0].into());
    assert_eq!(told(line), ["it does not collide"]);
}

/// Margins keep a box off the ground.
#[test]
fn margins_keep_apart() {
    let mut m = cuboid(3.0, [0.2, 0.2, 0.1], surface(1.0), Collider { margin: 0.01, ..ground(1.0) });
    m.colliders[1].margin = 0.02;
    let mut w = physx(m);
    let mut state = w.state().clone();
    state.q[2] = 0.2;
    w.set_initial_state(state);
    (0..1000).for_each(|_| w.advance());
    assert!((height(&w) - 0.13).abs() < 1e-4, "{}", height(&w));
    // It arrives with 1.2 m/s: less than a step of that.
    assert!(w.stats().worst_penetration < 1.2e-3, "{}", w.stats().worst_penetration);
}

/// Cubes above each other: where their links never touch, the upper one falls into the lower one.
#[test]
fn excluded_pairs_never_touch() {
    for excluded in [false, true] {
        let mut m = cubes(&[1.0, 1.0], 0.1, surface(1.0), ground(1.0));
        if excluded {
            let link = |name: &str| m.links.iter().position(|l| l.name == name).unwrap();
            m.excluded_pairs = vec![[link("b0"), link("b1")]];
        }
        let mut w = physx(m);
        let mut state = w.state().clone();
        (state.q[2], state.q[9]) = (0.1, 0.35);
        w.set_initial_state(state);
        (0..1000).for_each(|_| w.advance());
        let rest = if excluded { 0.1 } else { 0.3 };
        assert!((w.state().q[9] - rest).abs() < 1e-4, "{excluded} {}", w.state().q[9]);
    }
}
