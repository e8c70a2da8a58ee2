//! From text to couplings, initial states, findings.

use super::scene::{Part, advance, axis, model, model_on, said, settings, text, world};
use realnoid::engine::State;
use realnoid::model::{Base, Coupling};
use realnoid::world::{Integrator, World};
use std::sync::Arc;

fn chain(inner: [&str; 3]) -> Vec<Part<'_>> {
    ["a", "b", "c"].into_iter().zip(inner).map(|(name, inner)| Part { name, inner, ..Part::default() }).collect()
}

/// A follower of a follower follows the first leader.
#[test]
fn chains_are_resolved() {
    let m = model(&chain([
        "<mimic joint='b' multiplier='2' offset='0.5'/>",
        "<mimic joint='c' multiplier='-3' offset='0.25'/>",
        "",
    ]));
    let (a, b) = (
        Coupling { follower: 0, leader: 2, ratio: -6.0, offset: 1.0 },
        Coupling { follower: 1, leader: 2, ratio: -3.0, offset: 0.25 },
    );
    assert_eq!(m.couplings, [a, b]);
    let s = State::initial(&m);
    assert_eq!([0, 1, 2].map(|i| s.axis(&m, i).0), [1.0, 0.25, 0.0]);
}

/// What makes no sense is refused, with its line; what is odd is told, and simulated as it can be.
#[test]
fn findings_name_the_line() {
    type Expected = &'static [(&'static str, u32)];
    let cases: [([&str; 3], Expected); 6] = [
        (["<mimic joint='a'/>", "", ""], &[("mimic-cycle", 4)]),
        (
            ["<mimic joint='b'/>", "<mimic joint='c'/>", "<mimic joint='a'/>"],
            &[("mimic-cycle", 4), ("mimic-cycle", 6), ("mimic-cycle", 8)],
        ),
        (["<mimic joint='b'/>", "<mimic joint='b'/>", ""], &[("mimic-cycle", 6)]),
        (["<mimic joint='nobody'/>", "", ""], &[("unknown-joint", 4)]),
        (
            ["<mimic joint='b'/><realnoid><drive mode='servo' max_torque='3'/></realnoid>", "", ""],
            &[("mimic-drive", 4)],
        ),
        (["<mimic joint='b' multiplier='2'/>", "", ""], &[]),
    ];
    for (inner, expected) in cases {
        let found: Vec<(&str, u32)> = said(&text(&chain(inner), "")).iter().map(|f| (f.0, f.1)).collect();
        assert_eq!(found, expected, "{inner:?}");
    }
}

/// A range that stops the leader is told; ranges that never meet are refused.
#[test]
fn ranges_are_compared() {
    let limit = |low: f64, high: f64| format!("<limit lower='{low}' upper='{high}' effort='5' velocity='5'/>");
    let of = |leader: (f64, f64), follower: (f64, f64), mimic: &str| {
        let (a, b) = (limit(leader.0, leader.1), limit(follower.0, follower.1) + mimic);
        let part = |name, inner| Part { name, kind: "revolute", inner, ..Part::default() };
        said(&text(&[part("a", a.as_str()), part("b", b.as_str())], ""))
    };
    let negative = "<mimic joint='a' multiplier='-1'/>";
    assert!(of((0.0, 1.0), (-1.0, 0.0), negative).is_empty());
    let narrow = of((0.0, 1.0), (-0.4, 0.0), negative);
    assert_eq!(narrow[0].0, "mimic-range");
    assert!(narrow[0].2.contains("range -0.4 to 0") && narrow[0].2.contains("leaves 'a' only 0 to 0.4"), "{narrow:?}");
    assert_eq!(of((0.5, 1.0), (0.5, 1.0), negative)[0].0, "mimic-range");
    assert!(of((0.5, 1.0), (0.5, 1.0), negative)[0].2.contains("never meet"));
}

/// At the start leaders are where they and their followers are inside their ranges.
#[test]
fn the_initial_state_satisfies_the_couplings() {
    let narrow = "<limit lower='0.3' upper='0.6' effort='5' velocity='5'/><mimic joint='a' multiplier='-2'/>";
    let wide = "<limit lower='-1' upper='1' effort='5' velocity='5'/>";
    let m = model(&[
        Part { name: "a", kind: "revolute", inner: wide, ..Part::default() },
        Part { name: "b", kind: "revolute", inner: narrow, ..Part::default() },
    ]);
    let s = State::initial(&m);
    assert_eq!((s.axis(&m, 0).0, s.axis(&m, 1).0), (-0.15, 0.3));
}

/// Given axes: a leader moves its followers, a follower its leader, and what contradicts is refused.
#[test]
fn given_axes_move_the_others() {
    let m = model(&chain(["", "<mimic joint='a' multiplier='2'/>", "<mimic joint='a' offset='1'/>"]));
    let given = |set: &[(usize, f64, f64)]| {
        let mut s = State::initial(&m);
        set.iter().for_each(|(axis, q, v)| s.set_axis(&m, *axis, *q, *v));
        let axes: Vec<usize> = set.iter().map(|(axis, ..)| *axis).collect();
        s.couple_given(&m, &axes).map(|()| [0, 1, 2].map(|i| s.axis(&m, i)))
    };
    let expected = [(0.2, 0.5), (0.4, 1.0), (1.2, 0.5)];
    assert_eq!(given(&[(0, 0.2, 0.5)]).unwrap(), expected);
    assert_eq!(given(&[(1, 0.4, 1.0)]).unwrap(), expected);
    assert_eq!(given(&[(0, 0.2, 0.5), (1, 0.4, 1.0)]).unwrap(), expected);
    let refused = given(&[(0, 0.2, 0.0), (1, 0.5, 0.0)]).unwrap_err();
    assert!(refused.contains("'b' follows 'a'") && refused.contains("0.4") && refused.contains("0.5"), "{refused}");
    assert!(given(&[(1, 0.4, 0.0), (2, 5.0, 0.0)]).is_err());
}

/// Switched off, nothing is coupled and nothing is allocated for it; a joint of several axes cannot be followed.
#[test]
fn switched_off_they_move_by_themselves() {
    let m = model_on(&text(&chain(["", "<mimic joint='a'/>", ""]), ""), Base::Fixed);
    let mut off = (*m).clone();
    off.effects.mimic = false;
    let (m, off) = (m, Arc::new(off));
    assert!(m.effects.mimic && m.couplings_in_force().len() == 1 && off.couplings_in_force().is_empty());
    let s = settings(Integrator::SemiImplicitEuler, 0.001, [0.0; 3]);
    let mut w = world(&off, s, &[("a", 0.0, 1.0)]);
    advance(&mut w, 100);
    assert_eq!(axis(&w, "b"), (0.0, 0.0));
    let mut coupled = World::new(m.clone(), s).unwrap();
    let mut start = State::initial(&m);
    start.set_axis(&m, 0, 0.0, 1.0);
    start.couple(&m);
    coupled.set_initial_state(start);
    advance(&mut coupled, 100);
    let (a, b) = (axis(&coupled, "a"), axis(&coupled, "b"));
    assert!((a.0 - b.0).abs() <= 1e-14 && (a.0 - 0.1).abs() <= 1e-14, "{a:?} {b:?}");
}
