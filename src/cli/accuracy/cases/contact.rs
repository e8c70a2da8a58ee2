//! What touches.

use super::super::case::{Case, Closed, G, Look, Sample, Truth};
use super::super::closed;
use super::super::stage::{humanoid, scene, set_down};
use super::{DOWN, SECOND};
use crate::model::Base;
use crate::world::{AxisCommand, Integrator};

/// Of balls, m.
const RADIUS: f64 = 0.1;
const SOFT: &str = "its contacts are soft, with its default solref and solimp, and its friction is that of a soft cone";

/// A ball or a box of the name `body` that goes along x by a closed form: place at start, m, and the way.
fn along(z: f64, way: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Closed {
    Box::new(move |times| times.iter().map(|t| vec![way(*t), 0.0, z]).collect())
}

fn center() -> Vec<Look> {
    vec![Look::point("body", [0.0; 3])]
}

pub(super) fn rolling() -> Case {
    let slope = 20f64.to_radians();
    let text = format!(
        "version: 1\nground: true\nbodies: [{{name: body, mass: 1, shape: {{sphere: {{radius: {RADIUS}}}}}, pose: [0, 0, {RADIUS}, \
         0, 0, 0, 1]}}]"
    );
    let a = 5.0 / 7.0 * G * slope.sin();
    Case {
        name: "rolling",
        shows: "A ball rolls down an incline of 20° from rest without slipping.",
        compared: "where its centre is",
        unit: "m",
        size: 0.5 * a,
        instants: SECOND,
        make: Box::new(move || scene(&text, [G * slope.sin(), 0.0, -G * slope.cos()])),
        looks: center(),
        truth: Truth::Closed { words: "a = 5/7 g sin θ", value: along(RADIUS, move |t| 0.5 * a * t * t) },
        orders: None,
        iterates: true,
        peer_differs: Some(SOFT),
    }
}

pub(super) fn sliding() -> Case {
    let (speed, friction) = (1.0, 0.2);
    let text = format!(
        "version: 1\nground: {{friction: {friction}}}\nbodies: [{{name: body, mass: 3, shape: {{box: {{size: [0.4, 0.4, 0.2]}}}}, \
         pose: [0, 0, 0.1, 0, 0, 0, 1], velocity: [{speed}, 0, 0]}}]"
    );
    Case {
        name: "sliding",
        shows: "A box slides at 1 m/s on a floor with friction 0.2, and stops.",
        compared: "where its centre is",
        unit: "m",
        size: 0.5 * speed * speed / (friction * G),
        instants: SECOND,
        make: Box::new(move || scene(&text, DOWN)),
        looks: center(),
        truth: Truth::Closed {
            words: "slowed by μ g, it stops after v² / 2 μ g",
            value: along(0.1, move |t| closed::slide(speed, friction * G, t)),
        },
        orders: None,
        iterates: true,
        peer_differs: Some(SOFT),
    }
}

pub(super) fn slip_to_roll() -> Case {
    let (speed, friction) = (1.0, 0.1);
    let text = format!(
        "version: 1\nground: {{friction: {friction}}}\nbodies: [{{name: body, mass: 1, shape: {{sphere: {{radius: {RADIUS}}}}}, \
         pose: [0, 0, {RADIUS}, 0, 0, 0, 1], velocity: [{speed}, 0, 0]}}]"
    );
    // It slides for 2 v / 7 μ g, then it rolls at 5/7 v.
    let until = 2.0 * speed / (7.0 * friction * G);
    let way = move |t: f64| closed::slide(speed, friction * G, t.min(until)) + 5.0 / 7.0 * speed * (t - until).max(0.0);
    Case {
        name: "slip_to_roll",
        shows: "A ball that is thrown along the floor without turning slips until it rolls.",
        compared: "where its centre is",
        unit: "m",
        size: way(1.0),
        instants: SECOND,
        make: Box::new(move || scene(&text, DOWN)),
        looks: center(),
        truth: Truth::Closed { words: "slowed by μ g for 2 v / 7 μ g, then 5/7 v", value: along(RADIUS, way) },
        orders: None,
        iterates: true,
        peer_differs: Some(SOFT),
    }
}

pub(super) fn bounce() -> Case {
    let (height, e) = (0.2, 0.5);
    let text = format!(
        "version: 1\nground: {{restitution: 1}}\nbodies: [{{name: body, mass: 1, shape: {{sphere: {{radius: {RADIUS}}}}}, \
         surface: {{restitution: {e}}}, pose: [0, 0, {}, 0, 0, 0, 1]}}]",
        RADIUS + height
    );
    let value = move |t: &f64| vec![0.0, 0.0, RADIUS + closed::bounce(height, e, G, *t)];
    Case {
        name: "bounce",
        shows: "A ball with restitution 0.5 falls from 0.2 m and bounces until it rests after 0.6 s.",
        compared: "where its centre is",
        unit: "m",
        size: height,
        instants: 20,
        make: Box::new(move || scene(&text, DOWN)),
        looks: center(),
        truth: Truth::Closed {
            words: "parabolas, each a quarter as high; at rest after √(2h/g) (1 + e)/(1 − e)",
            value: Box::new(move |times| times.iter().map(value).collect()),
        },
        orders: None,
        iterates: false,
        peer_differs: Some(
            "it has no restitution: its contacts are soft springs, with solref so chosen that one blow of this height has e = 0.5",
        ),
    }
}

pub(super) fn stack() -> Case {
    let edge = 0.1;
    let masses = [1.0, 1.0, 1.0, 1.0, 100.0];
    let place = move |i: usize| (i as f64 + 0.5) * edge;
    let body = |(i, mass): (usize, &f64)| {
        format!(
            "{{name: body{i}, mass: {mass}, shape: {{box: {{size: [{edge}, {edge}, {edge}]}}}}, pose: [0, 0, {}, 0, 0, 0, 1]}}",
            place(i)
        )
    };
    let bodies: Vec<String> = masses.iter().enumerate().map(body).collect();
    let text = format!("version: 1\nground: true\nbodies: [{}]", bodies.join(", "));
    let rest: Sample = (0..masses.len()).flat_map(|i| [0.0, 0.0, place(i)]).collect();
    Case {
        name: "stack",
        shows: "Four boxes of 1 kg stand on each other, with 100 kg on top.",
        compared: "where their centres are, root of the mean square",
        unit: "m",
        size: edge,
        instants: SECOND,
        make: Box::new(move || scene(&text, DOWN)),
        looks: (0..masses.len()).map(|i| Look::point(&format!("body{i}"), [0.0; 3])).collect(),
        truth: Truth::Closed {
            words: "they stay where they are",
            value: Box::new(move |times| times.iter().map(|_| rest.clone()).collect()),
        },
        orders: None,
        iterates: true,
        peer_differs: Some(SOFT),
    }
}

pub(super) fn humanoid_drop() -> Case {
    Case {
        name: "humanoid_drop",
        shows: "The humanoid falls from 5 cm onto its feet, its joints loose, and collapses.",
        compared: "where its base is",
        unit: "m",
        size: 0.5,
        instants: 20,
        make: Box::new(|| humanoid(Base::Free, DOWN, &|m, s| set_down(m, s, 0.05))),
        looks: vec![Look::point("base_link", [0.0; 3])],
        truth: Truth::Own { integrator: Integrator::ImplicitMidpoint, steps_per_ms: 128 },
        orders: Some(|_, _, commands| commands.fill(AxisCommand::IDLE)),
        iterates: true,
        peer_differs: Some(
            "its contacts, stops and dry friction are soft, and it has no ranges for the three angles of a joint: it is left out",
        ),
    }
}
