//! Velocities of bodies whose frames are known: without sines and cosines.

use super::aba::joint_transform_p;
use super::joint::{carried, joint_velocity};
use super::{Kinematics, Workspace};
use crate::model::Model;

/// As [`super::kinematics_of`] with the velocities `v` (nv) at the coordinates `q` (nq) of the last pass of the dynamics in `ws`, whose frames
/// `at` has of these bodies (ascending, with all that carry them): the same bits. What took no part in the pass must stand still.
pub fn velocities_of(
    m: &Model,
    (ws, at): (&Workspace<f64>, &Kinematics),
    k: &mut Kinematics,
    (q, v): (&[f64], &[f64]),
    bodies: &[usize],
) {
    for i in bodies.iter().copied() {
        let b = &m.bodies[i];
        let (r, p) = (&ws.kin[i].r, joint_transform_p(b, q));
        (k.w[i], k.v[i]) = carried((r, p), (k.w[b.parent], k.v[b.parent]), joint_velocity(b, q, v));
        (k.r[i], k.p[i]) = (at.r[i], at.p[i]);
    }
}
