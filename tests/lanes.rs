//! Robots side by side in one pass get the bits that they get alone.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::dynamics::{AbaBatch, BallIn, CHUNK, DofIn, Kinematics, LaneKind, Limbs, Push, Response};
use realnoid::dynamics::{Workspace, aba, aba_fused, aba_hybrid, aba_limbs, kinematics, kinematics_of, take_turns};
use realnoid::math::{M3, V3};
use realnoid::model::{JointType, Model};
use std::sync::Arc;
use support::{ALL, Random, state, tree};

const GRAVITY: [f64; 3] = [0.3, -0.2, -9.81];

/// Random trees of all joints, chains of each, a long chain, and a tree as a humanoid's.
fn models() -> Vec<Model> {
    let mixed = |seed: u64| {
        let joints: Vec<JointType> = (0..12).map(|i| ALL[(i + seed as usize) % 5]).collect();
        tree(&joints, false, seed)
    };
    let mut all: Vec<Model> = (0..10).map(mixed).collect();
    all.extend(ALL.map(|joint| tree(&[joint; 6], true, 77)));
    all.push(tree(&[JointType::Revolute; 200], true, 5));
    let mut joints = [JointType::Revolute; 30];
    joints[0] = JointType::Floating;
    all.push(tree(&joints, false, 11));
    let others: Vec<Model> = all.iter().zip(20..).map(|(m, seed)| aligned(m, seed)).collect();
    all.extend(others);
    all
}

/// The same with two of three joints along axes of their parents' frames, either way, turned by any angle about them.
fn aligned(m: &Model, seed: u64) -> Model {
    let (mut rng, mut m) = (Random(seed), m.clone());
    for b in &mut m.bodies[1..] {
        let (s, c) = (rng.unit() * 6.0).sin_cos();
        let (x, y, z) = (V3::new(c, -s, 0.0), V3::new(s, c, 0.0), V3::new(0.0, 0.0, 1.0));
        let r = match rng.next() % 9 {
            0 => [z, x, y],
            1 => [y, z, x],
            2 => [x, y, z],
            3 => [-z, y, x],
            4 => [x, -z, y],
            5 => [y, x, -z],
            _ => continue,
        };
        b.put((M3 { r }, b.tree_p));
        assert!(b.along.is_some() && b.tree_r == M3 { r });
    }
    m
}

fn posed(m: &Model, (q, v, _): &Robot) -> (Vec<M3<f64>>, [Vec<V3<f64>>; 3]) {
    let mut k = Kinematics::new(m);
    kinematics(m, &mut k, q, v);
    (k.r, [k.p, k.w, k.v])
}

#[test]
fn zeros_that_are_left_out_change_no_bit() {
    let mut seen = [0; 3];
    for (n, m) in models().iter().chain(&branched()).enumerate() {
        let m = aligned(m, n as u64);
        let mut whole = m.clone();
        whole.bodies.iter_mut().for_each(|b| b.along = None);
        m.bodies.iter().filter_map(|b| b.along).for_each(|along| seen[along as usize] += 1);
        for robot in robots(&m, 4, &mut Random(n as u64)) {
            assert!(posed(&m, &robot) == posed(&whole, &robot), "model {n}");
            for kind in [LaneKind::Four, LaneKind::FourFused].into_iter().filter(|kind| kind.is_available()) {
                assert_eq!(bits(&alone(&m, &robot, kind)), bits(&alone(&whole, &robot, kind)), "model {n}, {kind:?}");
            }
        }
    }
    assert!(seen.iter().all(|n| *n > 20), "{seen:?}");
}

type Robot = (Vec<f64>, Vec<f64>, Vec<f64>);

/// One of the angles is so large that its lane leaves the common reduction.
fn robots(m: &Model, count: usize, rng: &mut Random) -> Vec<Robot> {
    let mut robots: Vec<Robot> = (0..count)
        .map(|_| {
            let (q, v) = state(m, rng, 2.0);
            (q, v, rng.many(m.nv, 5.0))
        })
        .collect();
    if let Some(b) = m.bodies[1..].iter().find(|b| b.joint == JointType::Revolute) {
        robots[count / 2].0[b.q] = 3.0e7;
    }
    robots
}

fn alone(m: &Model, robot: &Robot, kind: LaneKind) -> Vec<f64> {
    let (q, v, tau) = robot;
    let mut out = vec![0.0; m.nv];
    if matches!(kind, LaneKind::FourFused | LaneKind::EightFused) {
        assert!(aba_fused(m, &mut Workspace::new(m), (q, v), tau, GRAVITY, &mut out));
    } else {
        aba(m, &mut Workspace::new(m), (q, v), tau, GRAVITY, &mut out);
    }
    out
}

fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

fn check(m: &Model, kind: LaneKind, count: usize, name: &str) {
    let mut rng = Random(count as u64 + 3);
    let robots = robots(m, count, &mut rng);
    let mut batch = AbaBatch::new(m, count, kind);
    assert_eq!((batch.robots(), batch.width()), (count, kind.width()));
    for (n, (q, v, tau)) in robots.iter().enumerate() {
        batch.set(n, (q, v), tau);
    }
    let mut out = vec![0.0; m.nv];
    for again in 0..2 {
        batch.solve(m, GRAVITY);
        for (n, robot) in robots.iter().enumerate() {
            batch.accelerations(n, &mut out);
            assert!(out.iter().all(|x| x.is_finite()));
            assert_eq!(
                bits(&out),
                bits(&alone(m, robot, kind)),
                "{name}, {kind:?}, robot {n} of {count}, time {again}"
            );
        }
    }
}

#[test]
fn every_robot_has_the_bits_it_has_alone() {
    for kind in LaneKind::ALL.into_iter().filter(|kind| kind.is_available()) {
        for (n, m) in models().iter().enumerate() {
            check(m, kind, kind.width(), &format!("model {n}"));
        }
    }
}

#[test]
fn any_number_of_robots() {
    for kind in LaneKind::ALL.into_iter().filter(|kind| kind.is_available()) {
        let m = &models()[3];
        for count in 1..=2 * kind.width() + 1 {
            check(m, kind, count, "a tree");
        }
    }
}

#[test]
fn none_at_all_and_a_model_without_joints() {
    let m = &models()[0];
    AbaBatch::new(m, 0, LaneKind::best()).solve(m, GRAVITY);
    let rigid = &tree(&[], false, 1);
    let mut batch = AbaBatch::new(rigid, 5, LaneKind::best());
    batch.set(4, (&[], &[]), &[]);
    batch.solve(rigid, GRAVITY);
    batch.accelerations(4, &mut []);
}

#[test]
fn what_the_machine_has_not_is_computed_portably() {
    let m = &models()[1];
    for kind in LaneKind::ALL {
        let width = AbaBatch::new(m, 9, kind).width();
        assert_eq!(width, if kind.is_available() { kind.width() } else { LaneKind::Portable.width() });
    }
}

/// Trees of revolute joints, on the world or on a body that floats, slides or turns; and a humanoid's: limbs of 6, 6, 7, 7.
fn branched() -> Vec<Model> {
    let with_root = |root: JointType, seed: u64, size: usize| {
        let mut joints = vec![JointType::Revolute; size];
        joints[0] = root;
        tree(&joints, false, seed)
    };
    let mut all: Vec<Model> = (0..30).map(|seed| with_root(ALL[seed as usize % 5], seed, 25)).collect();
    all.push(tree(&[JointType::Revolute; 9], true, 5));
    for root in [JointType::Floating, JointType::Revolute] {
        let mut m = with_root(root, 50, 30);
        let parents =
            [1, 2, 3, 4, 5, 6, 1, 8, 9, 10, 11, 12, 1, 14, 15, 16, 17, 18, 19, 20, 21, 22, 16, 24, 25, 26, 27, 28, 29];
        m.bodies[2..].iter_mut().zip(parents).for_each(|(b, parent)| b.parent = parent);
        all.push(m);
    }
    let others: Vec<Model> = all.iter().zip(50..).map(|(m, seed)| aligned(m, seed)).collect();
    all.extend(others);
    all
}

#[test]
fn limbs_side_by_side_have_the_bits_of_the_whole() {
    for (n, m) in branched().iter().enumerate() {
        let Some(mut limbs) = Limbs::new(m) else { continue };
        let (mut rng, mut ws) = (Random(n as u64 + 9), Workspace::new(m));
        for _ in 0..3 {
            let robot = robots(m, 1, &mut rng).remove(0);
            let mut out = vec![0.0; m.nv];
            aba_limbs(m, (&mut ws, &mut limbs), (&robot.0, &robot.1), &robot.2, GRAVITY, &mut out);
            assert_eq!(bits(&out), bits(&alone(m, &robot, LaneKind::Four)), "model {n}");
        }
    }
}

#[test]
fn it_is_done_where_it_pays() {
    let pays = |m: &Model| Workspace::<f64>::new(m).put_side_by_side(m);
    let models = branched();
    assert_eq!(pays(&models[31]), Limbs::new(&models[31]).is_some(), "a humanoid");
    assert!(!pays(&tree(&[JointType::Revolute; 9], true, 5)), "a chain");
    assert!(!pays(&tree(&[JointType::Floating], true, 5)), "a single body");
    assert!(!pays(&tree(&[], true, 5)), "nothing");
}

#[test]
fn joints_that_are_not_revolute_stay_where_they_are() {
    assert!(Limbs::new(&models()[0]).is_none());
}

/// Torques, diagonals and locks at random, from none to all.
fn inputs(ws: &mut Workspace<f64>, share: f64, rng: &mut Random) {
    for input in &mut ws.dofs {
        let (tau, x) = (5.0 * rng.unit(), rng.unit());
        *input = match x.abs() {
            x if x < share / 2.0 => DofIn::locked(tau),
            x if x < share => DofIn::implicit(tau, 0.3 * x),
            _ => DofIn::free(tau),
        };
    }
    for (n, input) in ws.ball_in.iter_mut().enumerate() {
        *input = BallIn { tau: rng.vec3(5.0).into(), ..BallIn::default() };
        for _ in 0..if share > 0.0 { (rng.next() as usize + n) % 4 } else { 0 } {
            input.add_lock(rng.vec3(1.0).into(), rng.unit());
        }
    }
}

/// All that is read after a pass: accelerations, reactions, mobilities, and a row of every body.
fn outcome(m: &Model, ws: &mut Workspace<f64>, (q, v): (&[f64], &[f64])) -> Vec<f64> {
    let (mut out, mut response) = (vec![0.0; m.nv], Response::new(m));
    aba_hybrid(m, ws, (q, v), GRAVITY, &mut out);
    out.extend_from_slice(&ws.reaction);
    out.extend((0..m.nv).map(|v| ws.mobility(v)));
    out.extend(ws.ball_in.iter().flat_map(|b| b.lock[..b.locks].iter().map(|lock| lock.reaction)));
    out.extend((0..m.balls).map(|ball| ws.ball_mobility(ball, V3::new(0.3, -0.5, 0.7))));
    response.refresh(m, ws);
    for body in 1..m.bodies.len() {
        let (torque, force) = (V3::new(0.3, -0.2, 0.9), V3::new(1.0, 0.4, -0.7));
        let pushes = [Push { body, torque, force, own: [0.1; 6] }, Push::default()];
        let ids = response.layout.chunks(body).to_vec();
        let mut row = vec![0.0; CHUNK * ids.len()];
        response.row(m, ws, q, &pushes, (&ids, &mut row));
        out.extend(row);
    }
    out
}

#[test]
fn hybrid_dynamics_leave_the_same_bits_behind() {
    let mut side_by_side = 0;
    for (n, m) in branched().iter().enumerate() {
        let (mut rng, mut one, mut four) = (Random(n as u64 + 70), Workspace::new(m), Workspace::new(m));
        side_by_side += usize::from(four.put_side_by_side(m));
        for share in [0.0, 0.3, 0.7, 1.3, 2.0, 0.0] {
            let (q, v) = state(m, &mut rng, 2.0);
            inputs(&mut one, share, &mut rng);
            (four.dofs, four.ball_in) = (one.dofs.clone(), one.ball_in.clone());
            let (a, b) = (outcome(m, &mut one, (&q, &v)), outcome(m, &mut four, (&q, &v)));
            assert_eq!(bits(&a), bits(&b), "model {n}, {share} of the inputs not plain");
        }
    }
    assert!(side_by_side > 10 || Limbs::new(&branched()[1]).is_none(), "only {side_by_side}");
}

/// Robots that ask in turns get one pass, and find in their workspaces what they would find alone: of any joints, with any locks.
#[test]
fn common_passes_leave_the_same_bits_behind() {
    let all: Vec<Arc<Model>> = models().into_iter().chain(branched()).map(Arc::new).collect();
    for (n, m) in all.iter().enumerate() {
        let task = |seed: u64| {
            let m = m.clone();
            move || {
                let (mut rng, mut ws, mut all) = (Random(seed), Workspace::new(&m), vec![]);
                for share in [0.0, 0.5, 0.5, 1.3, 2.0] {
                    let (q, v) = state(&m, &mut rng, 2.0);
                    inputs(&mut ws, share, &mut rng);
                    all.extend(bits(&outcome(&m, &mut ws, (&q, &v))));
                }
                all
            }
        };
        for kind in LaneKind::ALL.into_iter().filter(|kind| kind.is_available()) {
            let (mut left, mut found) = ((0..11).map(|k| (k, task(k))), 0);
            let next = || left.next().map(|(k, task)| move || (k, task()));
            let asked = take_turns(
                (kind, kind.width()),
                || 0.0,
                next,
                |(k, all)| {
                    assert!(all == task(k)(), "model {n}, robot {k}, {kind:?}");
                    found += 1;
                },
            );
            assert_eq!((found, asked.all), (11, 55));
            let all = asked.together == 55 || m.balls > 0 && asked.together >= kind.width() as u64;
            assert!(all, "model {n}: {asked:?}");
        }
    }
}

/// A pass that leaves no factor leaves the same accelerations, reactions and mobilities; rows would not be numbers, and are again after the next.
#[test]
fn frugal_passes_leave_no_factor() {
    for m in branched().iter().filter(|m| Workspace::<f64>::new(m).put_side_by_side(m)) {
        let (mut rng, mut ws, mut frugal) = (Random(5), Workspace::new(m), Workspace::new(m));
        frugal.put_side_by_side(m);
        for frugally in [true, false] {
            let (q, v) = state(m, &mut rng, 2.0);
            inputs(&mut ws, 0.5, &mut rng);
            (frugal.dofs, frugal.ball_in, frugal.frugal) = (ws.dofs.clone(), ws.ball_in.clone(), frugally);
            let (whole, mut other) = (outcome(m, &mut ws, (&q, &v)), outcome(m, &mut frugal, (&q, &v)));
            let kept = if frugally { 3 * m.nv } else { whole.len() };
            assert!(!frugally || other[kept..].iter().any(|x| x.is_nan()));
            other.truncate(kept);
            assert_eq!(bits(&other), bits(&whole[..kept]));
        }
    }
}

/// What stands on the world may be moved between two passes.
#[test]
fn a_base_that_is_moved_is_seen() {
    let mut m = tree(&[JointType::Revolute; 20], false, 8);
    let (mut rng, mut limbs) = (Random(4), Limbs::new(&m));
    let Some(limbs) = &mut limbs else { return };
    for _ in 0..2 {
        let (robot, mut out) = (robots(&m, 1, &mut rng).remove(0), vec![0.0; m.nv]);
        aba_limbs(&m, (&mut Workspace::new(&m), limbs), (&robot.0, &robot.1), &robot.2, GRAVITY, &mut out);
        assert_eq!(bits(&out), bits(&alone(&m, &robot, LaneKind::Four)));
        let turned = rng.rotation();
        for b in m.bodies[1..].iter_mut().filter(|b| b.parent == 0) {
            b.tree_r = realnoid::math::M3::from(*turned.to_rotation_matrix().matrix()).mm(&b.tree_r);
            b.tree_p.x += 0.3;
        }
    }
}

/// Frames and velocities of the whole robot, limbs side by side where that pays, and of each body after its parent.
#[test]
fn frames_of_limbs_have_the_bits_of_one_after_the_other() {
    let mut rng = Random(91);
    let mut all = branched();
    all.extend(models());
    for (n, m) in all.iter().enumerate() {
        let bodies: Vec<usize> = (1..m.bodies.len()).collect();
        let (mut together, mut in_turn) = (Kinematics::new(m), Kinematics::new(m));
        for (q, v, _) in robots(m, 5, &mut rng) {
            kinematics(m, &mut together, &q, &v);
            kinematics_of(m, &mut in_turn, (&q, &v), &bodies);
            for i in 0..m.bodies.len() {
                let all = |k: &Kinematics| {
                    let [a, b, c] = k.r[i].r;
                    let v = [a, b, c, k.p[i], k.w[i], k.v[i]];
                    bits(&v.iter().flat_map(|v| [v.x, v.y, v.z]).collect::<Vec<f64>>())
                };
                assert_eq!(all(&together), all(&in_turn), "model {n}, body {i}");
            }
        }
    }
}

/// What stands on the world may be moved while the room that was made for the model stays.
#[test]
fn frames_follow_a_base_that_is_moved() {
    let mut rng = Random(92);
    for mut m in branched() {
        let (mut together, mut in_turn) = (Kinematics::new(&m), Kinematics::new(&m));
        let moved: Vec<usize> = (1..m.bodies.len()).filter(|i| m.bodies[*i].parent == 0).collect();
        moved.iter().for_each(|i| m.bodies[*i].tree_p = V3::new(0.3, -1.2, 2.5));
        let (q, v) = state(&m, &mut rng, 2.0);
        kinematics(&m, &mut together, &q, &v);
        kinematics_of(&m, &mut in_turn, (&q, &v), &(1..m.bodies.len()).collect::<Vec<usize>>());
        assert!(together.p == in_turn.p && together.r == in_turn.r);
    }
}
