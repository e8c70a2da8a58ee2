//! Nothing of the engine physx is left behind, and what PhysX refuses is an error. By itself: it counts what a process has.
#![cfg(feature = "physx")]
#![allow(clippy::unwrap_used)] // a test may panic

mod touching;

use realnoid::engine::{EngineKind, State, physx::allocations};
use realnoid::math::{Pose, Vec3};
use realnoid::model::{Collider, Model};
use realnoid::shape::{ContactForm, TriMesh};
use std::sync::Arc;
use touching::*;

fn mesh(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Collider {
    let form = ContactForm::Surface(Arc::new(TriMesh { vertices, triangles }));
    Collider { form, pose: Pose::translation(3.0, 0.0, 0.0), ..ground(1.0) }
}

/// A box with a hull on its back, a plane, and a triangle.
fn crowd() -> Model {
    let mut m = cuboid(1.0, [0.1, 0.2, 0.3], surface(1.0), ground(1.0));
    let mut colliders = std::mem::take(&mut m.colliders);
    let hull = ContactForm::Hull([Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()].into());
    colliders.push(on_link(&m, "b", hull, surface(0.5)));
    colliders.push(mesh(vec![Vec3::zeros(), Vec3::x(), Vec3::y()], vec![[0, 1, 2]]));
    m.set_colliders(colliders);
    m
}

#[test]
fn a_thousand_builds_and_drops_leave_nothing() {
    let m = Arc::new(crowd());
    let s = realnoid::world::Settings { engine: EngineKind::Physx, ..settings(1e-3, Default::default()) };
    let once = || {
        let mut w = realnoid::world::World::new(m.clone(), s).unwrap();
        (0..3).for_each(|_| w.advance());
        let copy = w.clone();
        assert!(allocations() > 0);
        drop((w, copy));
    };
    // PhysX's own tables grow with the first ones.
    (0..20).for_each(|_| once());
    let (before, start) = (allocations(), std::time::Instant::now());
    (0..1000).for_each(|_| once());
    assert_eq!(allocations(), before);
    println!("{:.0} µs for each world with its copy", start.elapsed().as_secs_f64() * 1e3);
    what_is_refused_is_an_error(&crowd());
    assert_eq!(allocations(), before);
}

fn what_is_refused_is_an_error(m: &Model) {
    let with = |more: Collider| {
        let mut m = m.clone();
        let mut colliders = std::mem::take(&mut m.colliders);
        colliders.push(more);
        m.set_colliders(colliders);
        EngineKind::Physx.build(&m, &State::initial(&m)).map(|_| ()).unwrap_err()
    };
    let told = with(mesh(vec![Vec3::zeros()], vec![[0, 7, 8]]));
    assert!(told.contains("corner that is not there"), "{told}");
    let told = with(mesh(vec![Vec3::zeros(); 3], vec![[0, 1, 2]]));
    assert!(told.contains("physx"), "{told}");
    let told = with(on_link(m, "b", ContactForm::HalfSpace, surface(1.0)));
    assert!(told.contains("'b' moves"), "{told}");
    let told = with(Collider { pose: Pose::translation(1e300, 0.0, 0.0), ..ground(1.0) });
    assert!(told.contains("single precision"), "{told}");
    let mut light = m.clone();
    light.bodies[1].mass = 1e-50;
    assert!(EngineKind::Physx.build(&light, &State::initial(&light)).is_err());
}
