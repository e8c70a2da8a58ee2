//! Joints, their frames and senses, drives, stops.

use super::support::{ALL, Random, state, tree};
use super::{G, run, settings, touching, world};
use realnoid::engine::{Engine, EngineKind, State, StepSettings, bullet::Bullet};
use realnoid::math::Vec3;
use realnoid::model::{Base, EulerFrame, JointType, Model};
use realnoid::solver::AxisCommand;
use realnoid::world::{Integrator, World};

fn read_angles(m: &Model, s: &mut State) {
    for (g, angles) in m.eulers.iter().zip(&mut s.angles) {
        let r = realnoid::model::rotation([s.q[g.q], s.q[g.q + 1], s.q[g.q + 2], s.q[g.q + 3]]);
        *angles = g.angles(&r, *angles);
    }
}

/// Relative difference of the accelerations in a short step, soon after the same state, with the same torques. Not in the first
/// steps: Bullet learns from the gap that a joint gets in a step how it turns the velocities, and closes a fifth of it at a time.
fn against_rbx(m: &Model, s: &State, commands: &[AxisCommand], h: f64) -> f64 {
    let step = StepSettings {
        h,
        gravity: [1.0, 2.0, -9.0],
        effects: m.effects,
        passes: 10_000,
        integrator: Integrator::SemiImplicitEuler,
        accuracy: 1e-9,
    };
    let engines: [Box<dyn Engine>; 2] = [EngineKind::Rbx.build(m, s).unwrap(), EngineKind::Bullet.build(m, s).unwrap()];
    let [a, b] = engines.map(|mut e| {
        e.prepare(m, step.integrator);
        (0..100).for_each(|_| assert!(!e.step(m, commands, &step).diverged));
        let before = e.state().v.clone();
        assert!(!e.step(m, commands, &step).diverged);
        let gained = e.state().v.iter().zip(&before).map(|(new, old)| (new - old) / h);
        gained.collect::<Vec<f64>>()
    });
    let size = a.iter().map(|x| x.abs()).fold(1.0, f64::max);
    a.iter().zip(&b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / size
}

/// Is it only the step that makes the difference? It is 0.1 at most at 10 µs, and half of that at 5 µs. Rounding of a pose,
/// 1e-16 m, is corrected within a step: 1e-5 m/s².
fn agrees(m: &Model, s: &State, commands: &[AxisCommand]) -> Result<(), String> {
    let [whole, half] = [1e-5, 5e-6].map(|h| against_rbx(m, s, commands, h));
    if whole < 0.1 && half < 0.55 * whole + 1e-5 {
        Ok(())
    } else {
        Err(format!("{whole:e} at 10 µs, {half:e} at 5 µs"))
    }
}

/// The frames, senses and scales of every kind of joint: the same torques accelerate as in rbx.
#[test]
fn torques_accelerate_every_kind_of_joint_as_in_rbx() {
    let mut wrong = vec![];
    for seed in 0..40 {
        let mut rng = Random(seed);
        let joints: Vec<JointType> = (0..4).map(|_| ALL[rng.next() as usize % ALL.len()]).collect();
        let joints = if seed < 10 { vec![ALL[seed as usize % ALL.len()]; 1 + seed as usize / 5] } else { joints };
        let mut m = tree(&joints, false, seed);
        m.eulers = (m.bodies.iter().enumerate().skip(1).filter(|(_, b)| b.joint == JointType::Spherical))
            .map(|(body, b)| EulerFrame { body, q: b.q, v: b.v, sense: if seed % 2 == 0 { 1.0 } else { -1.0 } })
            .collect();
        add_euler_axes(&mut m);
        let (q, v) = state(&m, &mut rng, 1.0);
        let mut s = State { q, v, angles: vec![[0.0; 3]; m.eulers.len()] };
        read_angles(&m, &mut s);
        let commands: Vec<_> = m.axes.iter().map(|_| AxisCommand::torque(5.0 * rng.unit())).collect();
        if let Err(error) = agrees(&m, &s, &commands) {
            wrong.push(format!("{joints:?}, seed {seed}: {error}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn add_euler_axes(m: &mut Model) {
    use realnoid::model::{Axis, AxisSlot};
    let like = super::support::tree(&[JointType::Revolute], true, 1).axes[0].clone();
    for group in 0..m.eulers.len() {
        for angle in 0..3 {
            let name = format!("angle_{group}_{angle}");
            m.axes.push(Axis { name, slot: AxisSlot::Euler { group, angle }, ..like.clone() });
        }
    }
}

/// A hinge about y at the origin; 1 kg hangs 0.5 m below it.
fn pendulum(limit: &str, more: &str) -> Model {
    let kind = if limit.is_empty() { "continuous" } else { "revolute" };
    touching::model(
        &format!(
            r#"<robot name="p"><link name="w"/><link name="b"><inertial><origin xyz="0 0 -0.5"/><mass value="1"/>
            <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
            <joint name="j" type="{kind}"><parent link="w"/><child link="b"/><axis xyz="0 1 0"/>{limit}
            <realnoid>{more}</realnoid></joint></robot>"#
        ),
        Base::Fixed,
    )
}

/// Iterations after which nothing of a single hinge's servo or stop is left: the row of its motor is about the centre of mass, and
/// takes I/(I + m l²) = 4 % of what is left in each.
fn finely(m: &Model) -> World {
    let s = realnoid::world::Settings { solver_iterations: 300, ..settings(1e-3) };
    touching::world(m.clone(), s)
}

/// A servo holds 1 rad, and its effort is the weight's torque there; with few iterations nearly.
#[test]
fn a_servo_holds_a_pendulum_and_tells_its_torque() {
    let m = pendulum("", r#"<drive mode="servo" max_torque="20"/>"#);
    for (mut w, off) in [(finely(&m), 1e-6), (world(m.clone(), 1e-3), 2e-3)] {
        w.set_commands(&[AxisCommand::servo(1.0)]).unwrap();
        run(&mut w, 3.0);
        let (q, v) = w.state().axis(w.model(), 0);
        assert!((q - 1.0).abs() < off && v.abs() < 1e-6, "{q} {v}");
        let torque = G * 0.5 * q.sin();
        assert!((w.efforts()[0] - torque).abs() < 1e-3 * torque, "{} of {torque}", w.efforts()[0]);
    }
}

/// Damping is implicit, whatever its size: q̇ = −G m l q / d for a stiff damper.
#[test]
fn a_stiff_damper_creeps() {
    let mut m = pendulum("", "");
    m.axes[0].damping = 500.0;
    m.effects.damping = true;
    let mut w = finely(&m);
    let mut s = State::initial(&m);
    s.set_axis(&m, 0, 0.1, 0.0);
    w.set_initial_state(s);
    run(&mut w, 2.0);
    // l/d tan(q/2) decays exactly as exp(−G m l t / d).
    let exact = 2.0 * (0.05f64.tan() * (-G * 0.5 * 2.0 / 500.0).exp()).atan();
    let q = w.state().axis(&m, 0).0;
    assert!((q / exact - 1.0).abs() < 1e-4, "{q} {exact}");
}

/// A constant torque for 0.1 s without weight: ω = τ t / I, exact in every step.
#[test]
fn a_torque_accelerates_exactly() {
    let mut m = pendulum("", "");
    m.effects.gravity = false;
    let mut w = world(m.clone(), 1e-3);
    w.set_commands(&[AxisCommand::torque(0.3)]).unwrap();
    run(&mut w, 0.1);
    let exact = 0.3 * 0.1 / (0.01 + 0.25);
    let v = w.state().axis(&m, 0).1;
    assert!((v / exact - 1.0).abs() < 1e-3, "{v} {exact}");
}

/// Bullet knows stops within half a turn; those further away are told in each step.
#[test]
fn stops_near_and_far_hold() {
    for (lower, upper, from, torque) in [(-0.5, 0.4, 0.0, 30.0), (-0.5, 0.4, 0.0, -30.0), (-1.0, 9.0, 8.0, 30.0)] {
        let limit = format!(r#"<limit lower="{lower}" upper="{upper}" effort="100" velocity="100"/>"#);
        let m = pendulum(&limit, "");
        let mut w = finely(&m);
        let mut s = State::initial(&m);
        s.set_axis(&m, 0, from, 0.0);
        w.set_initial_state(s);
        w.set_commands(&[AxisCommand::torque(torque)]).unwrap();
        run(&mut w, 4.0);
        let (q, v) = w.state().axis(&m, 0);
        let stop = if torque > 0.0 { upper } else { lower };
        assert!((q - stop).abs() < 1e-4 && v.abs() < 1e-4, "{q} at {stop}, {v}");
        assert!(w.stats().worst_stop_violation < 1e-3, "{}", w.stats().worst_stop_violation);
        assert!((w.efforts()[0] - torque).abs() < 1e-9, "{}", w.efforts()[0]);
    }
}

/// A link that slides down a vertical axis to the end of its way.
#[test]
fn a_slide_stops_at_its_end() {
    let m = touching::model(
        r#"<robot name="p"><link name="w"/><link name="b"><inertial><mass value="2"/>
        <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="j" type="prismatic"><parent link="w"/><child link="b"/><axis xyz="0 0 -1"/>
        <limit lower="-0.1" upper="0.3" effort="100" velocity="100"/></joint></robot>"#,
        Base::Fixed,
    );
    let mut w = world(m.clone(), 1e-3);
    run(&mut w, 0.2);
    let (q, v) = w.state().axis(&m, 0);
    assert!((q - 0.5 * G * 0.04).abs() < 1e-9 && (v - G * 0.2).abs() < 1e-9, "{q} {v}");
    run(&mut w, 2.0);
    assert!((w.state().axis(&m, 0).0 - 0.3).abs() < 1e-5, "{}", w.state().axis(&m, 0).0);
}

/// What hangs on a joint is what the joint gives: J-18's feedback.
#[test]
fn a_joint_tells_the_force_that_goes_through_it() {
    let m = pendulum("", "");
    let s = State::initial(&m);
    let mut engine = Bullet::new(&m, &s).unwrap();
    let step = StepSettings {
        h: 1e-3,
        gravity: [0.0, 0.0, -G],
        effects: m.effects,
        passes: 50,
        integrator: Integrator::default(),
        accuracy: 1e-9,
    };
    for _ in 0..100 {
        assert!(!engine.step(&m, &[AxisCommand::IDLE], &step).diverged);
    }
    let force = engine.joint_forces().unwrap()[0].force;
    assert!((Vec3::from(force) - Vec3::new(0.0, 0.0, G)).norm() < 1e-6, "{force:?}");
}

/// J-18: ERP and CFM are a spring k = ERP / (h CFM) and a damper. 1 kg hangs on a soft weld.
#[test]
fn a_soft_joint_sags_by_its_spring() {
    let urdf = r#"<robot name="p"><link name="w"/><link name="b"><inertial><mass value="1"/>
        <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="j" type="fixed"><parent link="w"/><child link="b"/>
        <realnoid><constraint erp="0.2" cfm="0.01"/></realnoid></joint></robot>"#;
    let mut w = world(touching::model(urdf, Base::Fixed), 1e-3);
    run(&mut w, 3.0);
    let snapshot = w.new_snapshot();
    let sag = -snapshot.link_pose[1].translation.z;
    let exact = G * 1e-3 * 0.01 / 0.2;
    assert!((sag / exact - 1.0).abs() < 1e-6, "{sag} {exact}");
}

/// A joint that carries more than its threshold comes apart, one that carries less does not.
#[test]
fn a_joint_breaks_above_its_threshold() {
    for (threshold, breaks) in [(9.5, true), (10.1, false)] {
        let mut w = world(pendulum("", &format!(r#"<constraint break_threshold="{threshold}"/>"#)), 1e-3);
        run(&mut w, 0.5);
        assert_eq!(!w.broken().is_empty(), breaks, "{threshold}");
        let z = w.new_snapshot().link_pose[1].translation.z;
        assert_eq!(z < -0.5, breaks, "{z}");
    }
}

/// The chain of facts/engines.md, A7: within 1e-3 m of the reference of the last link's centre of mass.
#[test]
fn the_chain_of_ten_hinges_ends_where_it_should() {
    let mut urdf = String::from(r#"<robot name="chain"><link name="l0"/>"#);
    for k in 1..=10 {
        let (axis, x) = (if k % 2 == 1 { "0 1 0" } else { "0 0 1" }, if k == 1 { 0.0 } else { 0.2 });
        urdf += &format!(
            r#"<link name="l{k}"><inertial><origin xyz="0.1 0 0"/><mass value="1"/><inertia ixx="0.002" iyy="0.004" izz="0.005"
            ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j{k}" type="continuous"><origin xyz="{x} 0 0"/>
            <axis xyz="{axis}"/><parent link="l{}"/><child link="l{k}"/></joint>"#,
            k - 1
        );
    }
    let m = touching::model(&(urdf + "</robot>"), Base::Fixed);
    let mut w = world(m, 2.5e-4);
    run(&mut w, 2.0);
    let tip = w.new_snapshot().link_pose[10] * nalgebra::Point3::new(0.1, 0.0, 0.0);
    let error = (tip.coords - Vec3::new(0.3058350679, 0.0, -1.7631342685)).norm();
    assert!(error < 1e-3, "{error:e}");
}

/// Two hinges without mass between them are one joint; three likewise; in rbx they are as they are.
#[test]
fn hinges_without_mass_between_them_are_one_joint() {
    for axes in [vec!["0 1 0", "1 0 0"], vec!["0 0 1", "0 -1 0", "-1 0 0"]] {
        let mut urdf = String::from(r#"<robot name="p"><link name="l0"/>"#);
        for (k, axis) in axes.iter().enumerate() {
            urdf += &format!(
                r#"<joint name="j{k}" type="continuous"><parent link="l{k}"/><child link="l{}"/><axis xyz="{axis}"/></joint>"#,
                k + 1
            );
            if k + 1 < axes.len() {
                urdf += &format!(r#"<link name="l{}"/>"#, k + 1);
            }
        }
        urdf += &format!(
            r#"<link name="l{}"><inertial><origin xyz="0.1 0.2 -0.3"/><mass value="1"/><inertia ixx="0.02" iyy="0.03" izz="0.04"
            ixy="0.001" ixz="0" iyz="0.002"/></inertial></link></robot>"#,
            axes.len()
        );
        let m = touching::model(&urdf, Base::Fixed);
        let mut s = State::initial(&m);
        for k in 0..axes.len() {
            s.set_axis(&m, k, 0.3 + 0.4 * k as f64, 0.7 - 0.9 * k as f64);
        }
        let commands: Vec<_> = (0..axes.len()).map(|k| AxisCommand::torque(1.0 - 0.4 * k as f64)).collect();
        agrees(&m, &s, &commands).unwrap();
    }
}

/// The humanoid with all three groups, every axis a servo: after 5 s every axis stands where it does in rbx, but for what 50
/// iterations leave of the load: 0.3°.
#[test]
fn the_humanoid_follows_its_servos() {
    let m = super::support::urdf::model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Fixed);
    let targets: Vec<f64> = m.axes.iter().map(|a| 0.3f64.max(a.lower).min(a.upper)).collect();
    let ends = [EngineKind::Rbx, EngineKind::Bullet].map(|engine| {
        let s = realnoid::world::Settings { engine, solver_iterations: 50, ..settings(5e-4) };
        let mut w = World::new(m.clone(), s).unwrap();
        w.set_commands(&targets.iter().map(|t| AxisCommand::servo(*t)).collect::<Vec<_>>()).unwrap();
        run(&mut w, 5.0);
        (0..m.axes.len()).map(|i| w.state().axis(&m, i).0).collect::<Vec<_>>()
    });
    for (i, axis) in m.axes.iter().enumerate() {
        let (a, b) = (ends[0][i], ends[1][i]);
        assert!((a - b).abs() < 5e-3, "{}: rbx {a}, bullet {b}, target {}", axis.name, targets[i]);
    }
}

/// What Bullet cannot take is told with a name.
#[test]
fn what_cannot_be_taken_is_an_error() {
    let with = |inertia: &str| {
        let urdf = format!(
            r#"<robot name="p"><link name="w"/><link name="b"><inertial><mass value="1"/><inertia {inertia} ixy="0" ixz="0" iyz="0"/>
            </inertial></link><joint name="j" type="prismatic"><parent link="w"/><child link="b"/><axis xyz="0 0 1"/>
            <limit lower="-1" upper="1"/></joint></robot>"#
        );
        touching::model(&urdf, Base::Fixed)
    };
    let m = with(r#"ixx="0" iyy="0" izz="0""#);
    let told = EngineKind::Bullet.build(&m, &State::initial(&m)).unwrap_err();
    assert!(told.contains("link 'b'") && told.contains("bullet"), "{told}");
}
