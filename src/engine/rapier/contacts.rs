//! What collides, which pairs do not, and what contacts did in a step.

use super::convert::{ours, pose, vector};
use super::parts::Parts;
use super::shapes::shape;
use super::sim::Sim;
use crate::dynamics::Kinematics;
use crate::engine::rolling::{Turning, roll};
use crate::math::V3;
use crate::model::Model;
use crate::solver::ContactPoint;
use rapier3d_f64::pipeline::{ActiveHooks, PairFilterContext, PhysicsHooks};
use rapier3d_f64::prelude::{CoefficientCombineRule, ColliderBuilder, ContactManifold, ContactPair, SolverFlags};

/// What contacts did in the last step. Makes its memory as it grows.
#[derive(Clone, Debug, Default)]
pub(super) struct Contacts {
    /// Those that carry something.
    pub points: Vec<ContactPoint>,
    /// Per body of the model: force, averaged over the step, along the world's axes, N.
    pub received: Vec<V3<f64>>,
    /// The deepest penetration so far, m.
    pub worst: f64,
    /// Energy that rolling and spinning friction took in the step, J.
    pub rolled: f64,
}

/// Which links never touch.
pub(super) struct Filter<'a>(pub &'a Model);

impl PhysicsHooks for Filter<'_> {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let index = |handle| context.colliders.get(handle).map(|c| c.user_data as usize);
        let (a, b) = (index(context.collider1)?, index(context.collider2)?);
        let link = |c: usize| self.0.colliders.get(c).and_then(|c| c.link);
        let standing = |handle| context.bodies.get(handle).is_none_or(|b| b.is_fixed());
        let stands = |body: Option<_>| body.is_none_or(standing);
        if stands(context.rigid_body1) && stands(context.rigid_body2) {
            return None;
        }
        if let (Some(a), Some(b)) = (link(a), link(b))
            && self.0.excluded_pairs.binary_search(&[a.min(b), a.max(b)]).is_ok()
        {
            return None;
        }
        Some(SolverFlags::COMPUTE_RIGID_IMPULSES)
    }
}

/// Puts all colliders on their bodies.
pub(super) fn insert_colliders(m: &Model, sim: &mut Sim, parts: &Parts) {
    if !m.effects.contact {
        return;
    }
    for (i, c) in m.colliders.iter().enumerate() {
        let (body, at) = m.seat_of(c);
        let (Some((shape, own)), Some(handle)) = (shape(&c.form), parts.handles[body]) else { continue };
        let collider = ColliderBuilder::new(shape)
            .position(pose(&at) * own)
            .density(0.0)
            .friction(c.surface.friction)
            .friction_combine_rule(CoefficientCombineRule::Multiply)
            .restitution(c.surface.restitution)
            .restitution_combine_rule(CoefficientCombineRule::Multiply)
            .contact_skin(c.margin)
            .active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS)
            .user_data(i as u128);
        sim.colliders.insert_with_parent(collider, handle, &mut sim.bodies);
    }
}

/// The two sides of a pair: indices of colliders and bodies of the model.
struct Sides {
    colliders: [usize; 2],
    bodies: [usize; 2],
    /// The first of the two is rapier's second.
    swapped: bool,
}

impl Contacts {
    pub fn new(m: &Model) -> Self {
        Self { received: vec![V3::default(); m.bodies.len()], ..Self::default() }
    }

    /// Before a step that may have several parts.
    pub fn open(&mut self) {
        self.received.fill(V3::default());
        self.points.clear();
        self.rolled = 0.0;
    }

    /// Reads the contacts of a part of `h.0` seconds of a step of `h.1`, of which `h.2` was rapier's last substep.
    pub fn read(&mut self, m: &Model, sim: &Sim, h: (f64, f64, f64)) {
        self.points.clear();
        for pair in sim.narrow.contact_pairs() {
            let Some(sides) = sides(m, sim, pair) else { continue };
            for manifold in pair.solver_manifolds() {
                self.read_manifold(sim, pair, manifold, &sides, h);
            }
        }
        self.points.sort_by_key(|p| p.colliders);
    }

    fn read_manifold(
        &mut self,
        sim: &Sim,
        pair: &ContactPair,
        of: &ContactManifold,
        sides: &Sides,
        h: (f64, f64, f64),
    ) {
        let (Some(first), Some(second)) = (sim.colliders.get(pair.collider1), sim.colliders.get(pair.collider2)) else {
            return;
        };
        let normal = of.data.normal;
        let carried: f64 = of.points.iter().map(|p| p.data.impulse).sum();
        let skins = first.contact_skin() + second.contact_skin();
        for p in &of.points {
            let on = |c: &rapier3d_f64::prelude::Collider, sub: Option<&rapier3d_f64::math::Pose>, at| {
                c.position() * sub.map_or(at, |sub| sub * at)
            };
            let (a, b) = (on(first, of.subshape_pos1(), p.local_p1), on(second, of.subshape_pos2(), p.local_p2));
            let depth = skins - (b - a).dot(normal);
            self.worst = self.worst.max(depth);
            if p.data.impulse <= 0.0 {
                continue;
            }
            // Friction is that of the whole manifold, and of the last substep alone.
            let friction = p.data.warmstart_tangent_world * (p.data.impulse / carried / h.2);
            let force = ours(normal * (p.data.impulse / h.0) - friction);
            let side = if sides.swapped { -1.0 } else { 1.0 };
            let share = force * (side * h.0 / h.1);
            self.received[sides.bodies[1]] += share;
            self.received[sides.bodies[0]] += -share;
            self.points.push(ContactPoint {
                colliders: sides.colliders,
                point: ours((a + b) * 0.5),
                normal: ours(normal) * side,
                depth,
                force: force * side,
            });
        }
    }

    /// Energy that they took in a part of a step of `h` seconds between two poses, J: impulses along the mean of the relative
    /// velocities at its ends, which is exact for impacts.
    pub fn taken(&self, m: &Model, ends: [&Kinematics; 2], h: f64) -> f64 {
        let done = self.points.iter().map(|p| {
            let bodies = p.colliders.map(|c| m.seat_of(&m.colliders[c]).0);
            let apart = |k: &Kinematics| k.velocity_at(bodies[1], p.point) - k.velocity_at(bodies[0], p.point);
            0.5 * h * p.force.dot(apart(ends[0]) + apart(ends[1]))
        });
        -done.sum::<f64>()
    }

    /// Lets rolling and spinning friction turn the bodies.
    pub fn roll(&mut self, m: &Model, sim: &mut Sim, parts: &Parts, (k, h): (&Kinematics, f64)) {
        for p in &self.points {
            self.rolled += roll(m, p, h, &mut Bodies { sim, parts, k }).unwrap_or(0.0);
        }
    }
}

/// What friction can turn.
struct Bodies<'a> {
    sim: &'a mut Sim,
    parts: &'a Parts,
    k: &'a Kinematics,
}

impl Turning for Bodies<'_> {
    fn spin(&self, body: usize) -> V3<f64> {
        self.parts.handles[body].and_then(|h| self.sim.bodies.get(h)).map_or(V3::default(), |b| ours(b.angvel()))
    }

    fn mobility(&self, body: usize, about: V3<f64>) -> f64 {
        self.parts.turning(self.k, body, about)
    }

    fn turn(&mut self, body: usize, impulse: V3<f64>) {
        let handle = self.parts.handles[body];
        if let Some(b) = handle.and_then(|h| self.sim.bodies.get_mut(h)).filter(|b| b.is_dynamic()) {
            b.apply_torque_impulse(vector(impulse), false);
        }
    }
}

fn sides(m: &Model, sim: &Sim, pair: &ContactPair) -> Option<Sides> {
    let index = |handle| sim.colliders.get(handle).map(|c| c.user_data as usize);
    let (a, b) = (index(pair.collider1)?, index(pair.collider2)?);
    let swapped = a > b;
    let colliders = [a.min(b), a.max(b)];
    let bodies = colliders.map(|c| m.colliders.get(c).map_or(0, |c| m.seat_of(c).0));
    Some(Sides { colliders, bodies, swapped })
}
