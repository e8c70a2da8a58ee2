//! Moving coordinates: rates, exponential steps, unit quaternions.

use crate::math::{Real, V3, sin_cos};
use crate::model::{JointType, Model, rotation};

/// Rates of all coordinates, `q̇` (nq), from `q` (nq) and `v` (nv).
pub fn coordinate_rates(m: &Model, q: &[f64], v: &[f64], rates: &mut [f64]) {
    for b in &m.bodies[1..] {
        match b.joint {
            JointType::Revolute | JointType::Prismatic => rates[b.q] = v[b.v],
            JointType::Universal => rates[b.q..b.q + 2].copy_from_slice(&v[b.v..b.v + 2]),
            JointType::Spherical => quaternion_rates(&q[b.q..b.q + 4], &v[b.v..b.v + 3], &mut rates[b.q..b.q + 4]),
            JointType::Floating => {
                let r = rotation([q[b.q + 3], q[b.q + 4], q[b.q + 5], q[b.q + 6]]);
                let l = r.mv(V3::new(v[b.v + 3], v[b.v + 4], v[b.v + 5]));
                (rates[b.q], rates[b.q + 1], rates[b.q + 2]) = (l.x, l.y, l.z);
                quaternion_rates(&q[b.q + 3..b.q + 7], &v[b.v..b.v + 3], &mut rates[b.q + 3..b.q + 7]);
            }
        }
    }
}

/// `½ q ⊗ ω` with ω in the child frame.
fn quaternion_rates(q: &[f64], w: &[f64], out: &mut [f64]) {
    out[0] = 0.5 * (-q[1] * w[0] - q[2] * w[1] - q[3] * w[2]);
    out[1] = 0.5 * (q[0] * w[0] + q[2] * w[2] - q[3] * w[1]);
    out[2] = 0.5 * (q[0] * w[1] + q[3] * w[0] - q[1] * w[2]);
    out[3] = 0.5 * (q[0] * w[2] + q[1] * w[1] - q[2] * w[0]);
}

/// One semi-implicit step: first `v ← v + h v̇`, then the coordinates move with the new velocity for `h` seconds. Rotations
/// turn by the exponential of h ω; a floating body's origin moves on a straight line, so its velocity is advanced in the
/// world's axes.
pub fn exponential_step(m: &Model, q: &mut [f64], v: &mut [f64], vdot: &[f64], h: f64) {
    for b in &m.bodies[1..] {
        match b.joint {
            JointType::Floating => floating_step(&mut q[b.q..b.q + 7], &mut v[b.v..b.v + 6], &vdot[b.v..b.v + 6], h),
            JointType::Spherical => {
                (b.v..b.v + 3).for_each(|k| v[k] += h * vdot[k]);
                let w = V3::new(v[b.v], v[b.v + 1], v[b.v + 2]);
                turn(&mut q[b.q..b.q + 4], w * h);
            }
            JointType::Revolute | JointType::Prismatic => scalar_step(&mut q[b.q], &mut v[b.v], vdot[b.v], h),
            JointType::Universal => {
                for k in 0..2 {
                    scalar_step(&mut q[b.q + k], &mut v[b.v + k], vdot[b.v + k], h);
                }
            }
        }
    }
}

/// Moves the coordinates from `from` to `to` (nq) at constant speeds `u` (nv) for `h` seconds: rotations turn by the
/// exponential of h ω; a floating body's origin moves along the axes of the body in the middle of its turn, so that moving
/// back with −u leads back to `from`.
pub fn move_coordinates(m: &Model, from: &[f64], u: &[f64], h: f64, to: &mut [f64]) {
    to.copy_from_slice(from);
    for b in &m.bodies[1..] {
        let (q, u) = (&mut to[b.q..b.q + b.joint.nq()], &u[b.v..b.v + b.joint.nv()]);
        match b.joint {
            JointType::Spherical => turn(q, V3::new(u[0], u[1], u[2]) * h),
            JointType::Floating => {
                let half = V3::new(u[0], u[1], u[2]) * (0.5 * h);
                turn(&mut q[3..7], half);
                let way = rotation([q[3], q[4], q[5], q[6]]).mv(V3::new(u[3], u[4], u[5]) * h);
                turn(&mut q[3..7], half);
                (q[0], q[1], q[2]) = (q[0] + way.x, q[1] + way.y, q[2] + way.z);
            }
            _ => q.iter_mut().zip(u).for_each(|(x, u)| *x += h * u),
        }
    }
}

#[inline(always)]
fn scalar_step(q: &mut f64, v: &mut f64, vdot: f64, h: f64) {
    *v += h * vdot;
    *q += h * *v;
}

fn floating_step(q: &mut [f64], v: &mut [f64], vdot: &[f64], h: f64) {
    let (w, l) = (V3::new(v[0], v[1], v[2]), V3::new(v[3], v[4], v[5]));
    let (wd, ld) = (V3::new(vdot[0], vdot[1], vdot[2]), V3::new(vdot[3], vdot[4], vdot[5]));
    let r = rotation([q[3], q[4], q[5], q[6]]);
    let world = r.mv((ld + w.cross(l)).mad(h, l));
    let w = wd.mad(h, w);
    turn(&mut q[3..7], w * h);
    (q[0], q[1], q[2]) = (q[0] + h * world.x, q[1] + h * world.y, q[2] + h * world.z);
    let l = rotation([q[3], q[4], q[5], q[6]]).tv(world);
    v.copy_from_slice(&[w.x, w.y, w.z, l.x, l.y, l.z]);
}

/// Turns a unit quaternion `q` (w, x, y, z) by the rotation vector `a` (rad, child frame).
pub fn turn(q: &mut [f64], a: V3<f64>) {
    let angle = a.dot(a).sqrt();
    if angle == 0.0 {
        return;
    }
    let (s, c) = sin_cos(0.5 * angle);
    let k = if angle > 1e-8 { s / angle } else { 0.5 - angle * angle / 48.0 };
    let (x, y, z) = (a.x * k, a.y * k, a.z * k);
    let p = [q[0], q[1], q[2], q[3]];
    q[0] = p[0] * c - p[1] * x - p[2] * y - p[3] * z;
    q[1] = p[0] * x + p[1] * c + p[2] * z - p[3] * y;
    q[2] = p[0] * y + p[2] * c + p[3] * x - p[1] * z;
    q[3] = p[0] * z + p[3] * c + p[1] * y - p[2] * x;
    normalize(q);
}

/// Unit length for a quaternion (4).
pub fn normalize(q: &mut [f64]) {
    let n = q[0].mad(q[0], q[1].mad(q[1], q[2].mad(q[2], q[3] * q[3]))).sqrt();
    for x in q.iter_mut() {
        *x /= n;
    }
}
