//! Every shape comes to rest where its outside is: margins of Bullet do not show.

use super::touching::{free_body, ground, on_link, surface};
use super::{run, world};
use realnoid::engine::State;
use realnoid::math::{Pose, Quat, Vec3};
use realnoid::model::{Collider, Model};
use realnoid::shape::{ContactForm, TriMesh};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// The margin that is compensated, 0.5 mm, must not show; what Bullet's iterative search for contacts is told to find is 0.1 mm.
const REST: f64 = 1e-4;

/// Name, shape, how it is turned, and how high its frame's origin is when it rests, m.
fn shapes() -> Vec<(&'static str, ContactForm, Quat, f64)> {
    let (up, lying) = (Quat::identity(), Quat::from_axis_angle(&Vec3::y_axis(), FRAC_PI_2));
    let corners = |half: [f64; 3]| -> Arc<[Vec3]> {
        (0..8).map(|k| Vec3::from_fn(|i, _| if k >> i & 1 == 1 { half[i] } else { -half[i] })).collect()
    };
    // A tapered capsule touches with both balls where it leans by the difference of their radii over their distance.
    let lean = Quat::from_axis_angle(&Vec3::y_axis(), FRAC_PI_2 - (0.02f64 / 0.2).asin());
    vec![
        ("ball", ContactForm::Ball { radius: 0.1 }, up, 0.1),
        ("small ball", ContactForm::Ball { radius: 0.01 }, up, 0.01),
        ("cuboid", ContactForm::Cuboid { half: [0.1, 0.08, 0.06] }, up, 0.06),
        ("thin cuboid", ContactForm::Cuboid { half: [0.1, 0.08, 0.004] }, up, 0.004),
        ("round cuboid", ContactForm::RoundCuboid { half: [0.08, 0.07, 0.05], radius: 0.02 }, up, 0.07),
        ("capsule", ContactForm::Capsule { bottom: 0.05, top: 0.05, half: 0.1 }, lying, 0.05),
        ("tapered capsule", ContactForm::Capsule { bottom: 0.05, top: 0.03, half: 0.1 }, lean, 0.04),
        ("ellipsoid", ContactForm::Ellipsoid { radii: [0.1, 0.08, 0.05] }, up, 0.05),
        ("cylinder", ContactForm::Cylinder { radius: 0.06, half: 0.05 }, up, 0.05),
        ("lying cylinder", ContactForm::Cylinder { radius: 0.06, half: 0.05 }, lying, 0.06),
        ("cone", ContactForm::Cone { radius: 0.1, half: 0.08 }, up, 0.08),
        ("frustum", ContactForm::Frustum { radii: [0.1, 0.07], top: 0.5, half: 0.05 }, up, 0.05),
        ("elliptic cylinder", ContactForm::Frustum { radii: [0.1, 0.07], top: 1.0, half: 0.05 }, up, 0.05),
        ("lying elliptic cylinder", ContactForm::Frustum { radii: [0.05, 0.1], top: 1.0, half: 0.05 }, lying, 0.05),
        ("elliptic cone", ContactForm::Frustum { radii: [0.1, 0.07], top: 0.0, half: 0.05 }, up, 0.05),
        ("disc", ContactForm::Frustum { radii: [0.1, 0.1], top: 1.0, half: 0.0 }, up, 0.0),
        ("hull", ContactForm::Hull(corners([0.1, 0.08, 0.06])), up, 0.06),
    ]
}

/// A body of this shape just above what it falls on.
fn rest(form: ContactForm, turn: Quat, (margin, height): (f64, f64), floor: Collider) -> f64 {
    let mut m: Model = free_body(1.0, [0.004, 0.005, 0.006]);
    let own = on_link(&m, "b", form, surface(1.0));
    let pose = Pose::from_parts(nalgebra::Translation3::identity(), turn);
    m.set_colliders(vec![floor, Collider { pose, margin, ..own }]);
    let mut s = State::initial(&m);
    s.set_base_pose(&m, [0.0, 0.0, height + 1e-3], [0.0, 0.0, 0.0, 1.0]);
    let mut w = world(m, 1e-3);
    w.set_initial_state(s);
    run(&mut w, 1.0);
    w.state().q[2]
}

/// A plane; a box whose upper face is at z = 0; two triangles.
fn floors() -> [(&'static str, Collider); 3] {
    let at = |z: f64| Pose::translation(0.0, 0.0, z);
    let vertices = [[-1.0, -1.1], [1.0, -1.0], [1.0, 1.1], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
    let mesh = TriMesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] };
    [
        ("plane", ground(1.0)),
        ("box", Collider { form: ContactForm::Cuboid { half: [1.0, 1.0, 0.2] }, pose: at(-0.2), ..ground(1.0) }),
        ("mesh", Collider { form: ContactForm::Surface(Arc::new(mesh)), ..ground(1.0) }),
    ]
}

#[test]
fn every_shape_rests_at_its_outside() {
    let mut wrong = vec![];
    for (floor, collider) in floors() {
        for (name, form, turn, height) in shapes() {
            for margin in [0.0, 0.01] {
                let z = rest(form.clone(), turn, (margin, height + margin), collider.clone());
                if (z - height - margin).abs() > REST {
                    wrong.push(format!("{name} with margin {margin} on a {floor}: {z} instead of {}", height + margin));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
