//! The detector as a whole: lists of near pairs, names that last, manifolds, surfaces, memory.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "contact/scene.rs"]
mod scene;
mod support;

use realnoid::contact::{Detector, Touch};
use realnoid::math::{Pose, Quat, V3, Vec3};
use realnoid::shape::{ContactForm, TriMesh};
use scene::{Scene, collider, forms, pose};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;
use support::Random;

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call goes on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|c| c.set(c.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        COUNT.with(|c| c.set(c.get() + 1));
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A floor of (n × n) squares of `edge`, each two triangles, bent by `height`; inner corners are moved within the plane.
fn floor(n: usize, edge: f64, height: impl Fn(f64, f64) -> f64) -> ContactForm {
    let mut rng = Random(3);
    let mut mesh = TriMesh::default();
    for j in 0..=n {
        for i in 0..=n {
            let mut at = |i: usize| (i as f64 - 0.5 * n as f64 + 0.3 * rng.unit()) * edge;
            let (x, y) = (at(i), at(j));
            mesh.vertices.push(Vec3::new(x, y, height(x, y)));
        }
    }
    let id = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    for j in 0..n {
        for i in 0..n {
            mesh.triangles.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            mesh.triangles.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
    }
    ContactForm::Surface(Arc::new(mesh))
}

fn found(detector: &mut Detector, scene: &Scene) -> Vec<Touch> {
    let mut out = vec![];
    detector.find(&scene.k, 1e-3, &mut out);
    out
}

fn told(touches: &[Touch]) -> String {
    format!("{touches:?}")
}

/// A crowd that drifts, turns and jumps: a detector that lives through it says bit for bit what a new one says, and what
/// detectors for one pair each say.
#[test]
fn the_list_of_near_pairs_leaves_nothing_out() {
    let mut rng = Random(1);
    let list: Vec<ContactForm> = (0..2).flat_map(|_| forms(&mut rng)).collect();
    let mut scene = Scene::new(&list);
    scene.model.colliders.push(collider(ContactForm::HalfSpace, None, Pose::translation(0.0, 0.0, -0.8)));
    scene.model.colliders.push(collider(floor(8, 0.3, |x, _| 0.1 * x), None, Pose::translation(0.0, 0.0, -0.7)));
    let n = scene.model.colliders.len();
    let mut lasting = Detector::new(&scene.model).unwrap();
    let mut pairs: Vec<(u32, u32, Detector)> = vec![];
    for a in 0..n {
        for b in a + 1..n {
            let mut m = scene.model.clone();
            m.colliders = vec![m.colliders[a].clone(), m.colliders[b].clone()];
            pairs.extend(Detector::new(&m).map(|d| (a as u32, b as u32, d)));
        }
    }
    let mut at: Vec<(Pose, Vec3, Vec3)> =
        list.iter().map(|_| (pose(&mut rng, 0.8), rng.vec3(2.0), rng.vec3(4.0))).collect();
    let mut total = 0;
    for step in 0..300 {
        for (i, (x, v, w)) in at.iter_mut().enumerate() {
            x.translation.vector += *v * 2e-3;
            x.rotation = Quat::from_scaled_axis(*w * 2e-3) * x.rotation;
            if step % 100 == 99 {
                *x = pose(&mut rng, 0.8);
            }
            scene.place(i, *x);
            scene.k.v[i + 1] = V3::from(x.inverse_transform_vector(v));
            scene.k.w[i + 1] = V3::from(x.inverse_transform_vector(w));
        }
        let touches = found(&mut lasting, &scene);
        assert!(touches.windows(2).all(|w| w[0].key() < w[1].key()));
        total += touches.len();
        let mut fresh = Detector::new(&scene.model).unwrap();
        assert_eq!(told(&touches), told(&found(&mut fresh, &scene)), "step {step}");
        let mut single = vec![];
        for (a, b, detector) in &mut pairs {
            let mut out = vec![];
            detector.find(&scene.k, 1e-3, &mut out);
            single.extend(out.into_iter().map(|t| Touch { pair: [*a, *b], ..t }));
        }
        assert_eq!(told(&touches), told(&single), "step {step}");
    }
    assert!(total > 3000, "{total}");
}

fn on_plane(form: ContactForm, pose: Pose) -> (Scene, Vec<Touch>) {
    let mut scene = Scene::new(&[form]);
    scene.model.colliders.push(collider(ContactForm::HalfSpace, None, Pose::identity()));
    scene.place(0, pose);
    let mut detector = Detector::new(&scene.model).unwrap();
    let touches = found(&mut detector, &scene);
    (scene, touches)
}

fn lying() -> Quat {
    Quat::from_axis_angle(&Vec3::y_axis(), std::f64::consts::FRAC_PI_2)
}

#[test]
fn manifolds_on_a_plane_have_the_points_that_matter() {
    let cylinder = ContactForm::Cylinder { radius: 0.1, half: 0.2 };
    let (scene, side) = on_plane(cylinder.clone(), Pose::from_parts(Vec3::new(0.0, 0.0, 0.1).into(), lying()));
    assert_eq!(side.len(), 2);
    let ends: Vec<f64> = side.iter().map(|t| t.placed(&scene.k).point.x).collect();
    assert!((ends[0].abs() - 0.2).abs() < 1e-12 && (ends[0] + ends[1]).abs() < 1e-12, "{ends:?}");
    let (scene, cap) = on_plane(cylinder, Pose::translation(0.0, 0.0, 0.2));
    assert!(cap.len() >= 4);
    for t in &cap {
        let p = t.placed(&scene.k);
        assert!((p.point.x.hypot(p.point.y) - 0.1).abs() < 1e-12 && p.gap.abs() < 1e-12);
    }
    let block = ContactForm::Cuboid { half: [0.1, 0.2, 0.05] };
    assert_eq!(on_plane(block, Pose::translation(0.0, 0.0, 0.05)).1.len(), 4);
    // A cylinder rolls on exactly as it did: its cores are on its axis.
    let roll = Quat::from_axis_angle(&Vec3::x_axis(), 1.0);
    let (mut scene, side) = on_plane(
        ContactForm::Cylinder { radius: 0.1, half: 0.2 },
        Pose::from_parts(Vec3::new(0.0, 0.0, 0.1).into(), lying()),
    );
    scene.place(0, Pose::from_parts(Vec3::new(0.0, 0.0, 0.1).into(), roll * lying()));
    assert!(side.iter().all(|t| t.placed(&scene.k).gap.abs() < 1e-12));
}

fn over(below: ContactForm, above: ContactForm, x: Pose) -> (Scene, Detector) {
    let mut scene = Scene::new(&[below, above]);
    scene.place(1, x);
    let detector = Detector::new(&scene.model).unwrap();
    (scene, detector)
}

#[test]
fn manifolds_on_a_box_are_those_on_a_plane() {
    let table = ContactForm::Cuboid { half: [1.0, 1.0, 0.1] };
    let at = |z: f64, turn: Quat| Pose::from_parts(Vec3::new(0.2, 0.1, 0.1 + z).into(), turn);
    let flat = Quat::from_axis_angle(&Vec3::z_axis(), 0.3);
    let cases = [
        (ContactForm::Cuboid { half: [0.1, 0.2, 0.05] }, at(0.05, flat), 4, 4),
        (ContactForm::RoundCuboid { half: [0.1, 0.2, 0.05], radius: 0.02 }, at(0.07, flat), 4, 4),
        (ContactForm::Capsule { bottom: 0.1, top: 0.1, half: 0.2 }, at(0.1, flat * lying()), 2, 2),
        (ContactForm::Cylinder { radius: 0.1, half: 0.2 }, at(0.1, flat * lying()), 2, 2),
        (ContactForm::Cylinder { radius: 0.1, half: 0.2 }, at(0.2, flat), 4, 6),
        (ContactForm::Frustum { radii: [0.1, 0.15], top: 0.5, half: 0.2 }, at(0.2, flat), 4, 6),
        (ContactForm::Cone { radius: 0.1, half: 0.2 }, at(0.2, flat), 4, 6),
        (ContactForm::Ball { radius: 0.1 }, at(0.1, flat), 1, 1),
        (ContactForm::Ellipsoid { radii: [0.1, 0.2, 0.3] }, at(0.3, flat), 1, 1),
    ];
    for (form, x, least, most) in cases {
        for sunk in [0.0, 1e-4, -1e-3] {
            let mut lowered = x;
            lowered.translation.vector.z -= sunk;
            for swapped in [false, true] {
                let mut scene =
                    Scene::new(&if swapped { [form.clone(), table.clone()] } else { [table.clone(), form.clone()] });
                scene.place(usize::from(!swapped), lowered);
                let mut detector = Detector::new(&scene.model).unwrap();
                let touches = found(&mut detector, &scene);
                assert!((least..=most).contains(&touches.len()), "{form:?} {sunk} {swapped}: {touches:#?}");
                let up = if swapped { -1.0 } else { 1.0 };
                for t in &touches {
                    let p = t.placed(&scene.k);
                    assert!((p.gap + sunk).abs() < 1e-9, "{form:?} {sunk}: {}", p.gap);
                    assert!((p.normal.z - up).abs() < 1e-12 && p.normal.x.hypot(p.normal.y) < 1e-7, "{form:?} {p:?}");
                }
            }
        }
    }
    let block = ContactForm::Cuboid { half: [0.1; 3] };
    let turned = Quat::from_axis_angle(&Vec3::z_axis(), std::f64::consts::FRAC_PI_4);
    let (scene, mut detector) = over(block.clone(), block, Pose::from_parts(Vec3::new(0.0, 0.0, 0.2).into(), turned));
    assert_eq!(found(&mut detector, &scene).len(), 6, "an octagon, reduced");
}

#[test]
fn names_last_through_a_slow_motion() {
    let table = ContactForm::Cuboid { half: [0.3, 0.3, 0.1] };
    let hull: Vec<Vec3> = (0..6)
        .map(|i| {
            Vec3::from(match i % 3 {
                0 => [0.1, 0.0, 0.1 * (i / 3) as f64],
                1 => [-0.05, 0.08, 0.1 * (i / 3) as f64],
                _ => [-0.05, -0.08, 0.1 * (i / 3) as f64],
            })
        })
        .collect();
    let cases = [
        (ContactForm::Cuboid { half: [0.1, 0.1, 0.05] }, 0.05),
        (ContactForm::Hull(hull.into()), 0.0),
        (ContactForm::Cylinder { radius: 0.1, half: 0.1 }, 0.1),
    ];
    for (form, z) in cases {
        // Half over the edge of the table, so that some points are crossings of edges.
        for x in [0.0, 0.28] {
            let mut scene = Scene::new(&[table.clone(), form.clone()]);
            let mut detector = Detector::new(&scene.model).unwrap();
            let mut known: Option<Vec<_>> = None;
            for step in 0..200 {
                let s = f64::from(step);
                let turn = Quat::from_axis_angle(&Vec3::z_axis(), 0.1 + 1e-5 * s);
                let sunk = 1e-5 * (0.3 * s).sin();
                scene.place(1, Pose::from_parts(Vec3::new(x + 1e-6 * s, 0.01, 0.1 + z - 2e-5 + sunk).into(), turn));
                let keys: Vec<_> = found(&mut detector, &scene).iter().map(Touch::key).collect();
                assert!(keys.len() >= 3);
                assert_eq!(known.get_or_insert_with(|| keys.clone()), &keys, "{form:?} {x} step {step}");
            }
        }
    }
}

#[test]
fn a_triangulated_floor_is_flat() {
    let level = floor(20, 0.1, |_, _| 0.0);
    for (form, z, least) in [
        (ContactForm::Ball { radius: 0.1 }, 0.1, 1),
        (ContactForm::Capsule { bottom: 0.05, top: 0.05, half: 0.2 }, 0.05, 2),
        (ContactForm::Cuboid { half: [0.12, 0.07, 0.1] }, 0.1, 4),
    ] {
        let mut scene = Scene::new(&[form.clone()]);
        scene.model.colliders.push(collider(level.clone(), None, Pose::identity()));
        let mut detector = Detector::new(&scene.model).unwrap();
        for step in 0..2000 {
            let s = f64::from(step);
            let sunk = 5e-5 * (0.1 * s).sin();
            let turn = Quat::from_axis_angle(&Vec3::z_axis(), 1e-3 * s);
            let lie = if matches!(form, ContactForm::Capsule { .. }) { turn * lying() } else { turn };
            scene.place(0, Pose::from_parts(Vec3::new(-0.5 + 5e-4 * s, 0.3e-3 * s - 0.3, z + sunk).into(), lie));
            let touches = found(&mut detector, &scene);
            assert!(touches.len() >= least, "{form:?} step {step}: {}", touches.len());
            for t in &touches {
                let p = t.placed(&scene.k);
                let tilt = p.normal.x.hypot(p.normal.y);
                assert!(tilt < 1e-9, "{form:?} step {step}: normal {:?} gap {}", p.normal, p.gap);
                assert!((p.gap - sunk).abs() < 1e-9, "{form:?} step {step}: {} {sunk}", p.gap);
            }
        }
    }
}

#[test]
fn ridges_and_valleys_are_met() {
    for (fold, count) in [(-0.5, 1), (0.5, 2)] {
        let v = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let vertices = vec![
            v(0.0, -1.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(1.0, -1.0, fold),
            v(1.0, 1.0, fold),
            v(-1.0, -1.0, fold),
            v(-1.0, 1.0, fold),
        ];
        let triangles = vec![[0, 2, 3], [0, 3, 1], [4, 0, 1], [4, 1, 5]];
        let bent = ContactForm::Surface(Arc::new(TriMesh { vertices, triangles }));
        let mut scene = Scene::new(&[ContactForm::Ball { radius: 0.1 }]);
        scene.model.colliders.insert(0, collider(bent, None, Pose::identity()));
        // Distance from the fold: 0.1 on a ridge; in a valley the planes touch at 0.1/cos of their slope.
        let z = if fold < 0.0 { 0.1 } else { 0.1 * 1.25f64.sqrt() };
        scene.place(0, Pose::translation(0.0, 0.1, z));
        let mut detector = Detector::new(&scene.model).unwrap();
        let touches = found(&mut detector, &scene);
        assert_eq!(touches.len(), count);
        assert!(touches.iter().all(|t| t.placed(&scene.k).gap.abs() < 1e-12));
    }
}

#[test]
fn once_warm_nothing_is_allocated() {
    let mut rng = Random(5);
    let list: Vec<ContactForm> = (0..2).flat_map(|_| forms(&mut rng)).collect();
    let mut scene = Scene::new(&list);
    scene.model.colliders.push(collider(ContactForm::HalfSpace, None, Pose::translation(0.0, 0.0, -0.5)));
    scene.model.colliders.push(collider(floor(8, 0.2, |x, y| 0.3 * x * y), None, Pose::translation(0.0, 0.0, -0.4)));
    let mut detector = Detector::new(&scene.model).unwrap();
    let at: Vec<(Pose, Vec3)> = list.iter().map(|_| (pose(&mut rng, 0.4), rng.vec3(3.0))).collect();
    let mut out = vec![];
    let mut run = || {
        let mut count = 0;
        for step in 0..500 {
            for (i, (x, w)) in at.iter().enumerate() {
                let s = 0.01 * f64::from(step);
                let shift = Vec3::new(0.1 * s.sin(), 0.2 * (2.0 * s).cos(), 0.1 * s.cos());
                let turned = Quat::from_scaled_axis(*w * s) * x.rotation;
                scene.place(i, Pose::from_parts((x.translation.vector + shift).into(), turned));
            }
            let before = COUNT.with(Cell::get);
            detector.find(&scene.k, 1e-3, &mut out);
            count += COUNT.with(Cell::get) - before;
        }
        (count, out.len())
    };
    run();
    let (count, touches) = run();
    assert!(touches > 10);
    assert_eq!(count, 0);
}

#[test]
fn fast_parts_are_told() {
    let mut scene = Scene::new(&[ContactForm::Ball { radius: 0.1 }]);
    scene.model.colliders.push(collider(ContactForm::HalfSpace, None, Pose::identity()));
    let mut detector = Detector::new(&scene.model).unwrap();
    let mut out = vec![];
    scene.place(0, Pose::translation(0.0, 0.0, 0.5));
    scene.k.v[1] = V3::new(0.0, 0.0, -50.0);
    detector.find(&scene.k, 0.01, &mut out);
    assert!((detector.fastest() - 0.5 / 0.2).abs() < 1e-12);
    assert_eq!(out.len(), 1);
    scene.place(0, Pose::translation(0.0, 0.0, 5.0));
    detector.find(&scene.k, 0.01, &mut out);
    assert_eq!((detector.fastest(), out.len()), (0.0, 0));
}
