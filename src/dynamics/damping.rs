//! Damping of bodies (B-8 I, J): v ← v·(1 − d)^dt of the centre of mass, and so the angular velocity.
//!
//! It is the wrench −k_l m v_com, −k_a I_com ω on the body, so that it acts in any tree. In continuous time k = λ = −ln(1 − d);
//! in a step of h seconds k is such that a free body loses the factor e^(−λh) to the last digit:
//!
//! ```text
//! force of the velocity at the start:   v⁺ = v − h k v,            k = (1 − e^(−λh))/h
//! force of the mean of both velocities: v⁺ = v − h k (v + v⁺)/2,   k = (2/h) tanh(λh/2)
//! ```

use super::aba::{Workspace, joint_transform_p};
use super::articulated::Spatial;
use super::joint::universal_axis;
use crate::math::{Real, S3, V3};
use crate::model::{JointType, Model};
use std::ops::Range;

/// Which velocity a step takes its damping from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// That at the start of the step.
    Start,
    /// The mean of those at the start and the end.
    Middle,
    /// The present one, in the stages of a method of high order.
    Continuous,
}

/// A damped body, and what damped it in the last pass of the hybrid dynamics.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Damped<T> {
    body: usize,
    /// k of the velocity of the centre of mass and of the angular velocity, 1/s.
    rates: (T, T),
    /// On the body, about its origin, along its axes.
    wrench: Spatial<T>,
    /// What that wrench does, W.
    power: T,
}

/// λ = −ln(1 − d), 1/s. d = 1 counts as the greatest number below 1 (λ = 36.7/s): nothing is infinite, and after a second
/// 10⁻¹⁶ of the velocity is left.
fn decay(d: f64) -> f64 {
    -libm::log((1.0 - d).max(f64::EPSILON / 2.0))
}

/// k of [`Damped`] for a loss of d per second in steps of `h` seconds.
pub(super) fn rate(d: f64, (h, scheme): (f64, Scheme)) -> f64 {
    let decay = decay(d);
    match scheme {
        Scheme::Start => -libm::expm1(-decay * h) / h,
        Scheme::Middle => 2.0 / h * libm::tanh(0.5 * decay * h),
        Scheme::Continuous => decay,
    }
}

/// Sets up the damping of a step of `h` seconds for all its passes; none if the effect is off. Allocates nothing.
pub fn write_damping(m: &Model, ws: &mut Workspace<f64>, step: (f64, Scheme), on: bool) {
    ws.damped.clear();
    let damped = m.dampings.iter().filter(|_| on).map(|d| Damped {
        body: d.body,
        rates: (rate(d.linear, step), rate(d.angular, step)),
        ..Damped::default()
    });
    ws.damped.extend(damped);
}

/// Adds the wrenches to the bias forces of these bodies, whose velocities are those of the pass.
pub(crate) fn resist<T: Real>(m: &Model, ws: &mut Workspace<T>, bodies: Range<usize>) {
    let zero = T::of(0.0);
    for d in ws.damped.iter_mut().filter(|d| bodies.contains(&d.body)) {
        let b = &m.bodies[d.body];
        let (w, v) = (ws.kin[d.body].w, ws.kin[d.body].v);
        let (mc, mass) = (V3::<T>::of(b.mc), T::of(b.mass));
        // What is damped has mass. I_com ω = I ω − c × (ω × m c).
        let c = V3::<T>::of(b.mc * (1.0 / b.mass));
        let turning = w.cross(mc);
        let force = v.mad(mass, turning) * (zero - d.rates.0);
        let spin = S3::<T>::of(&b.inertia).mv(w) - c.cross(turning);
        let torque = c.cross_add(force, spin * (zero - d.rates.1));
        d.wrench = Spatial { a: torque, l: force };
        d.power = torque.dot(w) + force.dot(v);
        ws.acc[d.body].n += -torque;
        ws.acc[d.body].f += -force;
    }
}

/// Power of the damping in the state of the last pass, W; not above 0.
pub fn damping_power(ws: &Workspace<f64>) -> f64 {
    ws.damped.iter().map(|d| d.power).sum()
}

/// Power of the wrenches of the last pass, in a state `q` (nq), with each of two velocities (nv), W.
pub fn damping_powers(m: &Model, ws: &mut Workspace<f64>, q: &[f64], v: [&dyn Fn(usize) -> f64; 2]) -> [f64; 2] {
    let mut powers = [0.0; 2];
    if ws.damped.is_empty() {
        return powers;
    }
    ws.wrenches.fill(Spatial::default());
    for d in &ws.damped {
        ws.wrenches[d.body] = d.wrench;
    }
    for (i, b) in m.bodies.iter().enumerate().skip(1).rev() {
        let Spatial { a: n, l: f } = ws.wrenches[i];
        let torques = match b.joint {
            JointType::Revolute => [n.z, 0.0, 0.0, 0.0, 0.0, 0.0],
            JointType::Prismatic => [f.z, 0.0, 0.0, 0.0, 0.0, 0.0],
            JointType::Universal => [universal_axis(q[b.q + 1].sin_cos()).dot(n), n.z, 0.0, 0.0, 0.0, 0.0],
            JointType::Spherical | JointType::Floating => [n.x, n.y, n.z, f.x, f.y, f.z],
        };
        for (k, torque) in torques.iter().take(b.joint.nv()).enumerate() {
            powers[0] += torque * v[0](b.v + k);
            powers[1] += torque * v[1](b.v + k);
        }
        if b.parent != 0 {
            let (r, p) = (ws.kin[i].r, joint_transform_p(b, q));
            let f = r.mv(f);
            ws.wrenches[b.parent].l += f;
            ws.wrenches[b.parent].a += p.cross_add(f, r.mv(n));
        }
    }
    powers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rate_leaves_the_same_share_after_a_step() {
        for d in [0.0_f64, 1e-9, 0.1, 0.9, 1.0 - 1e-12] {
            for h in [1e-6_f64, 1e-3, 1e-2] {
                let share = (1.0_f64 - d).powf(h);
                let start = 1.0 - h * rate(d, (h, Scheme::Start));
                let k = 0.5 * h * rate(d, (h, Scheme::Middle));
                // Both are a few roundings away.
                assert!((start - share).abs() <= 4.0 * f64::EPSILON, "{d} {h}");
                assert!(((1.0 - k) / (1.0 + k) - share).abs() <= 4.0 * f64::EPSILON, "{d} {h}");
            }
        }
    }

    #[test]
    fn all_of_it_is_finite() {
        for scheme in [Scheme::Start, Scheme::Middle, Scheme::Continuous] {
            let k = rate(1.0, (1e-3, scheme));
            assert!(k.is_finite() && k > 30.0, "{scheme:?} {k}");
        }
    }
}
