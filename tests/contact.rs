//! Contacts with known answers (facts/references.md), at 1 ms unless said. Inclines are made by turning gravity.
#![allow(clippy::unwrap_used)] // a test may panic

mod touching;

use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::Surface;
use realnoid::world::{Integrator, Settings, World};
use touching::*;

const G: f64 = 9.81;
const H: f64 = 1e-3;

fn plain() -> Settings {
    settings(H, Integrator::ImplicitMidpoint)
}

fn incline(angle: f64) -> Settings {
    Settings { gravity: [G * angle.sin(), 0.0, -G * angle.cos()], ..plain() }
}

fn run(w: &mut World, seconds: f64) {
    let steps = (seconds / (w.settings().control_interval_ns as f64 * 1e-9)).round() as usize;
    (0..steps).for_each(|_| w.advance());
    assert_eq!(w.stats().diverged_steps, 0);
}

fn total(w: &World) -> f64 {
    w.energy().kinetic + w.energy().potential
}

/// a = 5/7 g sin θ while μ ≥ 2/7 tan θ. The floor of the error is that of a body that turns by ωh per step while its velocity
/// is told along its own axes: (ωh)²/8 of the way at most.
#[test]
fn a_ball_rolls_down_an_incline() {
    let angle: f64 = 20f64.to_radians();
    for (integrator, order) in
        [(Integrator::ImplicitMidpoint, 2), (Integrator::SemiImplicitEuler, 1), (Integrator::Rk4, 2)]
    {
        let mut last = f64::INFINITY;
        for h in [4e-3, 2e-3, 1e-3] {
            let s = Settings { control_interval_ns: (h * 1e9) as i64, integrator, ..incline(angle) };
            let mut w = world(ball(1.0, 0.1, surface(1.0), ground(0.5)), s);
            start(&mut w, 0.1, Vec3::zeros(), Vec3::zeros());
            run(&mut w, 1.0);
            let exact = 0.5 * 5.0 / 7.0 * G * angle.sin();
            let error = (w.state().q[0] / exact - 1.0).abs();
            let turn = 5.0 / 7.0 * G * angle.sin() / 0.1 * h;
            let bound = if order == 2 { turn * turn / 8.0 } else { 1.01 * h };
            assert!(error < bound, "{integrator:?} {h}: {error:e} of {bound:e}");
            assert!(error < 1.1 * last * 0.5_f64.powi(order), "order of {integrator:?}: {error:e} after {last:e}");
            last = error;
        }
    }
}

/// A ball thrown without spin rolls after t = 2 v₀ / (7 μ g), with 5/7 v₀. Until the end of the step in which it begins to roll it
/// may slide, so t is right to a step.
#[test]
fn slipping_becomes_rolling() {
    let (mu, v0, radius) = (0.3, 2.0, 0.1);
    let mut w = world(ball(1.0, radius, surface(1.0), ground(mu)), plain());
    start(&mut w, radius, Vec3::zeros(), Vec3::new(v0, 0.0, 0.0));
    let exact = 2.0 * v0 / (7.0 * mu * G);
    let slip = |w: &World| {
        let t = w.contacts()[0];
        assert!(t.force.z > 0.0);
        let u = t.force.x.hypot(t.force.y);
        u > 1e-3 * mu * G
    };
    let mut rolls = None;
    for step in 0..1000 {
        w.advance();
        if rolls.is_none() && !slip(&w) {
            rolls = Some(f64::from(step) * H);
        }
    }
    assert!((rolls.unwrap() - exact).abs() <= 1.5 * H, "{rolls:?} {exact}");
    let speed = w.state().v[3].hypot(w.state().v[5]);
    // The velocity along the body's own axes turns by ωh per step.
    let turn = v0 / radius * H;
    assert!((speed / (5.0 / 7.0 * v0) - 1.0).abs() < turn * turn, "{speed}");
}

/// It stops after v²/(2 μ g). The last step ends the motion within itself: v h is its share.
#[test]
fn a_sliding_box_stops() {
    let mu = 0.3;
    let mut w = world(cuboid(1.0, [0.1, 0.05, 0.02], surface(1.0), ground(mu)), plain());
    start(&mut w, 0.02, Vec3::zeros(), Vec3::new(1.0, 0.0, 0.0));
    run(&mut w, 1.0);
    let exact = 1.0 / (2.0 * mu * G);
    assert!((w.state().q[0] - exact).abs() < 0.5 * mu * G * H * H, "{:e}", w.state().q[0] - exact);
    assert_eq!(w.energy().kinetic.max(1e-25), 1e-25);
}

/// tan θ = μ, half a degree to both sides: it stays (creep below 1 µm in 100 s, exactly 0 once it rests), or it slides with
/// g (sin θ − μ cos θ).
#[test]
fn the_threshold_of_sticking() {
    let mu: f64 = 0.5;
    let edge = mu.atan();
    let at = |degrees: f64| edge + degrees.to_radians();
    let mut w = world(cuboid(1.0, [0.1, 0.05, 0.02], surface(1.0), ground(mu)), incline(at(-0.5)));
    start(&mut w, 0.02, Vec3::zeros(), Vec3::zeros());
    run(&mut w, 100.0);
    let creep = Vec3::new(w.state().q[0], w.state().q[1], w.state().q[2] - 0.02).norm();
    println!("creep in 100 s: {creep:e} m");
    assert!(creep < 1e-6, "{creep:e}");

    let mut m = cuboid(1.0, [0.1, 0.05, 0.02], surface(1.0), ground(mu));
    rest(&mut m, 0.01, 0.01, 0.2);
    let mut w = world(m, incline(at(-0.5)));
    start(&mut w, 0.02, Vec3::zeros(), Vec3::zeros());
    run(&mut w, 1.0);
    let q = w.state().q.clone();
    run(&mut w, 100.0);
    assert_eq!(w.state().q, q);

    let mut w = world(cuboid(1.0, [0.1, 0.05, 0.02], surface(1.0), ground(mu)), incline(at(0.5)));
    start(&mut w, 0.02, Vec3::zeros(), Vec3::zeros());
    run(&mut w, 2.0);
    let exact = 0.5 * 4.0 * G * (at(0.5).sin() - mu * at(0.5).cos());
    assert!((w.state().q[0] / exact - 1.0).abs() < 1e-6, "{:e}", w.state().q[0] / exact - 1.0);
}

/// Friction is the same in every direction, and against the motion.
#[test]
fn friction_knows_no_direction() {
    let mut ways = vec![];
    for degrees in [0.0_f64, 17.0, 45.0, 60.0] {
        let (s, c) = degrees.to_radians().sin_cos();
        let mut w = world(cuboid(1.0, [0.1, 0.05, 0.02], surface(1.0), ground(0.3)), plain());
        start(&mut w, 0.02, Vec3::zeros(), Vec3::new(c, s, 0.0));
        run(&mut w, 1.0);
        let q = &w.state().q;
        assert!((q[0] * s - q[1] * c).abs() < 1e-9, "aside: {:e}", q[0] * s - q[1] * c);
        ways.push(q[0].hypot(q[1]));
    }
    for way in &ways {
        assert!((way / ways[0] - 1.0).abs() < 1e-6, "{ways:?}");
    }
}

/// Each apex is e² of the one before; in all it takes √(2h/g) (1+e)/(1−e). Between impacts the flight is exact (decided by the
/// gap and the acceleration of the step), so the apexes of the first bounces are exact, too.
#[test]
fn a_bouncing_ball() {
    for e in [0.5, 0.8, 1.0] {
        let bouncy = |friction| Surface { restitution: 1.0, ..surface(friction) };
        let mut floor = ground(0.0);
        floor.surface.restitution = e;
        let mut w = world(ball(1.0, 0.1, bouncy(0.0), floor), plain());
        start(&mut w, 1.1, Vec3::zeros(), Vec3::zeros());
        let (mut apexes, mut last, mut moved) = (vec![], 0.0, 0.0);
        for step in 0..8000 {
            let (z, v) = (w.state().q[2], w.state().v[5]);
            w.advance();
            let now = w.state().v[5];
            if last > 0.0 && now <= 0.0 {
                // The top of the parabola through the step.
                apexes.push(z - 0.1 + v * v / (2.0 * G));
            }
            moved = if now.abs() > 1e-9 { f64::from(step) * H } else { moved };
            last = now;
        }
        let mut exact = 1.0;
        for apex in apexes.iter().take_while(|a| **a > 1e-2).take(7) {
            exact *= e * e;
            assert!((apex / exact - 1.0).abs() < 1e-9, "e {e}: {apex} {exact}");
        }
        if e < 1.0 {
            // Bounces shorter than a step are not made: with speeds below g h, the rest of the series is 2 h / (1 − e) at most.
            let ends = (2.0 / G).sqrt() * (1.0 + e) / (1.0 - e);
            assert!((moved - ends).abs() < 2.0 * H / (1.0 - e) + H, "{moved} {ends}");
        }
        assert!(w.stats().worst_penetration < 1e-9);
    }
}

/// A rolling ball is slowed down by 5/7 b g / R.
#[test]
fn rolling_resistance() {
    let (b, radius, v0) = (1e-3, 0.1, 1.0);
    let own = Surface { rolling: b, ..surface(1.0) };
    let mut w = world(ball(1.0, radius, own, ground(1.0)), plain());
    start(&mut w, radius, Vec3::new(0.0, v0 / radius, 0.0), Vec3::new(v0, 0.0, 0.0));
    run(&mut w, 2.0);
    let exact = v0 * 2.0 - 0.5 * 5.0 / 7.0 * b * G / radius * 4.0;
    let turn = v0 / radius * H;
    assert!((w.state().q[0] / exact - 1.0).abs() < turn * turn, "{:e}", w.state().q[0] / exact - 1.0);
    // It comes to rest, and stays.
    run(&mut w, 20.0);
    let x = w.state().q[0];
    run(&mut w, 1.0);
    assert!((w.state().q[0] - x).abs() < 1e-12);
    let ends = v0 * v0 / (2.0 * 5.0 / 7.0 * b * G / radius);
    assert!((x / ends - 1.0).abs() < 1e-4, "{x} {ends}");
}

/// A spinning ball stops after I ω / (b m g).
#[test]
fn spinning_friction() {
    let (b, radius, spin, mass) = (2e-3, 0.1, 10.0, 2.0);
    let own = Surface { spinning: b, ..surface(1.0) };
    let mut w = world(ball(mass, radius, own, ground(1.0)), plain());
    start(&mut w, radius, Vec3::new(0.0, 0.0, spin), Vec3::zeros());
    let ends = 0.4 * mass * radius * radius * spin / (b * mass * G);
    run(&mut w, (ends - 2.0 * H).floor() + (ends - 2.0 * H).fract());
    assert!(w.state().v[2] > 0.0);
    run(&mut w, 4.0 * H);
    assert!(w.state().v[2].abs() < 1e-12, "{}", w.state().v[2]);
}

fn tower(masses: &[f64], s: Settings) -> World {
    let list: Vec<(f64, f64)> = masses.iter().map(|m| (*m, 0.1)).collect();
    let mut w = world(balls(&list, surface(1.0), ground(0.5)), s);
    stack(&mut w);
    w
}

/// Five balls stand on each other for 10 s, also when the one on top is 1000 times as heavy; so does a light box under a heavy
/// one. Nothing sinks, nothing moves.
#[test]
fn towers() {
    for h in [5e-3, H] {
        for top in [1.0, 1000.0] {
            let s = Settings { control_interval_ns: (h * 1e9) as i64, ..plain() };
            let mut w = tower(&[1.0, 1.0, 1.0, 1.0, top], s);
            let before = total(&w);
            run(&mut w, 10.0);
            let x = (0..5).map(|k| w.state().q[7 * k].hypot(w.state().q[7 * k + 1])).fold(0.0, f64::max);
            println!(
                "tower 1:{top} at {h}: sinks {:e}, aside {x:e}, energy {:e}",
                0.9 - w.state().q[30],
                total(&w) - before
            );
            assert!(x < 1e-9 && (w.state().q[30] - 0.9).abs() < 1e-6);
            assert!(total(&w) - before < 1e-4 && w.energy().kinetic < 1e-12);
        }
    }
    let mut w = boxes(&[1.0, 1000.0], plain());
    run(&mut w, 10.0);
    assert!(w.stats().worst_penetration < 1e-6, "{:e}", w.stats().worst_penetration);
    assert!(w.energy().kinetic < 1e-12, "{:e}", w.energy().kinetic);
}

/// Cubes of 0.2 m on each other.
fn boxes(masses: &[f64], s: Settings) -> World {
    let mut w = world(cubes(masses, 0.1, surface(1.0), ground(0.5)), s);
    stack(&mut w);
    w
}

/// A rod thrown onto rough ground so that rigid-body accelerations have no solution (Painlevé: μ > (1/3 + cos²θ)/(sin θ cos θ)):
/// velocities stay finite, energy does not grow, the tip stays out of the ground.
#[test]
fn the_rod_of_painleve() {
    let (half, theta) = (0.5_f64, 1.1_f64);
    let needed = (1.0 / 3.0 + theta.cos().powi(2)) / (theta.sin() * theta.cos());
    for mu in [0.5 * needed, 1.2 * needed, 3.0 * needed] {
        for speed in [0.1, 1.0, 10.0] {
            let mut w = world(rod(1.0, half, surface(1.0), ground(mu)), plain());
            let m = w.model().clone();
            let mut s = State::initial(&m);
            let q = realnoid::math::Quat::from_axis_angle(&Vec3::y_axis(), -(std::f64::consts::FRAC_PI_2 - theta));
            let c = q.coords;
            s.set_base_pose(&m, [0.0, 0.0, half * theta.sin()], [c.x, c.y, c.z, c.w]);
            let linear = q.inverse() * Vec3::new(-speed, 0.0, 0.0);
            s.set_base_twist(&m, Vec3::zeros(), linear);
            w.set_initial_state(s);
            let (first, mut energy) = (total(&w).abs() + 0.5 * speed * speed, total(&w));
            for _ in 0..2000 {
                w.advance();
                assert!(total(&w) < energy + 1e-6 * first, "μ {mu} v {speed}: {:e}", total(&w) - energy);
                energy = total(&w);
                assert!(w.state().v.iter().all(|v| v.abs() < 100.0 * speed.max(1.0)));
            }
            assert!(w.stats().worst_penetration < 1e-4, "{:e}", w.stats().worst_penetration);
        }
    }
}

/// A chain of 16 links with a ball of 1000 times a link's mass at its end, stretched out sideways and let go: the ball lands on
/// the floor, where the chain whips about. A step that ends in contact has no more energy than it began with.
#[test]
fn a_heavy_ball_on_a_light_chain() {
    let mut w = world(chain_with_ball(16, 0.05, 1000.0, ground(0.5)), plain());
    let (first, mut energy) = (total(&w), total(&w));
    for step in 0..5000 {
        w.advance();
        let touched = !w.contacts().is_empty();
        assert!(!touched || total(&w) < energy + 1e-9 * first, "step {step}: {:e}", total(&w) - energy);
        energy = total(&w);
    }
    assert!(w.stats().worst_penetration < 1e-4, "{:e}", w.stats().worst_penetration);
    assert_eq!(w.stats().diverged_steps, 0);
    assert!(energy < first);
}
