//! Contacts, discs and bounded rows together: the law checked by itself, energy, degenerate and stiff problems.

use super::problems::{Brick, Problem, impulses};
use crate::support::Random;
use nalgebra::{DVector, Vector3};
use realnoid::solver::{Kind, Rows};

/// Residual that is asked for, relative.
const AIM: f64 = 1e-10;
/// Residual that counts as solved.
const SOLVED: f64 = 1e-9;
/// Velocity that gravity gives in a step of 1 ms.
const FALL: f64 = 9.81e-3;
const HALF: Vector3<f64> = Vector3::new(0.2, 0.15, 0.1);

/// 100 000 random problems from nothing: not one NaN, at least 99.9 % solved, and what claims to be solved is so by an
/// independent check of the law. The rows are unrelated directions, harder than those of bodies.
#[test]
fn random_problems_are_solved() {
    let mut rng = Random(101);
    let (mut solved, mut tries, mut rows) = (0u32, 0, Rows::new(20));
    const COUNT: u32 = 100_000;
    for n in 0..COUNT {
        let (contacts, others) = (1 + rng.next() as usize % 4, rng.next() as usize % 3);
        let problem = Problem::random((contacts, others), 6 + rng.next() as usize % 13, true, &mut rng);
        problem.write(&mut rows);
        let s = rows.solve(10, AIM);
        let x = impulses(&rows);
        assert!(s.residual.is_finite() && x.iter().all(|x| x.is_finite()), "{n}: {s:?}");
        let violation = problem.violation(&x);
        assert!(violation <= 10.0 * s.residual + 1e-12 * s.scale.max(x.amax()), "{n}: {violation:e} against {s:?}");
        solved += u32::from(s.within(SOLVED));
        tries += s.tries;
    }
    println!("{} of {COUNT} not solved, {:.2} tries each", COUNT - solved, f64::from(tries) / f64::from(COUNT));
    assert!(solved >= COUNT / 1000 * 999, "{solved}");
}

/// Contacts never make energy: `x·(u_free + u_end)/2 ≤ 0`, to rounding and the residual.
#[test]
fn energy_never_grows() {
    let mut rng = Random(102);
    for n in 0..5000 {
        let problem = Problem::random((1 + n % 6, n % 3), 6 + n % 20, false, &mut rng);
        let mut rows = problem.rows();
        let s = rows.solve(10, 1e-13);
        let x = impulses(&rows);
        let (free, end) = (&problem.bias, problem.velocity(&x));
        let gain = 0.5 * x.dot(&(free + &end));
        let size: f64 =
            x.iter().zip(free.iter().zip(end.iter())).map(|(x, (a, b))| (x * a).abs() + (x * b).abs()).sum();
        assert!(gain <= 1e-12 * size + x.lp_norm(1) * s.residual, "{n}: {gain:e} of {size:e}, {s:?}");
    }
}

/// The finish finds what 20 000 sweeps find, where the answer is one (little friction, rows that do not depend).
#[test]
fn the_finish_agrees_with_many_sweeps() {
    let mut rng = Random(103);
    let mut with_tries = 0;
    for n in 0..300 {
        let mut problem = Problem::random((4, 2), 24, true, &mut rng);
        for (kind, _) in &mut problem.kinds {
            if let Kind::Cone { friction } = kind {
                *friction *= 0.25;
            }
        }
        let (mut quick, mut slow) = (problem.rows(), problem.rows());
        let s = quick.solve(3, 1e-12);
        with_tries += u32::from(s.tries > 0);
        let reference = slow.solve(20_000, 1e-13);
        let (x, y) = (impulses(&quick), impulses(&slow));
        assert!(s.within(1e-12) && reference.within(1e-12), "{n}: {s:?} {reference:?}");
        assert!((&x - &y).amax() <= 1e-8 * y.amax().max(1.0), "{n}: {:e}", (&x - &y).amax());
    }
    assert!(with_tries > 200, "{with_tries}");
}

/// A box on its four corners: internal forces are not determined, the motion is.
#[test]
fn a_box_on_four_corners() {
    for (push, slides) in [(0.3, false), (0.499, false), (0.501, true), (2.0, true)] {
        let mass = 3.0;
        let brick = Brick::new(0, mass, HALF, Vector3::new(0.0, 0.0, HALF.z));
        let mut problem = Problem::new(6);
        corners(&mut problem, (&brick, None), 0.0, 0.5, [-FALL, push * FALL, 0.0]);
        let mut rows = problem.rows();
        let s = rows.solve(10, AIM);
        let x = impulses(&rows);
        let sum = |k: usize| (0..4).map(|c| x[3 * c + k]).sum::<f64>();
        assert!(s.within(AIM), "{push}: {s:?}");
        let small = 1e-8 * mass * FALL;
        assert!((sum(0) - mass * FALL).abs() <= small, "{push}: carries its weight");
        let friction = -push.min(0.5) * mass * FALL;
        assert!((sum(1) - friction).abs() <= small && sum(2).abs() <= small, "{push}: {x}");
        let speed = problem.velocity(&x)[1];
        assert!((speed - if slides { (push - 0.5) * FALL } else { 0.0 }).abs() <= 1e-8 * FALL, "{push}: {speed}");
    }
}

/// Five boxes on top of each other, the last 1000 times as heavy: each carries what is above it, to 1e-9 of that.
#[test]
fn a_heavy_box_on_a_stack() {
    let mass = |k: usize| if k == 4 { 1000.0 } else { 1.0 };
    let bricks: Vec<Brick> =
        (0..5).map(|k| Brick::new(k, mass(k), HALF, Vector3::new(0.0, 0.0, HALF.z * (2 * k + 1) as f64))).collect();
    let mut problem = Problem::new(30);
    for k in 0..5 {
        let below = if k > 0 { Some(&bricks[k - 1]) } else { None };
        let fall = if k == 0 { -FALL } else { 0.0 };
        corners(&mut problem, (&bricks[k], below), HALF.z * (2 * k) as f64, 0.5, [fall, 0.0, 0.0]);
    }
    let mut rows = problem.rows();
    assert_eq!(rows.rows().len(), 60);
    let s = rows.solve(10, AIM);
    assert!(s.within(AIM), "{s:?}");
    let x = impulses(&rows);
    for k in 0..5 {
        let carried: f64 = (0..4).map(|c| x[12 * k + 3 * c]).sum();
        let above: f64 = (k..5).map(mass).sum::<f64>() * FALL;
        assert!((carried - above).abs() <= 1e-9 * above, "box {k} carries {carried}, not {above}");
    }
}

/// Two feet of four points on one body each, joined by a heavy trunk through stiff equalities: a standing robot in rough.
#[test]
fn standing_on_eight_points() {
    let feet: Vec<Brick> = (0..2).map(|k| Brick::new(k, 1.0, HALF, Vector3::new(k as f64, 0.0, HALF.z))).collect();
    let trunk = Brick::new(2, 60.0, HALF * 2.0, Vector3::new(0.5, 0.0, 1.0));
    let mut problem = Problem::new(18);
    for foot in &feet {
        let at = foot.center + Vector3::new(0.0, 0.0, HALF.z);
        for d in [Vector3::x(), Vector3::y(), Vector3::z()] {
            for turn in [false, true] {
                let mut y = DVector::zeros(18);
                if turn {
                    trunk.write_turn(&mut y, d);
                    foot.write_turn(&mut y, -d);
                } else {
                    trunk.write(&mut y, at, d);
                    foot.write(&mut y, at, -d);
                }
                problem.add(Kind::EQUALITY, &[(y, 0.0)]);
            }
        }
        corners(&mut problem, (foot, None), 0.0, 0.8, [-FALL, 0.1 * FALL, 0.0]);
    }
    let mut rows = problem.rows();
    let s = rows.solve(10, AIM);
    assert!(s.within(AIM), "{s:?}");
    let x = impulses(&rows);
    let carried: f64 = [6, 24].iter().flat_map(|f| (0..4).map(move |c| f + 3 * c)).map(|k| x[k]).sum();
    assert!((carried - 62.0 * FALL).abs() <= 1e-8 * 62.0 * FALL, "{carried}");
}

/// A bounce: the floor of the normal velocity is not 0. And a spinning, rolling ball loses what its discs allow.
#[test]
fn bounces_and_discs() {
    let ball = Brick { column: 0, mass: 2.0, inertia: Vector3::repeat(0.008), center: Vector3::new(0.0, 0.0, 0.1) };
    let mut problem = Problem::new(6);
    let (before, restitution) = (3.0, 0.6);
    problem.stack_contact((&ball, None), Vector3::zeros(), 0.4, [-before - restitution * before, 0.0, 0.0]);
    for (d, ratio) in [(vec![Vector3::z()], 0.02), (vec![Vector3::x(), Vector3::y()], 0.01)] {
        let rows: Vec<_> = d
            .iter()
            .map(|d| {
                let mut y = DVector::zeros(6);
                ball.write_turn(&mut y, *d);
                (y, if d.z > 0.0 { 50.0 } else { 40.0 })
            })
            .collect();
        problem.add(Kind::Disc { ratio, normal: 0 }, &rows);
    }
    // It rolls about both axes, without slip where it touches.
    (problem.bias[1], problem.bias[2]) = (0.0, 0.0);
    let mut rows = problem.rows();
    let s = rows.solve(10, AIM);
    let x = impulses(&rows);
    let push = 2.0 * (1.0 + restitution) * before;
    assert!(s.within(AIM) && (x[0] - push).abs() <= 1e-9 * push, "{s:?} {x}");
    assert!((x[3] + 0.02 * push).abs() <= 1e-9 * push, "spins on, against the full friction: {x}");
    let (rolling, turn) = (x[4].hypot(x[5]), problem.velocity(&x));
    assert!((rolling - 0.01 * push).abs() <= 1e-9 * push, "{x}");
    assert!(
        (x[4] * turn[5] - x[5] * turn[4]).abs() <= 1e-7 * rolling * turn[4].abs(),
        "against the rolling: {x} {turn}"
    );
}

/// Problems that change a little from one to the next: warm starts need less than starts from nothing.
#[test]
fn warm_starts_help() {
    let mut rng = Random(104);
    let problem = Problem::random((6, 2), 40, false, &mut rng);
    let (mut warm, mut cold) = ([0, 0], [0, 0]);
    let mut rows = problem.rows();
    for step in 0..200 {
        let mut now = problem.rows();
        for (k, row) in (0..problem.bias.len()).zip(problem.bias.iter()) {
            let bias = row + 0.02 * (0.05 * f64::from(step) + k as f64).sin();
            let (block, n) = place(&problem, k);
            now.row(block, n).bias = bias;
            rows.row(block, n).bias = bias;
        }
        for (solved, count) in [(now.solve(30, SOLVED), &mut cold), (rows.solve(30, SOLVED), &mut warm)] {
            assert!(solved.within(SOLVED), "{step}: {solved:?}");
            (count[0], count[1]) = (count[0] + solved.sweeps, count[1] + solved.tries);
        }
    }
    assert!(warm[0] * 4 < cold[0] * 3, "sweeps, tries: warm {warm:?}, cold {cold:?}");
}

/// Block and row in it of the row `k`.
fn place(problem: &Problem, k: usize) -> (usize, usize) {
    let mut first = 0;
    for (block, (_, count)) in problem.kinds.iter().enumerate() {
        if k < first + count {
            return (block, k - first);
        }
        first += count;
    }
    unreachable!()
}

/// Contacts at the four corners of a box, at this height.
fn corners(problem: &mut Problem, bricks: (&Brick, Option<&Brick>), height: f64, friction: f64, bias: [f64; 3]) {
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let at = Vector3::new(bricks.0.center.x + x * HALF.x, y * HALF.y, height);
        problem.stack_contact(bricks, at, friction, bias);
    }
}
