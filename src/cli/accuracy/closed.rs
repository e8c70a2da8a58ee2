//! Closed forms that cases are compared with.

use crate::math::{Quat, Vec3};

/// Elliptic sine, cosine and delta amplitude (sn, cn, dn) of `u` for the parameter m = 1 − `mc`, 0 < mc ≤ 1: by the
/// arithmetic–geometric mean and descending Landen transformations (Abramowitz and Stegun 16.4). Taking mc and not m keeps digits
/// where m is near 1.
pub fn jacobi(u: f64, mc: f64) -> (f64, f64, f64) {
    let (mut a, mut b) = (1.0, mc.sqrt());
    let mut steps = vec![];
    while steps.len() < 12 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        steps.push(c / a);
        if c.abs() <= f64::EPSILON * a {
            break;
        }
    }
    let mut phase = u * a * f64::from(1u32 << steps.len());
    for ratio in steps.iter().rev() {
        phase = 0.5 * (phase + (ratio * phase.sin()).asin());
    }
    let (sn, cn) = phase.sin_cos();
    (sn, cn, (mc + (1.0 - mc) * cn * cn).sqrt())
}

/// Carlson's R_F by duplication (DLMF 19.36): ∫₀^∞ dt / 2√((t+x)(t+y)(t+z)).
fn carlson_rf(mut x: f64, mut y: f64, mut z: f64) -> f64 {
    for _ in 0..30 {
        let (rx, ry, rz) = (x.sqrt(), y.sqrt(), z.sqrt());
        let l = rx * ry + ry * rz + rz * rx;
        (x, y, z) = (0.25 * (x + l), 0.25 * (y + l), 0.25 * (z + l));
    }
    1.0 / ((x + y + z) / 3.0).sqrt()
}

/// A body that nothing turns, with I1 < I2 < I3 and L² > 2 E I2.
#[derive(Clone, Debug)]
pub struct FreeBody {
    inertia: [f64; 3],
    /// Amplitudes of the angular velocity about its principal axes, rad/s.
    amplitude: [f64; 3],
    u0: f64,
    rate: f64,
    mc: f64,
}

impl FreeBody {
    /// Principal moments (kg·m²) and angular velocity at start (rad/s, all positive) along the principal axes.
    pub fn new(i: [f64; 3], w: [f64; 3]) -> Self {
        let sum = |f: &dyn Fn(usize) -> f64| (0..3).map(f).sum::<f64>();
        // L² − 2 E I_k without cancellation.
        let less = |k: usize| sum(&|n| i[n] * (i[n] - i[k]) * w[n] * w[n]);
        let (from_1, from_2, from_3) = (less(0), less(1), -less(2));
        let amplitude = [
            (from_3 / (i[0] * (i[2] - i[0]))).sqrt(),
            (from_3 / (i[1] * (i[2] - i[1]))).sqrt(),
            (from_1 / (i[2] * (i[2] - i[0]))).sqrt(),
        ];
        let rate = ((i[2] - i[1]) * from_1 / (i[0] * i[1] * i[2])).sqrt();
        let mc = (i[2] - i[0]) * from_2 / ((i[2] - i[1]) * from_1);
        let (sn, cn, dn) = (w[1] / amplitude[1], w[0] / amplitude[0], w[2] / amplitude[2]);
        let u0 = sn * carlson_rf(cn * cn, dn * dn, 1.0);
        Self { inertia: i, amplitude, u0, rate, mc }
    }

    /// Angular velocity along the principal axes at time `t` (s), rad/s.
    pub fn angular_velocity(&self, t: f64) -> Vec3 {
        let (sn, cn, dn) = jacobi(self.u0 + self.rate * t, self.mc);
        let a = self.amplitude;
        Vec3::new(a[0] * cn, a[1] * sn, a[2] * dn)
    }

    /// Angular momentum along the principal axes, kg·m²/s.
    fn momentum(&self, t: f64) -> Vec3 {
        self.angular_velocity(t).component_mul(&Vec3::from(self.inertia))
    }

    /// How it is turned at these times (ascending, s), from no turn at time 0.
    ///
    /// About the fixed angular momentum it turns with φ' = L (I1 ω1² + I2 ω2²) / (L1² + L2²), Landau and Lifshitz, Mechanics § 37; the
    /// integral is by Gauss–Legendre in pieces so short that it is exact to rounding. The other two Euler angles are where L is in the body.
    pub fn turns(&self, times: &[f64]) -> Vec<Quat> {
        let start = self.euler(0.0, 0.0).inverse();
        let (mut phi, mut before) = (0.0, 0.0);
        let turn = |t: &f64| {
            let pieces = ((t - before) / PIECE).ceil().max(1.0);
            let h = (t - before) / pieces;
            for n in 0..pieces as u32 {
                let middle = before + (f64::from(n) + 0.5) * h;
                let part = |(x, w): (f64, f64)| {
                    w * (self.precession(middle + 0.5 * h * x) + self.precession(middle - 0.5 * h * x))
                };
                phi += 0.5 * h * GAUSS.map(part).iter().sum::<f64>();
            }
            before = *t;
            start * self.euler(*t, phi)
        };
        times.iter().map(turn).collect()
    }

    fn precession(&self, t: f64) -> f64 {
        let (w, l) = (self.angular_velocity(t), self.momentum(t));
        l.norm() * (l.x * w.x + l.y * w.y) / (l.x * l.x + l.y * l.y)
    }

    /// From a frame whose z axis is along the angular momentum.
    fn euler(&self, t: f64, phi: f64) -> Quat {
        let l = self.momentum(t);
        let about = |axis, angle| Quat::from_axis_angle(&axis, angle);
        let (x, z) = (Vec3::x_axis(), Vec3::z_axis());
        about(z, phi) * about(x, l.x.hypot(l.y).atan2(l.z)) * about(z, l.x.atan2(l.y))
    }
}

/// s.
const PIECE: f64 = 0.01;
/// Gauss–Legendre of 8 points: abscissas above 0, and weights (Abramowitz and Stegun table 25.4).
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Speed of a precession of a symmetric top, rad/s: the slow root of I1 cosθ Ω² − I3 ω3 Ω + m g l = 0.
///
/// I1: moment of inertia across its axis about the support; `gyro` = I3 ω3, `weight` = m g l, `cos` = cosθ, θ from the upward vertical.
pub fn slow_precession(i1: f64, gyro: f64, weight: f64, cos: f64) -> f64 {
    2.0 * weight / (gyro + (gyro * gyro - 4.0 * i1 * cos * weight).sqrt())
}

/// Height above where it comes to rest, m, of a ball that falls from `h` (m) and bounces with restitution `e`, at time `t` (s). It
/// rests from √(2h/g) (1 + e)/(1 − e) on.
pub fn bounce(h: f64, e: f64, g: f64, t: f64) -> f64 {
    let fall = (2.0 * h / g).sqrt();
    if t <= fall {
        return h - 0.5 * g * t * t;
    }
    let (mut speed, mut since) = (e * g * fall, t - fall);
    while speed > f64::MIN_POSITIVE {
        let flight = 2.0 * speed / g;
        if since <= flight {
            return since * (speed - 0.5 * g * since);
        }
        since -= flight;
        speed *= e;
    }
    0.0
}

/// Way (m) that a box has slid at time `t` (s) from `speed` (m/s) while friction slows it by `slowing` (m/s²): it stops.
pub fn slide(speed: f64, slowing: f64, t: f64) -> f64 {
    let t = t.min(speed / slowing);
    t * (speed - 0.5 * slowing * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elliptic_functions_keep_their_identities() {
        for mc in [1.0, 0.7, 0.1, 1e-4, 1e-9] {
            for u in [-3.0, 0.0, 0.4, 2.0, 11.0] {
                let (sn, cn, dn) = jacobi(u, mc);
                assert!(
                    (sn * sn + cn * cn - 1.0).abs() < 1e-14 && (dn * dn + (1.0 - mc) * sn * sn - 1.0).abs() < 1e-14
                );
                // Undone by the integral that defines them, within the first quarter of a period.
                if u > 0.0 && u < 1.0 {
                    assert!((sn * carlson_rf(cn * cn, dn * dn, 1.0) - u).abs() < 1e-14);
                }
            }
        }
        let (sn, cn, dn) = jacobi(0.7, 1.0);
        assert!((sn - 0.7f64.sin()).abs() < 1e-15 && (cn - 0.7f64.cos()).abs() < 1e-15 && dn == 1.0);
        let sn = jacobi(1.3, 1e-12).0;
        assert!((sn - 1.3f64.tanh()).abs() < 1e-11, "m → 1 gives the hyperbolic tangent");
    }

    #[test]
    fn a_free_body_keeps_energy_and_momentum_and_turns_with_its_angular_velocity() {
        let (i, w) = ([0.01, 0.02, 0.028], Vec3::new(0.5, 10.0, 0.5));
        let body = FreeBody::new(i, w.into());
        let energy = |w: Vec3| w.dot(&w.component_mul(&Vec3::from(i)));
        let times: Vec<f64> = (0..=100).map(|k| 0.04 * f64::from(k)).collect();
        let turns = body.turns(&times);
        let fixed = w.component_mul(&Vec3::from(i));
        for (t, q) in times.iter().zip(&turns) {
            let now = body.angular_velocity(*t);
            assert!((energy(now) / energy(w) - 1.0).abs() < 1e-12);
            assert!(
                (q * now.component_mul(&Vec3::from(i)) - fixed).norm() < 1e-12 * fixed.norm(),
                "L stands in the world"
            );
        }
        // The derivative of the turn is the angular velocity: central differences of fourth order.
        let (t, h) = (1.3, 1e-3);
        let near = body.turns(&[t - 2.0 * h, t - h, t, t + h, t + 2.0 * h]);
        let to = |k: usize| (near[2].inverse() * near[k]).scaled_axis();
        let rate = (8.0 * (to(3) - to(1)) - (to(4) - to(0))) / (12.0 * h);
        assert!((rate - body.angular_velocity(t)).norm() < 1e-7, "(ωh)⁴ ω / 30 is 1e-9, rounding 1e-12");
    }

    #[test]
    fn precession_solves_its_equation_and_bounces_end_when_they_should() {
        let (i1, gyro, weight, cos) = (0.013, 0.3, 0.98, 0.8);
        let w = slow_precession(i1, gyro, weight, cos);
        assert!((i1 * cos * w * w - gyro * w + weight).abs() < 1e-14 * weight);
        let (h, e) = (0.2, 0.5);
        let end = (2.0 * h / G).sqrt() * (1.0 + e) / (1.0 - e);
        assert_eq!(bounce(h, e, G, end + 1e-9), 0.0);
        assert!(bounce(h, e, G, end - 1e-3) > 0.0 && bounce(h, e, G, end - 1e-3) < 0.5 * G * 1e-6);
        let top = bounce(h, e, G, (2.0 * h / G).sqrt() * (1.0 + e));
        assert!((top - e * e * h).abs() < 1e-15);
        assert_eq!(slide(1.0, 2.0, 9.0), 0.25);
    }

    const G: f64 = crate::cli::accuracy::G;
}
