//! The bodies: which of the model's are rapier's, with what mass, and where they are.

use super::convert::{axes, frame, ours, vector};
use super::sim::Sim;
use crate::dynamics::{Kinematics, kinematics_of};
use crate::engine::State;
use crate::engine::sleep::limit;
use crate::math::{Mat3, S3, V3};
use crate::model::{Body, Deactivation, Model};
use rapier3d_f64::math::Matrix;
use rapier3d_f64::prelude::{MassProperties, RigidBodyBuilder, RigidBodyHandle};

/// A body without mass between two joints has this share of the mass and inertia of what it carries: rapier cannot divide by
/// nothing.
const LIGHT: f64 = 1e-3;
/// Least radius of gyration, m: below it a body counts as a point to rapier, which then does not turn it.
const POINT: f64 = 1e-3;

/// The bodies of a model in rapier.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    /// Per body of the model: `None` if it is carried, without one of its own.
    pub handles: Vec<Option<RigidBodyHandle>>,
    /// Per body: centre of mass along its axes, m.
    centers: Vec<V3<f64>>,
    /// Per body: mass and inertia about the centre of mass, as rapier has them.
    masses: Vec<(f64, S3<f64>)>,
    /// May any of them sleep?
    pub sleepy: bool,
}

/// Without mass, and with a joint that does not move in rapier: what a soft joint puts between its sides.
pub(super) fn is_carried(m: &Model, body: usize) -> bool {
    m.bodies[body].mass == 0.0 && is_soft(m, body)
}

/// Its coordinate is a direction in which a joint yields.
pub(super) fn is_soft(m: &Model, body: usize) -> bool {
    m.softs.iter().any(|s| s.v == m.bodies[body].v)
}

/// Bodies that get a mass, or an inertia, that they do not have.
pub(super) fn embodied(m: &Model) -> impl Iterator<Item = usize> {
    let point = |b: &Body| size_of(b).is_some_and(|(_, i)| least(&i) < 0.5 * b.mass * POINT * POINT);
    (1..m.bodies.len()).filter(move |i| !is_carried(m, *i) && (m.bodies[*i].mass == 0.0 || point(&m.bodies[*i])))
}

impl Parts {
    /// Makes them at these poses.
    pub fn new(m: &Model, sim: &mut Sim, k: &Kinematics) -> Self {
        let n = m.bodies.len();
        let mut parts = Self {
            handles: vec![None; n],
            centers: vec![V3::default(); n],
            masses: vec![(0.0, S3::default()); n],
            sleepy: false,
        };
        parts.handles[0] = Some(sim.bodies.insert(RigidBodyBuilder::fixed()));
        for i in (1..n).rev() {
            let own = size_of(&m.bodies[i]).map(|(c, inertia)| (m.bodies[i].mass, c, inertia));
            let (mass, center, inertia) = own.unwrap_or_else(|| parts.light(m, i));
            (parts.masses[i], parts.centers[i]) = ((mass, inertia), center);
        }
        for i in (1..n).filter(|i| !is_carried(m, *i)) {
            let limit = limit(m, i);
            parts.sleepy |= limit.is_some();
            parts.handles[i] = Some(parts.insert(sim, k, i, limit));
        }
        parts
    }

    /// What a body without mass gets: a share of the first body with mass that hangs on it.
    fn light(&self, m: &Model, i: usize) -> (f64, V3<f64>, S3<f64>) {
        let next = (i + 1..m.bodies.len()).find(|c| m.bodies[*c].parent == i).unwrap_or(i);
        let ((mass, inertia), c) = (self.masses[next], self.centers[next]);
        let round = (inertia.xx + inertia.yy + inertia.zz) / 3.0 + mass * c.dot(c);
        (LIGHT * mass, V3::default(), S3 { xx: LIGHT * round, yy: LIGHT * round, zz: LIGHT * round, ..S3::default() })
    }

    fn insert(&self, sim: &mut Sim, k: &Kinematics, i: usize, limit: Option<Deactivation>) -> RigidBodyHandle {
        let ((mass, inertia), center) = (self.masses[i], self.centers[i]);
        let floor = mass * POINT * POINT;
        let more = (floor - least(&inertia)).max(0.0);
        let more = if more > 0.5 * floor { more } else { 0.0 };
        let s = S3 { xx: inertia.xx + more, yy: inertia.yy + more, zz: inertia.zz + more, ..inertia };
        let matrix = Matrix::from_cols(
            vector(V3::new(s.xx, s.xy, s.xz)),
            vector(V3::new(s.xy, s.yy, s.yz)),
            vector(V3::new(s.xz, s.yz, s.zz)),
        );
        let (angular, linear) = velocity(k, i, center);
        let mut body = RigidBodyBuilder::dynamic()
            .pose(frame(&k.r[i], k.p[i]))
            .angvel(vector(angular))
            .linvel(vector(linear))
            .additional_mass_properties(MassProperties::with_inertia_matrix(vector(center), mass, matrix))
            .linear_damping(0.0)
            .angular_damping(0.0)
            .gyroscopic_forces_enabled(true)
            .allow_fast_rotation(true)
            .can_sleep(limit.is_some())
            .build();
        if let Some(limit) = limit {
            let sleep = body.activation_mut();
            sleep.normalized_linear_threshold = limit.linear;
            (sleep.angular_threshold, sleep.time_until_sleep) = (limit.angular, limit.after);
        }
        let handle = sim.bodies.insert(body);
        if let Some(body) = sim.bodies.get_mut(handle) {
            // Else it has neither mass nor centre until its first step.
            body.recompute_mass_properties_from_colliders(&sim.colliders);
        }
        handle
    }

    /// Fills `k` with where they are; what is carried is where `state` has it on its parent.
    pub fn read(&self, m: &Model, sim: &Sim, state: &State, k: &mut Kinematics) {
        for i in 1..m.bodies.len() {
            let Some(body) = self.handles[i].and_then(|h| sim.bodies.get(h)) else {
                kinematics_of(m, k, (&state.q, &state.v), &[i]);
                continue;
            };
            let r = axes(&body.position().rotation);
            let (w, v) = (r.tv(ours(body.angvel())), r.tv(ours(body.linvel())));
            (k.r[i], k.p[i], k.w[i]) = (r, ours(body.position().translation), w);
            k.v[i] = v - w.cross(self.centers[i]);
        }
    }

    /// Centre of mass in the world.
    pub fn center(&self, k: &Kinematics, body: usize) -> V3<f64> {
        k.r[body].mv(self.centers[body]) + k.p[body]
    }

    /// About how far from its centre of mass the mass of a body lies, m.
    pub fn gyration(&self, body: usize) -> f64 {
        let (mass, i) = self.masses[body];
        ((i.xx + i.yy + i.zz) / (2.0 * mass)).sqrt().max(POINT)
    }

    /// Resistance of a body to be turned about a unit vector of the world, 1/(kg·m²); 0 for what stands still.
    pub fn turning(&self, k: &Kinematics, body: usize, about: V3<f64>) -> f64 {
        let (mass, inertia) = self.masses[body];
        let own = k.r[body].tv(about);
        if mass > 0.0 { own.dot(inertia.inverse().mv(own)) } else { 0.0 }
    }
}

/// Of the centre of mass, along the world's axes: rad/s, m/s.
fn velocity(k: &Kinematics, i: usize, center: V3<f64>) -> (V3<f64>, V3<f64>) {
    (k.r[i].mv(k.w[i]), k.r[i].mv(k.v[i] + k.w[i].cross(center)))
}

/// Centre of mass, and inertia about it along the body's axes; `None` without mass.
fn size_of(b: &Body) -> Option<(V3<f64>, S3<f64>)> {
    let c = (b.mass > 0.0).then(|| b.mc * (1.0 / b.mass))?;
    let (cc, i) = (c.dot(c), &b.inertia);
    Some((
        c,
        S3 {
            xx: i.xx - b.mass * (cc - c.x * c.x),
            yy: i.yy - b.mass * (cc - c.y * c.y),
            zz: i.zz - b.mass * (cc - c.z * c.z),
            xy: i.xy + b.mass * c.x * c.y,
            xz: i.xz + b.mass * c.x * c.z,
            yz: i.yz + b.mass * c.y * c.z,
        },
    ))
}

/// Least principal moment, kg·m².
fn least(s: &S3<f64>) -> f64 {
    Mat3::from(*s).symmetric_eigenvalues().min()
}
