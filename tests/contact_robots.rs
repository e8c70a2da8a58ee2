//! Colliders of robots, and which of their links may touch.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "contact/scene.rs"]
mod scene;
mod support;

use realnoid::contact::{Defaults, Detector, colliders};
use realnoid::description::{self, Finding, Geometry};
use realnoid::dynamics::{Kinematics, kinematics};
use realnoid::mass::link_bodies;
use realnoid::math::Pose;
use realnoid::model::{Base, LinkFrame, Model};
use realnoid::shape::{ContactForm, Meshes, collision_shapes};
use scene::collider;
use std::path::Path;

fn robot(text: &str, file: &str, base: Base) -> (description::Description, Model, Vec<Finding>) {
    let d = description::read(text, file).description.unwrap();
    let meshes = Meshes::beside(Path::new(file), &[]);
    let masses: Vec<_> = link_bodies(&d, &meshes).0.iter().map(|b| b.simulated).collect();
    let mut m = Model::build(&d, &masses, base, Pose::identity());
    let findings = colliders(&d, &mut m, &meshes, Defaults::default());
    (d, m, findings)
}

#[test]
fn every_shape_of_our_robots_collides() {
    for (file, base) in
        [("urdf/origin.urdf", Base::Free), ("urdf/shapes.urdf", Base::Fixed), ("urdf/shapes.urdf", Base::Free)]
    {
        let text = std::fs::read_to_string(file).unwrap();
        let (d, m, findings) = robot(&text, file, base);
        let mut shapes = 0;
        for (i, link) in d.links.iter().enumerate() {
            let n = collision_shapes(link).1.len();
            shapes += n;
            assert_eq!(m.colliders.iter().filter(|c| c.link == Some(i)).count(), n, "{}", link.name);
            assert!(n == 0 || matches!(m.links[i].frame, LinkFrame::OnBody { .. }));
        }
        assert!(shapes > 10, "{file}");
        assert!(findings.iter().all(|f| f.code == "collides-as" || f.code == "links-overlap"), "{findings:?}");
        let hollow =
            d.links.iter().flat_map(|l| collision_shapes(l).1).filter(|s| matches!(s.geometry, Geometry::Torus { .. }));
        let surfaces = m.colliders.iter().filter(|c| matches!(c.form, ContactForm::Surface(_))).count();
        if base == Base::Fixed {
            assert!(surfaces >= hollow.count());
        } else {
            assert_eq!(surfaces, 0, "what moves is convex");
        }
        assert_eq!(Detector::new(&m).is_some(), base == Base::Free && file.contains("origin"));
    }
}

const LIMB: &str =
    "<inertial><mass value='1'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial>";

fn ball_link(name: &str, tags: &str) -> String {
    format!("<link name='{name}'>{LIMB}<collision><geometry><sphere radius='0.1'/></geometry></collision>{tags}</link>")
}

fn joint(name: &str, parent: &str, child: &str, x: f64, tags: &str) -> String {
    format!(
        "<joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/>\
         <origin xyz='{x} 0 0'/><axis xyz='0 0 1'/>{tags}</joint>"
    )
}

#[test]
fn which_links_may_touch() {
    let links: String = ["a", "b", "c", "d", "e"].iter().map(|n| ball_link(n, "")).collect();
    // a–b–c–d in a row, the joint of c soft; e overlaps a, but hangs on c.
    let soft = "<realnoid><constraint erp='0.3' cfm='1e-4'/></realnoid>";
    let joints = joint("ab", "a", "b", 0.3, "")
        + &joint("bc", "b", "c", 0.3, soft)
        + &joint("cd", "c", "d", 0.3, "")
        + &joint("ce", "c", "e", -0.5, "");
    let text = |chain: &str| format!("<robot name='r'>{links}{joints}{chain}</robot>");
    let (_, m, findings) = robot(&text(""), "x", Base::Free);
    assert_eq!(m.excluded_pairs, [[0, 1], [0, 4], [1, 2], [2, 3], [2, 4]]);
    let told: Vec<_> = findings.iter().map(|f| (f.code, f.message.as_str())).collect();
    // Centres 0.1 apart, radii 0.1 each: 0.1 m of overlap.
    assert_eq!(
        told,
        [(
            "links-overlap",
            "links 'a' and 'e' overlap by 100.00 mm where all joints are at 0: they never collide with each other"
        )]
    );
    let chain = "<realnoid version='1'><chain root='bc' self_collision='false' anchor='b'/></realnoid>";
    let (_, m, _) = robot(&text(chain), "x", Base::Free);
    assert_eq!(m.excluded_pairs, [[0, 1], [0, 4], [1, 2], [2, 3], [2, 4], [3, 4]]);
}

#[test]
fn surfaces_and_shapes_are_told() {
    let tag = "<realnoid><surface friction='0.5' margin='0.01'/></realnoid>";
    let (_, m, _) = robot(&format!("<robot name='r'>{}</robot>", ball_link("a", tag)), "x", Base::Free);
    let c = &m.colliders[0];
    assert_eq!((c.surface.friction, c.surface.restitution, c.margin), (0.5, 0.0, 0.01));
    let moving = format!(
        "<robot name='r'><link name='a'>{LIMB}<collision><geometry><torus ring_radius='0.2' pipe_radius='0.05'/></geometry></collision>\
         <collision><geometry><mesh filename='nowhere.stl'/></geometry></collision></link></robot>"
    );
    let (_, m, findings) = robot(&moving, "x", Base::Free);
    assert!(matches!(m.colliders[0].form, ContactForm::Hull(_)));
    let codes: Vec<_> = findings.iter().map(|f| f.code).collect();
    assert_eq!(codes, ["collides-as", "does-not-collide"]);
    assert!(findings.iter().all(|f| f.at.line == 1 && f.element.starts_with("link 'a' <")));
}

/// Prints what it costs: `cargo test --release --test contact_robots -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn cost_of_finding() {
    let text = std::fs::read_to_string("urdf/origin.urdf").unwrap();
    let (_, mut m, _) = robot(&text, "urdf/origin.urdf", Base::Free);
    m.colliders.push(collider(ContactForm::HalfSpace, None, Pose::identity()));
    let mut detector = Detector::new(&m).unwrap();
    let mut k = Kinematics::new(&m);
    let mut q = m.neutral();
    let mut out = vec![];
    // The height at which the lowest point is on the ground.
    q[2] = 2.0;
    kinematics(&m, &mut k, &q, &vec![0.0; m.nv]);
    detector.find(&k, 2.0, &mut out);
    for (what, lift) in [("far above", 2.0), ("on the ground", 0.0), ("1 cm deep", -0.01)] {
        let mut low = (0.0, 4.0);
        while low.1 - low.0 > 1e-9 {
            q[2] = 0.5 * (low.0 + low.1);
            kinematics(&m, &mut k, &q, &vec![0.0; m.nv]);
            detector.find(&k, 0.0, &mut out);
            let deep = out.iter().any(|t| t.placed(&k).gap < 0.0);
            if deep { low.0 = q[2] } else { low.1 = q[2] }
        }
        q[2] += lift;
        kinematics(&m, &mut k, &q, &vec![0.0; m.nv]);
        let start = std::time::Instant::now();
        for _ in 0..100_000 {
            detector.find(std::hint::black_box(&k), 1e-3, &mut out);
        }
        println!(
            "{what}: {:.3} µs, {} touches, {} colliders",
            start.elapsed().as_secs_f64() * 10.0,
            out.len(),
            m.colliders.len()
        );
    }
}
