//! Block elimination of spherical and floating joints.

use super::aba::Dof;
use super::articulated::{Acc, Spatial};
use crate::math::{Flat, M3, Real, S3, V3};

/// A prescribed rate of change along one direction of a spherical joint: `gradient·ω̇ = acceleration`.
#[derive(Clone, Copy, Debug, Default)]
pub struct BallLock<T> {
    /// Row of the constraint, in the child frame.
    pub gradient: V3<T>,
    /// Right-hand side, rad/s².
    pub acceleration: T,
    /// Out: the torque along `gradient` that keeps it.
    pub reaction: T,
}

/// Inputs of one spherical joint to the hybrid dynamics.
#[derive(Clone, Copy, Debug, Default)]
pub struct BallIn<T> {
    /// Torque on the child, in the child frame, N·m.
    pub tau: V3<T>,
    /// Added inertia (implicit damping and the like), in the child frame, kg·m².
    pub inertia: S3<T>,
    /// Locks; the first `locks` of them count.
    pub lock: [BallLock<T>; 3],
    /// 0 to 3.
    pub locks: usize,
}

/// What the elimination of a spherical joint leaves: `ω̇ = x − P Uᵀ a`.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct Ball<T> {
    ua: S3<T>,
    ul: M3<T>,
    /// `D⁻¹` on the directions that are not locked.
    p: S3<T>,
    x: V3<T>,
    /// Torque that is left over: τ − n.
    left: V3<T>,
    /// `D⁻¹`.
    pub(crate) inverse: S3<T>,
    /// Torque that is left over for locks and acceleration, `τ − n − Uᵀ a`; written by the hybrid dynamics.
    load: V3<T>,
}

// SAFETY: repr(C), of V3, M3 and S3 alone.
unsafe impl<T: Real> Flat<T> for Ball<T> {}

impl<T: Real> Ball<T> {
    /// `ω̇`, given the acceleration of the frame it moves against.
    #[inline(always)]
    pub fn acceleration(&self, a: Spatial<T>) -> V3<T> {
        self.x - self.p.mv(self.reach(a))
    }

    /// `gᵀ D⁻¹ g`.
    pub fn mobility(&self, gradient: V3<T>) -> T {
        gradient.dot(self.inverse.mv(gradient))
    }

    /// Takes the acceleration of the frame it moves against into account.
    #[inline(always)]
    pub fn set_load(&mut self, a: Spatial<T>) {
        self.load = self.left - self.reach(a);
    }

    /// `P t` of a torque on the joint, and what of that torque the joint's motion carries: `U P t`.
    #[inline(always)]
    pub fn yielding(&self, t: V3<T>) -> (V3<T>, Spatial<T>) {
        let x = self.p.mv(t);
        (x, Spatial { a: self.ua.mv(x), l: self.ul.tv(x) })
    }

    /// `tᵀ D⁻¹ t`: what a torque would do if nothing were locked.
    pub fn unlocked(&self, t: V3<T>) -> T {
        t.dot(self.inverse.mv(t))
    }

    /// Takes a further torque into `x` and what is left over, and a further [`Ball::reach`].
    pub fn add(&mut self, t: V3<T>, reach: V3<T>) {
        self.left += t;
        self.load += t;
        self.load -= reach;
        self.x += self.p.mv(t);
    }

    /// What the acceleration of the frame it moves against does to the load of the joint.
    #[inline(always)]
    pub fn reach(&self, a: Spatial<T>) -> V3<T> {
        self.ua.mv(a.a) + self.ul.mv(a.l)
    }
}

/// Eliminates the three rotations of a spherical joint at once: `D = J + added inertia`.
#[inline(always)]
pub(crate) fn eliminate_ball<T: Real>(k: &mut Acc<T>, out: &mut Ball<T>, input: &BallIn<T>) {
    let (ua, ul) = (k.ia.j, k.ia.h);
    let mut d = ua;
    d += input.inertia;
    let inverse = d.inverse();
    let left = input.tau - k.n;
    let (p, held) = project(&inverse, input);
    let x = p.mv(left) + held;
    *out = Ball { ua, ul, p, x, left, inverse, load: left };
    subtract(k, &p);
    k.n += ua.mv(x);
    k.f += ul.tv(x);
}

/// `IA − U P Uᵀ` with `U = [J; Hᵀ]`.
#[inline(always)]
fn subtract<T: Real>(k: &mut Acc<T>, p: &S3<T>) {
    let (j, h) = (k.ia.j, k.ia.h);
    let jp = M3::rows(p.mv(j.row0()), p.mv(j.row1()), p.mv(j.row2()));
    let (c0, c1, c2) = (h.col0(), h.col1(), h.col2());
    let (p0, p1, p2) = (p.mv(c0), p.mv(c1), p.mv(c2));
    k.ia.j.xx -= jp.r[0].dot(j.row0());
    k.ia.j.xy -= jp.r[0].dot(j.row1());
    k.ia.j.xz -= jp.r[0].dot(j.row2());
    k.ia.j.yy -= jp.r[1].dot(j.row1());
    k.ia.j.yz -= jp.r[1].dot(j.row2());
    k.ia.j.zz -= jp.r[2].dot(j.row2());
    for (row, a) in k.ia.h.r.iter_mut().zip(jp.r) {
        *row -= h.tv(a);
    }
    k.ia.m.xx -= p0.dot(c0);
    k.ia.m.xy -= p0.dot(c1);
    k.ia.m.xz -= p0.dot(c2);
    k.ia.m.yy -= p1.dot(c1);
    k.ia.m.yz -= p1.dot(c2);
    k.ia.m.zz -= p2.dot(c2);
}

/// `P = D⁻¹ − D⁻¹ G W⁻¹ Gᵀ D⁻¹` and `D⁻¹ G W⁻¹ b`, with `W = Gᵀ D⁻¹ G`: one lock after the other, which is the same by
/// the quotient property of Schur complements.
#[inline(always)]
fn project<T: Real>(inverse: &S3<T>, input: &BallIn<T>) -> (S3<T>, V3<T>) {
    let (mut p, mut held) = (*inverse, V3::default());
    for lock in &input.lock[..input.locks] {
        let y = p.mv(lock.gradient);
        let s = y * (T::of(1.0) / lock.gradient.dot(y));
        held = s.mad(lock.acceleration - lock.gradient.dot(held), held);
        p.sub_outer(s, y);
    }
    (p, held)
}

impl<T: Real> BallIn<T> {
    /// Adds a lock (three at most) and returns its index.
    pub fn add_lock(&mut self, gradient: V3<T>, acceleration: T) -> usize {
        let index = self.locks;
        self.lock[index] = BallLock { gradient, acceleration, reaction: T::of(0.0) };
        self.locks += 1;
        index
    }

    /// Torques along the locked gradients: the λ of `D ω̇ = τ − n − Uᵀ a + G λ`, by backward substitution.
    #[inline(always)]
    pub(crate) fn react(&mut self, ball: &Ball<T>) {
        let mut rest = ball.inverse.mv(ball.load);
        let mut p = ball.inverse;
        let mut steps = [(V3::default(), T::of(0.0)); 3];
        for (n, lock) in self.lock[..self.locks].iter().enumerate() {
            let y = p.mv(lock.gradient);
            let s = y * (T::of(1.0) / lock.gradient.dot(y));
            let missing = lock.acceleration - lock.gradient.dot(rest);
            steps[n] = (s, missing / lock.gradient.dot(y));
            rest = s.mad(missing, rest);
            p.sub_outer(s, y);
        }
        self.solve_reactions(&steps);
    }

    /// A later lock's torque also acts along the earlier ones: take that part away, last first.
    #[inline(always)]
    fn solve_reactions(&mut self, steps: &[(V3<T>, T); 3]) {
        let locks = self.locks;
        for n in (0..locks).rev() {
            let mut own = steps[n].1;
            for later in n + 1..locks {
                own -= steps[n].0.dot(self.lock[later].gradient) * self.lock[later].reaction;
            }
            self.lock[n].reaction = own;
        }
    }
}

/// The free acceleration of a floating body, `IA⁻¹ (τ − p)`, by the Schur complement of M.
#[inline(always)]
pub(crate) fn eliminate_floating<T: Real>(k: &Acc<T>, tau: [T; 6], out: &mut [Dof<T>]) {
    let n = V3::new(tau[0], tau[1], tau[2]) - k.n;
    let f = V3::new(tau[3], tau[4], tau[5]) - k.f;
    let mi = k.ia.m.inverse();
    let h = &k.ia.h;
    let hm = M3::rows(mi.mv(h.r[0]), mi.mv(h.r[1]), mi.mv(h.r[2]));
    let mut j = k.ia.j;
    j.xx -= hm.r[0].dot(h.r[0]);
    j.xy -= hm.r[0].dot(h.r[1]);
    j.xz -= hm.r[0].dot(h.r[2]);
    j.yy -= hm.r[1].dot(h.r[1]);
    j.yz -= hm.r[1].dot(h.r[2]);
    j.zz -= hm.r[2].dot(h.r[2]);
    let a = j.inverse().mv(n - hm.mv(f));
    let l = mi.mv(f - h.tv(a));
    for (d, x) in out.iter_mut().zip([a.x, a.y, a.z, l.x, l.y, l.z]) {
        d.x = x;
    }
}
