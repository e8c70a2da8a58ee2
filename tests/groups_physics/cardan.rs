//! A shaft, a cardan, and a second shaft at an angle β: tan θ₂ = tan θ₁ / cos β.

use crate::limbs::{INERTIAL, WIDE, advance, joint, model, settings, world};
use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::{Base, Model};
use realnoid::world::{Integrator, Settings, World};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

fn shafts() -> Arc<Model> {
    let free = WIDE.replace("1.5", "3.1");
    let text = [
        "<robot name='shafts'><realnoid version='1'><joint_group name='cross' type='cardan' h='h' p='p'/></realnoid>"
            .into(),
        format!(
            "<link name='base'/><link name='first'>{INERTIAL}</link><link name='pin'/><link name='second'>{INERTIAL}</link>"
        ),
        joint("turn", "continuous", ("base", "first"), "0 0 1", "xyz='0 0 0'", ""),
        joint("h", "revolute", ("first", "pin"), "1 0 0", "xyz='0 0 0'", &free),
        joint("p", "revolute", ("pin", "second"), "0 1 0", "xyz='0 0 0'", &free),
        "</robot>".to_string(),
    ];
    model(&text.concat(), Base::Fixed)
}

/// Both shafts keep their bearings: the first turns about z by θ₁, the second about (sin β, 0, cos β). Angles and rates of the
/// cross follow in closed form; the second shaft's attitude and speed are read from the simulated frames.
#[test]
fn a_cardan_transmits_as_it_must() {
    let m = shafts();
    let second = m.links.iter().position(|l| l.name == "second").unwrap();
    for beta in [0.1f64, 0.5, 1.0, 1.3] {
        let out = Vec3::new(beta.sin(), 0.0, beta.cos());
        let (mut slowest, mut fastest) = (f64::INFINITY, 0.0f64);
        for i in 0..=400 {
            let theta = f64::from(i) * FRAC_PI_2 / 100.0 * 1.0001;
            let (s, c) = theta.sin_cos();
            // In the frame of the first shaft; Rx(h) Ry(p) z = (sin p, −sin h cos p, cos h cos p).
            let u = Vec3::new(c * out.x + s * out.y, c * out.y - s * out.x, out.z);
            let (h, p) = ((-u.y).atan2(u.z), u.x.asin());
            // ẑ + ḣ x' + ṗ y = ω₂ out, for a first shaft at 1 rad/s.
            let pin = Vec3::new(c, s, 0.0);
            let across = Vec3::new(-s * h.cos(), c * h.cos(), h.sin());
            let rates = nalgebra::Matrix3::from_columns(&[pin, across, -out]).lu().solve(&-Vec3::z()).unwrap();
            let mut state = State::initial(&m);
            for (axis, q, v) in [(0, theta, 1.0), (1, h, rates.x), (2, p, rates.y)] {
                state.set_axis(&m, axis, q, v);
            }
            let mut w = World::new(m.clone(), Settings::default()).unwrap();
            w.set_initial_state(state);
            let shown = w.new_snapshot();
            let r = shown.link_pose[second].rotation;
            assert!((r * Vec3::z() - out).norm() <= 1e-12, "the second shaft keeps its bearing");
            let yoke = r * Vec3::y();
            let turned = yoke.dot(&out.cross(&Vec3::y())).atan2(yoke.y);
            // As angles, since the tangent has poles: tan θ₂ cos β = tan θ₁ in the same quadrant.
            let expected = theta.sin().atan2(theta.cos() * beta.cos());
            let error = (turned - expected).sin().abs();
            assert!(error <= 1e-9, "β {beta}, θ₁ {theta}: {turned} {expected}");
            let speed = (r * shown.link_twist[second].angular).dot(&out);
            let ratio = beta.cos() / (beta.cos().powi(2) * c * c + s * s);
            assert!((speed / ratio - 1.0).abs() <= 1e-9, "β {beta}, θ₁ {theta}: {speed} {ratio}");
            (slowest, fastest) = (slowest.min(speed), fastest.max(speed));
        }
        assert!((slowest / beta.cos() - 1.0).abs() <= 1e-3 && (fastest * beta.cos() - 1.0).abs() <= 1e-3, "its bounds");
    }
}

/// A point mass on a cardan with level axes circles at Ω² = g / (L cos θ).
#[test]
fn a_conical_pendulum_on_a_cardan() {
    const L: f64 = 0.5;
    let bob = format!(
        "<inertial><origin xyz='0 0 -{L}'/><mass value='2'/><inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/></inertial>"
    );
    let text = [
        "<robot name='bob'><realnoid version='1'><joint_group name='cross' type='cardan' h='h' p='p'/></realnoid>"
            .into(),
        format!("<link name='base'/><link name='pin'/><link name='bob'>{bob}</link>"),
        joint("h", "revolute", ("base", "pin"), "1 0 0", "xyz='0 0 0'", WIDE),
        joint("p", "revolute", ("pin", "bob"), "0 1 0", "xyz='0 0 0'", WIDE),
        "</robot>".to_string(),
    ];
    let mut m = Model::clone(&model(&text.concat(), Base::Fixed));
    m.effects.limits = false;
    let m = Arc::new(m);
    for theta in [0.3f64, 0.9] {
        let omega = (9.80665 / (L * theta.cos())).sqrt();
        let mut last = f64::INFINITY;
        for h in [0.002, 0.001] {
            let start = [(0.0, omega * theta.tan()), (-theta, 0.0)];
            let mut w = world(&m, settings(Integrator::Rk4, h), &start);
            advance(&mut w, (1.0 / h) as usize);
            let shown = w.new_snapshot();
            let at = shown.link_pose[2] * nalgebra::Point3::new(0.0, 0.0, -L);
            let (s, c) = omega.sin_cos();
            let expected = Vec3::new(theta.sin() * c, theta.sin() * s, -theta.cos()) * L;
            // Of fourth order in the fastest angle; the 1/5! of the leading term is the margin.
            let rate = omega * theta.tan().max(1.0);
            let (error, bound) = ((at.coords - expected).norm(), L * rate * (rate * h).powi(4));
            println!("θ {theta} h {h}: {error:.2e} of {bound:.2e}");
            assert!(error <= bound && error <= last / 12.0, "θ {theta}: {last} → {error}, bound {bound}");
            last = error;
        }
    }
}
