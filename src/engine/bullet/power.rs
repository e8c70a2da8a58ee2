//! What stops and soft joints do in a step: the power of what each constraint gives, since locks do none.

use super::Bullet;
use super::bridge::JointForce;
use crate::dynamics::Kinematics;
use crate::math::V3;

/// Work that the constraints did on the bodies in `h` seconds between these poses and twists, J: force and torque along the mean of the
/// relative velocities at both ends, which is exact for impacts. Motors are not among them.
pub(super) fn work(engine: &Bullet, forces: &[JointForce], ends: [&Kinematics; 2], h: f64) -> f64 {
    let power = engine.plan.links.iter().zip(forces).map(|(link, given)| {
        let (force, torque) = (V3::from(given.force), V3::from(given.torque));
        ends.map(|k| {
            let point = k.r[link.child].mv(link.center) + k.p[link.child];
            let apart = k.velocity_at(link.child, point) - k.velocity_at(link.parent, point);
            let turn = k.r[link.child].mv(k.w[link.child]) - k.r[link.parent].mv(k.w[link.parent]);
            force.dot(apart) + torque.dot(turn)
        })
    });
    power.map(|[a, b]| 0.5 * h * (a + b)).sum()
}
