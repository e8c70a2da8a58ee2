//! Fast and thin bodies: what would pass through something within a step is followed in shorter pieces.
#![allow(clippy::unwrap_used)] // a test may panic

mod touching;

use realnoid::math::{Pose, Vec3};
use realnoid::model::{Collider, Model};
use realnoid::shape::ContactForm;
use realnoid::world::{Integrator, World};
use touching::{ball, free_body, on_link, settings, surface, world};

const INTEGRATORS: [Integrator; 4] =
    [Integrator::ImplicitMidpoint, Integrator::SemiImplicitEuler, Integrator::Rk4, Integrator::Extrapolation];

fn fixed(form: ContactForm, pose: Pose) -> Collider {
    Collider { name: "fixed".into(), link: None, pose, form, surface: surface(0.0), margin: 0.0 }
}

fn started(m: Model, h: f64, integrator: Integrator, set: impl Fn(&Model, &mut realnoid::engine::State)) -> World {
    let mut w = world(m, realnoid::world::Settings { gravity: [0.0; 3], ..settings(h, integrator) });
    let mut state = w.state().clone();
    set(w.model(), &mut state);
    w.set_initial_state(state);
    w
}

/// A ball of 1 cm at 200 m/s against a plate of 2 mm: it moves 100 plates per step of 1 ms. Whatever the phase of the steps
/// against the plate, it stays on its side, and is divided before it arrives.
#[test]
fn a_bullet_does_not_pass_a_plate() {
    for integrator in INTEGRATORS {
        for (h, phases) in [(1e-3, 40), (1e-2, 40)] {
            for phase in 0..phases {
                let plate = fixed(ContactForm::Cuboid { half: [0.5, 0.5, 1e-3] }, Pose::identity());
                let away = 1.0 + 200.0 * h * f64::from(phase) / f64::from(phases);
                let m = ball(0.05, 0.01, surface(0.0), plate);
                let mut w = started(m, h, integrator, |m, s| {
                    s.set_base_pose(m, [0.0, 0.0, away], [0.0, 0.0, 0.0, 1.0]);
                    s.set_base_twist(m, Vec3::zeros(), Vec3::new(0.0, 0.0, -200.0));
                });
                for _ in 0..(2.0 * away / 200.0 / h).ceil() as usize + 1 {
                    w.advance();
                }
                let z = w.state().q[2];
                // The radius and half the plate, less what a step leaves of a gap (FLUSH).
                assert!(z > 0.011 - 1e-9, "{integrator:?} {h} {phase}: {z}");
                assert!(w.stats().divided_steps > 0, "{:?}", w.stats());
            }
        }
    }
}

/// A rod of 1 m and 4 mm that turns past the edge of a block at 100 rad/s: its tip moves 50 mm per step of 1 ms. It must not
/// come out on the other side of the edge.
#[test]
fn a_spinning_rod_does_not_pass_an_edge() {
    for integrator in INTEGRATORS {
        for h in [1e-3, 1e-2] {
            for phase in 0..20 {
                let block = fixed(ContactForm::Cuboid { half: [0.002, 0.002, 0.5] }, Pose::translation(0.45, 0.0, 0.0));
                let i = 1.0 / 12.0;
                let mut m = free_body(1.0, [1e-4, i, i]);
                let rod = on_link(&m, "b", ContactForm::Cuboid { half: [0.5, 0.002, 0.002] }, surface(0.0));
                m.set_colliders(vec![block, rod]);
                let angle = -0.3 - 100.0 * h * f64::from(phase) / 20.0;
                let mut w = started(m, h, integrator, |m, s| {
                    s.set_base_pose(m, [0.0; 3], [0.0, 0.0, (0.5 * angle).sin(), (0.5 * angle).cos()]);
                    s.set_base_twist(m, Vec3::new(0.0, 0.0, 100.0), Vec3::zeros());
                });
                let mut past = false;
                for _ in 0..(0.6 / 100.0 / h).ceil() as usize + 4 {
                    w.advance();
                    let q = &w.state().q;
                    // Where the bar stands in the rod's frame: on the left of it as long as it has not been passed.
                    // It may turn about its own axis as well.
                    let (qw, qx, qy, qz) = (q[3], q[4], q[5], q[6]);
                    let yaw = (2.0 * (qx * qy + qw * qz)).atan2(1.0 - 2.0 * (qy * qy + qz * qz));
                    let (x, y) = (0.45 - q[0], -q[1]);
                    let (along, aside) = (x * yaw.cos() + y * yaw.sin(), -x * yaw.sin() + y * yaw.cos());
                    past |= along.abs() < 0.5 && aside < 0.0;
                    if along.abs() >= 0.5 {
                        break;
                    }
                }
                assert!(!past, "{integrator:?} {h} {phase}: {:?} {:?}", w.state().q, w.stats());
                assert!(w.stats().divided_steps > 0, "{:?}", w.stats());
            }
        }
    }
}

/// What is slow or alone is not divided; what even the shortest piece does not resolve is counted.
#[test]
fn only_what_is_fast_and_near_is_divided() {
    for integrator in INTEGRATORS {
        let plate = || fixed(ContactForm::Cuboid { half: [0.5, 0.5, 1e-3] }, Pose::identity());
        let thrown = |height: f64, speed: f64| {
            started(ball(0.05, 0.01, surface(0.0), plate()), 1e-3, integrator, |m, s| {
                s.set_base_pose(m, [0.0, 0.0, height], [0.0, 0.0, 0.0, 1.0]);
                s.set_base_twist(m, Vec3::zeros(), Vec3::new(0.0, 0.0, speed));
            })
        };
        let mut slow = thrown(0.02, -1.0);
        (0..100).for_each(|_| slow.advance());
        assert_eq!((slow.stats().divided_steps, slow.stats().fast_pieces), (0, 0));
        let mut alone = thrown(1.0, 200.0);
        (0..100).for_each(|_| alone.advance());
        assert_eq!((alone.stats().divided_steps, alone.stats().fast_pieces), (0, 0));
        let mut fast = thrown(1.0, -2000.0);
        (0..3).for_each(|_| fast.advance());
        if integrator == Integrator::Extrapolation {
            // Its pieces are as short as that asks for.
            assert!(fast.state().q[2] > 0.011 - 1e-9 && fast.stats().divided_steps > 0);
        } else {
            assert!(fast.stats().fast_pieces > 0);
        }
    }
}
