//! The last resort of a step that even its shortest pieces cannot resolve: whirling so fast that the velocity products of an
//! explicit step would make energy out of nothing.
//!
//! Such a piece is made explicitly, and then the motion relative to the body as a whole is slowed down until the energy is
//! what the drives and the weight have paid for. The momentum of a robot on a free base stays: the kinetic energy splits, without
//! a cross term, into that of the locked body with the same momentum and the rest (König). With a fixed base, or in several pieces,
//! all motion is slowed down alike. Each such piece is counted, and what it took is added up.

use super::midpoint::Midpoint;
use super::rbx::{Rbx, State, StepReport};
use crate::dynamics::{Energy, Kinematics, energy, kinematics, momentum};
use crate::math::{Mat3, S3, V3, Vec3};
use crate::model::{Base, JointType, Model};

/// Buffers of the guard.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    kinematics: Kinematics,
}

/// The motion of the whole as if all joints were locked.
struct Locked {
    angular: Vec3,
    linear: Vec3,
    center: Vec3,
    kinetic: f64,
}

impl Guard {
    pub fn new(m: &Model) -> Self {
        Self { kinematics: Kinematics::new(m) }
    }

    fn energy(&mut self, m: &Model, s: &State, gravity: [f64; 3]) -> Energy {
        kinematics(m, &mut self.kinematics, &s.q, &s.v);
        energy(m, &self.kinematics, gravity)
    }
}

impl Rbx {
    /// Slows the state down to the energy that it may have, coming from `mid.start`.
    pub(super) fn guard(&mut self, m: &Model, mid: &mut Midpoint, gravity: [f64; 3], report: &mut StepReport) {
        let mut before = mid.guard.energy(m, &mid.start, gravity);
        let mut after = mid.guard.energy(m, &self.state, gravity);
        before.kinetic += mid.start.rotor_energy(m, self.axes.rotors());
        after.kinetic += self.state.rotor_energy(m, self.axes.rotors());
        let (by_start, by_end) = self.axes.paid();
        let locked = Locked::of(m, &mid.guard.kinematics);
        let rest = after.kinetic - locked.as_ref().map_or(0.0, |l| l.kinetic);
        let held = before.kinetic + before.potential - after.potential + by_start - (after.kinetic - rest);
        // share² · rest = held + share · by_end
        let root = (by_end * by_end + 4.0 * rest * held.max(0.0)).sqrt();
        let share = if rest > 0.0 { (by_end + root) / (2.0 * rest) } else { 1.0 };
        if !(0.0..1.0).contains(&share) {
            return;
        }
        report.guarded += 1;
        report.guarded_energy += (1.0 - share * share) * rest;
        slow_down(m, &mid.guard.kinematics, &mut self.state, share, locked);
    }
}

/// Scales the velocities, those of a free base about its locked motion.
fn slow_down(m: &Model, k: &Kinematics, s: &mut State, share: f64, locked: Option<Locked>) {
    for v in &mut s.v {
        *v *= share;
    }
    let (Some(l), Some(base)) = (locked, m.bodies.get(1)) else { return };
    let (r, p) = (k.r[1], Vec3::from(k.p[1]));
    let linear = l.linear + l.angular.cross(&(p - l.center));
    let (w, v) = (r.tv(V3::from(l.angular)), r.tv(V3::from(linear)));
    for (x, own) in s.v[base.v..base.v + 6].iter_mut().zip([w.x, w.y, w.z, v.x, v.y, v.z]) {
        *x += (1.0 - share) * own;
    }
}

impl Locked {
    /// `None` if the robot is not one tree on a free base.
    fn of(m: &Model, k: &Kinematics) -> Option<Self> {
        let roots = m.bodies[1..].iter().filter(|b| b.parent == 0).count();
        if m.base != Base::Free || roots != 1 || m.bodies[1].joint != JointType::Floating {
            return None;
        }
        let p = momentum(m, k);
        let (mut mass, mut inertia) = (0.0, Mat3::zeros());
        for (i, b) in m.bodies.iter().enumerate().skip(1) {
            let r = Mat3::from(k.r[i]);
            let origin = Vec3::from(k.p[i]) - p.center;
            let c = r * Vec3::from(b.mc);
            mass += b.mass;
            inertia += matrix(&b.inertia.rotated(&k.r[i]));
            // J + 2 (c·o) 1 − (c oᵀ + o cᵀ) + m (o·o 1 − o oᵀ)
            inertia += Mat3::identity() * (2.0 * c.dot(&origin) + b.mass * origin.norm_squared());
            inertia -= c * origin.transpose() + origin * c.transpose() + b.mass * origin * origin.transpose();
        }
        let angular = inertia.try_inverse()? * p.angular;
        let linear = p.linear / mass;
        let kinetic = 0.5 * (mass * linear.norm_squared() + angular.dot(&p.angular));
        kinetic.is_finite().then_some(Self { angular, linear, center: p.center, kinetic })
    }
}

fn matrix(s: &S3<f64>) -> Mat3 {
    Mat3::new(s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz)
}
