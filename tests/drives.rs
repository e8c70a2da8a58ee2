//! The drive (J-13) against closed forms: K = 0.05 N·m/A, R = 2 Ω, 12 V on J = 1e-3 kg·m², so that the line goes from
//! 0.3 N·m at rest to 240 rad/s, with the time constant τ = R J / K² = 0.8 s.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::engine::State;
use realnoid::math::V3;
use realnoid::model::{DriveLimits, Effects, JointType, Model};
use realnoid::world::{AxisCommand, Integrator, Settings, World};
use std::sync::Arc;
use support::tree;

const J: f64 = 1e-3;
const STALL: f64 = 0.3;
const NO_LOAD: f64 = 240.0;
const TAU: f64 = J * NO_LOAD / STALL;

/// A fly-wheel on a vertical axis.
fn wheel(drive: DriveLimits) -> Model {
    let mut m = tree(&[JointType::Revolute], true, 1);
    let b = &mut m.bodies[1];
    b.tree_r = realnoid::math::M3::identity();
    (b.mass, b.mc, b.inertia) = (1.0, V3::default(), Default::default());
    (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (J, J, J);
    m.axes[0].drive = drive;
    m.effects = Effects::called_for(&m);
    m
}

fn motor() -> DriveLimits {
    DriveLimits { max_torque: STALL, no_load_speed: NO_LOAD, max_speed: NO_LOAD, ..DriveLimits::default() }
}

fn world(m: &Model, h: f64, speed: f64) -> World {
    let settings = Settings {
        control_interval_ns: (h * 1e9).round() as i64,
        steps_per_interval: 1,
        integrator: Integrator::ImplicitMidpoint,
        ..Settings::default()
    };
    let mut w = World::new(Arc::new(m.clone()), settings).unwrap();
    let mut s = State::initial(m);
    s.set_axis(m, 0, 0.0, speed);
    w.set_initial_state(s);
    w
}

fn run(w: &mut World, seconds: f64) -> (f64, f64) {
    let steps = (seconds / (w.settings().control_interval_ns as f64 * 1e-9)).round() as usize;
    (0..steps).for_each(|_| w.advance());
    w.state().axis(w.model(), 0)
}

fn effort(w: &World) -> f64 {
    w.new_snapshot().effort[0]
}

/// The relative error of the midpoint rule on a decay of rate 1/τ after t: (t/τ)(h/τ)²/12, to leading order.
fn midpoint_error(t: f64, h: f64) -> f64 {
    1.1 * t / TAU * (h / TAU).powi(2) / 12.0 + 1e-12
}

/// ω = ω0 (1 − e^(−t/τ)), both ways; J-15: the drive shows what the line leaves at this speed.
#[test]
fn spin_up() {
    for h in [0.01, 0.001] {
        for side in [1.0, -1.0] {
            let mut w = world(&wheel(motor()), h, 0.0);
            w.set_commands(&[AxisCommand { speed: side * NO_LOAD, ..AxisCommand::torque(side * STALL) }]).unwrap();
            let (angle, speed) = run(&mut w, 1.0);
            let left = (-1.0 / TAU).exp();
            let bound = NO_LOAD * left * midpoint_error(1.0, h);
            assert!((side * speed - NO_LOAD * (1.0 - left)).abs() <= bound, "{h} {speed}");
            assert!((side * angle - NO_LOAD * (1.0 - TAU * (1.0 - left))).abs() <= TAU * bound * 2.0, "{h} {angle}");
            // Effort is that of the last step, at its mean speed.
            let shown = STALL * left * (0.5 * h / TAU).exp();
            assert!((side * effort(&w) - shown).abs() <= 1e-4 * STALL * h / 0.01, "{} {shown}", effort(&w));
        }
    }
}

/// The errors fall with h², and with h⁴ under RK4.
#[test]
fn spin_up_keeps_the_order() {
    // Euler leaves steps in which torques change by a sixteenth to the default rule.
    let rules =
        [(Integrator::ImplicitMidpoint, 2, 0.1), (Integrator::Rk4, 4, 0.1), (Integrator::SemiImplicitEuler, 1, 0.02)];
    for (integrator, order, h) in rules {
        let error = |h: f64| {
            let mut w = world(&wheel(motor()), h, 0.0);
            w.set_settings(Settings { integrator, ..*w.settings() }).unwrap();
            w.set_commands(&[AxisCommand::torque(STALL)]).unwrap();
            (run(&mut w, 1.0).1 - NO_LOAD * (1.0 - (-1.0 / TAU).exp())).abs()
        };
        let ratio = error(h) / error(h / 2.0);
        let expected = f64::from(1 << order);
        assert!((ratio / expected - 1.0).abs() <= 0.25, "{integrator:?}: {ratio}");
    }
}

/// Less than the maximum: c and d make a line of their own; beyond it they are cut to it.
#[test]
fn applied_values_within_and_beyond_the_maximum() {
    for (torque, speed, c, d) in [(0.1, 60.0, 0.1, 60.0), (5.0, 1e4, STALL, NO_LOAD), (0.1, f64::NAN, 0.1, NO_LOAD)] {
        let mut w = world(&wheel(motor()), 0.001, 0.0);
        w.set_commands(&[AxisCommand { speed, ..AxisCommand::torque(torque) }]).unwrap();
        let (_, v) = run(&mut w, 0.5);
        let tau = J * d / c;
        let exact = d * (1.0 - (-0.5 / tau).exp());
        assert!((v - exact).abs() <= 1e-5 * exact, "{torque} {speed}: {v} {exact}");
    }
}

/// Faster than its no-load speed the drive brakes; turned backwards it gives no more than the current limit.
#[test]
fn four_quadrants() {
    let mut w = world(&wheel(motor()), 0.001, 300.0);
    w.set_commands(&[AxisCommand::torque(STALL)]).unwrap();
    let exact = NO_LOAD + 60.0 * (-0.4 / TAU).exp();
    assert!((run(&mut w, 0.4).1 - exact).abs() <= 60.0 * midpoint_error(0.4, 0.001) * 1.1);
    assert!(effort(&w) < 0.0);
    for (start, sign) in [(-300.0, 1.0), (1000.0, -1.0)] {
        let mut w = world(&wheel(motor()), 0.001, start);
        w.set_commands(&[AxisCommand::torque(STALL)]).unwrap();
        let (_, v) = run(&mut w, 0.1);
        assert!((v - (start + sign * STALL / J * 0.1)).abs() <= 1e-9, "{v}");
        assert_eq!(effort(&w), sign * STALL);
    }
}

/// ω = ω_i e^(−t/τ), angle ω_i τ in all; it never stops by itself and never turns back. With idle terminals it turns on.
#[test]
fn short_brake() {
    let braked = DriveLimits { short_brake: true, ..motor() };
    for h in [0.01, 0.001] {
        let mut w = world(&wheel(braked), h, 100.0);
        w.set_commands(&[AxisCommand::torque(0.0)]).unwrap();
        let (_, v) = run(&mut w, 1.0);
        assert!((v / (100.0 * (-1.0 / TAU).exp()) - 1.0).abs() <= midpoint_error(1.0, h), "{h} {v}");
        let (angle, v) = run(&mut w, 15.0);
        // Σ h v̄ is exact for the trapezoid of a linear brake: all momentum is gone into J/b · angle.
        assert!((angle + v * TAU - 100.0 * TAU).abs() <= 1e-9 * 100.0 * TAU, "{h} {angle}");
        assert!(v > 0.0 && v < 1e-6);
    }
    for (drive, command) in [(braked, AxisCommand::IDLE), (motor(), AxisCommand::torque(0.0))] {
        let mut w = world(&wheel(drive), 0.001, 100.0);
        w.set_commands(&[command]).unwrap();
        assert_eq!(run(&mut w, 1.0).1, 100.0);
    }
}

/// A brake whose time constant is far below the step still brakes, without ringing.
#[test]
fn a_stiff_brake_does_not_ring() {
    let strong = DriveLimits { max_torque: 1e4, no_load_speed: 1.0, max_speed: 1.0, short_brake: true, ..motor() };
    let mut w = world(&wheel(strong), 0.01, 100.0);
    w.set_commands(&[AxisCommand::torque(0.0)]).unwrap();
    let mut last = 100.0;
    for _ in 0..100 {
        w.advance();
        let v = w.state().axis(w.model(), 0).1;
        assert!(v >= 0.0 && (v < last || v == 0.0), "{v} after {last}");
        last = v;
    }
    assert!(last < 1e-12);
}

/// Brake and Coulomb torque together stop at τ ln(1 + bω/τc); Coulomb alone slows down linearly; then it stands exactly.
#[test]
fn brake_with_coulomb_torque() {
    let coulomb = 0.02;
    for (brake, h) in [(true, 0.01), (true, 0.001), (false, 0.01), (false, 0.001)] {
        let drive =
            DriveLimits { short_brake: brake, static_resistance: coulomb, dynamic_resistance: coulomb, ..motor() };
        let (b, start) = (STALL / NO_LOAD, 100.0);
        let (time, angle) = if brake {
            let time = TAU * (1.0 + b * start / coulomb).ln();
            (time, (start + coulomb / b) * TAU * (1.0 - (-time / TAU).exp()) - coulomb / b * time)
        } else {
            (start * J / coulomb, 0.5 * start * start * J / coulomb)
        };
        let mut w = world(&wheel(drive), h, start);
        w.set_commands(&[AxisCommand::torque(0.0)]).unwrap();
        let mut steps = 0;
        while w.state().axis(w.model(), 0).1 > 0.0 {
            w.advance();
            steps += 1;
            assert!(
                w.state().axis(w.model(), 0).1 >= 0.0,
                "friction has turned the motion around {:?}",
                w.state().axis(w.model(), 0)
            );
        }
        // It stands at the end of the step in which it stops; in that step the way is off by at most v h = (τc/J) h².
        assert!((f64::from(steps) * h - time - 0.5 * h).abs() <= 0.5 * h + 1e-3 * h, "{brake} {h}: {steps} {time}");
        let stopped = w.state().axis(w.model(), 0).0;
        let bound = coulomb / J * h * h + 2.0 * angle * midpoint_error(time, h) + 1e-9;
        assert!((stopped - angle).abs() <= bound, "{brake} {h}: {stopped} {angle}");
        assert_eq!(run(&mut w, 1.0), (stopped, 0.0));
    }
}

/// Below the static resistance nothing moves, not by a bit, in 100 s; above it the axis goes with what the dynamic one
/// leaves; when it has stopped it takes the static one again to start it.
#[test]
fn breakaway() {
    let (e, f) = (0.12, 0.08);
    let drive = DriveLimits { static_resistance: e, dynamic_resistance: f, no_load_speed: f64::INFINITY, ..motor() };
    for side in [1.0, -1.0] {
        let mut w = world(&wheel(drive), 0.001, 0.0);
        w.set_commands(&[AxisCommand::torque(side * 0.999 * e)]).unwrap();
        assert_eq!(run(&mut w, 100.0), (0.0, 0.0));
        w.set_commands(&[AxisCommand::torque(side * 1.001 * e)]).unwrap();
        let (_, v) = run(&mut w, 1.0);
        assert!((side * v - (1.001 * e - f) / J).abs() <= 1e-9, "{v}");
        // Between the two resistances it goes on once it turns …
        w.set_commands(&[AxisCommand::torque(side * 0.1)]).unwrap();
        assert!((side * (run(&mut w, 1.0).1 - v) - (0.1 - f) / J).abs() <= 1e-9);
        // … but does not start again.
        w.set_commands(&[AxisCommand::torque(0.0)]).unwrap();
        run(&mut w, 2.0);
        w.set_commands(&[AxisCommand::torque(side * 0.1)]).unwrap();
        let (there, v) = run(&mut w, 1.0);
        assert_eq!((v, run(&mut w, 1.0).0), (0.0, there));
    }
}

/// A pendulum whose weight works as a spring against Coulomb friction: from peak to peak the weight's energy pays the way,
/// and it ends where the static resistance holds it.
#[test]
fn weight_against_coulomb_friction() {
    let (e, f, mgl) = (0.9, 0.5, 9.81);
    let mut m = tree(&[JointType::Revolute], true, 1);
    let b = &mut m.bodies[1];
    // Joint z along world y, body x downwards at angle 0.
    b.tree_r.r = [V3::new(0.0, -1.0, 0.0), V3::new(0.0, 0.0, 1.0), V3::new(-1.0, 0.0, 0.0)];
    (b.mass, b.mc, b.inertia) = (1.0, V3::new(1.0, 0.0, 0.0), Default::default());
    (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (0.1, 1.1, 1.1);
    m.axes[0].drive = DriveLimits { static_resistance: e, dynamic_resistance: f, ..DriveLimits::default() };
    m.effects = Effects::called_for(&m);
    let h = 0.001;
    let mut w = world(&m, h, 0.0);
    w.set_settings(Settings { gravity: [0.0, 0.0, -9.81], ..*w.settings() }).unwrap();
    let mut s = State::initial(&m);
    s.set_axis(&m, 0, 1.2, 0.0);
    w.set_initial_state(s);
    let (mut peak, mut last_speed, mut peaks) = (1.2_f64, 0.0_f64, 0.0);
    for _ in 0..20_000 {
        let before = w.state().axis(&m, 0).0;
        w.advance();
        let (_, v) = w.state().axis(&m, 0);
        if v * last_speed < 0.0 || (v == 0.0 && last_speed != 0.0) {
            // mgl (cos φ' − cos φ) = f |φ' − φ|
            let expected = next_peak(peak, mgl, f);
            peaks += 1.0;
            // The step in which it stops leaves out at most ½ a h² of way.
            let bound = peaks * 0.5 * (mgl + f) / 1.1 * h * h + 1e-6;
            assert!((before - expected).abs() <= bound, "{before} {expected}");
            peak = expected;
        }
        last_speed = v;
    }
    let (rest, v) = w.state().axis(&m, 0);
    assert_eq!(v, 0.0);
    assert!((mgl * rest.sin()).abs() <= e + 1e-6, "rests at {rest}");
}

fn next_peak(from: f64, mgl: f64, f: f64) -> f64 {
    let side = -from.signum();
    let loss = |x: f64| mgl * ((side * x).cos() - from.cos()) - f * (x + from.abs());
    let (mut low, mut high) = (-from.abs() + 1e-6, from.abs());
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if loss(middle) > 0.0 { low = middle } else { high = middle }
    }
    side * low
}

/// Bang-bang: with ± the same torque a way x takes 2 √(x/a), by hand and by the servo, which does not overshoot.
#[test]
fn bang_bang() {
    let (way, a) = (1.0, STALL / J);
    let time = 2.0 * f64::sqrt(way / a);
    let drive = DriveLimits { no_load_speed: f64::INFINITY, max_speed: f64::INFINITY, servo_time: 1e-4, ..motor() };
    let h = time / 400.0;
    let mut w = world(&wheel(drive), h, 0.0);
    let h = w.settings().control_interval_ns as f64 * 1e-9;
    w.set_commands(&[AxisCommand::torque(STALL)]).unwrap();
    run(&mut w, 200.0 * h);
    w.set_commands(&[AxisCommand::torque(-STALL)]).unwrap();
    let (x, v) = run(&mut w, 200.0 * h);
    assert!((x - a * (200.0 * h).powi(2)).abs() <= 1e-9 && v.abs() <= 1e-9, "{x} {v}");
    for side in [1.0, -1.0] {
        let mut w = world(&wheel(drive), h, 0.0);
        w.set_commands(&[AxisCommand::servo(side * way)]).unwrap();
        let (mut steps, mut farthest) = (0, 0.0_f64);
        while (side * way - w.state().axis(w.model(), 0).0).abs() > 1e-3 * way {
            w.advance();
            farthest = farthest.max(side * w.state().axis(w.model(), 0).0);
            steps += 1;
            assert!(steps < 1000);
        }
        // The last thousandth of the way takes √(2·0.001/a), which is left out.
        let expected = time - f64::sqrt(2e-3 * way / a);
        assert!((f64::from(steps) * h - expected).abs() <= 3.0 * h, "{} {expected}", f64::from(steps) * h);
        run(&mut w, 0.2);
        farthest = farthest.max(side * w.state().axis(w.model(), 0).0);
        assert!(farthest <= way * (1.0 + 1e-9), "overshoot to {farthest}");
        let (x, v) = w.state().axis(w.model(), 0);
        assert!((x - side * way).abs() <= 1e-9 && v.abs() <= 1e-9);
    }
}

/// A servo turns towards its target whatever the signs of c and d; it is no faster than d and, at rest at its target, does
/// not move by a bit.
#[test]
fn servo() {
    for (torque, speed) in [(0.2, 50.0), (-0.2, -50.0), (-0.2, 50.0)] {
        let mut w = world(&wheel(motor()), 0.001, 0.0);
        w.set_commands(&[AxisCommand { torque, speed, ..AxisCommand::servo(-20.0) }]).unwrap();
        let mut fastest = 0.0_f64;
        for _ in 0..3000 {
            w.advance();
            fastest = fastest.max(-w.state().axis(w.model(), 0).1);
            assert!(effort(&w).abs() <= 0.2 + 1e-12);
        }
        // The line ends at 50 rad/s: it comes near, never beyond.
        assert!(fastest < 50.0 && fastest > 30.0, "{fastest}");
        let rest = w.state().axis(w.model(), 0);
        assert!((rest.0 + 20.0).abs() <= 1e-9 && rest.1.abs() <= 1e-7, "{rest:?}");
    }
}

/// The rotor's inertia counts as J_r n²: in the acceleration, and in the energy.
#[test]
fn rotor_inertia() {
    let rotor = 4e-3;
    let drive = DriveLimits { rotor_inertia: rotor, no_load_speed: f64::INFINITY, ..motor() };
    let mut w = world(&wheel(drive), 0.001, 0.0);
    w.set_commands(&[AxisCommand::torque(0.2)]).unwrap();
    let (x, v) = run(&mut w, 1.0);
    let a = 0.2 / (J + rotor);
    assert!((v - a).abs() <= 1e-9 && (x - 0.5 * a).abs() <= 1e-9, "{x} {v}");
    assert!((w.energy().kinetic - 0.2 * x).abs() <= 1e-9);
    assert!((w.work().drives - 0.2 * x).abs() <= 1e-9 && w.work().losses == 0.0);
}

/// Everything about a drive can change while it runs; what has no meaning is refused and changes nothing.
#[test]
fn drives_change_while_running() {
    let mut w = world(&wheel(motor()), 0.001, 0.0);
    w.set_commands(&[AxisCommand::torque(STALL)]).unwrap();
    let (_, v) = run(&mut w, 0.5);
    assert!(v > 100.0);
    let braked = DriveLimits { short_brake: true, static_resistance: 0.03, dynamic_resistance: 0.02, ..motor() };
    w.set_drive(0, braked).unwrap();
    w.set_commands(&[AxisCommand::torque(0.0)]).unwrap();
    assert_eq!(run(&mut w, 5.0).1, 0.0, "resistance acts although the scene did not call for friction");
    for bad in [
        DriveLimits { max_torque: -1.0, ..braked },
        DriveLimits { no_load_speed: 0.0, ..braked },
        DriveLimits { static_resistance: 0.01, ..braked },
        DriveLimits { rotor_inertia: f64::NAN, ..braked },
        DriveLimits { dynamic_resistance: f64::INFINITY, ..braked },
    ] {
        assert!(w.set_drive(0, bad).unwrap_err().contains("must be"));
        assert_eq!(w.drive(0), Some(&braked));
    }
}

/// A servo brakes in time against its weight and with it, and shows the torque that friction leaves it: gravity is in its
/// braking parabola.
#[test]
fn a_servo_brakes_against_gravity() {
    let (m_l, inertia, friction) = (2.0, 0.51, 1.5);
    for (from, to) in [(1.4, -1.2), (-1.4, 1.2), (0.1, 1.5), (2.5, 0.4)] {
        let mut m = tree(&[JointType::Revolute], true, 1);
        let b = &mut m.bodies[1];
        b.tree_r.r = [V3::new(0.0, -1.0, 0.0), V3::new(0.0, 0.0, 1.0), V3::new(-1.0, 0.0, 0.0)];
        (b.mass, b.mc, b.inertia) = (2.0, V3::new(m_l / 2.0, 0.0, 0.0), Default::default());
        (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (0.01, inertia, inertia);
        let fast = DriveLimits { max_torque: 14.0, servo_time: 1e-4, ..DriveLimits::default() };
        m.axes[0].drive = DriveLimits { static_resistance: friction, dynamic_resistance: friction, ..fast };
        m.effects = Effects::called_for(&m);
        let h = 1e-3;
        let mut w = world(&m, h, 0.0);
        let mut s = State::initial(&m);
        s.set_axis(&m, 0, from, 0.0);
        w.set_initial_state(s);
        w.set_commands(&[AxisCommand::servo(to)]).unwrap();
        let side = f64::signum(to - from);
        let mut beyond = f64::NEG_INFINITY;
        for _ in 0..2000 {
            w.advance();
            let (q, v) = w.state().axis(&m, 0);
            beyond = beyond.max(side * (q - to));
            assert!(effort(&w).abs() <= 14.0 + 1e-9 && v.abs() < 20.0);
        }
        // The load changes by up to m g l v h within a step: what the parabola of the last step does not know.
        let unknown = m_l / 2.0 * 9.80665 * 10.0 * h / inertia * h;
        assert!(beyond <= unknown, "{from} {to}: {beyond} beyond the target");
        assert!((w.state().axis(&m, 0).0 - to).abs() <= 1e-9);
        let weight = m_l / 2.0 * 9.80665 * to.sin();
        let held = (weight.abs() - friction).max(0.0) * weight.signum();
        assert!((effort(&w) - held).abs() <= 1e-6, "{} {held}", effort(&w));
    }
}

/// Static friction of one axis is not lost because the first guess of another one was wrong: the heavy flywheel that stands
/// feels at most what the servo on it can give.
#[test]
fn static_friction_beside_a_saturated_servo() {
    let mut m = tree(&[JointType::Revolute; 2], true, 1);
    for b in &mut m.bodies[1..] {
        (b.tree_r, b.tree_p) = (realnoid::math::M3::identity(), V3::default());
        (b.mass, b.mc, b.inertia) = (1.0, V3::default(), Default::default());
        (b.inertia.xx, b.inertia.yy, b.inertia.zz) = (J, J, J);
    }
    m.axes[0].drive = DriveLimits { static_resistance: 10.0, dynamic_resistance: 1.0, ..DriveLimits::default() };
    m.axes[1].drive = DriveLimits { max_torque: 5.0, ..DriveLimits::default() };
    m.effects = Effects::called_for(&m);
    let mut w = world(&m, 0.001, 0.0);
    for target in [0.0, 1.0, -1.0] {
        w.set_commands(&[AxisCommand::IDLE, AxisCommand::servo(target)]).unwrap();
        run(&mut w, 1.0);
        assert_eq!(w.state().axis(&m, 0), (0.0, 0.0), "{target}");
    }
}

/// A servo whose applied speed is 0 gives no torque forwards, and brakes; nothing diverges.
#[test]
fn a_servo_without_speed() {
    let mut w = world(&wheel(motor()), 0.001, 0.0);
    for speed in [0.0, 1e-310] {
        w.set_commands(&[AxisCommand { speed, ..AxisCommand::servo(1.0) }]).unwrap();
        let (q, v) = run(&mut w, 1.0);
        assert!(q.abs() <= 1e-8 && v.abs() <= 1e-8 && w.stats().diverged_steps == 0);
    }
}
