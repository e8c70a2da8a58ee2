//! Soft joints (J-18): CFM and ERP of the joint itself against springs and dampers in closed form.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::{Base, Model};
use realnoid::world::{Integrator, Settings, World};
use std::sync::Arc;
use support::urdf;

const MASS: f64 = 3.0;
const INERTIA: [f64; 3] = [0.04, 0.05, 0.02];
const G: f64 = 9.80665;

/// What joins the limb to its stand.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    HingeX,
    HingeZ,
    SlideX,
    Cardan,
    ThreeDof,
    Fixed,
}
const ALL: [Kind; 6] = [Kind::HingeX, Kind::HingeZ, Kind::SlideX, Kind::Cardan, Kind::ThreeDof, Kind::Fixed];

/// A limb on a stand, its centre of mass at `center`; `tag` goes into the `<realnoid>` of the first joint.
fn text(kind: Kind, center: Vec3, tag: &str) -> String {
    let joint = |name: &str, kind: &str, ends: (&str, &str), axis: &str, z: f64, tag: &str| {
        format!(
            "<joint name='{name}' type='{kind}'><parent link='{}'/><child link='{}'/><origin xyz='0 0 {z}'/>\
             <axis xyz='{axis}'/>{tag}</joint>",
            ends.0, ends.1
        )
    };
    let tag = if tag.is_empty() { String::new() } else { format!("<realnoid>{tag}</realnoid>") };
    let single = |kind: &str, axis: &str| joint("h", kind, ("stand", "limb"), axis, 1.0, &tag);
    let [h, p] = [("h", ("stand", "l1"), "0 0 1", 1.0, tag.as_str()), ("p", ("l1", "limb"), "0 1 0", 0.0, "")]
        .map(|(name, ends, axis, z, tag)| joint(name, "continuous", ends, axis, z, tag));
    let ranged = |text: &str| text.replace("'continuous'>", "'revolute'><limit lower='-1.5' upper='1.5'/>");
    let rest = match kind {
        Kind::HingeX => single("continuous", "1 0 0"),
        Kind::HingeZ => single("continuous", "0 0 1"),
        Kind::SlideX => single("prismatic", "1 0 0"),
        Kind::Fixed => single("fixed", "1 0 0"),
        Kind::Cardan => {
            format!(
                "<link name='l1'/>{h}{p}<realnoid version='1'><joint_group name='g' type='cardan' h='h' p='p'/></realnoid>"
            )
        }
        Kind::ThreeDof => {
            let b = joint("b", "continuous", ("l2", "limb"), "1 0 0", 0.0, "");
            format!(
                "<link name='l1'/><link name='l2'/>{h}{}{b}\
                 <realnoid version='1'><joint_group name='g' type='3dof' h='h' p='p' b='b'/></realnoid>",
                ranged(&p.replace("'limb'", "'l2'"))
            )
        }
    };
    let [ixx, iyy, izz] = INERTIA;
    format!(
        "<robot name='r'><link name='stand'/><link name='limb'><inertial><origin xyz='{} {} {}'/><mass value='{MASS}'/>\
         <inertia ixx='{ixx}' ixy='0' ixz='0' iyy='{iyy}' iyz='0' izz='{izz}'/></inertial></link>{rest}</robot>",
        center.x, center.y, center.z
    )
}

fn model(text: &str) -> Arc<Model> {
    urdf::model(text, Base::Fixed)
}

fn settings(h: f64) -> Settings {
    Settings {
        integrator: Integrator::SemiImplicitEuler,
        control_interval_ns: (h * 1e9).round() as i64,
        steps_per_interval: 1,
        ..Settings::default()
    }
}

fn world(m: &Arc<Model>, h: f64) -> World {
    World::new(m.clone(), settings(h)).unwrap()
}

fn run(w: &mut World, steps: usize) {
    (0..steps).for_each(|_| w.advance());
    assert_eq!(w.stats().diverged_steps, 0);
}

fn limb(w: &World) -> realnoid::math::Pose {
    let link = w.model().links.iter().position(|l| l.name == "limb").unwrap();
    w.new_snapshot().link_pose[link]
}

/// J-18: the tag of a spring and a damper for a step of h seconds.
fn tag(k: f64, d: f64, h: f64) -> String {
    format!("<constraint erp='{:e}' cfm='{:e}'/>", h * k / (h * k + d), 1.0 / (h * k + d))
}

/// A spring and a damper on an inertia under a constant force, by implicit Euler: positions after each step.
fn spring((inertia, k, d): (f64, f64, f64), force: f64, (mut e, mut v): (f64, f64), h: f64, steps: usize) -> Vec<f64> {
    let mut path = vec![];
    for _ in 0..steps {
        v = (inertia * v + h * (force - k * e)) / (inertia + h * d + h * h * k);
        e += h * v;
        path.push(e);
    }
    path
}

/// At rest under its weight: the spring alone carries it, with m g/k, whatever the step.
#[test]
fn a_link_sags_by_its_weight_over_k() {
    for kind in ALL {
        for h in [1e-3, 1e-2] {
            let (erp, cfm) = (0.3, 2e-4);
            let m = model(&text(kind, Vec3::zeros(), &format!("<constraint erp='{erp}' cfm='{cfm}'/>")));
            let mut w = world(&m, h);
            // Each step the error shrinks at least by (1 − erp) where the mass is small against h/cfm.
            run(&mut w, 3000);
            let k = erp / (cfm * h);
            let sag = 1.0 - limb(&w).translation.z;
            assert!((sag / (MASS * G / k) - 1.0).abs() < 1e-9, "{kind:?} h {h}: {sag} instead of {}", MASS * G / k);
            assert!(limb(&w).rotation.angle() < 1e-12, "{kind:?}");
        }
    }
}

/// The centre of mass beside the joint: it tilts by θ with k θ = m g c cos θ.
#[test]
fn a_link_tilts_by_its_moment_over_k() {
    let (h, c) = (1e-3, 0.1);
    let (erp, cfm) = (0.3, 1e-4);
    let k = erp / (cfm * h);
    let mut tilt = 0.0_f64;
    (0..100).for_each(|_| tilt = MASS * G * c * tilt.cos() / k);
    for kind in [Kind::HingeZ, Kind::SlideX, Kind::Fixed] {
        let m = model(&text(kind, Vec3::new(c, 0.0, 0.0), &format!("<constraint erp='{erp}' cfm='{cfm}'/>")));
        let mut m = Model::clone(&m);
        if kind == Kind::SlideX {
            // Else it would slide down its tilted axis.
            m.effects.friction = true;
            m.axes[0].friction = 100.0;
        }
        let mut w = world(&Arc::new(m), h);
        run(&mut w, 5000);
        assert!((limb(&w).rotation.angle() / tilt - 1.0).abs() < 1e-9, "{kind:?}: {}", limb(&w).rotation.angle());
        assert!((limb(&w).rotation * Vec3::x()).z < 0.0, "{kind:?}: downwards");
    }
}

/// Let go at e = 0 under its weight: every position is that of the spring and damper, soft and stiff, weakly and strongly
/// damped, short and long steps.
#[test]
fn the_step_response_is_that_of_spring_and_damper() {
    for kind in ALL {
        for (k, d, h) in [(500.0, 3.0, 1e-3), (1e5, 200.0, 1e-3), (2e3, 1e3, 1e-2), (1e8, 1.0, 1e-2)] {
            let m = model(&text(kind, Vec3::zeros(), &tag(k, d, h)));
            for integrator in [Integrator::SemiImplicitEuler, Integrator::ImplicitMidpoint] {
                let mut w = World::new(m.clone(), Settings { integrator, ..settings(h) }).unwrap();
                for (step, e) in spring((MASS, k, d), -MASS * G, (0.0, 0.0), h, 500).into_iter().enumerate() {
                    run(&mut w, 1);
                    let z = limb(&w).translation.z;
                    let scale = MASS * G / k;
                    assert!((z - 1.0 - e).abs() < 1e-9 * scale + 1e-15, "{kind:?} k {k} d {d} step {step}: {z} {e}");
                }
            }
        }
    }
}

/// The same for turns: kicked about each direction that yields, without gravity.
#[test]
fn turns_respond_as_spring_and_damper() {
    let (k, d, h) = (40.0, 0.2, 1e-3);
    // Inertia about the directions in which each joint yields, in the order of the model.
    let cases: [(Kind, &[usize]); 5] = [
        (Kind::HingeX, &[1, 2]),
        (Kind::HingeZ, &[0, 1]),
        (Kind::SlideX, &[0, 1, 2]),
        (Kind::Cardan, &[0]),
        (Kind::Fixed, &[0, 1, 2]),
    ];
    for (kind, turning) in cases {
        let mut m = Model::clone(&model(&text(kind, Vec3::zeros(), &tag(k, d, h))));
        m.effects.gravity = false;
        let m = Arc::new(m);
        let softs: Vec<_> = m.softs.iter().rev().take(turning.len()).rev().copied().collect();
        let mut seen: Vec<f64> = vec![];
        for soft in softs {
            let mut w = world(&m, h);
            let mut start = State::initial(&m);
            start.v[soft.v] = 0.3;
            w.set_initial_state(start);
            w.advance();
            let turned = limb(&w).rotation.scaled_axis();
            let axis = turned.iamax();
            seen.push(axis as f64);
            let path = spring((INERTIA[axis], k, d), 0.0, (0.0, 0.3), h, 300);
            assert!((turned[axis].abs() / path[0].abs() - 1.0).abs() < 1e-12, "{kind:?}");
            for e in &path[1..] {
                w.advance();
                let angle = limb(&w).rotation.scaled_axis()[axis].abs();
                assert!((angle - e.abs()).abs() < 1e-9 * 0.3 * h, "{kind:?} axis {axis}: {angle} {e}");
            }
        }
        seen.sort_by(f64::total_cmp);
        assert_eq!(seen, turning.iter().map(|a| *a as f64).collect::<Vec<_>>(), "{kind:?}");
    }
}

/// A swinging limb on a joint of softness cfm differs from the hard one in proportion to cfm, also where H of a cardan
/// joint has turned far.
#[test]
fn a_softness_of_zero_is_the_hard_joint() {
    let center = Vec3::new(0.05, 0.02, -0.2);
    let swing = |m: &Arc<Model>| {
        let mut w = world(m, 1e-3);
        let mut start = State::initial(m);
        for axis in 0..m.axes.len() {
            start.set_axis(m, axis, [1.4, 0.6, -0.3][axis], 0.0);
        }
        for axis in 0..m.axes.len() {
            start.set_axis(m, axis, [1.4, 0.6, -0.3][axis], [0.5, 1.0, -2.0][axis]);
        }
        w.set_initial_state(start);
        run(&mut w, 400);
        limb(&w)
    };
    for kind in ALL {
        let hard = swing(&model(&text(kind, center, "")));
        let apart = |tag: &str| {
            let soft = swing(&model(&text(kind, center, tag)));
            (soft.translation.vector - hard.translation.vector).norm() + soft.rotation.angle_to(&hard.rotation)
        };
        let gaps = [1e-6, 1e-8, 1e-10].map(|cfm| apart(&format!("<constraint erp='0.5' cfm='{cfm:e}'/>")));
        println!("{kind:?}: {gaps:?}");
        for pair in gaps.windows(2) {
            // First order in cfm: 100 times less; the second order adds less than half.
            assert!(pair[0] / pair[1] > 50.0 && pair[0] / pair[1] < 200.0, "{kind:?}: {gaps:?}");
        }
    }
}

/// The effect switched off, a soft joint is hard; and a cfm of 0 builds nothing at all.
#[test]
fn compliance_off_is_hard() {
    let center = Vec3::new(0.05, 0.02, -0.2);
    for kind in ALL {
        let hard = model(&text(kind, center, ""));
        let zero = model(&text(kind, center, "<constraint erp='0.5' cfm='0'/>"));
        assert_eq!((zero.softs.len(), zero.bodies.len(), zero.nv), (0, hard.bodies.len(), hard.nv), "{kind:?}");
        assert!(!zero.effects.compliance);
        let soft = model(&text(kind, center, "<constraint erp='0.5' cfm='1e-3'/>"));
        assert!(soft.effects.compliance && !soft.softs.is_empty());
        let mut off = Model::clone(&soft);
        assert!(off.effects.switch("compliance", false));
        let [a, b, yielding] = [hard, Arc::new(off), soft].map(|m| {
            let mut w = world(&m, 1e-3);
            run(&mut w, 300);
            limb(&w)
        });
        let gap = |a: &realnoid::math::Pose, b: &realnoid::math::Pose| {
            (a.translation.vector - b.translation.vector).norm() + a.rotation.angle_to(&b.rotation)
        };
        // 300 steps of rounding, amplified by a swing of less than a radian.
        assert!(gap(&a, &b) < 1e-11, "{kind:?}: {}", gap(&a, &b));
        assert!(gap(&a, &yielding) > 1e-6, "{kind:?}: soft it must differ");
    }
}

/// From softer than its inertia (h/cfm is m/3) to harder than rounding, at long steps: finite, and never more energy than at
/// the start. Springs only store and dampers only take; the integrator's own error is h/2 v·∂V/∂x, below h v m g.
#[test]
fn every_softness_is_stable() {
    let center = Vec3::new(0.05, 0.02, -0.2);
    for kind in ALL {
        for cfm in [1e-2, 1e-3, 1e-6, 1e-9, 1e-20, 1e-29, 1e-31, 1e-300] {
            for erp in [0.1, 1.0] {
                let m = model(&text(kind, center, &format!("<constraint erp='{erp}' cfm='{cfm:e}'/>")));
                let h = 1e-2;
                let mut w = world(&m, h);
                let start = w.energy().potential;
                for step in 0..300 {
                    run(&mut w, 1);
                    let e = w.energy();
                    let error = h * (2.0 * e.kinetic / MASS).sqrt() * MASS * G;
                    let gained = e.kinetic + e.potential - start;
                    assert!(gained < error + 1e-9, "{kind:?} cfm {cfm} erp {erp} step {step}: {gained} J");
                }
                assert!(limb(&w).translation.vector.iter().all(|x| x.is_finite()));
            }
        }
    }
}

/// A step that the midpoint rule halves keeps the spring of the whole step: a whirling light limb at the tip of a soft hinge
/// halves the steps, and the hinge sags by m g/k of the whole step all the same.
#[test]
fn halved_steps_keep_the_spring() {
    let (erp, cfm, h) = (0.3, 2e-4, 1e-2);
    let text = text(Kind::HingeZ, Vec3::zeros(), &format!("<constraint erp='{erp}' cfm='{cfm}'/>"));
    // Two light limbs whirl about horizontal axes, symmetrical, so that they pull with nothing but their weight on average.
    let light = "<mass value='1e-4'/><inertia ixx='1e-9' ixy='0' ixz='0' iyy='3e-9' iyz='0' izz='2e-9'/>";
    let whirl = format!(
        "<link name='w1'><inertial>{light}</inertial></link><link name='w2'><inertial>{light}</inertial></link>\
         <joint name='x' type='continuous'><parent link='limb'/><child link='w1'/><axis xyz='1 0 0'/></joint>\
         <joint name='y' type='continuous'><parent link='w1'/><child link='w2'/><axis xyz='0 1 0'/></joint></robot>"
    );
    let m = model(&text.replace("</robot>", &whirl));
    let mut w = World::new(m.clone(), Settings { integrator: Integrator::ImplicitMidpoint, ..settings(h) }).unwrap();
    let mut start = State::initial(&m);
    let k = erp / (cfm * h);
    let sag = (MASS + 2e-4) * G / k;
    start.q[m.softs[2].q] = -sag;
    start.set_axis(&m, 1, 0.3, 300.0);
    start.set_axis(&m, 2, 0.2, -250.0);
    w.set_initial_state(start);
    run(&mut w, 200);
    assert!(w.stats().halvings > 100, "{:?}", w.stats());
    let seen = 1.0 - limb(&w).translation.z;
    // The whirling limbs' centres are on their axes: they pull with their weight only.
    assert!((seen / sag - 1.0).abs() < 1e-6, "{seen} {sag}");
}

/// What a soft joint takes is in the ledger: with f·h·v̄ per step, ΔE = −taken + ½ h m g (v₁ − v₀), because the height
/// changes with the speed at the end and not with the mean. Held, it takes the speed that it had.
#[test]
fn the_ledger_has_the_work_of_soft_joints() {
    let h = 1e-2;
    for (integrator, compliance) in [
        (Integrator::SemiImplicitEuler, true),
        (Integrator::ImplicitMidpoint, true),
        (Integrator::ImplicitMidpoint, false),
    ] {
        let mut m = Model::clone(&model(&text(Kind::Fixed, Vec3::zeros(), &tag(2e3, 10.0, h))));
        m.effects.compliance = compliance;
        let m = Arc::new(m);
        let mut w = World::new(m.clone(), Settings { integrator, ..settings(h) }).unwrap();
        let mut start = State::initial(&m);
        let v0 = 0.7;
        start.v[m.softs[2].v] = v0;
        w.set_initial_state(start);
        let total = |w: &World| w.energy().kinetic + w.energy().potential;
        let e0 = total(&w);
        for step in 0..200 {
            run(&mut w, 1);
            let v = w.state().v[m.softs[2].v];
            let expected = -w.work().losses + 0.5 * h * MASS * G * (v - v0);
            let seen = total(&w) - e0;
            assert!(
                (seen - expected).abs() < 1e-12 * MASS * G,
                "{integrator:?} {compliance} step {step}: {seen} {expected}"
            );
        }
        assert!(w.work().losses > 0.5 * MASS * (v0 * v0 - h * G * v0) - 1e-9, "it took the kinetic energy");
    }
}

/// RK4 leaves the steps of a soft joint to the implicit method, and counts them.
#[test]
fn rk4_leaves_soft_joints_to_the_implicit_method() {
    let m = model(&text(Kind::HingeX, Vec3::zeros(), "<constraint erp='0.5' cfm='1e-4'/>"));
    let run_with = |integrator| {
        let mut w = World::new(m.clone(), Settings { integrator, ..settings(1e-3) }).unwrap();
        run(&mut w, 100);
        (w.stats().fallback_steps, w.state().clone())
    };
    let (midpoint, rk4) = (run_with(Integrator::ImplicitMidpoint), run_with(Integrator::Rk4));
    assert_eq!((rk4.0, midpoint.0), (100, 0));
    assert_eq!(rk4.1, midpoint.1);
}

/// E-2 and groups: what has no effect, or a strange one, is told with joint and item.
#[test]
fn findings_name_joint_and_item() {
    let said = |text: &str| {
        let found = realnoid::description::read(text, "r.urdf").findings;
        found.iter().map(|f| (f.code, f.element.clone(), f.message.clone())).collect::<Vec<_>>()
    };
    let one = |text: &str, code: &str, element: &str, item: &str| {
        let all = said(text);
        let found: Vec<_> = all.iter().filter(|(c, ..)| *c == code).collect();
        assert_eq!(found.len(), 1, "{all:?}");
        assert!(found[0].1.contains(element) && found[0].2.contains(item), "{all:?}");
    };
    let center = Vec3::zeros();
    one(&text(Kind::HingeX, center, "<constraint erp='0.5'/>"), "erp-without-cfm", "joint 'h'", "erp");
    one(&text(Kind::HingeX, center, "<constraint cfm='0.5'/>"), "drifting-joint", "joint 'h'", "cfm");
    let floating = text(Kind::Fixed, center, "<constraint break_threshold='5'/>").replace("'fixed'", "'floating'");
    one(&floating, "constraint-without-effect", "joint 'h'", "break_threshold");
    let three = text(Kind::ThreeDof, center, "<constraint erp='0.5' cfm='1e-3'/>");
    let with_second = |cfm: &str| {
        let tag = format!("<realnoid><constraint erp='0.5' cfm='{cfm}'/></realnoid>");
        three.replace("</joint><joint name='b'", &format!("{tag}</joint><joint name='b'"))
    };
    one(&with_second("2e-3"), "overruled-constraint", "joint 'p'", "cfm");
    assert!(said(&with_second("1e-3")).iter().all(|(code, ..)| *code != "overruled-constraint"));
    let m = model(&with_second("2e-3"));
    assert!(m.softs.len() == 3 && m.softs.iter().all(|s| s.softness.cfm == 1e-3));
}

/// A soft joint that carries no inertia in a direction in which it yields is refused by name.
#[test]
fn a_soft_joint_without_inertia_is_named() {
    let text = text(Kind::HingeX, Vec3::zeros(), "<constraint erp='0.5' cfm='1e-3'/>");
    let [ixx, iyy, izz] = INERTIA;
    let point = text.replace(
        &format!("ixx='{ixx}' ixy='0' ixz='0' iyy='{iyy}' iyz='0' izz='{izz}'"),
        "ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'",
    );
    let report = urdf::load_text(&point, Base::Fixed).err().unwrap();
    assert!(report.contains("joint 'h'") && !report.contains("body "), "{report}");
}
