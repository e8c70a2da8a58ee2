//! A ball on a 3DOF joint: the pole, free spins, and along which directions stops and drives act.

use crate::limbs::{WIDE, advance, axes, body, model, settings};
use realnoid::engine::State;
use realnoid::math::{S3, V3, Vec3};
use realnoid::model::{Base, Model};
use realnoid::world::{AxisCommand, Integrator, World};
use std::sync::Arc;

const SPHERE: [f64; 3] = [0.05, 0.05, 0.05];
const BRICK: [f64; 3] = [0.03, 0.05, 0.06];

/// A group alone, whose body has these moments about the pivot and its centre there: gravity does nothing.
fn ball(moments: [f64; 3], limits: bool) -> Arc<Model> {
    let text = body("3dof", ["0 0 0"; 3], "").replace("type='prismatic'", "type='fixed'");
    let text = text.replace("name='trunk' type='revolute'", "name='trunk' type='fixed'");
    let text = text.replace(WIDE, &WIDE.replace("1.5", "0.6"));
    let mut m = Model::clone(&model(&text, Base::Fixed));
    m.effects.limits = limits;
    let b = &mut m.bodies[1];
    (b.mc, b.inertia) = (V3::default(), S3::default());
    [b.inertia.xx, b.inertia.yy, b.inertia.zz] = moments;
    Arc::new(m)
}

fn spinning(m: &Arc<Model>, integrator: Integrator, h: f64, hpb: [f64; 3], rates: V3<f64>) -> World {
    let mut state = State::initial(m);
    (0..3).for_each(|axis| state.set_axis(m, axis, hpb[axis], 0.0));
    let v = m.eulers[0].v;
    state.v[v..v + 3].copy_from_slice(&[rates.x, rates.y, rates.z]);
    let mut w = World::new(m.clone(), settings(integrator, h)).unwrap();
    w.set_initial_state(state);
    w
}

fn rates(w: &World) -> V3<f64> {
    let v = w.model().eulers[0].v;
    V3::new(w.state().v[v], w.state().v[v + 1], w.state().v[v + 2])
}

fn attitude(w: &World) -> nalgebra::UnitQuaternion<f64> {
    let q = w.model().eulers[0].q;
    let s = &w.state().q;
    nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(s[q], s[q + 1], s[q + 2], s[q + 3]))
}

/// A million steps at 10 rad/s through pitch ±90°, at the pole and 0.01° beside it: the attitude is exp(ω t). The exponential
/// of the others errs by rounding alone; RK4 turns short by (h ω)⁵ / 1920 a step.
#[test]
fn a_million_steps_through_the_pole() {
    let (m, h, omega) = (ball(SPHERE, false), 0.0005, 10.0);
    for (integrator, beside) in [Integrator::Rk4, Integrator::ImplicitMidpoint, Integrator::SemiImplicitEuler]
        .iter()
        .flat_map(|i| [0.0, 0.01f64.to_radians()].map(|b| (*i, b)))
    {
        let axis = V3::new(0.0, omega * beside.cos(), omega * beside.sin());
        let mut w = spinning(&m, integrator, h, [0.0; 3], axis);
        let (start, energy) = (attitude(&w), w.energy().kinetic);
        let (mut before, mut worst) = (axes(&w), 0.0f64);
        for step in 1..=1_000_000u32 {
            w.advance();
            let now = axes(&w);
            // Past the pole on the far branch: beside² + along² under the root on either side of it.
            let most = omega * h * (1.0 + 1e-9) + 2.0 * beside;
            assert!((now[1].0 - before[1].0).abs() <= most, "step {step}: pitch {before:?} → {now:?}");
            before = now;
            if step % 10_000 == 0 {
                let angle = omega * h * f64::from(step);
                let turn =
                    nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Unit::new_normalize(Vec3::from(axis)), angle);
                let error = 2.0 * ((start * turn).inverse() * attitude(&w)).imag().norm().min(1.0).asin();
                let truncated = if integrator == Integrator::Rk4 { (omega * h).powi(5) / 1920.0 } else { 0.0 };
                // A few roundings of a unit quaternion each step, and those of the angle itself.
                let rounding = 4.0 * f64::EPSILON;
                let bound = f64::from(step) * (truncated * 1.01 + rounding) + 1e-12;
                assert!(error <= bound, "{integrator:?} beside {beside}, step {step}: {error} > {bound}");
                worst = worst.max(error);
            }
        }
        assert!((w.energy().kinetic / energy - 1.0).abs() <= 1e-9 && w.stats().diverged_steps == 0);
        println!("{integrator:?}, {beside:.1e} rad beside the pole: attitude error {worst:.2e} rad after 500 s");
    }
}

/// A brick tumbles freely through the pole: RK4's energy error falls with its order and is bounded by it.
#[test]
fn a_free_spin_keeps_its_energy_to_the_order() {
    let m = ball(BRICK, false);
    let (t, omega) = (5.0, 10.0);
    let mut last = f64::INFINITY;
    for h in [0.002, 0.001] {
        let mut w = spinning(&m, Integrator::Rk4, h, [0.0; 3], V3::new(0.1, omega, 0.2));
        let energy = w.energy().kinetic;
        let mut highest = 0.0f64;
        for _ in 0..(t / h).round() as usize {
            w.advance();
            highest = highest.max(axes(&w)[1].0.abs());
        }
        assert!(highest > 1.57, "through the pole: {highest}");
        assert_eq!(w.stats().fallback_steps, 0);
        let error = (w.energy().kinetic / energy - 1.0).abs();
        // The amplitude of RK4 shrinks by (h ω)⁶ / 144 a step, energy twice that.
        let bound = 2.0 * t / h * (omega * h).powi(6) / 144.0;
        println!("h {h}: relative energy error {error:.2e} of {bound:.2e}");
        assert!(error <= bound && error <= last / 12.0, "{last} → {error}, bound {bound}");
        last = error;
    }
}

/// A constant torque on an angle does the work torque × angle, whatever the others do: the gain in energy is Σ τ Δangle, for
/// H, P and B at once.
#[test]
fn drives_do_their_work_about_their_own_angle() {
    let m = ball(BRICK, false);
    for torque in [[0.4, 0.0, 0.0], [0.0, -0.3, 0.0], [0.0, 0.0, 0.2], [0.3, -0.2, 0.1]] {
        let mut last = f64::INFINITY;
        for h in [0.004, 0.002] {
            let from = [0.2, 0.5, -0.4];
            let mut w = spinning(&m, Integrator::Rk4, h, from, V3::new(0.5, -1.0, 0.8));
            let before = w.energy().kinetic;
            w.set_commands(&torque.map(AxisCommand::torque)).unwrap();
            advance(&mut w, (0.6 / h).round() as usize);
            let now = axes(&w);
            assert!(now[1].0.abs() < 1.4, "away from the pole: {now:?}");
            let work: f64 = (0..3).map(|k| torque[k] * (now[k].0 - from[k])).sum();
            let error = (w.energy().kinetic - before - work).abs();
            let fastest = now.iter().map(|a| a.1.abs()).fold(5.0, f64::max);
            let bound = 0.6 * fastest * (fastest * h).powi(4) * (before + work.abs());
            println!("{torque:?} h {h}: work {work:.4} J, error {error:.2e} of {bound:.2e}");
            assert!(error <= bound && error <= last / 10.0, "{torque:?}: {last} → {error}, bound {bound}");
            last = error;
        }
    }
}

/// A stop takes exactly the rate of its own angle: on a sphere it leaves ω − g (g·ω)/(g·g), g the gradient of the angle. In
/// between the sphere turns a step or two further.
#[test]
fn stops_act_about_their_own_angle() {
    let m = ball(SPHERE, true);
    for (axis, hpb, omega) in [
        (0, [0.55, 0.3, -0.2], V3::new(0.3, 0.4, 2.0)),
        (1, [0.1, 0.55, 0.4], V3::new(0.5, 2.0, 0.2)),
        (2, [-0.2, 0.4, 0.55], V3::new(2.0, 0.3, -0.4)),
    ] {
        let integrators = [Integrator::SemiImplicitEuler, Integrator::ImplicitMidpoint];
        for (integrator, h) in integrators.iter().flat_map(|i| [0.001, 0.0001].map(|h| (*i, h))) {
            let mut w = spinning(&m, integrator, h, hpb, omega);
            let speed = axes(&w)[axis].1;
            assert!(speed > 0.0);
            // What the turning of the gradient within a step leaves, as a rate and as an angle.
            let size = omega.dot(omega);
            let mut steps = 0;
            while axes(&w)[axis].1 > h * size {
                w.advance();
                steps += 1;
                assert!(steps < 10_000, "axis {axis} never stopped: {:?}", axes(&w));
            }
            let now = axes(&w);
            assert!((now[axis].0 - 0.6).abs() <= h * h * size, "at the stop: {now:?}");
            let g = m.eulers[0].rates([now[0].0, now[1].0, now[2].0]).gradient[axis];
            // Until it reached the stop ω stood still in the body, as a sphere's does.
            let expected = omega - g * (g.dot(omega) / g.dot(g));
            let difference = rates(&w) - expected;
            let error = difference.dot(difference).sqrt();
            // The two steps of the impact turn the gradient by h |ω| each, and it multiplies |ω|.
            println!("{integrator:?} axis {axis} h {h}: error {error:.2e} of {:.2e}", 4.0 * h * size);
            assert!(error <= 4.0 * h * size, "axis {axis}, h {h}: {:?} {expected:?}", rates(&w));
        }
    }
}

/// Rotors on H, P or B: a free spin keeps the energy of body and rotor to the order of the method, which is that of the axes'
/// turning as well.
#[test]
fn rotors_of_a_group_keep_the_energy() {
    for (axis, integrator, order) in [
        (0, Integrator::ImplicitMidpoint, 2),
        (1, Integrator::ImplicitMidpoint, 2),
        (2, Integrator::ImplicitMidpoint, 2),
        (0, Integrator::SemiImplicitEuler, 1),
        (2, Integrator::Rk4, 4),
    ] {
        let mut m = Model::clone(&ball(BRICK, false));
        m.axes[axis].drive.rotor_inertia = 0.05;
        m.effects.rotor_inertia = true;
        let m = Arc::new(m);
        let error = |h: f64| {
            let mut w = spinning(&m, integrator, h, [0.3, 0.4, 0.2], V3::new(1.0, 0.7, 2.0));
            let (start, mut worst) = (w.energy().kinetic, 0.0_f64);
            for _ in 0..(0.5 / h).round() as usize {
                w.advance();
                worst = worst.max((w.energy().kinetic / start - 1.0).abs());
            }
            worst
        };
        let (coarse, fine) = (error(0.002), error(0.001));
        println!("{axis} {integrator:?}: {coarse:.2e} {fine:.2e}");
        assert!(
            fine <= 1e-11 || coarse / fine >= 0.8 * f64::from(1 << order),
            "{axis} {integrator:?}: {coarse} {fine}"
        );
        assert!(fine <= 0.02, "{axis} {integrator:?}: {fine}");
    }
}
