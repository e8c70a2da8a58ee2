//! The force that goes through each joint, averaged over a step.
//!
//! What lies beyond a joint moves under its weight m g, the force e of contacts and damping on it, and the force f that the joint
//! transmits, so over a step of h seconds
//!
//! ```text
//! f = (P⁺ − P⁻)/h − m g − e
//! ```
//!
//! with P its linear momentum at the end and the beginning. This holds for any integrator, and counts impacts in full.

use super::damping::rate;
use super::{Kinematics, Scheme, body_momentum, kinematics};
use crate::math::{Pose, V3};
use crate::model::{JointType, Model};

/// What acts on bodies from outside of the tree in a step, besides their weight.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outside<'a> {
    /// Force of contacts on each body, averaged over the step, along the world's axes, N; empty if there are none.
    pub contacts: &'a [V3<f64>],
    /// Length of the step, s, and how it takes the damping of bodies; none: it does not.
    pub damping: Option<(f64, Scheme)>,
}

/// Forces through the joints of one model. Makes its memory once.
#[derive(Clone, Debug)]
pub struct JointForces {
    kinematics: Kinematics,
    /// Per body: mass of what its joint carries, kg.
    mass: Vec<f64>,
    before: Vec<V3<f64>>,
    after: Vec<V3<f64>>,
    /// Per damped body: its own momentum, at the beginning and the end.
    damped: Vec<[V3<f64>; 2]>,
    /// Per body: force of contacts and damping on what its joint carries, N.
    outside: Vec<V3<f64>>,
    /// State that `after` belongs to: as a rule the next step begins with it.
    ended: (Vec<f64>, Vec<f64>),
    /// Where the fixed bases were then.
    bases: Vec<Pose>,
}

impl JointForces {
    /// Room for this model.
    pub fn new(m: &Model) -> Self {
        let n = m.bodies.len();
        let mut mass: Vec<f64> = m.bodies.iter().map(|b| b.mass).collect();
        for_children(m, |parent, child| mass[parent] += mass[child]);
        let [before, after, outside] = std::array::from_fn(|_| vec![V3::default(); n]);
        let damped = vec![[V3::default(); 2]; m.dampings.len()];
        // No state is equal to this one.
        let ended = (vec![f64::NAN; m.nq], vec![f64::NAN; m.nv]);
        let bases = bases(m).copied().collect();
        Self { kinematics: Kinematics::new(m), mass, before, after, damped, outside, ended, bases }
    }

    /// Takes the state `q` (nq), `v` (nv) at the beginning of a step.
    pub fn begin(&mut self, m: &Model, q: &[f64], v: &[f64]) {
        if self.ended.0 == q && self.ended.1 == v && self.bases.iter().eq(bases(m)) {
            std::mem::swap(&mut self.before, &mut self.after);
            self.damped.iter_mut().for_each(|p| p[0] = p[1]);
        } else {
            momenta(m, &mut self.kinematics, (q, v), &mut self.before);
            own_momenta(m, &self.kinematics, &mut self.damped, 0);
        }
    }

    /// Takes the state at the end of the step of `outside`.
    pub fn end(&mut self, m: &Model, (q, v): (&[f64], &[f64]), outside: &Outside) {
        momenta(m, &mut self.kinematics, (q, v), &mut self.after);
        own_momenta(m, &self.kinematics, &mut self.damped, 1);
        self.take_outside(m, outside);
        self.ended.0.copy_from_slice(q);
        self.ended.1.copy_from_slice(v);
        for (then, now) in self.bases.iter_mut().zip(bases(m)) {
            *then = *now;
        }
    }

    fn take_outside(&mut self, m: &Model, outside: &Outside) {
        self.outside.fill(V3::default());
        for (sum, force) in self.outside.iter_mut().zip(outside.contacts) {
            *sum = *force;
        }
        if let Some((h, scheme)) = outside.damping {
            for (d, [start, end]) in m.dampings.iter().zip(&self.damped) {
                let momentum = if scheme == Scheme::Start { *start } else { (*start + *end) * 0.5 };
                self.outside[d.body] += momentum * -rate(d.linear, (h, scheme));
            }
        }
        for_children(m, |parent, child| {
            let carried = self.outside[child];
            self.outside[parent] += carried;
        });
    }

    /// Force on the body through its joint in the step of `h` seconds between the two states under gravity (m/s²), along
    /// the axes of the world, N. 0 for a floating joint within the tree, which transmits nothing.
    pub fn force(&self, body: usize, gravity: [f64; 3], h: f64) -> V3<f64> {
        let g = V3::from(gravity);
        (self.after[body] - self.before[body]) * (1.0 / h) - g * self.mass[body] - self.outside[body]
    }
}

fn bases(m: &Model) -> impl Iterator<Item = &Pose> {
    std::iter::once(&m.base_pose).chain(m.joined.iter().map(|j| &j.base_pose))
}

/// Linear momentum of what each joint carries, along the axes of the world, kg·m/s.
fn momenta(m: &Model, k: &mut Kinematics, (q, v): (&[f64], &[f64]), out: &mut [V3<f64>]) {
    kinematics(m, k, q, v);
    out.iter_mut().enumerate().for_each(|(i, p)| *p = body_momentum(m, k, i));
    for_children(m, |parent, child| {
        let carried = out[child];
        out[parent] += carried;
    });
}

/// The same of each damped body alone, for the state that `k` is of.
fn own_momenta(m: &Model, k: &Kinematics, out: &mut [[V3<f64>; 2]], end: usize) {
    for (d, momentum) in m.dampings.iter().zip(out) {
        momentum[end] = body_momentum(m, k, d.body);
    }
}

/// Every joint that transmits a force, the outermost first.
fn for_children(m: &Model, mut add: impl FnMut(usize, usize)) {
    for (i, b) in m.bodies.iter().enumerate().skip(1).rev() {
        if b.joint != JointType::Floating {
            add(b.parent, i);
        }
    }
}
