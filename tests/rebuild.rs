//! Bodies and links are taken out of a world, and the world is built again (W-2, W-11); orders; what is warned of (W-16).
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::cli::load::Source;
use realnoid::cli::scene::{Scene, Spare, assemble};
use realnoid::model::Base;
use realnoid::world::{Condition, ElementKind, EngineKind, Order, Settings, Side, WarningKind, World};
use std::io::Write;
use std::sync::Arc;
use support::urdf::{joint, link, model, robot};

const G: f64 = 9.80665;

/// Links that swing below each other.
fn chain(links: usize) -> String {
    let mut parts = vec![link("stand", 0.0, "")];
    for i in 1..=links {
        let parent = if i == 1 { "stand".to_owned() } else { format!("l{}", i - 1) };
        parts.push(link(&format!("l{i}"), 1.0, "0 0 -0.2"));
        let axis = if i % 2 == 0 { "1 0 0" } else { "0 1 0" };
        parts.push(joint(&format!("j{i}"), "continuous", (&parent, &format!("l{i}")), ("0 0 -0.4", axis), ""));
    }
    robot(&parts)
}

fn swinging(text: &str, engine: EngineKind) -> World {
    let mut w = World::new(model(text, Base::Fixed), Settings { engine, ..Settings::default() }).unwrap();
    let mut state = w.state().clone();
    state.set_axis(w.model(), 0, 1.0, 0.5);
    w.set_initial_state(state);
    w
}

fn scene(text: &str, engine: EngineKind) -> World {
    let mut file = tempfile::Builder::new().suffix(".yaml").tempfile().unwrap();
    write!(file, "version: 1\n{text}").unwrap();
    let scene = Scene::read(Some(file.path())).unwrap();
    let stand = (Base::Fixed, scene.robot.pose);
    let all = assemble(&scene, Source::default(), stand, Spare::Nobody, &|m| scene.switch_effects(m));
    let all = all.unwrap_or_else(|_| panic!("the scene cannot be put together"));
    let mut w = World::new(Arc::new(all.model), Settings { engine, ..Settings::default() }).unwrap();
    w.set_initial_state(all.initial);
    w
}

fn run(w: &mut World, intervals: usize) {
    (0..intervals).for_each(|_| w.advance());
    assert_eq!(w.stats().diverged_steps, 0);
}

fn with_joints() -> Vec<EngineKind> {
    EngineKind::built().filter(|e| e.capabilities().joints).collect()
}

/// What is left moves as the robot whose URDF never had the link: the same equations, so the same numbers but for rounding.
#[test]
fn what_is_left_moves_as_if_the_rest_had_never_been() {
    for engine in with_joints() {
        let (mut w, mut shorter) = (swinging(&chain(4), engine), swinging(&chain(2), engine));
        run(&mut w, 100);
        w.execute(&Order::Remove { name: "l3".into() }).unwrap();
        assert_eq!(w.condition(), Condition::JointConfigurationFault);
        let stands = w.state().clone();
        run(&mut w, 50);
        assert_eq!(&stands, w.state(), "a world with a fault stands still");
        assert!((w.time() - 0.15).abs() < 1e-12, "its time goes on");
        w.execute(&Order::Rebuild { all: false }).unwrap();
        assert_eq!(w.condition(), Condition::Normal);
        for _ in 0..500 {
            w.advance();
            shorter.advance();
        }
        for axis in 0..2 {
            let (a, b) = (w.state().axis(w.model(), axis), shorter.state().axis(shorter.model(), axis));
            let gap = (a.0 - b.0).abs().max((a.1 - b.1).abs());
            assert!(gap < 1e-9, "{}: axis {axis} {a:?} {b:?}", engine.name());
        }
        let (e, s) = (w.energy(), shorter.energy());
        assert!((e.kinetic - s.kinetic).abs() < 1e-9 && (e.potential - s.potential).abs() < 1e-9);
        let shown = w.new_snapshot();
        assert_eq!(shown.removed, [false, false, false, true, true]);
        assert_eq!((shown.velocity[3], shown.effort[3]), (0.0, 0.0));
    }
}

#[test]
fn all_comes_back_with_the_same_bits() {
    for engine in with_joints().into_iter().filter(|e| e.capabilities().exact_copy) {
        let (mut w, mut fresh) = (swinging(&chain(4), engine), swinging(&chain(4), engine));
        run(&mut w, 70);
        w.execute(&Order::Remove { name: "l4".into() }).unwrap();
        w.execute(&Order::Remove { name: "l2".into() }).unwrap();
        w.execute(&Order::Rebuild { all: true }).unwrap();
        run(&mut w, 100);
        run(&mut fresh, 100);
        assert_eq!(w.state(), fresh.state(), "{}", engine.name());
        assert!(w.new_snapshot().removed.iter().all(|gone| !gone));
    }
}

const PILE: &str = "bodies:\n  - {name: low, mass: 1, shape: {box: {size: [0.4, 0.4, 0.2]}}, pose: [0, 0, 0.1, 0, 0, 0, 1]}\n  \
    - {name: high, mass: 1, shape: {box: {size: [0.2, 0.2, 0.2]}}, pose: [0, 0, 0.3, 0, 0, 0, 1]}\n  \
    - {name: shelf, static: true, shape: {box: {size: [0.4, 0.4, 0.2]}}, pose: [2, 0, 0.1, 0, 0, 0, 1]}\nground: true\n";

/// What lay on a body falls when that is gone, and comes to lie where it was. No joint goes with it.
#[test]
fn what_lay_on_a_body_falls() {
    for engine in EngineKind::built() {
        let mut w = scene(PILE, engine);
        run(&mut w, 200);
        let height = |w: &World| {
            let s = w.new_snapshot();
            let high = w.model().links.iter().position(|l| l.name == "high").unwrap();
            s.link_pose[high].translation.z
        };
        let before = height(&w);
        w.execute(&Order::Remove { name: "low".into() }).unwrap();
        assert_eq!(w.condition(), Condition::Normal);
        run(&mut w, 100);
        // Semi-implicit steps of 0.2 ms are g t h / 2 = 1e-4 m off after 0.1 s; it may have sunk or moved by some 0.1 mm.
        let fallen = before - height(&w);
        assert!((fallen - 0.5 * G * 0.01).abs() < 1e-3, "{}: fell {fallen}", engine.name());
        run(&mut w, 900);
        assert!((height(&w) - 0.1).abs() < 2e-3, "{}: lies at {}", engine.name(), height(&w));
        w.execute(&Order::Reset { time: true, state: true, joints: true }).unwrap();
        assert!((height(&w) - 0.3).abs() < 1e-12);
        assert!(w.elements().iter().any(|e| e.name == "low" && e.removed), "a reset does not bring it back");
        w.execute(&Order::Rebuild { all: true }).unwrap();
        run(&mut w, 500);
        assert!((height(&w) - 0.3).abs() < 2e-3, "{}: rests on the other one again", engine.name());
    }
}

#[test]
fn refused_orders_change_nothing() {
    let text = chain(2).replace(
        "</robot>",
        &(link("tip", 0.1, "0 0 0") + &joint("f", "fixed", ("l2", "tip"), ("0 0 -0.4", "0 0 1"), "") + "</robot>"),
    );
    let mut w = swinging(&text, EngineKind::Rbx);
    run(&mut w, 10);
    let before = w.new_snapshot();
    let place = |pose, twist| Order::Place { link: 0, pose, twist };
    let unit = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let orders = [
        (Order::Remove { name: "nobody".into() }, "no robot, body or link 'nobody'"),
        (Order::Remove { name: "stand".into() }, "root link"),
        (Order::Remove { name: "tip".into() }, "'tip' and link 'l2' are one body"),
        (Order::SetAngles { positions: vec![(0, 0.5), (1, f64::NAN)], side: Side::Tip }, "cannot stand at NaN"),
        (Order::SetAngles { positions: vec![(7, 0.5)], side: Side::Tip }, "no axis 7"),
        (place(unit, [0.0; 6]), "does not float"),
    ];
    for (order, reason) in orders {
        let told = w.execute(&order).unwrap_err();
        assert!(told.contains(reason), "{told}");
        let after = w.new_snapshot();
        assert_eq!((&before.position, &before.velocity), (&after.position, &after.velocity));
        assert_eq!(w.condition(), Condition::Normal);
    }
}

#[test]
fn a_body_is_put_somewhere_with_a_speed() {
    for engine in EngineKind::built() {
        let mut w = scene(PILE, engine);
        let high = w.model().links.iter().position(|l| l.name == "high").unwrap();
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let pose = [1.0, 2.0, 5.0, 0.0, 0.0, half, half];
        w.execute(&Order::Place { link: high, pose, twist: [0.0, 0.0, 2.0, 0.5, 0.0, 1.0] }).unwrap();
        let s = w.new_snapshot();
        let (p, t) = (&s.link_pose[high], &s.link_twist[high]);
        let v = p.rotation * t.linear;
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{}: {a} {b}", engine.name());
        near(p.translation.z, 5.0);
        near(v.x, 0.5);
        near(v.z, 1.0);
        near((p.rotation * t.angular).z, 2.0);
        run(&mut w, 100);
        let p = &w.new_snapshot().link_pose[high];
        assert!(
            (p.translation.x - 1.05).abs() < 1e-3
                && (p.rotation.angle() - (0.2 + std::f64::consts::FRAC_PI_2)).abs() < 1e-3
        );
        for (bad, reason) in [([0.0; 7], "length 0"), ([f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], "not finite")] {
            assert!(w.execute(&Order::Place { link: high, pose: bad, twist: [0.0; 6] }).unwrap_err().contains(reason));
        }
    }
}

/// Time and state are reset apart from each other; joints keep their angles if that is wanted (W-7).
#[test]
fn resets() {
    let mut w = swinging(&chain(3), EngineKind::Rbx);
    run(&mut w, 100);
    let swung = w.new_snapshot();
    w.execute(&Order::Reset { time: false, state: true, joints: false }).unwrap();
    let s = w.new_snapshot();
    assert_eq!((s.stamp_ns, &s.position, s.velocity[0]), (swung.stamp_ns, &swung.position, 0.0));
    w.execute(&Order::Reset { time: false, state: true, joints: true }).unwrap();
    assert_eq!((w.stamp_ns(), w.state().axis(w.model(), 0)), (swung.stamp_ns, (1.0, 0.5)));
    run(&mut w, 10);
    let here = w.state().clone();
    w.execute(&Order::Reset { time: true, state: false, joints: true }).unwrap();
    assert_eq!((w.stamp_ns(), w.state()), (0, &here));
}

/// An order read back from JSON is the same order, to the last bit.
#[test]
fn orders_are_data() {
    let mut rng = support::Random(3);
    let mut number = || rng.unit() * 1e3 / 3.0;
    let orders = [
        Order::Reset { time: true, state: false, joints: true },
        Order::SetAngles { positions: vec![(2, number()), (0, number())], side: Side::Root },
        Order::Place { link: 4, pose: std::array::from_fn(|_| number()), twist: std::array::from_fn(|_| number()) },
        Order::Remove { name: "a \"link\"".into() },
        Order::Rebuild { all: true },
        Order::Remember,
    ];
    for order in orders {
        let text = serde_json::to_string(&order).unwrap();
        assert_eq!(serde_json::from_str::<Order>(&text).unwrap(), order, "{text}");
        assert!(text.contains(order.name()), "{text}");
    }
}

/// A copy knows that it is one until it runs (W-2), and goes its own way.
#[test]
fn copies_go_their_own_way() {
    let mut w = swinging(&chain(3), EngineKind::Rbx);
    run(&mut w, 10);
    let mut copy = w.clone();
    assert_eq!((w.condition(), copy.condition()), (Condition::Normal, Condition::Copied));
    copy.set_settings(Settings { gravity: [0.0, 0.0, -1.6], ..*copy.settings() }).unwrap();
    let mut same = w.clone();
    run(&mut w, 100);
    run(&mut copy, 100);
    run(&mut same, 100);
    assert_eq!(copy.condition(), Condition::Normal);
    assert_eq!(w.state(), same.state());
    assert_ne!(w.state(), copy.state());
}

#[test]
fn warnings_have_a_history() {
    let frozen = chain(2)
        .replace("name='j2' type='continuous'", "name='j2' type='revolute'")
        .replace("<axis xyz='1 0 0'/>", "<axis xyz='1 0 0'/><limit lower='0.3' upper='0.3' effort='1' velocity='1'/>");
    let mut w = swinging(&frozen, EngineKind::Rbx);
    let kinds = |w: &World| w.warnings().iter().map(|x| (x.kind, x.element.clone(), x.stamp_ns)).collect::<Vec<_>>();
    assert_eq!(kinds(&w), [(WarningKind::FrozenTransform, "j2".to_owned(), 0)]);
    run(&mut w, 20);
    w.execute(&Order::Remove { name: "l2".into() }).unwrap();
    assert_eq!(kinds(&w)[1..], [(WarningKind::JointConfigurationFault, String::new(), 20_000_000)]);
    w.execute(&Order::Reset { time: false, state: true, joints: true }).unwrap();
    run(&mut w, 20);
    assert_eq!((w.warnings().count(), w.new_snapshot().warnings), (2, 2), "the history stays, nothing is said twice");
}

#[test]
fn elements_are_listed_with_what_the_engine_makes_of_them() {
    for engine in EngineKind::built() {
        let w = scene(PILE, engine);
        let all = w.elements();
        let named = |name: &str| all.iter().find(|e| e.name == name).unwrap_or_else(|| panic!("{name}"));
        assert_eq!(named("low").kind, ElementKind::DynamicBody);
        assert_eq!(named("shelf").kind, ElementKind::StaticBody);
        assert_eq!(named("ground").kind, ElementKind::StaticBody);
        assert_eq!((named("low").mass, named("shelf").mass, named("low").shapes.len()), (1.0, 0.0, 1));
        assert!((named("high").initial_pose.translation.z - 0.3).abs() < 1e-12);
    }
    let w = swinging(&chain(3), EngineKind::Rbx);
    let kinds: Vec<_> = w.elements().into_iter().map(|e| (e.name, e.kind, e.constraint.is_empty())).collect();
    assert_eq!(kinds[0], ("stand".to_owned(), ElementKind::StaticBody, true));
    assert_eq!(kinds[1], ("l1".to_owned(), ElementKind::Link, true));
    assert_eq!(kinds[4], ("j1".to_owned(), ElementKind::Joint, false));
}
