//! Engines with a body for each link: from poses and twists of all bodies to the coordinates of a model, and how far the two
//! sides of its joints have come apart. The other way round is [`crate::dynamics::kinematics`].
//!
//! What such an engine has of a joint is a pose of the child in the joint's frame, `(R, p)`, that a joint of its type can make
//! but for the engine's own error. The coordinate taken is that of the nearest pose that the joint can make; what is left is
//! the [`Gap`].

use super::State;
use crate::dynamics::{Kinematics, joint_transform, universal_axis};
use crate::math::{M3, V3};
use crate::model::{Body, JointType, Model};
use std::f64::consts::TAU;

/// How far the sides of a joint are from any pose that it can make.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gap {
    /// m.
    pub linear: f64,
    /// rad.
    pub angular: f64,
}

impl Gap {
    /// The greater of each.
    pub fn max(self, other: Self) -> Self {
        Self { linear: self.linear.max(other.linear), angular: self.angular.max(other.angular) }
    }
}

/// Writes the state in which the bodies have these poses and twists; angles go on from those that `state` had. Returns the
/// widest gaps of its joints. Allocates nothing.
///
/// `k` in the world frame, of all bodies; a body that an engine does not make, since it has no mass and its joint does not move, is where
/// [`crate::dynamics::kinematics_of`] puts it.
pub fn read_state(m: &Model, k: &Kinematics, state: &mut State) -> Gap {
    let mut widest = Gap::default();
    for i in 1..m.bodies.len() {
        widest = widest.max(read_body(m, k, i, state));
    }
    state.read_angles(m);
    widest
}

/// The same of one body, without angles of a 3DOF group.
pub fn read_body(m: &Model, k: &Kinematics, i: usize, state: &mut State) -> Gap {
    let b = &m.bodies[i];
    read_joint(b, &Relative::of(b, k, i), &mut state.q[b.q..], &mut state.v[b.v..])
}

/// A body against the frame of its joint on its parent.
struct Relative {
    /// Its axes in the joint's frame.
    r: M3<f64>,
    /// Its origin in the joint's frame, m.
    p: V3<f64>,
    /// Angular velocity against the parent along its own axes, rad/s.
    w: V3<f64>,
    /// Velocity of its origin against the parent along its own axes, m/s.
    v: V3<f64>,
}

impl Relative {
    fn of(b: &Body, k: &Kinematics, i: usize) -> Self {
        let (parent, up) = (&k.r[b.parent], k.p[i] - k.p[b.parent]);
        let arm = parent.tv(up);
        let seen = |world: V3<f64>| k.r[i].tv(world);
        let (w0, v0) = (parent.mv(k.w[b.parent]), parent.mv(k.w[b.parent].cross_add(arm, k.v[b.parent])));
        Self {
            r: parent.mm(&b.tree_r).tmm(&k.r[i]),
            p: b.tree_r.tv(arm - b.tree_p),
            w: k.w[i] - seen(w0),
            v: k.v[i] - seen(v0),
        }
    }
}

/// Writes the coordinates of one joint.
fn read_joint(b: &Body, at: &Relative, q: &mut [f64], v: &mut [f64]) -> Gap {
    let (r, whole) = (&at.r.r, TAU);
    let near = |angle: f64, before: f64| angle + whole * libm::round((before - angle) / whole);
    match b.joint {
        JointType::Revolute => {
            q[0] = near(libm::atan2(r[1].x - r[0].y, r[0].x + r[1].y), q[0]);
            v[0] = at.w.z;
        }
        JointType::Prismatic => (q[0], v[0]) = (at.p.z, at.v.z),
        JointType::Universal => {
            q[0] = near(libm::atan2(-r[1].z, r[2].z), q[0]);
            q[1] = near(libm::atan2(-r[0].y, r[0].x), q[1]);
            // The two axes are perpendicular.
            let first = universal_axis(crate::math::Real::sin_cos(q[1]));
            (v[0], v[1]) = (first.dot(at.w), at.w.z);
        }
        JointType::Spherical => {
            read_quaternion(&at.r, &mut q[..4]);
            v[..3].copy_from_slice(&[at.w.x, at.w.y, at.w.z]);
        }
        JointType::Floating => {
            q[..3].copy_from_slice(&[at.p.x, at.p.y, at.p.z]);
            read_quaternion(&at.r, &mut q[3..7]);
            v[..6].copy_from_slice(&[at.w.x, at.w.y, at.w.z, at.v.x, at.v.y, at.v.z]);
        }
    }
    let makes = Body { q: 0, tree_r: M3::identity(), tree_p: V3::default(), along: None, ..b.clone() };
    let (turned, shifted) = joint_transform(&makes, q);
    Gap { linear: size(at.p - shifted), angular: angle(&turned.tmm(&at.r)) }
}

/// The unit quaternion (w, x, y, z) of a rotation, of the two the one that is nearer to what `q` had.
fn read_quaternion(r: &M3<f64>, q: &mut [f64]) {
    let [a, b, c] = r.r;
    let trace = a.x + b.y + c.z;
    // The greatest of the four is taken from its square, so that nothing is lost in a difference.
    let mut new = if trace >= a.x && trace >= b.y && trace >= c.z {
        [1.0 + trace, c.y - b.z, a.z - c.x, b.x - a.y]
    } else if a.x >= b.y && a.x >= c.z {
        [c.y - b.z, 1.0 + a.x - b.y - c.z, a.y + b.x, a.z + c.x]
    } else if b.y >= c.z {
        [a.z - c.x, a.y + b.x, 1.0 + b.y - a.x - c.z, b.z + c.y]
    } else {
        [b.x - a.y, a.z + c.x, b.z + c.y, 1.0 + c.z - a.x - b.y]
    };
    let norm = new.iter().map(|x| x * x).sum::<f64>().sqrt();
    let along: f64 = new.iter().zip(&*q).map(|(x, y)| x * y).sum();
    let scale = if along < 0.0 { -1.0 / norm } else { 1.0 / norm };
    new.iter_mut().for_each(|x| *x *= scale);
    q.copy_from_slice(&new);
}

/// By how much a rotation turns, rad.
fn angle(r: &M3<f64>) -> f64 {
    let [a, b, c] = r.r;
    let sine = 0.5 * size(V3::new(c.y - b.z, a.z - c.x, b.x - a.y));
    libm::atan2(sine, 0.5 * (a.x + b.y + c.z - 1.0))
}

fn size(v: V3<f64>) -> f64 {
    v.dot(v).sqrt()
}
