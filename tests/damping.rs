//! Damping of bodies (B-8 I, J): v ← v·(1 − d)^dt.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "support/urdf.rs"]
#[allow(dead_code)] // other tests use the rest
mod urdf;

use realnoid::engine::State;
use realnoid::model::{Base, Model};
use realnoid::world::{Integrator, Settings, World};
use std::sync::Arc;
use urdf::{model, robot};

const ALL: [Integrator; 4] =
    [Integrator::ImplicitMidpoint, Integrator::SemiImplicitEuler, Integrator::Rk4, Integrator::Extrapolation];

fn damped(name: &str, mass: f64, damping: &str) -> String {
    format!(
        "<link name='{name}'><inertial><origin xyz='0.1 -0.2 0.3'/><mass value='{mass}'/>\
         <inertia ixx='0.4' ixy='0' ixz='0' iyy='0.5' iyz='0' izz='0.2'/></inertial>\
         <realnoid><damping {damping}/></realnoid></link>"
    )
}

fn settings(integrator: Integrator, step: f64) -> Settings {
    let control_interval_ns = (step * 1e9).round() as i64;
    Settings { integrator, control_interval_ns, steps_per_interval: 1, gravity: [0.0; 3], ..Settings::default() }
}

fn world(m: &Model, settings: Settings, start: impl Fn(&mut State, &Model)) -> World {
    let mut w = World::new(Arc::new(m.clone()), settings).unwrap();
    let mut s = State::initial(m);
    start(&mut s, m);
    w.set_initial_state(s);
    w
}

/// Momentum (kg·m/s) and the angular one about the centre of mass of a free body after the duration, s.
fn momenta(damping: &str, settings: Settings, duration: f64, twist: ([f64; 3], [f64; 3])) -> (f64, f64) {
    let m = model(&robot(&[damped("body", 3.0, damping)]), Base::Free);
    let mut w = world(&m, settings, |s, m| s.set_base_twist(m, twist.0.into(), twist.1.into()));
    let steps = (duration * 1e9 / settings.control_interval_ns as f64).round() as usize;
    (0..steps).for_each(|_| w.advance());
    let p = w.momentum();
    (p.linear.norm(), p.angular.norm())
}

/// A body that does not turn loses exactly the share of the law, with every rule; one that turns about a principal axis through
/// its centre of mass loses exactly that of its turning. RK4 is of fourth order: (λh)⁵ per step.
#[test]
fn a_free_body_decays_by_the_law_to_rounding() {
    for integrator in ALL {
        for step in [1e-4_f64, 1e-3, 1e-2] {
            for d in [0.05, 0.5, 0.999] {
                let law = (1.0_f64 - d).powf(1.0);
                // Rounding; and what the rule leaves: the iteration of the midpoint rule 10⁻⁸ (1 + v) times its
                // contraction λh/2 in each of the 1/h steps, RK4 (λh)⁵ in each of them.
                let decay = -(1.0_f64 - d).ln();
                let allowed = 1e-11
                    + match integrator {
                        Integrator::ImplicitMidpoint => 1e-8 * decay,
                        Integrator::SemiImplicitEuler => 0.0,
                        Integrator::Rk4 => decay.powi(5) * step.powi(4),
                        // 1e-9 per second of 1 + |v|, in units of v ≥ 1.
                        Integrator::Extrapolation => 2e-9,
                    };
                let (p, _) =
                    momenta(&format!("linear='{d}'"), settings(integrator, step), 1.0, ([0.0; 3], [1.0, 2.0, -2.0]));
                assert!((p / 9.0 - law).abs() <= allowed, "{integrator:?} {step} {d}: {} {law}", p / 9.0);
                // About z through the centre of mass: the origin moves, v = −ω × c.
                let turn = ([0.0, 0.0, 2.0], [-0.4, -0.2, 0.0]);
                let (_, l) = momenta(&format!("angular='{d}'"), settings(integrator, step), 1.0, turn);
                assert!((l / 0.4 - law).abs() <= allowed, "{integrator:?} {step} {d}: {} {law}", l / 0.4);
            }
        }
    }
}

/// Momentum and angular momentum of any free motion decay by the law: K̇ = −λ K in each. The error of the midpoint rule is of
/// second order: a quarter at half the step.
#[test]
fn tumbling_decays_with_the_order_of_the_rule() {
    for (integrator, order) in
        [(Integrator::ImplicitMidpoint, 2.0), (Integrator::SemiImplicitEuler, 1.0), (Integrator::Rk4, 4.0)]
    {
        let error = |step: f64| {
            let twist = ([2.0, -1.0, 3.0], [1.0, 0.5, -0.3]);
            let none = momenta("linear='0' angular='0.6'", settings(integrator, 1e-2), 0.0, twist).1;
            let l = momenta("linear='0' angular='0.6'", settings(integrator, step), 1.0, twist).1;
            (l / none - 0.4).abs()
        };
        let (coarse, fine) = (error(2e-2), error(1e-2));
        let seen = (coarse / fine).log2();
        assert!(coarse < 1e-13 || seen > order - 0.4, "{integrator:?}: {coarse:e} {fine:e}, order {seen}");
    }
}

/// What the bodies lose is in the ledger: it closes as without damping, by the order of the rule.
#[test]
fn the_ledger_closes() {
    let arm = |damping: &str| {
        robot(&[
            damped("root", 2.0, damping),
            damped("arm", 1.0, damping),
            damped("hand", 0.5, damping),
            "<joint name='a' type='continuous'><parent link='root'/><child link='arm'/><origin xyz='0.3 0 0'/><axis xyz='0 1 0'/></joint>".into(),
            "<joint name='b' type='continuous'><parent link='arm'/><child link='hand'/><origin xyz='0.3 0 0'/><axis xyz='1 0 0'/></joint>".into(),
        ])
    };
    for base in [Base::Fixed, Base::Free] {
        for (integrator, allowed) in
            [(Integrator::ImplicitMidpoint, 2.0), (Integrator::SemiImplicitEuler, 40.0), (Integrator::Rk4, 0.05)]
        {
            let left = |damping: &str| {
                let m = model(&arm(damping), base);
                let settings = Settings { gravity: [0.0, 0.0, -9.80665], ..settings(integrator, 1e-3) };
                let mut w = world(&m, settings, |s, m| {
                    s.set_axis(m, 0, 0.5, 3.0);
                    s.set_axis(m, 1, 0.2, -2.0);
                    s.set_base_twist(m, [1.0, 2.0, 0.5].into(), [0.3, 0.0, 0.0].into());
                });
                let total = |w: &World| w.energy().kinetic + w.energy().potential;
                let start = total(&w);
                (0..1000).for_each(|_| w.advance());
                (total(&w) - start + w.work().losses, w.work().losses, start)
            };
            let (free, none, _) = left("");
            let (damped, losses, _) = left("linear='0.3' angular='0.5'");
            assert_eq!(none, 0.0);
            assert!(losses > 0.1, "{losses}");
            // The undamped run shows what the rule itself leaves; damping may not leave more than its share of that kind.
            let bound = allowed * 1e-3 * (losses * 1e-2).max(1e-3) + 2.0 * free.abs();
            assert!(
                damped.abs() <= bound,
                "{integrator:?} {base:?}: {damped:e}, without damping {free:e}, losses {losses}"
            );
        }
    }
}

/// d = 1 stops nothing at once and breaks nothing: 10⁻¹⁶ of the velocity is left after a second.
#[test]
fn a_damping_of_one_is_finite() {
    for integrator in ALL {
        let (p, l) =
            momenta("linear='1' angular='1'", settings(integrator, 1e-3), 1.0, ([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]));
        assert!(p.is_finite() && l.is_finite() && p < 1e-12 && l < 1e-12, "{integrator:?}: {p} {l}");
    }
}

/// Of links joined by fixed joints the one with mass that is nearest the root counts (J-6), and the effect has a switch.
#[test]
fn a_link_is_damped_as_its_body_nearest_the_root_says() {
    let parts = [
        "<link name='base'/>".into(),
        damped("near", 1.0, "linear='0.1'"),
        damped("far", 5.0, "linear='0.9' angular='0.9'"),
        "<joint name='a' type='fixed'><parent link='base'/><child link='near'/></joint>".into(),
        "<joint name='b' type='fixed'><parent link='near'/><child link='far'/></joint>".into(),
    ];
    let mut m = Model::clone(&model(&robot(&parts), Base::Free));
    assert_eq!(m.dampings.len(), 1);
    assert_eq!((m.dampings[0].linear, m.dampings[0].angular), (0.1, 0.0));
    assert!(m.effects.body_damping && m.effects.switch("body_damping", false));
    let mut w = world(&m, settings(Integrator::ImplicitMidpoint, 1e-3), |s, m| {
        s.set_base_twist(m, [0.0; 3].into(), [1.0, 0.0, 0.0].into())
    });
    (0..100).for_each(|_| w.advance());
    assert!((w.state().v[3] - 1.0).abs() <= 1e-13, "switched off, nothing is damped");
    assert!(!model(&robot(&[damped("body", 1.0, "")]), Base::Free).effects.body_damping, "not called for");
}

/// Steps with damped bodies are of the same kind: a copy goes on with the same bits.
#[test]
fn a_copy_goes_on_with_the_same_bits() {
    let m = model(&robot(&[damped("body", 3.0, "linear='0.2' angular='0.3'")]), Base::Free);
    let mut w = world(&m, settings(Integrator::ImplicitMidpoint, 1e-3), |s, m| {
        s.set_base_twist(m, [1.0, 2.0, 3.0].into(), [1.0, 0.0, 0.0].into())
    });
    (0..10).for_each(|_| w.advance());
    let mut copy = w.clone();
    (0..10).for_each(|_| w.advance());
    (0..10).for_each(|_| copy.advance());
    assert_eq!(w.state(), copy.state());
}
