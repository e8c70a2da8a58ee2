//! Size, mass, distribution and symmetry.

use super::reader::{read, zero_pose};
use realnoid::description::Description;
use realnoid::mass::{MassProperties, link_masses};
use realnoid::math::{Mat3, Vec3};
use realnoid::shape::{Bounds, Meshes, Shape, bounds};

/// Mirrors Y.
const MIRROR: Mat3 = Mat3::new(1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0);

fn masses(description: &Description) -> Vec<MassProperties> {
    let (masses, findings) = link_masses(description);
    assert!(findings.is_empty(), "{findings:?}");
    masses
}

/// Mass of all links whose name contains one of `parts`.
fn mass_of(parts: &[&str]) -> f64 {
    let d = read();
    let named = d.links.iter().zip(masses(&d)).filter(|(l, _)| parts.iter().any(|p| l.name.contains(p)));
    named.map(|(_, m)| m.mass).sum()
}

fn visual_bounds(description: &Description, link: impl Fn(&str) -> bool) -> Bounds {
    let poses = zero_pose(description);
    let links = description.links.iter().filter(|l| link(&l.name));
    let placed = links.flat_map(|l| {
        l.visuals.iter().map(|v| {
            let pose = poses[l.name.as_str()] * v.origin.pose();
            bounds(&Shape::of(v).unwrap(), &pose, &Meshes::default()).unwrap()
        })
    });
    placed.reduce(|a, b| a.union(&b)).unwrap()
}

#[test]
fn it_is_life_size() {
    let d = read();
    let all = visual_bounds(&d, |_| true);
    let height = all.max.z - all.min.z;
    assert!((1.58..1.62).contains(&height), "{height} m");
    assert!((all.max.y - all.min.y) < 0.55, "shoulder width");
    let foot = visual_bounds(&d, |name| name == "left_foot" || name == "left_toes");
    assert!((0.22..0.26).contains(&(foot.max.x - foot.min.x)), "length of a foot");
}

#[test]
fn it_stands_on_both_soles() {
    let d = read();
    let poses = zero_pose(&d);
    let ground = visual_bounds(&d, |_| true).min.z;
    for part in ["left_foot", "right_foot", "left_toes", "right_toes"] {
        assert!((visual_bounds(&d, |name| name == part).min.z - ground).abs() < 1e-12, "{part}");
    }
    assert!((poses["l_sole"].translation.z - ground).abs() < 1e-12);
    let parts: Vec<_> = d.links.iter().zip(masses(&d)).map(|(l, m)| m.placed(&poses[l.name.as_str()])).collect();
    let center = MassProperties::sum(&parts).center;
    let feet = visual_bounds(&d, |name| name.ends_with("foot"));
    assert!(center.y.abs() < 1e-15, "{center}");
    assert!(feet.min.x + 0.03 < center.x && center.x < feet.max.x - 0.03, "balanced with a margin: {center}");
    let part = (center.z - ground) / 1.6;
    assert!((0.5..0.62).contains(&part), "centre of mass at {part} of the height");
}

#[test]
fn it_weighs_what_a_person_does_part_by_part() {
    let total = mass_of(&[""]);
    assert!((55.0..60.0).contains(&total), "{total} kg");
    // Fractions of body mass, with room for the spread between published tables.
    let expected = [
        ("head and neck", mass_of(&["head", "neck"]), 0.06, 0.09),
        ("trunk", mass_of(&["pelvis", "waist", "torso"]), 0.42, 0.52),
        ("upper arm", mass_of(&["left_upper_arm"]), 0.024, 0.032),
        ("forearm", mass_of(&["left_forearm"]), 0.013, 0.019),
        ("hand", mass_of(&["left_hand", "left_fingers"]), 0.005, 0.010),
        ("thigh", mass_of(&["left_thigh"]), 0.10, 0.14),
        ("shank", mass_of(&["left_shank"]), 0.038, 0.05),
        ("foot", mass_of(&["left_ankle", "left_foot", "left_toes"]), 0.012, 0.025),
    ];
    for (part, mass, least, most) in expected {
        let fraction = mass / total;
        assert!((least..most).contains(&fraction), "{part}: {mass:.2} kg, {:.1} %", fraction * 100.0);
    }
}

#[test]
fn specific_gravities_are_those_of_limbs_and_machines() {
    for link in read().links {
        if let Some(body) = link.body {
            assert!(
                (0.8..=1.6).contains(&body.substance.specific_gravity),
                "{}: {}",
                link.name,
                body.substance.specific_gravity
            );
        }
    }
}

#[test]
fn left_and_right_are_mirror_images() {
    let d = read();
    let all = masses(&d);
    let poses = zero_pose(&d);
    let find = |name: &str| d.links.iter().position(|l| l.name == name).unwrap_or_else(|| panic!("no {name}"));
    let mut pairs = 0;
    for (i, link) in d.links.iter().enumerate() {
        let Some(other) = twin(&link.name).map(|name| find(&name)) else { continue };
        pairs += 1;
        let (a, b) = (&all[i], &all[other]);
        assert_eq!(a.mass, b.mass, "{}", link.name);
        assert!((a.center - MIRROR * b.center).norm() < 1e-15, "{}", link.name);
        assert!((a.inertia - MIRROR * b.inertia * MIRROR).norm() <= 1e-14 * a.inertia.norm(), "{}", link.name);
        let at = |name: &str| poses[name].translation.vector;
        assert!((at(&link.name) - MIRROR * at(&d.links[other].name)).norm() < 1e-15, "{}", link.name);
        let shapes = |l: usize| (d.links[l].visuals.len(), d.links[l].collisions.len(), d.links[l].proxies.len());
        assert_eq!(shapes(i), shapes(other), "{}", link.name);
        let extent = |name: &str| visual_bounds(&d, |n| n == name);
        if !link.visuals.is_empty() {
            let (here, there) = (extent(&link.name), extent(&d.links[other].name));
            let turned = Vec3::new(there.max.x, -there.min.y, there.max.z);
            assert!((here.max - turned).norm() < 1e-12, "{}", link.name);
        }
    }
    assert!(pairs >= 26, "{pairs}");
}

/// The name on the other side.
pub fn twin(name: &str) -> Option<String> {
    let sides = [("left_", "right_"), ("right_", "left_"), ("l_", "r_"), ("r_", "l_")];
    sides.iter().find_map(|(here, there)| name.strip_prefix(here).map(|rest| format!("{there}{rest}")))
}

#[test]
fn what_touches_has_a_collision_shape_and_a_proxy() {
    let d = read();
    for name in ["pelvis", "torso", "head", "left_hand", "left_fingers", "left_shank", "left_foot", "left_toes"] {
        let link = d.links.iter().find(|l| l.name == name).unwrap();
        assert!(!link.collisions.is_empty() && !link.proxies.is_empty(), "{name}");
    }
    for name in ["base_link", "torso", "head", "left_hand", "right_hand", "left_foot", "right_foot"] {
        assert!(d.links.iter().find(|l| l.name == name).unwrap().monitor.is_some(), "{name}");
    }
}
