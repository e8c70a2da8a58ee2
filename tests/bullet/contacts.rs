//! Free bodies and their contacts. Bounds are of the method: leapfrog is exact in a fall; facts/engines.md D has what Bullet's
//! friction and its gyroscopic term do.

use super::touching::{ball, cubes, cuboid, free_body, ground, on_link, rest, stack, start, surface};
use super::{G, run, world};
use realnoid::engine::State;
use realnoid::math::{Pose, Vec3};
use realnoid::model::{Collider, Model, Surface};
use realnoid::shape::ContactForm;
use realnoid::world::World;

#[test]
fn a_free_body_falls() {
    let mut w = world(free_body(2.0, [0.01, 0.02, 0.03]), 1e-3);
    start(&mut w, 0.0, Vec3::zeros(), Vec3::new(1.0, 2.0, 3.0));
    run(&mut w, 1.0);
    let q = &w.state().q;
    let exact = [1.0, 2.0, 3.0 - 0.5 * G];
    assert!((0..3).all(|k| (q[k] - exact[k]).abs() < 1e-9), "{q:?}");
}

/// Bullet's implicit gyroscopic term takes energy and momentum; 4 % and 2 % were measured in 10 s.
#[test]
fn a_tumbling_body_loses_no_more_than_bullet_does() {
    let mut w = world(free_body(1.0, [0.01, 0.02, 0.03]), 1e-3);
    start(&mut w, 0.0, Vec3::new(0.01, 10.0, 0.01), Vec3::zeros());
    let mut s = *w.settings();
    s.gravity = [0.0; 3];
    w.set_settings(s).unwrap();
    let (energy, momentum) = (w.energy().kinetic, Vec3::from(w.momentum().angular).norm());
    run(&mut w, 10.0);
    assert!((w.energy().kinetic / energy - 1.0).abs() < 5e-2, "{}", w.energy().kinetic / energy);
    assert!((Vec3::from(w.momentum().angular).norm() / momentum - 1.0).abs() < 3e-2);
}

/// 115° in each step, which Bullet would cut to 45°.
#[test]
fn a_fast_turn_is_not_cut() {
    let mut w = world(free_body(1.0, [0.02; 3]), 1e-3);
    let speed = 2000.0;
    start(&mut w, 0.0, Vec3::new(0.0, 0.0, speed), Vec3::zeros());
    for k in 1..=100 {
        w.advance();
        let q = &w.state().q;
        // Half the angle, from w and z of the quaternion; rounding of 100 steps.
        let off = (2.0 * q[6].atan2(q[3]) - speed * 1e-3 * f64::from(k)).rem_euclid(std::f64::consts::TAU);
        let off = off.min(std::f64::consts::TAU - off);
        assert!(off < 1e-11, "{k}: {off} {q:?}");
    }
}

/// Exactly 1 − 0.2·9.81·0.4 m/s after 0.4 s. Bullet was measured to slow down by up to 3 % more.
#[test]
fn a_box_slides() {
    for direction in [Vec3::x(), Vec3::new(1.0, 1.0, 0.0).normalize(), Vec3::new(2.0, 1.0, 0.0).normalize()] {
        let mut w = world(cuboid(3.0, [0.1; 3], surface(0.4), ground(0.5)), 1e-3);
        start(&mut w, 0.1, Vec3::zeros(), direction);
        run(&mut w, 0.4);
        let v = Vec3::new(w.state().v[3], w.state().v[4], 0.0).norm();
        let exact = 1.0 - 0.2 * G * 0.4;
        assert!((v - exact).abs() < 0.03 * 0.2 * G * 0.4, "{direction:?}: {v} {exact}");
    }
}

/// The force of a resting body's contacts is its weight.
#[test]
fn contacts_tell_their_forces() {
    let mut w = world(cuboid(3.0, [0.1; 3], surface(1.0), ground(1.0)), 1e-3);
    start(&mut w, 0.1, Vec3::zeros(), Vec3::zeros());
    run(&mut w, 1.0);
    let force: Vec3 = w.contacts().iter().map(|c| c.force).sum();
    assert!((force - Vec3::new(0.0, 0.0, 3.0 * G)).norm() < 0.01, "{force:?}");
    for c in w.contacts() {
        assert!(c.colliders == [0, 1] && c.normal.z > 0.999 && c.depth.abs() < 1e-4 && c.point.z.abs() < 1e-4, "{c:?}");
    }
}

/// From 1 m with restitution 0.5 back to 0.25 m. A step's fall at 4.4 m/s is 4.4 mm, of which the bounce may miss its instant.
#[test]
fn a_ball_bounces() {
    let own = Surface { restitution: 0.5, ..surface(1.0) };
    let floor = Collider { surface: Surface { restitution: 1.0, ..surface(1.0) }, ..ground(1.0) };
    let mut w = world(ball(1.0, 0.1, own, floor), 1e-3);
    start(&mut w, 1.1, Vec3::zeros(), Vec3::zeros());
    let mut top: f64 = 0.0;
    for _ in 0..700 {
        w.advance();
        if w.time() > 0.46 {
            top = top.max(w.state().q[2] - 0.1);
        }
    }
    assert!((top - 0.25).abs() < 6e-3, "{top}");
}

#[test]
fn a_tower_stands() {
    let m = cubes(&[1.0; 5], 0.1, surface(1.0), ground(1.0));
    let mut w = world(m.clone(), 1e-3);
    stack(&mut w);
    run(&mut w, 3.0);
    for k in 0..5 {
        let q = &w.state().q[7 * k..];
        let exact = 0.1 + 0.2 * k as f64;
        assert!((q[2] - exact).abs() < 1e-3 && q[0].hypot(q[1]) < 1e-3, "{k}: {:?}", &q[..3]);
    }
}

/// B-8 G: a = 5/7 · g · ρ / r.
#[test]
fn rolling_friction_slows_a_ball_down() {
    let own = Surface { rolling: 0.002, ..surface(1.0) };
    let mut w = world(ball(1.0, 0.1, own, ground(1.0)), 1e-3);
    start(&mut w, 0.1, Vec3::new(0.0, 10.0, 0.0), Vec3::new(1.0, 0.0, 0.0));
    run(&mut w, 1.0);
    let exact = 1.0 - 5.0 / 7.0 * G * 0.002 / 0.1;
    let v = world_velocity(&w);
    assert!((v.x - exact).abs() < 0.01, "{v:?} {exact}");
}

fn world_velocity(w: &World) -> Vec3 {
    let twist = w.new_snapshot().link_twist[0];
    w.new_snapshot().link_pose[0].rotation * twist.linear
}

/// B-8 H, without rolling friction: ω̇ = −σ m g / I.
#[test]
fn spinning_friction_slows_a_top_down() {
    let own = Surface { spinning: 0.002, ..surface(1.0) };
    let mut w = world(ball(1.0, 0.1, own, ground(1.0)), 1e-3);
    start(&mut w, 0.1, Vec3::new(0.0, 0.0, 10.0), Vec3::zeros());
    run(&mut w, 1.0);
    let exact = 10.0 - 0.002 * G / 0.004;
    assert!((w.state().v[2] - exact).abs() < 0.02 * (10.0 - exact), "{} {exact}", w.state().v[2]);
}

/// Two feet of one body, one slippery, carry half of the weight each.
#[test]
fn shapes_of_one_body_keep_their_own_surfaces() {
    let mut m: Model = free_body(1.0, [0.1; 3]);
    let foot = |x: f64, friction: f64| {
        let c = on_link(&m, "b", ContactForm::Cuboid { half: [0.05; 3] }, surface(friction));
        Collider { pose: Pose::translation(0.0, x, 0.0), ..c }
    };
    let feet = vec![ground(1.0), foot(-0.5, 0.2), foot(0.5, 0.2000001), foot(0.0, 0.0)];
    let slippery = vec![ground(1.0), foot(-0.5, 0.0), foot(0.5, 0.0), foot(0.0, 0.0)];
    let (mut slower, mut free) = (m.clone(), m.clone());
    slower.set_colliders(feet);
    free.set_colliders(slippery);
    m = slower;
    for (m, brakes) in [(m, true), (free, false)] {
        let mut w = world(m, 1e-3);
        start(&mut w, 0.05, Vec3::zeros(), Vec3::x());
        run(&mut w, 0.3);
        let v = world_velocity(&w).x;
        assert!(if brakes { v < 0.95 && v > 0.3 } else { (v - 1.0).abs() < 1e-9 }, "{brakes}: {v}");
    }
}

/// Links that the model excludes pass through each other.
#[test]
fn excluded_pairs_do_not_touch() {
    for excluded in [false, true] {
        let mut m = cubes(&[1.0; 2], 0.1, surface(1.0), ground(1.0));
        if excluded {
            m.excluded_pairs = vec![[1, 2]];
        }
        let mut w = world(m.clone(), 1e-3);
        let mut s = State::initial(&m);
        (s.q[2], s.q[9]) = (0.1, 0.4);
        w.set_initial_state(s);
        run(&mut w, 1.0);
        let z = w.state().q[9];
        assert!((z - if excluded { 0.1 } else { 0.3 }).abs() < 1e-3, "{excluded}: {z}");
    }
}

/// B-9: each body has its own delay; what rests does not move to the last bit, and a hand wakes it.
#[test]
fn a_body_falls_asleep_and_wakes() {
    let mut m = cuboid(1.0, [0.1; 3], surface(1.0), ground(1.0));
    rest(&mut m, 0.01, 0.01, 0.2);
    let mut w = world(m.clone(), 1e-3);
    start(&mut w, 0.1, Vec3::zeros(), Vec3::zeros());
    run(&mut w, 0.1);
    let awake = w.state().clone();
    run(&mut w, 0.4);
    let asleep = w.state().clone();
    assert!(asleep.v.iter().all(|v| *v == 0.0), "{:?} {:?}", awake.v, asleep.v);
    run(&mut w, 0.1);
    assert_eq!(w.state().q, asleep.q);
    let mut s = *w.settings();
    s.gravity = [0.0, 0.0, 9.81];
    w.set_settings(s).unwrap();
    run(&mut w, 0.2);
    assert!(w.state().q[2] > 0.2, "gravity has turned: {}", w.state().q[2]);
}

/// A copy goes on from the same poses; without the impulses of the last step it parts by what one step of those is worth.
#[test]
fn a_copy_goes_on_nearly_alike() {
    let m = cubes(&[1.0; 3], 0.1, surface(1.0), ground(1.0));
    let mut w = world(m.clone(), 1e-3);
    stack(&mut w);
    run(&mut w, 0.5);
    let mut copy = w.clone();
    assert!(copy.state().q.iter().zip(&w.state().q).all(|(a, b)| a == b));
    run(&mut w, 0.5);
    run(&mut copy, 0.5);
    let apart = copy.state().q.iter().zip(&w.state().q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-3, "{apart:e}");
}
