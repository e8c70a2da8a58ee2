//! Drives, stops and friction across a coupling.

use super::scene::{ALL_INTEGRATORS, IMPLICIT, Part, advance, axis, deviation, effort, model, settings, world};
use realnoid::world::{AxisCommand, Integrator, World};

const NO_GRAVITY: [f64; 3] = [0.0; 3];
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.80665];

/// A parallel gripper: two fingers slide apart; only one is driven.
fn gripper<'a>(leader: &'a str, follower: &'a str) -> Vec<Part<'a>> {
    vec![
        Part { name: "left", kind: "prismatic", axis: "0 1 0", mass: 0.1, inner: leader, ..Part::default() },
        Part { name: "right", kind: "prismatic", axis: "0 -1 0", mass: 0.1, inner: follower, ..Part::default() },
    ]
}

const WIDE: &str = "<limit lower='0' upper='0.05' effort='20' velocity='0.1'/>";

/// The servo of one finger moves both, at the speed that it has, and holds both.
#[test]
fn a_gripper_closes_under_its_servo() {
    let follower = format!("{WIDE}<mimic joint='left'/>");
    for integrator in ALL_INTEGRATORS {
        let m = model(&gripper(WIDE, &follower));
        let mut w = world(&m, settings(integrator, 0.001, GRAVITY), &[]);
        w.set_commands(&[AxisCommand::servo(0.03), AxisCommand::IDLE]).unwrap();
        advance(&mut w, 200);
        let (left, right) = (axis(&w, "left"), axis(&w, "right"));
        assert!((left.1 - 0.1).abs() < 1e-12 && (right.1 - 0.1).abs() < 1e-12, "at its speed: {left:?} {right:?}");
        advance(&mut w, 5000);
        assert!((axis(&w, "right").0 - 0.03).abs() < 1e-12 && deviation(&w) < 1e-15);
        assert_eq!((w.stats().unsettled_steps, effort(&w, "right")), (0, 0.0));
    }
}

/// The follower's stop holds the leader against its drive, exactly at rest: with a bounded torque, a bounded servo, and a
/// servo that nothing bounds. The drive gives what it can, or nothing beyond what the stop asks for.
#[test]
fn the_followers_stop_holds_the_leader() {
    IMPLICIT.into_iter().for_each(the_followers_stop_holds_the_leader_by);
}

fn the_followers_stop_holds_the_leader_by(integrator: Integrator) {
    let short = "<limit lower='0' upper='0.02' effort='20' velocity='0.1'/><mimic joint='left'/>";
    let unbounded = "<limit lower='0' upper='0.05' effort='0' velocity='0'/>";
    for (leader, command, gives) in [
        (WIDE, AxisCommand::torque(5.0), Some(5.0)),
        (WIDE, AxisCommand::servo(0.04), Some(20.0)),
        (unbounded, AxisCommand::servo(0.04), None),
    ] {
        let m = model(&gripper(leader, short));
        let mut w = world(&m, settings(integrator, 0.001, GRAVITY), &[]);
        w.set_commands(&[command, AxisCommand::IDLE]).unwrap();
        advance(&mut w, 2000);
        for name in ["left", "right"] {
            let (q, v) = axis(&w, name);
            assert!((q - 0.02).abs() <= 1e-12 && v.abs() <= 1e-12, "{command:?}: {name} {q} {v}");
        }
        if let Some(force) = gives {
            assert!((effort(&w, "left") - force).abs() <= 1e-9, "{command:?}: {}", effort(&w, "left"));
        }
        assert_eq!(w.stats().unsettled_steps, 0, "{command:?}");
        // Back again, without sticking.
        w.set_commands(&[AxisCommand::servo(0.01), AxisCommand::IDLE]).unwrap();
        advance(&mut w, 3000);
        assert!((axis(&w, "right").0 - 0.01).abs() <= 1e-12, "{command:?}");
        assert_eq!(w.stats().unsettled_steps, 0, "{command:?}");
    }
}

/// The drive carries the weight of the follower: on a lever of ratio −2 it feels it twice.
#[test]
fn the_leaders_drive_carries_the_follower() {
    let m = model(&[
        Part { name: "a", axis: "0 1 0", ..Part::default() },
        Part {
            name: "b",
            axis: "0 1 0",
            mass: 2.0,
            center: "0.3 0 0",
            inner: "<mimic joint='a' multiplier='-2'/>",
            ..Part::default()
        },
    ]);
    for integrator in ALL_INTEGRATORS {
        let mut w = world(&m, settings(integrator, 0.001, GRAVITY), &[]);
        w.set_commands(&[AxisCommand::servo(0.0), AxisCommand::IDLE]).unwrap();
        advance(&mut w, 1000);
        // Gravity turns b by +m g l about +y (z to x); a must hold −2 times the torque on b.
        let weight = 2.0 * 9.80665 * 0.3;
        assert!((effort(&w, "a").abs() - 2.0 * weight).abs() <= 1e-9, "{integrator:?}: {}", effort(&w, "a"));
        assert_eq!((axis(&w, "a"), w.stats().fallback_steps), ((0.0, 0.0), 0));
    }
}

/// Dry friction of the follower holds the leader: below ratio × friction nothing moves at all, above it both do, with what
/// is left.
#[test]
fn the_followers_friction_holds_the_leader() {
    IMPLICIT.into_iter().for_each(the_followers_friction_holds_the_leader_by);
}

fn the_followers_friction_holds_the_leader_by(integrator: Integrator) {
    let rub = "<dynamics damping='0' friction='0.5'/><mimic joint='a' multiplier='-3'/>";
    let m = model(&[
        Part { name: "a", inertia: 0.2, ..Part::default() },
        Part { name: "b", inertia: 0.1, inner: rub, ..Part::default() },
    ]);
    for (torque, moves) in [(1.499, false), (1.501, true)] {
        let mut w = world(&m, settings(integrator, 0.001, NO_GRAVITY), &[]);
        w.set_commands(&[AxisCommand::torque(torque), AxisCommand::IDLE]).unwrap();
        advance(&mut w, 1000);
        let (q, v) = axis(&w, "a");
        assert_eq!((q != 0.0, w.stats().unsettled_steps), (moves, 0), "{torque}: {q}");
        if moves {
            let expected = (torque - 1.5) / (0.2 + 9.0 * 0.1);
            assert!((v - expected).abs() <= 1e-10, "{v} {expected}");
        }
    }
}

/// Both stand on their own: the follower rubs, the leader's servo is stronger; then it is weaker.
#[test]
fn a_servo_against_the_followers_friction() {
    IMPLICIT.into_iter().for_each(a_servo_against_the_followers_friction_by);
}

fn a_servo_against_the_followers_friction_by(integrator: Integrator) {
    for (bound, arrives) in [("4", true), ("2", false)] {
        let limit = format!("<limit lower='-2' upper='2' effort='{bound}' velocity='3'/>");
        let rub = "<limit lower='-6' upper='6' effort='9' velocity='9'/><dynamics damping='0' friction='1'/>\
                   <mimic joint='a' multiplier='3'/>";
        let m = model(&[
            Part { name: "a", kind: "revolute", inner: &limit, ..Part::default() },
            Part { name: "b", kind: "revolute", inner: rub, ..Part::default() },
        ]);
        let mut w = world(&m, settings(integrator, 0.001, NO_GRAVITY), &[]);
        w.set_commands(&[AxisCommand::servo(1.0), AxisCommand::IDLE]).unwrap();
        advance(&mut w, 8000);
        let (q, v) = axis(&w, "a");
        assert_eq!(w.stats().unsettled_steps, 0);
        if arrives {
            assert!((q - 1.0).abs() <= 1e-9 && v.abs() <= 1e-12 && deviation(&w) <= 1e-12, "{q} {v}");
        } else {
            assert_eq!((q, v), (0.0, 0.0), "too weak: it does not even creep");
        }
    }
}

/// Drives of the follower and the leader that pull apart: the stronger wins; two without bound: the leader's.
#[test]
fn two_drives_on_one_degree_of_freedom() {
    IMPLICIT.into_iter().for_each(two_drives_on_one_degree_of_freedom_by);
}

fn two_drives_on_one_degree_of_freedom_by(integrator: Integrator) {
    let both = "<limit lower='-3' upper='3' effort='0' velocity='2'/>";
    let follower = format!("{both}<mimic joint='a'/>");
    let m = model(&[
        Part { name: "a", kind: "revolute", inner: both, ..Part::default() },
        Part { name: "b", kind: "revolute", inner: &follower, ..Part::default() },
    ]);
    let mut w = world(&m, settings(integrator, 0.001, NO_GRAVITY), &[]);
    w.set_commands(&[AxisCommand::servo(0.5), AxisCommand::servo(-0.5)]).unwrap();
    advance(&mut w, 3000);
    assert!((axis(&w, "a").0 - 0.5).abs() <= 1e-9 && (axis(&w, "b").0 - 0.5).abs() <= 1e-9);
    assert_eq!(w.stats().unsettled_steps, 0);
}

/// A follower that its leader does not move, or whose leader is fixed, stands where it belongs, whatever pulls.
#[test]
fn a_follower_of_nothing_stands() {
    IMPLICIT.into_iter().for_each(a_follower_of_nothing_stands_by);
}

fn a_follower_of_nothing_stands_by(integrator: Integrator) {
    let m = model(&[
        Part { name: "a", kind: "fixed", ..Part::default() },
        Part {
            name: "b",
            axis: "0 1 0",
            center: "0.2 0 0",
            inner: "<mimic joint='a' offset='0.4'/>",
            ..Part::default()
        },
    ]);
    let mut w = world(&m, settings(integrator, 0.001, GRAVITY), &[]);
    assert_eq!(axis(&w, "b"), (0.4, 0.0));
    w.set_commands(&[AxisCommand::torque(7.0)]).unwrap();
    advance(&mut w, 1000);
    assert!((axis(&w, "b").0 - 0.4).abs() <= 1e-14);
}

/// Stops that contradict each other cannot be satisfied: that is counted, and everything stays finite.
#[test]
fn contradicting_stops_are_counted() {
    IMPLICIT.into_iter().for_each(contradicting_stops_are_counted_by);
}

fn contradicting_stops_are_counted_by(integrator: Integrator) {
    let leader = "<limit lower='0' upper='0.05' effort='20' velocity='0.1'/>";
    let follower = "<limit lower='0' upper='0.05' effort='20' velocity='0.1'/><mimic joint='left'/>";
    let m = model(&gripper(leader, follower));
    let mut m = (*m).clone();
    (m.axes[1].lower, m.axes[1].upper) = (0.1, 0.2);
    let m = std::sync::Arc::new(m);
    let mut w = World::new(m, settings(integrator, 0.001, GRAVITY)).unwrap();
    advance(&mut w, 1000);
    assert!(w.stats().unsettled_steps > 900 && w.stats().diverged_steps == 0, "{:?}", w.stats());
    assert!(axis(&w, "left").0.abs() < 1.0 && axis(&w, "right").0.abs() < 1.0);
}
