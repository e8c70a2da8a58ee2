//! Elimination of single degrees of freedom from an articulated inertia.

use super::DofIn;
use super::aba::Dof;
use super::articulated::{Acc, Art};
use super::turn::Turn;
use crate::math::{Real, V3};

/// Eliminates a rotation about `s`, a direction in the child frame.
#[inline(always)]
pub(crate) fn eliminate_axis<T: Real>(k: &mut Acc<T>, s: V3<T>, d: &mut Dof<T>, input: &DofIn<T>) {
    let (ua, ul) = (k.ia.j.mv(s), k.ia.h.tv(s));
    finish(k, (ua, ul), (s.dot(ua), s.dot(k.n)), d, input);
}

/// Eliminates a translation along z.
#[inline(always)]
pub(crate) fn eliminate_linear_z<T: Real>(k: &mut Acc<T>, d: &mut Dof<T>, input: &DofIn<T>) {
    let (ua, ul) = (k.ia.h.col2(), k.ia.m.row2());
    finish(k, (ua, ul), (ul.z, k.f.z), d, input);
}

/// `own` is S·U and S·p.
#[inline(always)]
fn finish<T: Real>(k: &mut Acc<T>, (ua, ul): (V3<T>, V3<T>), own: (T, T), d: &mut Dof<T>, input: &DofIn<T>) {
    let (inertia, force) = own;
    let di = input.free / (inertia + input.diagonal);
    let locked = (T::of(1.0) - input.free) * input.acceleration;
    let x = di.mad(input.tau - force, locked);
    *d = Dof { ua, ul, d: di, x, own: inertia.mad(locked, force) };
    k.ia.eliminate(ua, ul, di);
    k.n += ua * x;
    k.f += ul * x;
}

/// The elimination alone, for a joint on the world: nothing is handed on.
#[inline(always)]
pub(crate) fn revolute_root<T: Real>(k: &Acc<T>, (d, tau): (&mut Dof<T>, T)) {
    let (ua, ul) = (k.ia.j.row2(), k.ia.h.r[2]);
    let di = T::of(1.0) / ua.z;
    *d = Dof { ua, ul, d: di, x: (tau - k.n.z) * di, own: k.n.z };
}

/// Eliminates a free rotation about z without added inertia, and moves to the parent, in whose frame the origin is at `p`. The row and column of J that belong
/// to z vanish, and so does H's row: they are left out.
#[inline(always)]
pub(crate) fn revolute<T: Real>(
    k: &Acc<T>,
    (r, p): (&impl Turn<T>, V3<T>),
    (w, v): (V3<T>, V3<T>),
    s: T,
    (d, tau): (&mut Dof<T>, T),
) -> Acc<T> {
    revolute_root(k, (d, tau));
    let Dof { ua, ul, d: di, x, .. } = *d;
    let Art { j, h, mut m } = k.ia;
    let (ax, ay, l) = (ua.x * di, ua.y * di, ul * di);
    let (jxx, jxy, jyy) = ((-ax).mad(ua.x, j.xx), (-ax).mad(ua.y, j.xy), (-ay).mad(ua.y, j.yy));
    let (h0, h1) = (ul.mad(-ax, h.r[0]), ul.mad(-ay, h.r[1]));
    m.sub_outer(l, ul);
    let (cx, cy, lx, ly) = (w.y * s, -(w.x * s), v.y * s, -(v.x * s));
    let nx = ua.x.mad(x, jxx.mad(cx, jxy.mad(cy, h0.x.mad(lx, h0.y.mad(ly, k.n.x)))));
    let ny = ua.y.mad(x, jxy.mad(cx, jyy.mad(cy, h1.x.mad(lx, h1.y.mad(ly, k.n.y)))));
    let f = ul.mad(x, h0.mad(cx, h1.mad(cy, m.row0().mad(lx, m.row1().mad(ly, k.f)))));
    let f = r.mv(f);
    Acc { ia: r.flat([jxx, jxy, jyy], [h0, h1], m, p), f, n: p.cross_add(f, r.mv(V3::new(nx, ny, tau))) }
}
