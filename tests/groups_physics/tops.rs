//! Heavy symmetric tops on a 3DOF joint: H precesses, P nutates, B spins.

use crate::limbs::{advance, axes, model, settings};
use realnoid::engine::State;
use realnoid::math::{S3, V3};
use realnoid::model::{Base, Model};
use realnoid::world::{Integrator, World};
use std::sync::Arc;

/// Moments about the pivot across and along the axis of symmetry (kg·m²), and m·l (kg·m).
const I1: f64 = 0.05;
const I3: f64 = 0.02;
const ML: f64 = 0.3;
const G: f64 = 9.80665;

/// A top whose axis of symmetry is x, the axis of b.
fn top() -> Arc<Model> {
    let text = crate::limbs::body("3dof", ["0 0 0"; 3], "");
    let mut m = Model::clone(&model(&alone(&text), Base::Fixed));
    m.effects.limits = false;
    let b = &mut m.bodies[1];
    (b.mass, b.mc) = (1.5, V3::new(ML, 0.0, 0.0));
    b.inertia = S3::default();
    (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (I3, I1, I1);
    Arc::new(m)
}

/// The group alone: no trunk hinge, no knee.
fn alone(text: &str) -> String {
    text.replace("type='prismatic'", "type='fixed'")
        .replace("name='trunk' type='revolute'", "name='trunk' type='fixed'")
        .replace("xyz='0.1 0 0.2' rpy='0.2 0 0.4'", "xyz='0 0 0'")
}

/// At pitch p the axis of symmetry is at the angle θ from the vertical, cos θ = −sin p.
fn start(m: &Arc<Model>, integrator: Integrator, h: f64, pitch: f64, body_rates: V3<f64>) -> World {
    let mut state = State::initial(m);
    state.set_axis(m, 1, pitch, 0.0);
    let v = m.eulers[0].v;
    state.v[v..v + 3].copy_from_slice(&[body_rates.x, body_rates.y, body_rates.z]);
    let mut w = World::new(m.clone(), settings(integrator, h)).unwrap();
    w.set_initial_state(state);
    w
}

/// Truncation of a method of this order over `t` seconds of motion at `rate` rad/s; the leading term's 1/(order + 1)! is
/// left out as margin.
fn truncation(order: i32, rate: f64, h: f64, t: f64) -> f64 {
    rate * t * (rate * h).powi(order)
}

/// I₁ cos θ Ω² − I₃ ω₃ Ω + m g l = 0.
#[test]
fn a_heavy_top_precesses_steadily() {
    let m = top();
    for (theta, precession) in [(1.0f64, 4.0f64), (0.6, 2.5), (2.0, 6.0)] {
        let spin = (I1 * theta.cos() * precession * precession + ML * G) / (I3 * precession);
        let pitch = -theta.cos().asin();
        // Ω along the vertical and ω₃ along x, in body axes at h = b = 0.
        let rates = V3::new(spin, 0.0, precession * theta.sin());
        let t = 1.0;
        let runs = [(Integrator::Rk4, 4), (Integrator::ImplicitMidpoint, 2)];
        let mut last = f64::INFINITY;
        for (integrator, order, h) in runs.iter().flat_map(|(i, o)| [0.002, 0.001].map(|h| (*i, *o, h))) {
            let mut w = start(&m, integrator, h, pitch, rates);
            let before = axes(&w);
            assert!((before[0].1 - precession).abs() <= 1e-12 && before[1].1.abs() <= 1e-12, "{before:?}");
            advance(&mut w, (t / h).round() as usize);
            assert_eq!(w.stats().fallback_steps, 0);
            let (now, bound) = (axes(&w), truncation(order, spin, h, t));
            // ω₃ = ḃ + Ω cos θ.
            let expected = [precession * t, pitch, (spin - precession * theta.cos()) * t];
            let error = (0..3).map(|k| (now[k].0 - expected[k]).abs()).fold(0.0, f64::max);
            println!("{integrator:?} θ {theta} Ω {precession} ω₃ {spin:.2} h {h}: error {error:.2e} of {bound:.2e}");
            assert!(error <= bound, "θ {theta}, h {h}: {error} > {bound}: {now:?} {expected:?}");
            let falls = h > 0.0015 || error <= last / 2f64.powi(order).powf(0.9);
            assert!(falls, "{integrator:?} of order {order}: {last} → {error}");
            last = error;
        }
    }
}

/// A top let go at rest but for its spin nutates; against a 64 times finer run the error falls with the order of the method,
/// and what a symmetric top conserves stays: energy, the vertical angular momentum, the spin.
#[test]
fn a_nutating_top_converges_and_keeps_what_it_must() {
    let m = top();
    let (pitch, spin, t) = (-0.5, 30.0, 0.5);
    let momentum = |w: &World| {
        let (v, q) = (m.eulers[0].v, m.eulers[0].q);
        let s = w.state();
        let r = realnoid::model::rotation([s.q[q], s.q[q + 1], s.q[q + 2], s.q[q + 3]]);
        r.mv(V3::new(I3 * s.v[v], I1 * s.v[v + 1], I1 * s.v[v + 2])).z
    };
    let run = |integrator, h: f64| {
        let mut w = start(&m, integrator, h, pitch, V3::new(spin, 0.0, 0.0));
        advance(&mut w, (t / h).round() as usize);
        w
    };
    for (integrator, order, h) in [
        (Integrator::Rk4, 4, 0.002),
        (Integrator::ImplicitMidpoint, 2, 0.001),
        (Integrator::SemiImplicitEuler, 1, 0.0005),
    ] {
        let first = start(&m, integrator, h, pitch, V3::new(spin, 0.0, 0.0));
        let (energy, vertical) = (first.energy().kinetic + first.energy().potential, momentum(&first));
        let exact = axes(&run(Integrator::Rk4, h / 64.0));
        assert!(exact[0].0.abs() > 0.5, "it precesses: {exact:?}");
        let mut last = f64::INFINITY;
        for h in [h, h / 2.0, h / 4.0] {
            let w = run(integrator, h);
            let (bound, now) = (truncation(order, spin, h, t), axes(&w));
            let error = (0..3).map(|k| (now[k].0 - exact[k].0).abs()).fold(0.0, f64::max);
            println!("{integrator:?} h {h}: error {error:.2e} of {bound:.2e}");
            assert!(
                error <= bound && error <= last / 2f64.powi(order).powf(0.8),
                "{integrator:?} {h}: {last} → {error}"
            );
            last = error;
            let e = w.energy().kinetic + w.energy().potential;
            assert!((e - energy).abs() <= bound * energy.abs(), "energy: {e} {energy}");
            assert!((momentum(&w) - vertical).abs() <= bound * I3 * spin, "vertical momentum");
            assert!((w.state().v[m.eulers[0].v] - spin).abs() <= 1e-10 * spin, "the spin is constant to rounding");
        }
    }
}
