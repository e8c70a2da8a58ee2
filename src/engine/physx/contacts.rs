//! What contacts did in a step.
//!
//! PhysX tells the normal impulse of a point, not its friction. What a body got of all its contacts follows from its momentum;
//! of that what is not normal is given to the pairs of touching bodies: exactly if they touch each other without a loop (a
//! tower, whatever lies on the ground), else as the least impulses that fit. Within a pair it goes with the normal ones.

use super::flight::Flight;
use super::plan::Plan;
use super::share::Shares;
use super::spec::Touch;
use crate::engine::rolling::{Turning, roll};
use crate::math::{V3, Vec3};
use crate::model::Model;
use crate::solver::ContactPoint;

/// Of the last step. Makes its memory as it grows.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Those that carry something.
    pub points: Vec<ContactPoint>,
    /// Per body of the model: force, averaged over the step, along the world's axes, N.
    pub received: Vec<V3<f64>>,
    /// The deepest penetration so far, m.
    pub worst: f64,
    /// Energy that they took in the step, J.
    pub taken: f64,
    /// Per body of PhysX: impulse of all its contacts, N·s, and does it have one?
    got: Vec<(Vec3, bool)>,
    shares: Shares,
}

/// A part of a step: the bodies at both ends, and which sleep.
pub struct Part<'a> {
    /// At its start.
    pub from: &'a [Flight],
    /// At its end.
    pub to: &'a mut [Flight],
    /// Per body.
    pub asleep: &'a [bool],
    /// m/s².
    pub gravity: Vec3,
    /// Its length and that of the step, s.
    pub h: (f64, f64),
}

impl Contacts {
    /// Room for a model.
    pub fn new(m: &Model, plan: &Plan) -> Self {
        let n = plan.seats.len();
        let received = vec![V3::default(); if plan.scene.shapes.is_empty() { 0 } else { m.bodies.len() }];
        Self { received, got: vec![(Vec3::zeros(), false); n], shares: Shares::new(n), ..Self::default() }
    }

    /// Goes on with the deepest penetration of before, m.
    pub fn after(self, worst: f64) -> Self {
        Self { worst, ..self }
    }

    /// Before a step that may have several parts.
    pub fn open(&mut self) {
        self.received.fill(V3::default());
        self.taken = 0.0;
    }

    /// Reads what a part did.
    pub fn read(&mut self, m: &Model, plan: &Plan, touches: &[Touch], part: &Part) {
        let still = |body: Option<usize>| body.is_none_or(|i| part.asleep[i]);
        // PhysX does not tell of what sleeps: it carries what it did.
        self.points.retain(|p| p.colliders.iter().all(|c| still(plan.carrier(m, *c as u32))));
        self.shares.clear();
        self.got.iter_mut().for_each(|got| *got = (Vec3::zeros(), false));
        for t in touches {
            self.add(m, plan, t, part);
        }
        self.points.sort_by_key(|p| p.colliders);
        self.settle(m, plan, part);
        let n = self.points.len();
        for i in 0..n {
            let bodies = self.points[i].colliders.map(|c| plan.carrier(m, c as u32));
            if bodies.iter().all(|b| still(*b)) {
                continue;
            }
            let p = &mut self.points[i];
            let pressed = p.force.dot(p.normal);
            let share = self.shares.of(bodies, pressed);
            p.force = (p.force + V3::from(share)) * (1.0 / part.h.0);
        }
    }

    /// One point; for now its force is an impulse, and without friction.
    fn add(&mut self, m: &Model, plan: &Plan, t: &Touch, part: &Part) {
        let swapped = t.colliders[0] > t.colliders[1];
        let [a, b] = if swapped { [t.colliders[1], t.colliders[0]] } else { t.colliders };
        let normal = Vec3::from(t.normal.map(f64::from)) * if swapped { 1.0 } else { -1.0 };
        let start = Vec3::from(t.point.map(f64::from));
        let bodies = [a, b].map(|c| plan.carrier(m, c));
        if bodies.iter().flatten().all(|i| part.asleep[*i]) {
            return;
        }
        let ends = bodies.map(|body| body.map_or(start, |i| moved(&part.from[i], &part.to[i], start)));
        let margins = m.colliders[a as usize].margin + m.colliders[b as usize].margin;
        let depth = margins - f64::from(t.separation) - (ends[1] - ends[0]).dot(&normal);
        self.worst = self.worst.max(depth);
        let impulse = f64::from(t.impulse);
        if impulse <= 0.0 {
            return;
        }
        self.shares.touch(bodies, impulse);
        for (body, sign) in [(bodies[0], -1.0), (bodies[1], 1.0)] {
            if let Some(i) = body {
                self.got[i].0 += normal * (sign * impulse);
                self.got[i].1 = true;
            }
        }
        self.points.push(ContactPoint {
            colliders: [a as usize, b as usize],
            point: V3::from((ends[0] + ends[1]) * 0.5),
            normal: V3::from(normal),
            depth,
            force: V3::from(normal * impulse),
        });
    }

    /// What each body got by its momentum, and of that what is not normal.
    fn settle(&mut self, m: &Model, plan: &Plan, part: &Part) {
        let (h, whole) = part.h;
        for (i, seat) in plan.seats.iter().enumerate() {
            let (normal, touched) = self.got[i];
            let (from, to) = (&part.from[i], &part.to[i]);
            let weight = part.gravity * (seat.mass * h);
            if part.asleep[i] {
                self.receive(seat.own.body, -weight / whole);
            }
            if !touched || part.asleep[i] {
                continue;
            }
            let got = (to.v - from.v) * seat.mass - weight;
            self.receive(seat.own.body, got / whole);
            self.shares.ask(i, got - normal);
            self.taken -= 0.5 * got.dot(&(from.v + to.v)) + to.turning(seat) - from.turning(seat);
        }
        self.shares.solve();
        debug_assert!(self.received.is_empty() || self.received.len() == m.bodies.len());
    }

    fn receive(&mut self, body: usize, force: Vec3) {
        if let Some(received) = self.received.get_mut(body) {
            *received += V3::from(force);
        }
    }

    /// Lets rolling and spinning friction turn the bodies. True if there is any.
    pub fn roll(&mut self, m: &Model, plan: &Plan, part: &mut Part) -> bool {
        let mut rolls = false;
        for p in &self.points {
            let taken = roll(m, p, part.h.0, &mut Awake { plan, part });
            self.taken += taken.unwrap_or(0.0);
            rolls |= taken.is_some();
        }
        rolls
    }
}

/// Where a point that is fixed to a body goes.
fn moved(from: &Flight, to: &Flight, point: Vec3) -> Vec3 {
    (to.pose * (from.pose.inverse() * nalgebra::Point3::from(point))).coords
}

/// What friction can turn.
struct Awake<'a, 'b> {
    plan: &'a Plan,
    part: &'a mut Part<'b>,
}

impl Awake<'_, '_> {
    fn index(&self, body: usize) -> Option<usize> {
        self.plan.index[body].filter(|i| !self.part.asleep[*i])
    }
}

impl Turning for Awake<'_, '_> {
    fn spin(&self, body: usize) -> V3<f64> {
        self.index(body).map_or(V3::default(), |i| V3::from(self.part.to[i].w))
    }

    fn mobility(&self, body: usize, about: V3<f64>) -> f64 {
        self.index(body).map_or(0.0, |i| self.part.to[i].mobility(&self.plan.seats[i], &about.into()))
    }

    fn turn(&mut self, body: usize, impulse: V3<f64>) {
        if let Some(i) = self.index(body) {
            self.part.to[i].spin(&self.plan.seats[i], &impulse.into());
        }
    }
}
