//! What contacts take is booked, and does not count as what joints carry.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;
mod touching;

use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::{Base, Model, Surface};
use realnoid::shape::ContactForm;
use realnoid::world::{Integrator, World};
use std::sync::Arc;
use support::urdf::{joint, link, robot};
use touching::{ball, cuboid, ground, on_link, settings, surface, world};

const G: f64 = 9.81;
const H: f64 = 1e-3;

/// What is left of the energy balance, and what contacts have taken, J.
struct Books {
    unaccounted: f64,
    contacts: f64,
}

/// A single body, from height `z` with this twist.
fn run(m: Model, h: f64, (z, angular, linear): (f64, Vec3, Vec3), seconds: f64) -> (World, Books) {
    let mut w = world(m, settings(h, Integrator::ImplicitMidpoint));
    let model = w.model().clone();
    let mut s = State::initial(&model);
    s.set_base_pose(&model, [0.0, 0.0, z], [0.0, 0.0, 0.0, 1.0]);
    s.set_base_twist(&model, angular, linear);
    w.set_initial_state(s);
    let total = |w: &World| w.energy().kinetic + w.energy().potential;
    let start = total(&w);
    (0..(seconds / h).round() as usize).for_each(|_| w.advance());
    let (work, stats) = (w.work(), w.stats());
    let taken = work.contacts + work.losses + stats.trimmed_energy + stats.guarded_energy;
    let books = Books { unaccounted: total(&w) - start - work.drives + taken, contacts: work.contacts };
    (w, books)
}

/// Sums of a few thousand numbers of about 10 J.
const ROUNDING: f64 = 1e-10;

/// Without rotation the midpoint rule has no error of energy, and a blow leaves the share e² of the kinetic energy.
#[test]
fn a_bouncing_ball() {
    let (e, z, radius) = (0.6, 1.0, 0.1);
    let own = Surface { restitution: e, ..surface(0.5) };
    let floor = realnoid::model::Collider { surface: Surface { restitution: 1.0, ..surface(1.0) }, ..ground(1.0) };
    // The first blow is at sqrt(2 z / g) = 0.45 s, the second 2 e sqrt(2 z / g) later, at 0.99 s.
    for (seconds, blows) in [(0.4, 0), (0.7, 1), (1.2, 2)] {
        let m = ball(2.0, radius, own, floor.clone());
        let (_, books) = run(m, H, (radius + z, Vec3::zeros(), Vec3::zeros()), seconds);
        assert!(books.unaccounted.abs() < ROUNDING, "{:e}", books.unaccounted);
        let exact = 2.0 * G * z * (1.0 - e.powi(2 * blows));
        // The position after a blow is that of the blow itself; the speed is one of the step's end.
        assert!((books.contacts - exact).abs() < 1e-9 * (1.0 + exact), "{blows}: {} of {exact}", books.contacts);
    }
}

/// Friction takes the kinetic energy, whole.
#[test]
fn a_sliding_box() {
    let (mass, v0) = (3.0, 2.0);
    let m = cuboid(mass, [0.2, 0.2, 0.05], surface(1.0), ground(0.4));
    let (w, books) = run(m, H, (0.05, Vec3::zeros(), Vec3::new(v0, 0.0, 0.0)), 1.0);
    assert!(w.energy().kinetic < ROUNDING, "it stands");
    assert!(books.unaccounted.abs() < ROUNDING, "{:e}", books.unaccounted);
    let exact = 0.5 * mass * v0 * v0;
    assert!((books.contacts - exact).abs() < 1e-9 * exact, "{} of {exact}", books.contacts);
}

/// Thrown without spin it slides, then rolls, then rolling friction stops it. A body that turns by ω h per step errs by (ω h)²/8
/// of what moves, as its velocity is told along its own axes: of second order.
#[test]
fn a_ball_that_rolls_to_a_stop() {
    let (mass, radius, v0) = (1.0, 0.1, 2.0);
    let own = Surface { rolling: 0.05, spinning: 0.05, ..surface(1.0) };
    for h in [2e-3, 1e-3] {
        let m = ball(mass, radius, own, ground(0.3));
        let (w, books) = run(m, h, (radius, Vec3::new(0.0, 0.0, 5.0), Vec3::new(v0, 0.0, 0.0)), 4.0);
        let start = 0.5 * mass * v0 * v0 + 0.5 * 0.4 * mass * radius * radius * 25.0;
        assert!(w.energy().kinetic < 1e-6 * start, "it stands");
        let turn = v0 / radius * h;
        let bound = turn * turn / 8.0 * start;
        assert!(books.unaccounted.abs() < bound, "{h}: {:e} of {bound:e}", books.unaccounted);
        assert!((books.contacts / start - 1.0).abs() < turn * turn / 8.0 + 1e-6, "{} of {start}", books.contacts);
    }
}

const MASS: f64 = 3.0;

/// A horizontal arm, hinged at the world, that lies on a frictionless table at its far end, twice as far out as its centre
/// of mass.
fn arm(threshold: f64, table: bool) -> World {
    let parts = [
        link("stand", 0.0, ""),
        link("arm", MASS, "0.2 0 0"),
        joint("h", "continuous", ("stand", "arm"), ("0 0 1", "0 1 0"), &format!("break_threshold='{threshold:.17}'")),
    ];
    let mut m = touching::model(&robot(&parts), Base::Fixed);
    if table {
        let radius = 0.05;
        let mut floor = ground(0.0);
        floor.pose.translation.z = 1.0 - radius;
        let mut end = on_link(&m, "arm", ContactForm::Ball { radius }, surface(1.0));
        end.pose.translation.x = 0.4;
        m.set_colliders(vec![floor, end]);
    }
    World::new(Arc::new(m), settings(H, Integrator::ImplicitMidpoint)).unwrap()
}

/// Statics: the table carries half of the weight, the joint the other half.
#[test]
fn a_joint_does_not_carry_what_a_table_carries() {
    let half = 0.5 * MASS * G;
    for (ratio, breaks) in [(1.001, false), (0.999, true)] {
        let mut w = arm(ratio * half, true);
        (0..200).for_each(|_| w.advance());
        assert_eq!(!w.broken().is_empty(), breaks, "{ratio}: {:?}", w.broken());
        for broken in w.broken() {
            assert!((broken.force / half - 1.0).abs() < 1e-9, "{broken:?}");
        }
    }
    // Let go it carries m g (1 − m l²/I) at the first instant, with I about the hinge, and more on its way down.
    let mut w = arm(1.001 * half, false);
    (0..1000).for_each(|_| w.advance());
    assert!(!w.broken().is_empty());
}

/// A damped weight on a vertical slide falls as if there were no slide: the damping is not a force of the joint.
#[test]
fn a_joint_does_not_carry_damping() {
    for integrator in [Integrator::ImplicitMidpoint, Integrator::SemiImplicitEuler] {
        let bob = link("bob", MASS, "0 0 0");
        let bob = bob.replace("</link>", "<realnoid><damping linear='0.5'/></realnoid></link>");
        let slide = joint("h", "prismatic", ("stand", "bob"), ("0 0 1", "0 0 1"), "break_threshold='1e-6'");
        let text = robot(&[link("stand", 0.0, ""), bob, slide]);
        let m = touching::model(&text, Base::Fixed);
        assert!(m.effects.body_damping && m.effects.breaking);
        let mut w = World::new(Arc::new(m), settings(H, integrator)).unwrap();
        (0..1000).for_each(|_| w.advance());
        // A constraint of no force, to rounding of momenta of 20 kg m/s over a step of 1 ms.
        assert!(w.broken().is_empty(), "{integrator:?}: {:?}", w.broken());
        assert!(w.work().losses > 1.0, "it is damped");
    }
}
