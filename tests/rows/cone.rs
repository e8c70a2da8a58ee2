//! One contact by itself.

use crate::support::Random;
use realnoid::solver::{ConeBlock, Plane, disc};

/// A random symmetric positive definite block: `B Bᵀ` of 3 × 4 normal-ish numbers, stretched.
fn block(rng: &mut Random, stretch: f64) -> [[f64; 3]; 3] {
    let scale: [f64; 3] = std::array::from_fn(|_| (stretch * rng.unit()).exp());
    let b: [[f64; 4]; 3] = std::array::from_fn(|i| std::array::from_fn(|_| scale[i] * rng.unit()));
    std::array::from_fn(|i| std::array::from_fn(|k| (0..4).map(|n| b[i][n] * b[k][n]).sum()))
}

fn packed(h: &[[f64; 3]; 3]) -> [f64; 6] {
    [h[0][0], h[0][1], h[0][2], h[1][1], h[1][2], h[2][2]]
}

/// Complementarity and maximum dissipation of 100 000 random blocks, to 1e-10 of the velocities.
#[test]
fn coulombs_law_holds() {
    let mut rng = Random(5);
    let (mut stuck, mut slid, mut open) = (0, 0, 0);
    for n in 0..100_000 {
        let h = block(&mut rng, if n % 2 == 0 { 0.5 } else { 3.0 });
        let r: [f64; 3] = std::array::from_fn(|_| rng.unit());
        let mu = match n % 4 {
            0 => 0.0,
            1 => 0.3 + 0.2 * rng.unit(),
            2 => 1.0 + rng.unit(),
            _ => (4.0 * rng.unit()).exp(),
        };
        let x = ConeBlock::new(packed(&h)).solve(r, mu);
        let u: [f64; 3] = std::array::from_fn(|i| r[i] + (0..3).map(|k| h[i][k] * x[k]).sum::<f64>());
        let (speed, force) = (u[1].hypot(u[2]), x[1].hypot(x[2]));
        // Velocities are sums of H x and r: their rounding is relative to the largest term.
        let terms = (0..9).map(|k| (h[k / 3][k % 3] * x[k % 3]).abs()).fold(1.0, f64::max);
        let small = 1e-10 * terms;
        let impulse = x.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        assert!(x[0] >= 0.0 && u[0] >= -small, "{n}: {x:?} {u:?}");
        assert!(x[0] == 0.0 || u[0].abs() <= small, "{n}: pushes only where it touches: {x:?} {u:?}");
        assert!(force <= mu * x[0] * (1.0 + 1e-10) + 1e-12 * impulse, "{n}: inside the cone: {x:?} mu {mu}");
        if x[0] == 0.0 {
            open += 1;
        } else if speed <= small {
            stuck += 1;
        } else {
            slid += 1;
            assert!((force - mu * x[0]).abs() <= 1e-10 * impulse, "{n}: slides at the rim: {x:?} {u:?} mu {mu}");
            // Maximum dissipation: of all forces of that size the one against the velocity.
            let power = u[1] * x[1] + u[2] * x[2];
            assert!(power <= -speed * force + small * force, "{n}: against the motion: {x:?} {u:?} mu {mu}");
        }
    }
    assert!(stuck > 5_000 && slid > 5_000 && open > 20_000, "{stuck} stuck, {slid} slid, {open} open");
}

/// The friction cone is round: a block of equal tangents slides in the direction of the push, whatever its heading.
#[test]
fn the_cone_is_round() {
    let h = [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]];
    for degrees in 0..360 {
        let (s, c) = f64::from(degrees).to_radians().sin_cos();
        let x = ConeBlock::new(packed(&h)).solve([-1.0, 4.0 * c, 4.0 * s], 0.7);
        assert!((x[0] - 0.5).abs() < 1e-15);
        assert!((x[1] + 0.35 * c).abs() < 1e-14 && (x[2] + 0.35 * s).abs() < 1e-14, "{degrees}: {x:?}");
    }
}

/// A plane block within a disc: at rest inside, else at the rim and against the motion.
#[test]
fn a_disc_bounds_a_pair() {
    let mut rng = Random(8);
    for n in 0..20_000 {
        let full = block(&mut rng, 2.0);
        let h = [[full[0][0], full[0][1]], [full[1][0], full[1][1]]];
        let r = [rng.unit(), rng.unit()];
        let radius = rng.unit().abs() * (3.0 * rng.unit()).exp();
        let x = disc(&Plane::new(h[0][0], h[0][1], h[1][1]), r, radius);
        let u: [f64; 2] = std::array::from_fn(|i| r[i] + h[i][0] * x[0] + h[i][1] * x[1]);
        let (speed, force) = (u[0].hypot(u[1]), x[0].hypot(x[1]));
        let small = 1e-10 * (0..4).map(|k| (h[k / 2][k % 2] * x[k % 2]).abs()).fold(1.0, f64::max);
        assert!(force <= radius * (1.0 + 1e-12), "{n}");
        if speed > small {
            assert!((force - radius).abs() <= 1e-10 * radius, "{n}");
            assert!(u[0] * x[0] + u[1] * x[1] <= -speed * force + small * force, "{n}: {x:?} {u:?}");
        }
    }
    assert_eq!(disc(&Plane::new(1.0, 0.2, 1.0), [0.3, 0.1], 0.0), [0.0; 2]);
}
