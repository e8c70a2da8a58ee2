//! Nothing of the engine bullet is left behind, and what C++ throws is an error. By itself: it counts what a process has.
#![cfg(feature = "bullet")]
#![allow(clippy::unwrap_used)] // a test may panic

mod touching;

use realnoid::engine::{EngineKind, State, bullet::worlds};
use realnoid::math::Vec3;
use realnoid::model::{Base, Collider};
use realnoid::shape::{ContactForm, TriMesh};
use std::sync::Arc;
use touching::*;

/// What this process has in memory, bytes.
fn resident() -> usize {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap();
    text.split_whitespace().nth(1).unwrap().parse::<usize>().unwrap() * 4096
}

#[test]
fn a_thousand_builds_and_drops_leave_nothing() {
    let vertices = vec![Vec3::zeros(), Vec3::x(), Vec3::y()];
    let mesh = TriMesh { vertices, triangles: vec![[0, 1, 2]] };
    let mut m = feet("urdf/origin.urdf", 1.0);
    let mut colliders = std::mem::take(&mut m.colliders);
    colliders.push(Collider { form: ContactForm::Surface(Arc::new(mesh)), ..ground(1.0) });
    m.set_colliders(colliders);
    let m = Arc::new(m);
    let s = realnoid::world::Settings { engine: EngineKind::Bullet, ..settings(1e-3, Default::default()) };
    let mut before = 0;
    for k in 0..1000 {
        let mut w = realnoid::world::World::new(m.clone(), s).unwrap();
        w.advance();
        let copy = w.clone();
        assert_eq!(worlds(), 2);
        drop((w, copy));
        assert_eq!(worlds(), 0);
        if k == 200 {
            before = resident();
        }
    }
    let grown = resident().saturating_sub(before);
    // A world of the humanoid has some 200 kB; 800 of them, twice, would be 320 MB.
    assert!(grown < 4 << 20, "{grown} bytes more after 800 worlds");
    what_bullet_throws_is_an_error();
    assert_eq!(worlds(), 0);
}

fn what_bullet_throws_is_an_error() {
    let mut m = model(r#"<robot name="r"><link name="w"/></robot>"#, Base::Fixed);
    let mesh = TriMesh { vertices: vec![Vec3::zeros()], triangles: vec![[0, 7, 8]] };
    m.set_colliders(vec![ground(1.0), Collider { form: ContactForm::Surface(Arc::new(mesh)), ..ground(1.0) }]);
    let told = EngineKind::Bullet.build(&m, &State::initial(&m)).unwrap_err();
    assert!(told.contains("corner that is not there"), "{told}");
}
