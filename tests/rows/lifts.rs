//! The position pass.

use crate::support::Random;
use nalgebra::{DMatrix, DVector};
use realnoid::solver::{Kind, Lift, LiftKind, Rows};

/// Rows with these responses, each a block of one row.
fn rows_of(y: &DMatrix<f64>, kind: Kind) -> Rows {
    let width = y.ncols().next_multiple_of(4);
    let mut rows = Rows::new(width);
    let ids: Vec<u32> = (0..width as u32 / 4).collect();
    for k in 0..y.nrows() {
        let block = rows.add(kind, 1, &ids);
        for j in 0..y.ncols() {
            rows.response(block, 0).1[j] = y[(k, j)];
        }
        rows.row(block, 0).softness = 0.1;
        rows.seal(block);
    }
    rows
}

/// Complementarity with the exact dense matrix, to 1e-10 of the velocities; random rows, as many as the rank and more
/// than that.
#[test]
fn lifts_are_complementary() {
    let mut rng = Random(71);
    let (mut lifted, mut apart) = (0, 0);
    for (seed, (n, rank)) in
        [(6, 6), (12, 20), (24, 6), (40, 12), (60, 30), (60, 64)].into_iter().cycle().take(300).enumerate()
    {
        let y = DMatrix::from_fn(n, rank, |_, _| rng.unit());
        // What a motion can undo: else the question has no answer.
        let motion = DVector::from_fn(rank, |_, _| rng.unit());
        let bias = -&y * motion - DVector::from_fn(n, |_, _| (0.5 * rng.unit()).min(0.0));
        let mut rows = rows_of(&y, Kind::EQUALITY);
        for k in 0..n {
            let kind = [LiftKind::AtLeast, LiftKind::AtLeast, LiftKind::Off][k % 3];
            *rows.lift(k) = Lift { kind, bias: bias[k], impulse: 0.0 };
        }
        let solved = rows.solve_lifts(10, 1e-10);
        assert!(solved.within(1e-10), "{seed}: {n} rows of rank {rank}: {solved:?}");
        let p = DVector::from_fn(n, |k, _| rows.lift(k).impulse);
        let u = &bias + &y * (y.transpose() * &p);
        for k in 0..n {
            if k % 3 == 2 {
                assert_eq!(p[k], 0.0);
                continue;
            }
            let own = y.row(k).norm_squared();
            assert!(
                p[k] >= 0.0 && (p[k] * own).min(u[k]).abs() <= 2e-10 * solved.scale,
                "{seed} {k}: {} {}",
                p[k],
                u[k]
            );
            if p[k] > 0.0 { lifted += 1 } else { apart += 1 }
        }
        assert!(rows.rows().iter().all(|r| r.impulse == 0.0), "the velocity pass is not touched");
    }
    assert!(lifted > 500 && apart > 500, "{lifted} {apart}");
}

/// Equalities beside inequalities, and only the first row of a contact counts.
#[test]
fn exact_lifts_and_contacts() {
    let mut rng = Random(72);
    for _ in 0..100 {
        let y = DMatrix::from_fn(9, 9, |_, _| rng.unit());
        let mut rows = Rows::new(12);
        let ids = [0, 1, 2];
        for c in 0..3 {
            let block = rows.add(Kind::Cone { friction: 0.7 }, 3, &ids);
            for n in 0..3 {
                (0..9).for_each(|j| rows.response(block, n).1[j] = y[(3 * c + n, j)]);
                rows.row(block, n).bias = -1.0;
            }
            rows.seal(block);
            let kind = if c == 0 { LiftKind::Exactly } else { LiftKind::AtLeast };
            *rows.lift(block) = Lift { kind, bias: rng.unit(), impulse: 0.0 };
        }
        let solved = rows.solve_lifts(3, 1e-11);
        assert!(solved.within(1e-11), "{solved:?}");
        let p: Vec<f64> = (0..3).map(|b| rows.lift(b).impulse).collect();
        let u: Vec<f64> = (0..3)
            .map(|a| rows.lift(a).bias + (0..3).map(|b| y.row(3 * a).dot(&y.row(3 * b)) * p[b]).sum::<f64>())
            .collect();
        let small = 1e-10 * solved.scale;
        assert!(u[0].abs() <= small, "{u:?}");
        assert!((1..3).all(|k| p[k] >= 0.0 && u[k] >= -small && (p[k] == 0.0 || u[k] <= small)), "{p:?} {u:?}");
    }
}

/// Nothing asked, nothing done; a block that is off takes no part; blocks that were dropped are forgotten.
#[test]
fn idle_lifts() {
    let y = DMatrix::identity(4, 4);
    let mut rows = rows_of(&y, Kind::EQUALITY);
    assert_eq!(rows.solve_lifts(10, 1e-10).sweeps, 0);
    *rows.lift(3) = Lift { kind: LiftKind::AtLeast, bias: -1.0, impulse: 0.0 };
    rows.switch_off(3);
    assert_eq!(rows.solve_lifts(10, 1e-10).residual, 0.0);
    rows.truncate(3);
    let again = rows.add(Kind::EQUALITY, 1, &[0]);
    assert_eq!((again, rows.lift(3).kind, rows.rows().len()), (3, LiftKind::Off, 4));
}
