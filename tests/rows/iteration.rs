//! Gauss–Seidel and the direct finish, on problems made from dense matrices.

use crate::support::Random;
use nalgebra::{DMatrix, DVector};
use realnoid::solver::{FINISH_ROWS, Kind, Rows};

/// Relative residual that is asked for.
const AIM: f64 = 1e-11;

/// A w as wide as the problem: row k of the Cholesky factor of H is the response of row k.
struct Problem {
    h: DMatrix<f64>,
    bias: DVector<f64>,
}

impl Problem {
    /// `B Bᵀ` with rows of very different sizes: sizes from 1 to `ratio`.
    fn random(n: usize, ratio: f64, rng: &mut Random) -> Self {
        let scale: Vec<f64> = (0..n).map(|_| ratio.powf(0.5 * rng.unit().abs())).collect();
        let b = DMatrix::from_fn(n, n + 3, |i, _| scale[i] * rng.unit());
        let bias = DVector::from_fn(n, |i, _| scale[i] * rng.unit());
        Self { h: &b * b.transpose(), bias }
    }

    /// The rows as blocks of these kinds and sizes.
    fn rows(&self, blocks: &[(Kind, usize)]) -> Rows {
        let n = self.h.nrows();
        let l = self.h.clone().cholesky().unwrap().l();
        let mut rows = Rows::new(n.next_multiple_of(4));
        let ids: Vec<u32> = (0..n.div_ceil(4) as u32).collect();
        let mut first = 0;
        for (kind, count) in blocks {
            let block = rows.add(*kind, *count, &ids);
            for k in 0..*count {
                for j in 0..n {
                    rows.response(block, k).1[j] = l[(first + k, j)];
                }
                rows.row(block, k).bias = self.bias[first + k];
            }
            rows.seal(block);
            first += count;
        }
        rows
    }
}

fn impulses(rows: &Rows) -> DVector<f64> {
    DVector::from_iterator(rows.rows().len(), rows.rows().iter().map(|r| r.impulse))
}

/// Equalities: the finish gives the dense solution whatever the mass ratio; the iteration alone gets there if it is allowed
/// to, and the residual says how far it is.
#[test]
fn equalities_agree_with_the_dense_solution() {
    for (seed, ratio) in [(1, 1.0), (2, 1e3), (3, 1e6)] {
        let p = Problem::random(12, ratio, &mut Random(seed));
        let exact = p.h.clone().cholesky().unwrap().solve(&-&p.bias);
        let mut rows = p.rows(&[(Kind::EQUALITY, 1); 12]);
        let solved = rows.solve(10, AIM);
        assert!(solved.within(AIM) && solved.tries >= 1, "{ratio}: {solved:?}");
        assert!((impulses(&rows) - &exact).norm() <= 1e-8 * exact.norm(), "{ratio}");
        // Warm: nothing to do.
        let warm = rows.solve(10, AIM);
        assert!(warm.within(AIM) && warm.sweeps <= 2 && warm.tries <= 1, "{warm:?}");
    }
    // Without the finish (too many rows for it): sweeps alone, linear convergence.
    let p = Problem::random(FINISH_ROWS + 20, 1e2, &mut Random(4));
    let mut rows = p.rows(&[(Kind::EQUALITY, 1); FINISH_ROWS + 20]);
    let rough = rows.solve(10, AIM);
    let fine = rows.solve(2000, AIM);
    assert!(rough.tries == 0 && fine.tries == 0 && fine.residual < 0.1 * rough.residual, "{rough:?} {fine:?}");
}

/// Bounds: complementarity of every row, from rows that hit bounds and rows that do not.
#[test]
fn bounds_are_kept() {
    let mut rng = Random(21);
    let (mut at_bound, mut free) = (0, 0);
    for seed in 0..200 {
        let p = Problem::random(10, 1e3, &mut rng);
        let bounds: Vec<(Kind, usize)> = (0..10)
            .map(|k| match k % 3 {
                0 => (Kind::Bounds { lower: 0.0, upper: f64::INFINITY }, 1),
                1 => (Kind::Bounds { lower: -0.1, upper: 0.1 }, 1),
                _ => (Kind::EQUALITY, 1),
            })
            .collect();
        let mut rows = p.rows(&bounds);
        let solved = rows.solve(50, AIM);
        assert!(solved.within(AIM), "{seed}: {solved:?}");
        let x = impulses(&rows);
        let u = &p.h * &x + &p.bias;
        let small = 1e-10 * p.bias.amax().max((&p.h * &x).amax());
        for (k, (kind, _)) in bounds.iter().enumerate() {
            let Kind::Bounds { lower, upper } = *kind else { continue };
            assert!(x[k] >= lower && x[k] <= upper);
            let fits = u[k].abs() <= small || (x[k] == lower && u[k] > 0.0) || (x[k] == upper && u[k] < 0.0);
            assert!(fits, "{seed} {k}: x {} u {}", x[k], u[k]);
            if x[k] == lower || x[k] == upper { at_bound += 1 } else { free += 1 }
        }
    }
    assert!(at_bound > 300 && free > 300, "{at_bound} {free}");
}

/// Two rows that say the same: no division by zero, and the sum is right.
#[test]
fn dependent_rows_share_the_load() {
    let p = Problem::random(3, 1.0, &mut Random(9));
    let l = p.h.clone().cholesky().unwrap().l();
    let mut rows = Rows::new(4);
    for k in [0, 1, 1, 2] {
        let block = rows.add(Kind::EQUALITY, 1, &[0]);
        for j in 0..3 {
            rows.response(block, 0).1[j] = l[(k, j)];
        }
        rows.row(block, 0).bias = p.bias[k];
        rows.seal(block);
    }
    assert!(rows.solve(10, AIM).within(AIM));
    let x = impulses(&rows);
    let exact = p.h.clone().cholesky().unwrap().solve(&-&p.bias);
    let sum = DVector::from_vec(vec![x[0], x[1] + x[2], x[3]]);
    assert!((sum - &exact).norm() <= 1e-9 * exact.norm());
}

/// A row that nothing can move takes no part and does no harm; softness gives way by R x.
#[test]
fn rows_without_response_and_soft_rows() {
    let mut rows = Rows::new(4);
    let dead = rows.add(Kind::EQUALITY, 1, &[0]);
    rows.row(dead, 0).bias = 1.0;
    rows.seal(dead);
    let soft = rows.add(Kind::EQUALITY, 1, &[0]);
    rows.response(soft, 0).1[2] = 2.0;
    *rows.row(soft, 0) = realnoid::solver::Row { bias: -3.0, softness: 0.5, impulse: 0.0 };
    rows.seal(soft);
    let solved = rows.solve(10, AIM);
    assert!(rows.is_off(dead) && solved.within(AIM) && solved.residual.is_finite(), "{solved:?}");
    assert_eq!((rows.rows()[0].impulse, rows.rows()[1].impulse), (0.0, 3.0 / 4.5));
}

/// A contact among other rows: cone, spinning and rolling friction within what its normal impulse allows.
#[test]
fn contacts_join_the_rows() {
    let mut rng = Random(33);
    let (mut sliding, mut rolling) = (0, 0);
    for seed in 0..200 {
        let mut p = Problem::random(8, 10.0, &mut rng);
        p.bias[1] = -p.bias[1].abs();
        let spin = Kind::Disc { ratio: 0.05, normal: 1 };
        let roll = Kind::Disc { ratio: 0.02, normal: 1 };
        let mut rows = p.rows(&[
            (Kind::EQUALITY, 1),
            (Kind::Cone { friction: 0.6 }, 3),
            (spin, 1),
            (roll, 2),
            (Kind::EQUALITY, 1),
        ]);
        let solved = rows.solve(2000, AIM);
        assert!(solved.residual <= 1e-6, "{seed}: {solved:?}");
        let x = impulses(&rows);
        let u = &p.h * &x + &p.bias;
        let small = 1e-5 * (&p.h * &x).amax().max(1.0);
        assert!(u[0].abs() <= small && u[7].abs() <= small, "{seed}: equalities {u}");
        assert!(x[1] >= 0.0 && u[1] >= -small && x[1] * u[1] <= small * x[1].max(1.0), "{seed}");
        let (force, speed) = (x[2].hypot(x[3]), u[2].hypot(u[3]));
        assert!(force <= 0.6 * x[1] * (1.0 + 1e-9), "{seed}");
        if x[1] > 0.0 && speed > small {
            sliding += 1;
            assert!((force - 0.6 * x[1]).abs() <= small, "{seed}");
        }
        assert!(x[4].abs() <= 0.05 * x[1] * (1.0 + 1e-6) + 1e-9, "{seed}: spinning");
        let turn = x[5].hypot(x[6]);
        assert!(turn <= 0.02 * x[1] * (1.0 + 1e-6) + 1e-9, "{seed}: rolling");
        rolling += usize::from(turn > 0.0);
    }
    assert!(sliding > 50 && rolling > 50, "{sliding} {rolling}");
}
