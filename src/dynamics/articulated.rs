//! Articulated-body inertias: their sums, shifts and rotations.

use crate::math::{Flat, M3, Real, S3, V3};
use crate::model::{Body, JointType, Model};

/// Articulated inertia `[J H; Hᵀ M]` about the body's origin: (torque, force) per (angular, linear) acceleration.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct Art<T> {
    pub j: S3<T>,
    pub h: M3<T>,
    pub m: S3<T>,
}

/// What a body collects from its children: articulated inertia and bias force.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct Acc<T> {
    pub ia: Art<T>,
    pub n: V3<T>,
    pub f: V3<T>,
}

/// Spatial vector, angular first.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct Spatial<T> {
    pub a: V3<T>,
    pub l: V3<T>,
}

// SAFETY: repr(C), of V3, M3 and S3 alone.
unsafe impl<T: Real> Flat<T> for Acc<T> {}

impl<T: Real> Acc<T> {
    #[inline(always)]
    pub fn add(&mut self, o: &Self) {
        self.ia.j += o.ia.j;
        for (a, b) in self.ia.h.r.iter_mut().zip(o.ia.h.r) {
            *a += b;
        }
        self.ia.m += o.ia.m;
        self.n += o.n;
        self.f += o.f;
    }

    /// A rigid body's own inertia and its velocity-dependent bias `v ×* I v`.
    #[inline(always)]
    pub fn rigid(b: &Body, w: V3<T>, v: V3<T>) -> Self {
        Self::of_mass((T::of(b.mass), V3::of(b.mc), S3::of(&b.inertia)), w, v)
    }

    /// The same of a mass, its first moment and its inertia about the body's origin.
    #[inline(always)]
    pub fn of_mass((m, mc, j): (T, V3<T>, S3<T>), w: V3<T>, v: V3<T>) -> Self {
        let o = T::of(0.0);
        let h = M3::rows(V3::new(o, -mc.z, mc.y), V3::new(mc.z, o, -mc.x), V3::new(-mc.y, mc.x, o));
        let ia = Art { j, h, m: S3 { xx: m, xy: o, xz: o, yy: m, yz: o, zz: m } };
        let turning = w.cross(mc);
        let angular = mc.cross_add(v, j.mv(w));
        Self { ia, n: w.cross_add(angular, v.cross(turning)), f: w.cross(v.mad(m, turning)) }
    }

    /// Adds `IA·a` to the bias.
    #[inline(always)]
    pub fn push(&mut self, a: Spatial<T>) {
        self.n += self.ia.j.mv(a.a) + self.ia.h.mv(a.l);
        self.f += self.ia.h.tv(a.a) + self.ia.m.mv(a.l);
    }

    /// The same about the parent's origin, in the parent's axes.
    #[inline(always)]
    pub fn to_parent(self, r: &M3<T>, p: V3<T>) -> Self {
        let h = r.mm(&self.ia.h).mmt(r);
        let ia = Art { j: self.ia.j.rotated(r), h, m: self.ia.m.rotated(r) }.moved(p);
        let f = r.mv(self.f);
        Self { ia, f, n: p.cross_add(f, r.mv(self.n)) }
    }
}

impl<T: Real> Art<T> {
    /// About an origin that lies at −p: with P = [p×], H' = H + P M, J' = J − H P + P H'ᵀ.
    #[inline(always)]
    pub fn moved(self, p: V3<T>) -> Self {
        self.moved_flat::<3>(p)
    }

    /// The same of one whose row `Z` of H, and row and column `Z` of J, are zero; of any one for `Z` = 3.
    #[inline(always)]
    pub fn moved_flat<const Z: usize>(self, p: V3<T>) -> Self {
        let Self { mut j, h, m } = self;
        let (m0, m1, m2) = (p.cross(m.row0()), p.cross(m.row1()), p.cross(m.row2()));
        let g = M3::rows(
            if Z == 0 { V3::new(m0.x, m1.x, m2.x) } else { h.r[0] + V3::new(m0.x, m1.x, m2.x) },
            if Z == 1 { V3::new(m0.y, m1.y, m2.y) } else { h.r[1] + V3::new(m0.y, m1.y, m2.y) },
            if Z == 2 { V3::new(m0.z, m1.z, m2.z) } else { h.r[2] + V3::new(m0.z, m1.z, m2.z) },
        );
        let (b0, b1, b2) = (p.cross(g.r[0]), p.cross(g.r[1]), p.cross(g.r[2]));
        let (a0, a1, a2) = (p.cross(h.r[0]), p.cross(h.r[1]), p.cross(h.r[2]));
        if Z == 0 {
            (j.xx, j.xy, j.xz) = (b0.x, b1.x, b2.x);
        } else {
            j.xx += a0.x + b0.x;
            j.xy = if Z == 1 { a0.y + b1.x } else { j.xy + (a0.y + b1.x) };
            j.xz = if Z == 2 { a0.z + b2.x } else { j.xz + (a0.z + b2.x) };
        }
        if Z == 1 {
            (j.yy, j.yz) = (b1.y, b2.y);
        } else {
            j.yy += a1.y + b1.y;
            j.yz = if Z == 2 { a1.z + b2.y } else { j.yz + (a1.z + b2.y) };
        }
        j.zz = if Z == 2 { b2.z } else { j.zz + (a2.z + b2.z) };
        Self { j, h: g, m }
    }

    /// Takes away `U Uᵀ·d` of an eliminated direction.
    #[inline(always)]
    pub fn eliminate(&mut self, ua: V3<T>, ul: V3<T>, d: T) {
        let (a, l) = (ua * d, ul * d);
        self.j.sub_outer(a, ua);
        self.h.r[0] = ul.mad(-a.x, self.h.r[0]);
        self.h.r[1] = ul.mad(-a.y, self.h.r[1]);
        self.h.r[2] = ul.mad(-a.z, self.h.r[2]);
        self.m.sub_outer(l, ul);
    }
}

/// Where what a body collects comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sum {
    /// Nothing hangs on it.
    Own,
    /// Its only child is the next body.
    Next,
    /// It is added up in memory: of several children, where it is read after the pass (floating), or where damping is added.
    Several,
}

/// For every body of a model.
pub(crate) fn sums(m: &Model) -> Vec<Sum> {
    let mut children = vec![0; m.bodies.len()];
    m.bodies.iter().skip(1).for_each(|b| children[b.parent] += 1);
    let of = |i: usize| match children[i] {
        _ if i == 0 || !m.dampings.is_empty() || m.bodies[i].joint == JointType::Floating => Sum::Several,
        0 => Sum::Own,
        1 if m.bodies.get(i + 1).is_some_and(|b| b.parent == i) => Sum::Next,
        _ => Sum::Several,
    };
    (0..m.bodies.len()).map(of).collect()
}
