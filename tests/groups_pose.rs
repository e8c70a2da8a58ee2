//! Setting the angle of a joint from either side (J-12), and frames that mirror a group (J-4).
#![allow(clippy::unwrap_used)] // a test may panic

mod limbs;

use limbs::{axes, body, model, settings, world};
use realnoid::math::{Pose, Vec3};
use realnoid::model::Base;
use realnoid::monitor::rig_values;
use realnoid::world::{Integrator, Side, Snapshot, World};

const KINDS: [&str; 3] = ["3dof", "cardan", "combined_hinge"];
const START: [(f64, f64); 5] = [(0.3, 0.5), (-0.4, 0.2), (0.6, -0.7), (-0.5, 0.9), (0.1, 0.3)];
/// Rounding of a few products of rotations, m and rad.
const EXACT: f64 = 1e-12;

fn start(kind: &str, base: Base) -> World {
    let m = model(&body(kind, ["0 0 0.2", "0 0 0", "0 0 0"], ""), base);
    let mut w = world(&m, settings(Integrator::SemiImplicitEuler, 0.001), &START);
    if base == Base::Free {
        let mut state = w.state().clone();
        state.set_base_pose(&m, [1.0, 2.0, 3.0], [0.1, -0.5, 0.3, 0.8]);
        state.set_base_twist(&m, Vec3::new(0.3, 0.2, 0.1), Vec3::new(1.0, -1.0, 0.5));
        w.set_initial_state(state);
    }
    w
}

fn shown(w: &World) -> Snapshot {
    let mut s = w.new_snapshot();
    w.write_snapshot(&mut s);
    s
}

fn apart(a: &Pose, b: &Pose) -> f64 {
    let x = a.inverse() * b;
    x.translation.vector.norm().max(x.rotation.angle())
}

/// Names of the links that an axis carries, itself and beyond.
fn beyond(w: &World, axis: usize) -> Vec<bool> {
    let m = w.model();
    let first = m.carried(axis).unwrap();
    let path = |link: usize| std::iter::successors(Some(link), |l| m.links[*l].parent);
    (0..m.links.len()).map(|link| path(link).any(|l| l == first)).collect()
}

#[test]
fn from_the_root_side_what_lies_beyond_stays_and_the_rest_moves() {
    for (kind, base) in KINDS.iter().flat_map(|k| [Base::Fixed, Base::Free].map(|b| (k, b))) {
        for (axis, begin) in START.iter().enumerate() {
            let mut w = start(kind, base);
            let (before, was) = (shown(&w), axes(&w));
            let target = begin.0 - 0.25;
            w.set_joint_angle(axis, target, Side::Root).unwrap();
            let after = shown(&w);
            assert_eq!(axes(&w)[axis].0, target, "exactly");
            for (other, (now, then)) in axes(&w).iter().zip(&was).enumerate() {
                assert!(other == axis || now.0 == then.0, "{kind} {axis}: axis {other} has moved");
                assert!((now.1 - then.1).abs() <= EXACT, "{kind} {axis}: speed of {other}: {now:?} {then:?}");
            }
            for (link, stays) in beyond(&w, axis).into_iter().enumerate() {
                let moved = apart(&before.link_pose[link], &after.link_pose[link]);
                let name = &w.model().links[link].name;
                assert!(if stays { moved <= EXACT } else { moved > 1e-3 }, "{kind} {base:?} {axis} {name}: {moved}");
            }
        }
    }
}

#[test]
fn from_the_tip_side_only_what_lies_beyond_moves() {
    for kind in KINDS {
        for (axis, begin) in START.iter().enumerate() {
            let mut w = start(kind, Base::Free);
            let before = shown(&w);
            w.set_joint_angle(axis, begin.0 - 0.25, Side::Tip).unwrap();
            let after = shown(&w);
            for (link, moves) in beyond(&w, axis).into_iter().enumerate() {
                let (then, now) = (&before.link_pose[link], &after.link_pose[link]);
                assert!(if moves { apart(then, now) > 1e-3 } else { then == now }, "{kind} {axis} {link}");
            }
        }
    }
}

/// Root side there and tip side back is a motion of the base: all joints as before, every link moved alike.
#[test]
fn root_side_and_back_by_the_tip_side_moves_the_base() {
    for (kind, base) in KINDS.iter().flat_map(|k| [Base::Fixed, Base::Free].map(|b| (k, b))) {
        for (axis, begin) in START.iter().enumerate() {
            let mut w = start(kind, base);
            let (before, was) = (shown(&w), axes(&w));
            w.set_joint_angle(axis, begin.0 + 0.15, Side::Root).unwrap();
            w.set_joint_angle(axis, begin.0, Side::Tip).unwrap();
            let after = shown(&w);
            let motion = after.link_pose[0] * before.link_pose[0].inverse();
            assert!(apart(&motion, &Pose::identity()) > 1e-2, "the base has moved");
            for link in 0..before.link_pose.len() {
                assert!(
                    apart(&(motion * before.link_pose[link]), &after.link_pose[link]) <= EXACT,
                    "{kind} {axis} {link}"
                );
            }
            assert!(axes(&w).iter().zip(&was).all(|(a, b)| a.0 == b.0));
        }
    }
}

/// A fixed base that was moved goes on as a robot that was loaded there.
#[test]
fn a_moved_fixed_base_is_a_base_elsewhere() {
    let mut w = start("3dof", Base::Fixed);
    w.set_joint_angle(0, -0.9, Side::Root).unwrap();
    let base = shown(&w).link_pose[0];
    assert!(apart(&w.model().base_pose, &base) <= EXACT);
    let heights: f64 = w.energy().potential;
    (0..200).for_each(|_| w.advance());
    let mut there = start("3dof", Base::Fixed);
    let mut m = realnoid::model::Model::clone(there.model());
    m.move_fixed_base(0, &base);
    let mut begin = START;
    begin[0].0 = -0.9;
    there = world(&m.into(), *w.settings(), &begin);
    assert!((there.energy().potential - heights).abs() <= 1e-10);
    (0..200).for_each(|_| there.advance());
    for (a, b) in axes(&w).iter().zip(axes(&there)) {
        assert!((a.0 - b.0).abs() <= 1e-9 && (a.1 - b.1).abs() <= 1e-9, "{a:?} {b:?}");
    }
}

/// What floats on a fixed base is the base of what hangs on it: it moves, and the fixed base does not.
#[test]
fn a_floating_link_is_a_base_of_its_own() {
    let text = body("3dof", ["0 0 0.2", "0 0 0", "0 0 0"], "");
    let text = text.replace("name='trunk' type='revolute'", "name='trunk' type='floating'");
    let m = model(&text, Base::Fixed);
    let knee = m.axis("knee").unwrap();
    let mut w = world(&m, settings(Integrator::SemiImplicitEuler, 0.001), &START[1..]);
    (0..50).for_each(|_| w.advance());
    let before = shown(&w);
    w.set_joint_angle(knee, -0.15, Side::Root).unwrap();
    let after = shown(&w);
    assert_eq!(before.link_pose[0], after.link_pose[0], "the fixed base");
    for (link, stays) in beyond(&w, knee).into_iter().enumerate().skip(1) {
        let moved = apart(&before.link_pose[link], &after.link_pose[link]);
        assert!(if stays { moved <= EXACT } else { moved > 1e-3 }, "{}: {moved}", m.links[link].name);
    }
    assert!(before.link_twist[1].angular.norm() > 1e-3);
    assert!((before.link_twist[1].angular - after.link_twist[1].angular).norm() <= EXACT, "its twist stays its own");
}

#[test]
fn reset_takes_a_moved_base_back_unless_it_was_remembered() {
    for base in [Base::Fixed, Base::Free] {
        let mut w = start("cardan", base);
        let before = shown(&w);
        w.set_joint_angle(2, 0.1, Side::Root).unwrap();
        let moved = shown(&w);
        w.reset();
        assert_eq!(shown(&w).link_pose, before.link_pose, "to the bit");
        w.set_joint_angle(2, 0.1, Side::Root).unwrap();
        w.remember();
        w.reset();
        assert_eq!(shown(&w).link_pose, moved.link_pose);
    }
}

#[test]
fn what_cannot_be_set_is_refused_with_the_range() {
    let mut w = start("3dof", Base::Fixed);
    let before = shown(&w);
    for (position, side) in [(1.6, Side::Tip), (-1.6, Side::Root), (f64::NAN, Side::Root), (f64::INFINITY, Side::Tip)] {
        let said = w.set_joint_angle(1, position, side).unwrap_err();
        assert!(said.contains("'h'") && said.contains("-1.5 to 1.5"), "{said}");
    }
    assert!(w.set_joint_angle(99, 0.0, Side::Tip).is_err());
    assert_eq!(shown(&w).link_pose, before.link_pose);
}

const RIG: &str = "<chain root='hip' anchor='torso'/><separate_rig name='ik_hip' of='hip'/>\
    <separate_rig name='anchored' of='hip' anchor='base'/>";

/// With axes along z, y, x: Rz(h) Ry(p) Rx(b) in the frame of h; the origin is that of the link of p.
#[test]
fn a_rig_mirrors_its_group() {
    for kind in KINDS {
        let m = model(&body(kind, ["0 0 0.2", "0 0 0", "0 0 0"], RIG), Base::Fixed);
        let mut w = world(&m, settings(Integrator::SemiImplicitEuler, 0.001), &START);
        for _ in 0..50 {
            w.advance();
            let s = shown(&w);
            let rig = rig_values(&m.rigs[0], &s);
            let at = |name: &str| s.link_pose[m.links.iter().position(|l| l.name == name).unwrap()];
            assert_eq!(rig.angles, [s.position[1], s.position[2], s.position[3]]);
            assert_eq!(rig.pose.translation, at("l2").translation, "the link of p");
            // The frames of p and b are not turned, so the last link stands as the rig does.
            assert!(rig.pose.rotation.angle_to(&at("limb").rotation) <= EXACT);
            assert!(apart(&(at("torso") * rig.in_parent), &rig.pose) <= EXACT);
            let anchored = rig_values(&m.rigs[1], &s);
            assert!(apart(&(at("base") * anchored.in_parent), &rig.pose) <= EXACT, "only its parent is another");
        }
    }
}

/// A frozen zero (G-5) turns the links and not the rig: at zero the rig stands as the group's first frame.
#[test]
fn a_rig_stands_still_at_zero_whatever_is_frozen() {
    let m = model(&body("combined_hinge", ["0 0 0.2", "0.3 0 0", "0 -0.4 0"], RIG), Base::Fixed);
    let mut w = world(&m, settings(Integrator::SemiImplicitEuler, 0.001), &[]);
    let carrier = |s: &Snapshot| s.link_pose[m.rigs[0].carrier] * m.rigs[0].frame;
    let s = shown(&w);
    assert!(rig_values(&m.rigs[0], &s).pose.rotation.angle_to(&carrier(&s).rotation) <= EXACT);
    let limb = m.links.iter().position(|l| l.name == "limb").unwrap();
    let zero = s.link_pose[limb].rotation;
    for (axis, angle) in [(1, 0.5), (2, -0.3), (3, 0.8)] {
        w.set_joint_angle(axis, angle, Side::Tip).unwrap();
    }
    // What the rig turned is what the limb turned.
    let s = shown(&w);
    let turned = rig_values(&m.rigs[0], &s).pose.rotation * carrier(&s).rotation.inverse();
    assert!(turned.angle_to(&(s.link_pose[limb].rotation * zero.inverse())) <= EXACT);
}

/// Table 6-21: the link of P if there is one, else of B, else of H.
#[test]
fn the_reference_of_a_rig_follows_the_table() {
    for (axes, reference) in [
        ("h='h' p='p' b='b'", "l2"),
        ("h='h' p='p'", "l2"),
        ("p='p' b='b'", "l2"),
        ("p='p'", "l2"),
        ("b='b'", "limb"),
        ("h='h'", "l1"),
    ] {
        let text = body("combined_hinge", ["0 0 0"; 3], "<separate_rig name='ik' of='hip'/>");
        let m = model(&text.replace("h='h' p='p' b='b'", axes), Base::Fixed);
        assert_eq!(m.links[m.rigs[0].reference.unwrap()].name, reference, "{axes}");
    }
}
