//! Two or three hinges of the model that are one constraint of Bullet, since nothing between them has mass.

use super::plan::Link;
use crate::dynamics::{Kinematics, body_pose};
use crate::engine::State;
use crate::math::{Pose, Quat, Vec3};
use crate::model::{AxisSlot, Model, POLE};
use std::f64::consts::TAU;

/// Turns about x, y, z of the rotation `Rz Ry Rx`.
fn angles(r: &Quat) -> [f64; 3] {
    let m = r.to_rotation_matrix();
    let cos = libm::hypot(m[(0, 0)], m[(1, 0)]);
    [libm::atan2(m[(2, 1)], m[(2, 2)]), libm::atan2(-m[(2, 0)], cos), libm::atan2(m[(1, 0)], m[(0, 0)])]
}

/// Their rates for an angular velocity in the turned frame.
fn rates([x, y, _]: [f64; 3], w: Vec3) -> [f64; 3] {
    let ((sx, cx), (sy, cy)) = (crate::math::sin_cos(x), crate::math::sin_cos(y));
    let cy = if cy.abs() < POLE { POLE.copysign(cy) } else { cy };
    let about_z = (sx * w.y + cx * w.z) / cy;
    [w.x + sy * about_z, cx * w.y - sx * w.z, about_z]
}

/// Writes the coordinates of these hinges; `k` has the bodies at both ends.
pub(super) fn read(m: &Model, link: &Link, k: &Kinematics, state: &mut State) {
    let end = |body: usize, frame: &Pose| body_pose(k, body).rotation * frame.rotation;
    let (a, b) = (end(link.parent, &link.frames[0]), end(link.child, &link.frames[1]));
    let spin = |body: usize| body_pose(k, body).rotation * Vec3::from(k.w[body]);
    let turned = angles(&(a.inverse() * b));
    let rates = rates(turned, b.inverse() * (spin(link.child) - spin(link.parent)));
    for (body, dof, sense) in &link.turns {
        let b = &m.bodies[*body];
        let angle = sense * turned[dof - 3];
        let before = state.q[b.q];
        state.q[b.q] = angle + TAU * libm::round((before - angle) / TAU);
        state.v[b.v] = sense * rates[dof - 3];
    }
}

/// Length of the gradient of an axis that is one of these hinges; 1 for others. About z and x it grows as the middle one turns.
pub(super) fn scale(links: &[Link], slot: &AxisSlot, m: &Model, state: &State) -> f64 {
    let AxisSlot::Scalar { v, .. } = slot else { return 1.0 };
    let of_axis = |(body, ..): &&(usize, usize, f64)| m.bodies[*body].v == *v;
    let Some((link, turn)) = links.iter().find_map(|l| Some((l, l.turns.iter().find(of_axis)?))) else { return 1.0 };
    match link.turns.iter().find(|t| t.1 == 4) {
        Some((middle, ..)) if turn.1 != 4 => 1.0 / crate::math::sin_cos(state.q[m.bodies[*middle].q]).1.abs().max(POLE),
        _ => 1.0,
    }
}
