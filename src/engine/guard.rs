//! Steps that had to be halved because they do not resolve a whirl, and pieces that even the shortest of them cannot resolve, which are
//! made explicitly: the velocity products would make energy out of nothing.
//!
//! After such a piece the motion relative to the body as a whole is slowed down until the energy is
//! what the drives and the weight have paid for. The momentum of every robot, body or piece that floats stays: its kinetic energy
//! splits, without a cross term, into that of the locked body with the same momentum and the rest (König). What stands on a fixed
//! base has no locked motion. Each such piece is counted, and what it took is added up.

use super::midpoint::Midpoint;
use super::paid::share_of;
use super::rbx::{Rbx, State, StepReport};
use crate::dynamics::{Energy, Kinematics, energy, kinematics};
use crate::math::{Mat3, V3, Vec3};
use crate::model::{Body, JointType, Model};

/// Buffers of the guard.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    kinematics: Kinematics,
    /// Per body on the world: the motion of what it carries as if all joints were locked, and itself.
    locked: Vec<(usize, Locked)>,
    /// Per body: index into `locked` of what it is part of.
    part: Vec<usize>,
}

/// The motion of a part that floats as if all its joints were locked; the momenta about the world's origin while it is summed up.
#[derive(Clone, Copy, Debug, Default)]
struct Locked {
    mass: f64,
    /// Mass × place, kg·m.
    moment: Vec3,
    /// About the world's origin.
    inertia: Mat3,
    /// Of the body at the centre, rad/s.
    angular: Vec3,
    /// m/s.
    linear: Vec3,
    center: Vec3,
    kinetic: f64,
}

impl Guard {
    pub fn new(m: &Model) -> Self {
        let (mut locked, mut part) = (vec![], vec![0; m.bodies.len()]);
        for (i, b) in m.bodies.iter().enumerate().skip(1) {
            part[i] = if b.parent == 0 { locked.len() } else { part[b.parent] };
            if b.parent == 0 {
                locked.push((i, Locked::default()));
            }
        }
        Self { kinematics: Kinematics::new(m), locked, part }
    }

    fn energy(&mut self, m: &Model, s: &State, gravity: [f64; 3]) -> Energy {
        kinematics(m, &mut self.kinematics, &s.q, &s.v);
        energy(m, &self.kinematics, gravity)
    }
}

impl Rbx {
    /// Slows the state down to the energy that it may have, coming from `mid.start`, if that is a share of its speeds below `least`.
    pub(super) fn guard(
        &mut self,
        m: &Model,
        mid: &mut Midpoint,
        (gravity, least): ([f64; 3], f64),
        report: &mut StepReport,
    ) {
        let mut before = mid.guard.energy(m, &mid.start, gravity);
        let mut after = mid.guard.energy(m, &self.state, gravity);
        before.kinetic += mid.start.rotor_energy(m, self.axes.rotors());
        after.kinetic += self.state.rotor_energy(m, self.axes.rotors());
        let (by_start, by_end) = self.axes.paid();
        mid.guard.lock(m);
        let rest = after.kinetic - mid.guard.locked.iter().map(|(_, l)| l.kinetic).sum::<f64>();
        let held = before.kinetic + before.potential - after.potential + by_start - (after.kinetic - rest);
        let share = if rest > 0.0 { share_of(rest, held, by_end) } else { 1.0 };
        if !(0.0..least).contains(&share) {
            return;
        }
        report.guarded += 1;
        report.guarded_energy += (1.0 - share * share) * rest;
        mid.guard.slow_down(m, &mut self.state, share);
    }
}

impl Guard {
    /// Finds the locked motion of everything that floats on the world; what stands on it has none.
    fn lock(&mut self, m: &Model) {
        let k = &self.kinematics;
        for (_, locked) in &mut self.locked {
            *locked = Locked::default();
        }
        for (i, b) in m.bodies.iter().enumerate().skip(1) {
            let (root, part) = &mut self.locked[self.part[i]];
            if m.bodies[*root].joint == JointType::Floating {
                part.add(b, (Mat3::from(k.r[i]), k.p[i].into()), (k.w[i].into(), k.v[i].into()));
            }
        }
        for (_, locked) in &mut self.locked {
            locked.settle();
        }
    }

    /// Scales the velocities, those of what floats about its locked motion.
    fn slow_down(&self, m: &Model, s: &mut State, share: f64) {
        for v in &mut s.v {
            *v *= share;
        }
        let k = &self.kinematics;
        for (root, l) in self.locked.iter().filter(|(_, l)| l.mass > 0.0) {
            let (r, p, v) = (k.r[*root], Vec3::from(k.p[*root]), m.bodies[*root].v);
            let linear = l.linear + l.angular.cross(&(p - l.center));
            let (w, u) = (r.tv(V3::from(l.angular)), r.tv(V3::from(linear)));
            for (x, own) in s.v[v..v + 6].iter_mut().zip([w.x, w.y, w.z, u.x, u.y, u.z]) {
                *x += (1.0 - share) * own;
            }
        }
    }
}

impl Locked {
    /// Adds a body at a pose with a twist along its own axes.
    fn add(&mut self, b: &Body, (r, origin): (Mat3, Vec3), (w, v): (Vec3, Vec3)) {
        let c = r * Vec3::from(b.mc);
        let p = r * (v * b.mass + w.cross(&b.mc.into()));
        let l = r * (Mat3::from(b.inertia) * w + Vec3::from(b.mc).cross(&v));
        self.mass += b.mass;
        self.moment += c + origin * b.mass;
        self.linear += p;
        self.angular += l + origin.cross(&p);
        // J + 2 (c·o) 1 − (c oᵀ + o cᵀ) + m (o·o 1 − o oᵀ)
        self.inertia += r * Mat3::from(b.inertia) * r.transpose();
        self.inertia += Mat3::identity() * (2.0 * c.dot(&origin) + b.mass * origin.norm_squared());
        self.inertia -= c * origin.transpose() + origin * c.transpose() + b.mass * origin * origin.transpose();
    }

    /// From sums to the motion; none if there is no such motion.
    fn settle(&mut self) {
        let sums = *self;
        *self = Self::default();
        if sums.mass <= 0.0 {
            return;
        }
        let center = sums.moment / sums.mass;
        let about = Mat3::identity() * center.norm_squared() - center * center.transpose();
        let Some(inverse) = (sums.inertia - about * sums.mass).try_inverse() else { return };
        let momentum = sums.angular - center.cross(&sums.linear);
        let (angular, linear) = (inverse * momentum, sums.linear / sums.mass);
        let kinetic = 0.5 * (sums.mass * linear.norm_squared() + angular.dot(&momentum));
        if kinetic.is_finite() {
            *self = Self { angular, linear, center, kinetic, ..sums };
        }
    }
}
