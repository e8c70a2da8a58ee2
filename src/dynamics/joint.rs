//! What a joint does to frames and velocities, one match per question.

use super::aba::Kin;
use super::articulated::Spatial;
use super::turn::Turn;
use crate::math::{M3, Real, V3};
use crate::model::{Body, JointType, rotation};

/// `(R, p)`: axes and origin of the body's frame in its parent's.
#[inline(always)]
pub fn joint_transform<T: Real>(b: &Body, q: &[T]) -> (M3<T>, V3<T>) {
    let (r, p) = (M3::of(&b.tree_r), V3::of(b.tree_p));
    let q = &q[b.q..];
    match b.joint {
        JointType::Revolute => (turned_z(&r, q[0].sin_cos()), p),
        JointType::Prismatic => (r, r.col2().mad(q[0], p)),
        JointType::Universal => (turned_z(&turned_x(&r, q[0].sin_cos()), q[1].sin_cos()), p),
        JointType::Spherical => (r.mm(&rotation([q[0], q[1], q[2], q[3]])), p),
        JointType::Floating => {
            let at = V3::new(q[0], q[1], q[2]);
            (r.mm(&rotation([q[3], q[4], q[5], q[6]])), r.mv(at) + p)
        }
    }
}

/// `R Rz(q)`.
#[inline(always)]
pub(crate) fn turned_z<T: Real>(r: &M3<T>, (s, c): (T, T)) -> M3<T> {
    let row = [r.r[0], r.r[1], r.r[2]];
    M3::rows(turn_z_row(row[0], s, c), turn_z_row(row[1], s, c), turn_z_row(row[2], s, c))
}

#[inline(always)]
fn turn_z_row<T: Real>(v: V3<T>, s: T, c: T) -> V3<T> {
    V3::new(v.x.mad(c, v.y * s), v.y.mad(c, -(v.x * s)), v.z)
}

/// `R Rx(q)`.
#[inline(always)]
pub(crate) fn turned_x<T: Real>(r: &M3<T>, (s, c): (T, T)) -> M3<T> {
    let row = [r.r[0], r.r[1], r.r[2]];
    M3::rows(turn_x_row(row[0], s, c), turn_x_row(row[1], s, c), turn_x_row(row[2], s, c))
}

#[inline(always)]
fn turn_x_row<T: Real>(v: V3<T>, s: T, c: T) -> V3<T> {
    V3::new(v.x, v.y.mad(c, v.z * s), v.z.mad(c, -(v.y * s)))
}

/// First axis of a universal joint in the child frame: `Rz(−q2) x`, where `(s, c)` belong to q2.
#[inline(always)]
pub(crate) fn universal_axis<T: Real>((s, c): (T, T)) -> V3<T> {
    V3::new(c, -s, T::of(0.0))
}

/// The joint's own velocity `S q̇` in the child frame.
#[inline(always)]
pub(crate) fn joint_velocity<T: Real>(b: &Body, q: &[T], v: &[T]) -> Spatial<T> {
    let o = T::of(0.0);
    let v = &v[b.v..];
    match b.joint {
        JointType::Revolute => Spatial { a: V3::new(o, o, v[0]), l: V3::default() },
        JointType::Prismatic => Spatial { a: V3::default(), l: V3::new(o, o, v[0]) },
        JointType::Universal => {
            let first = universal_axis(q[b.q + 1].sin_cos()) * v[0];
            Spatial { a: V3::new(first.x, first.y, v[1]), l: V3::default() }
        }
        JointType::Spherical => Spatial { a: V3::new(v[0], v[1], v[2]), l: V3::default() },
        JointType::Floating => Spatial { a: V3::new(v[0], v[1], v[2]), l: V3::new(v[3], v[4], v[5]) },
    }
}

/// [`bias`] of a joint that turns about z with speed `s`.
#[inline(always)]
pub(crate) fn turning_bias<T: Real>(s: T, (w, l): (V3<T>, V3<T>)) -> Spatial<T> {
    let o = T::of(0.0);
    Spatial { a: V3::new(w.y * s, -(w.x * s), o), l: V3::new(l.y * s, -(l.x * s), o) }
}

/// The velocity-product acceleration `c = v × S q̇ + Ṡ q̇` in the child frame, with `(w, l)` the body's velocity.
#[inline(always)]
pub(crate) fn bias<T: Real>(b: &Body, q: &[T], v: &[T], (w, l): (V3<T>, V3<T>)) -> Spatial<T> {
    let o = T::of(0.0);
    let s = v[b.v];
    match b.joint {
        JointType::Revolute => turning_bias(s, (w, l)),
        JointType::Prismatic => Spatial { a: V3::default(), l: V3::new(w.y * s, -(w.x * s), o) },
        JointType::Universal => {
            let first = universal_axis(q[b.q + 1].sin_cos());
            let second = v[b.v + 1];
            let own = V3::new(first.x * s, first.y * s, second);
            let turning = V3::new(first.y, -first.x, o) * (s * second);
            Spatial { a: w.cross_add(own, turning), l: l.cross(own) }
        }
        JointType::Spherical | JointType::Floating => {
            let own = joint_velocity(b, q, v);
            Spatial { a: w.cross(own.a), l: w.cross_add(own.l, l.cross(own.a)) }
        }
    }
}

/// Velocity of a body, from its frame in its parent's, its parent's velocity, and its joint's own.
#[inline(always)]
pub(super) fn carried<T: Real>(
    (r, p): (&impl Turn<T>, V3<T>),
    (w, v): (V3<T>, V3<T>),
    own: Spatial<T>,
) -> (V3<T>, V3<T>) {
    (r.tv(w) + own.a, r.tv(w.cross_add(p, v)) + own.l)
}

/// Frame and velocity of a body that turns about z: its frame at 0, its angle and speed, its parent's velocity.
#[inline(always)]
pub(super) fn turned<T: Real>((r, p): (&impl Turn<T>, V3<T>), (q, s): (T, T), (pw, pv): (V3<T>, V3<T>)) -> Kin<T> {
    let r = r.turned_z(q.sin_cos());
    let mut w = r.tv(pw);
    w.z += s;
    Kin { r: r.matrix(), w, v: r.tv(pw.cross_add(p, pv)) }
}

/// Acceleration of a body that turns about z with speed `s`, without that of its joint; its motion; its parent's acceleration
/// last.
#[inline(always)]
pub(super) fn turned_outward<T: Real>(
    (r, p): (&impl Turn<T>, V3<T>),
    s: T,
    (w, v): (V3<T>, V3<T>),
    (pa, pl): (V3<T>, V3<T>),
) -> (V3<T>, V3<T>) {
    let mut a = r.tv(pa);
    let mut l = r.tv(pa.cross_add(p, pl));
    (a.x, a.y) = (w.y.mad(s, a.x), (-w.x).mad(s, a.y));
    (l.x, l.y) = (v.y.mad(s, l.x), (-v.x).mad(s, l.y));
    (a, l)
}

#[inline(always)]
pub(super) fn axis_z<T: Real>() -> V3<T> {
    V3::new(T::of(0.0), T::of(0.0), T::of(1.0))
}
