//! Joint groups from URDF text: 3DOF with a quaternion, cardan, combined hinge; against chains of single hinges.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::cli::load::{Source, load};
use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::{Base, Model};
use realnoid::world::{AxisCommand, Integrator, Settings, World};
use std::io::Write;
use std::sync::Arc;

/// A limb on a stand: h (yaw), p (pitch), b (roll), then the limb. `tag` is the robot's `<realnoid>` element; `limits` go
/// into each joint.
fn limb(kind: &str, limit: &str, dynamics: &str) -> Arc<Model> {
    let joint = |name: &str, parent: &str, child: &str, axis: &str, origin: &str| {
        format!(
            "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/>\
             <origin xyz='{origin}' rpy='0 0 0'/><axis xyz='{axis}'/>{limit}{dynamics}</joint>"
        )
    };
    let tag = match kind {
        "3dof" => "<realnoid version='1'><joint_group name='hip' type='3dof' h='h' p='p' b='b'/></realnoid>",
        "cardan" => "<realnoid version='1'><joint_group name='hip' type='cardan' h='h' p='p'/></realnoid>",
        "combined_hinge" => {
            "<realnoid version='1'><joint_group name='hip' type='combined_hinge' h='h' p='p' b='b'/></realnoid>"
        }
        _ => "",
    };
    let text = format!(
        "<robot name='limb'>{tag}<link name='base'/><link name='l1'/><link name='l2'/><link name='limb'><inertial>\
         <origin xyz='0.02 0.01 -0.2' rpy='0.1 0.2 0.3'/><mass value='3'/>\
         <inertia ixx='0.04' ixy='0.001' ixz='0.002' iyy='0.05' iyz='-0.001' izz='0.02'/></inertial></link>{}{}{}</robot>",
        joint("h", "base", "l1", "0 0 1", "0 0 1"),
        joint("p", "l1", "l2", "0 1 0", "0 0 0"),
        joint("b", "l2", "limb", "1 0 0", "0 0 0"),
    );
    let mut file = tempfile::Builder::new().suffix(".urdf").tempfile().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    load(Source { urdf: Some(file.path()), packages: &[] }, Base::Fixed)
        .unwrap_or_else(|report| panic!("{report}"))
        .model
}

const WIDE: &str = "<limit lower='-1.5' upper='1.5' effort='40' velocity='20'/>";

fn settings(integrator: Integrator, interval: f64) -> Settings {
    Settings { integrator, control_interval_ns: (interval * 1e9) as i64, steps_per_interval: 1, ..Settings::default() }
}

fn world(m: &Arc<Model>, s: Settings, start: &[(f64, f64)]) -> World {
    let mut w = World::new(m.clone(), s).unwrap();
    let mut state = State::initial(m);
    for (axis, (q, _)) in start.iter().enumerate() {
        state.set_axis(m, axis, *q, 0.0);
    }
    for (axis, (q, v)) in start.iter().enumerate() {
        state.set_axis(m, axis, *q, *v);
    }
    w.set_initial_state(state);
    w
}

fn advance(w: &mut World, intervals: usize) {
    (0..intervals).for_each(|_| w.advance());
}

fn without_limits(m: &Model) -> Arc<Model> {
    let mut m = m.clone();
    m.effects.limits = false;
    Arc::new(m)
}

fn axes(w: &World) -> Vec<(f64, f64)> {
    (0..w.model().axes.len()).map(|a| w.state().axis(w.model(), a)).collect()
}

/// Away from the pole a 3DOF group and a cardan move as the chain of three hinges with massless links between them, with
/// torques on the axes; RK4 at 0.5 ms, so that the difference is its truncation.
#[test]
fn groups_move_as_chains_of_hinges() {
    let start = [(0.3, 0.5), (0.4, -0.7), (-0.2, 0.9)];
    let commands = [0.8, -1.1, 0.4].map(AxisCommand::torque);
    let run = |kind: &str| {
        let m = without_limits(&limb(kind, WIDE, ""));
        let mut w = world(&m, settings(Integrator::Rk4, 0.0005), &start);
        w.set_commands(&commands).unwrap();
        advance(&mut w, 600);
        assert!(axes(&w)[1].0.abs() < 1.3, "away from the pole: {:?}", axes(&w));
        let shown = w.new_snapshot();
        (axes(&w), shown.link_pose, shown.link_twist, w.stats())
    };
    let chain = run("chain");
    for kind in ["3dof", "cardan", "combined_hinge"] {
        let group = run(kind);
        assert_eq!(group.3.fallback_steps, 0);
        for (a, b) in chain.0.iter().zip(&group.0) {
            assert!((a.0 - b.0).abs() <= 1e-9 && (a.1 - b.1).abs() <= 1e-8, "{kind}: {a:?} {b:?}");
        }
        for link in 0..chain.1.len() {
            let apart = chain.1[link].inverse() * group.1[link];
            assert!(apart.translation.vector.norm() <= 1e-9 && apart.rotation.angle() <= 1e-8, "{kind}: link {link}");
            let (a, b) = (&chain.2[link], &group.2[link]);
            assert!((a.angular - b.angular).norm() <= 1e-7 && (a.linear - b.linear).norm() <= 1e-7, "{kind}: {link}");
        }
    }
}

/// The same with damping, friction, stops and servos at work, in the implicit integrator: the laws act on H, P and B alike.
/// Both are first order, so the bound falls with the step; Euler leaves some of the longer steps to the default rule, so that the difference need not.
#[test]
fn laws_act_on_the_angles_of_a_group() {
    let dynamics = "<dynamics damping='0.3' friction='0.2'/>";
    let limit = "<limit lower='-0.6' upper='0.6' effort='15' velocity='20'/>";
    for interval in [0.002, 0.001, 0.0005] {
        let end = |kind: &str| {
            let m = limb(kind, limit, dynamics);
            let mut w =
                world(&m, settings(Integrator::SemiImplicitEuler, interval), &[(0.1, 1.0), (0.3, -2.0), (-0.2, 3.0)]);
            w.set_commands(&[AxisCommand::servo(0.4), AxisCommand::torque(-1.0), AxisCommand::torque(6.0)]).unwrap();
            advance(&mut w, (0.3 / interval) as usize);
            assert_eq!((w.stats().unsettled_steps, w.stats().pole_steps), (0, 0));
            axes(&w)
        };
        let (chain, group) = (end("chain"), end("3dof"));
        let apart = chain.iter().zip(&group).map(|(a, b)| (a.0 - b.0).abs()).fold(0.0, f64::max);
        assert!(apart <= 4.0 * interval, "{apart} at {interval}: {chain:?} {group:?}");
    }
}

/// Servos hold all three angles exactly; the torques shown are those of the chain of hinges.
#[test]
fn servos_hold_a_group() {
    let hold = |kind: &str| {
        let m = limb(kind, WIDE, "");
        let mut w = world(&m, settings(Integrator::SemiImplicitEuler, 0.001), &[(0.0, 0.0); 3]);
        w.set_commands(&[AxisCommand::servo(0.5), AxisCommand::servo(-0.6), AxisCommand::servo(0.7)]).unwrap();
        advance(&mut w, 4000);
        let mut shown = w.new_snapshot();
        w.write_snapshot(&mut shown);
        shown
    };
    let (group, chain) = (hold("3dof"), hold("chain"));
    for (axis, target) in [0.5, -0.6, 0.7].into_iter().enumerate() {
        assert!((group.position[axis] - target).abs() <= 1e-9 && group.velocity[axis].abs() <= 1e-9);
        assert!((group.effort[axis] - chain.effort[axis]).abs() <= 1e-6, "{:?} {:?}", group.effort, chain.effort);
    }
}

/// A ball on a 3DOF joint, through pitch ±90° again and again at 10 rad/s, through the pole and 0.01° beside it: the
/// attitude is exp(ω t) and the energy stays, the angles shown are continuous and give the attitude back.
#[test]
fn the_pole_is_nothing_special() {
    let mut ball = Model::clone(&without_limits(&limb("3dof", WIDE, "")));
    let b = &mut ball.bodies[1];
    (b.mc, b.inertia) = (Default::default(), Default::default());
    (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (0.05, 0.05, 0.05);
    let ball = Arc::new(ball);
    let e = &ball.eulers[0];
    for (integrator, offset) in [Integrator::Rk4, Integrator::SemiImplicitEuler]
        .map(|i| (i, [0.0, 1.7e-4]))
        .iter()
        .flat_map(|(i, o)| o.map(|o| (*i, o)))
    {
        let h = 0.0005;
        let mut w = world(&ball, settings(integrator, h), &[(0.0, 0.0), (0.0, 10.0), (offset, 0.0)]);
        let start = w.state().clone();
        let energy = w.energy().kinetic;
        let (mut before, mut highest) = (axes(&w), 0.0f64);
        for step in 1..=20_000 {
            w.advance();
            let now = axes(&w);
            assert!((now[1].0 - before[1].0).abs() <= 10.0 * h * 1.01, "pitch is continuous: {before:?} {now:?}");
            let s = w.state();
            let shown = e.quaternion([now[0].0, now[1].0, now[2].0]);
            let exact = turned(&start.q[e.q..e.q + 4], &start.v[e.v..e.v + 3], step as f64 * h);
            let dot = |p: &[f64], q: &[f64]| 1.0 - p.iter().zip(q).map(|(a, b)| a * b).sum::<f64>().abs();
            assert!(dot(&shown, &s.q[e.q..e.q + 4]) <= 1e-12, "the angles give the attitude back");
            // 1 − cos(φ/2) of an attitude error φ; RK4 turns by h ω up to (h ω)⁵ / 1920 a step, the exponential exactly.
            let error = if integrator == Integrator::Rk4 { (10.0f64 * h).powi(5) / 1920.0 * 2.0 } else { 1e-15 };
            assert!(dot(&exact, &s.q[e.q..e.q + 4]) <= 0.125 * (error * f64::from(step) + 1e-7).powi(2), "step {step}");
            highest = highest.max(now[1].0.abs());
            before = now;
        }
        assert!(highest > if offset == 0.0 { 90.0 } else { 1.57 }, "through the pole, or beside it: {highest}");
        assert!((w.energy().kinetic / energy - 1.0).abs() <= 1e-12);
        assert_eq!(w.stats().diverged_steps, 0);
    }
}

/// q ⊗ exp(ω t / 2), quaternions as (w, x, y, z).
fn turned(q: &[f64], w: &[f64], t: f64) -> [f64; 4] {
    let q = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]));
    let r = q * nalgebra::UnitQuaternion::from_scaled_axis(Vec3::new(w[0], w[1], w[2]) * t);
    [r.w, r.i, r.j, r.k]
}

/// Pushed and held at the very pole: finite, and said.
#[test]
fn torques_at_the_pole_stay_finite() {
    let limit = "<limit lower='-1.5707963267948966' upper='1.5707963267948966' effort='40' velocity='20'/>";
    let m = limb("3dof", limit, "<dynamics damping='0.1' friction='0.1'/>");
    for command in [AxisCommand::torque(5.0), AxisCommand::servo(std::f64::consts::FRAC_PI_2), AxisCommand::servo(0.3)]
    {
        let half_pi = std::f64::consts::FRAC_PI_2;
        let mut w =
            world(&m, settings(Integrator::SemiImplicitEuler, 0.001), &[(0.2, 0.0), (half_pi, 0.0), (0.1, 0.0)]);
        w.set_commands(&[command; 3]).unwrap();
        advance(&mut w, 2000);
        assert_eq!(w.stats().diverged_steps, 0, "{command:?}");
        let wild = axes(&w).iter().any(|(q, v)| !q.is_finite() || !v.is_finite() || v.abs() > 1e5);
        assert!(!wild, "{command:?}: {:?}", axes(&w));
        assert!(w.stats().pole_steps > 0);
    }
}

/// A conical pendulum on a 3DOF joint: Ω² = g / (L cos θ) for a point mass.
#[test]
fn conical_pendulum() {
    let m = limb("3dof", WIDE, "");
    let mut point = Model::clone(&without_limits(&m));
    let b = &mut point.bodies[1];
    (b.mass, b.mc) = (2.0, realnoid::math::V3::from(Vec3::new(0.0, 0.0, -0.5 * 2.0)));
    // As good as a point: its own inertia is 1e-9 of the rod's.
    let own = 1e-9;
    b.inertia = Default::default();
    (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (0.5 + own, 0.5 + own, own);
    let point = Arc::new(point);
    let theta: f64 = 0.4;
    let omega = (9.80665 / (0.5 * theta.cos())).sqrt();
    let mut state = State::initial(&point);
    state.set_axis(&point, 1, theta, 0.0);
    // The whole body turns about the vertical at Ω: its angular velocity in body axes is Ω R^T z.
    let e = &point.eulers[0];
    let q = e.quaternion([0.0, theta, 0.0]);
    let r = realnoid::model::rotation(q);
    let up = r.tv(realnoid::math::V3::new(0.0, 0.0, 1.0)) * omega;
    state.v[e.v..e.v + 3].copy_from_slice(&[up.x, up.y, up.z]);
    let mut w = World::new(point.clone(), settings(Integrator::Rk4, 0.001)).unwrap();
    w.set_initial_state(state);
    advance(&mut w, 1000);
    let heading = axes(&w)[0].0;
    assert!((axes(&w)[1].0 - theta).abs() <= 1e-6, "θ stays: {}", axes(&w)[1].0);
    assert!((heading - omega).abs() <= 1e-5, "turned by Ω·1 s: {heading} {omega}");
}
