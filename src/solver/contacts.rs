//! Contacts as rows: Coulomb's cone, rolling and spinning friction, restitution, and what keeps bodies out of each other.
//!
//! Notation: J(q) takes velocities v to the velocity u of side 1 against side 0 at a contact, along (normal, tangent, tangent);
//! 0, m, 1 mark the start, the middle and the end of a step of h. Derived in `docs/decisions/0016-contacts.md`.

mod booked;
mod point;
mod solve;

use self::point::{BodyColumns, Impulse, Point, axes};
use super::lifts::{Lift, LiftKind};
use super::rows::Rows;
use crate::contact::{Detector, Touch};
use crate::dynamics::{Kinematics, Posed, Response, Workspace, kinematics, velocities_of};
use crate::math::V3;
use crate::model::{JointType, Model};

/// Share of a penetration that one step takes back.
const ERP: f64 = 0.2;
/// Share of the velocities at the start to which the rows are solved if that is possible.
const AIM: f64 = 1e-9;
/// More rows than this begin with sweeps; fewer go to the direct finish from the impulses of the last step, and are swept only
/// where it does not help.
const FEW: usize = 40;
/// Tries of the direct finish: what it has not solved then stays near its impulses in the next pass or step.
const TRIES: usize = 4;
/// See `Contacts::least`: share of 1 / mass.
const HELD: f64 = 1e-12;
/// Rows that are left with more than this share of their velocities make energy: they are swept on, at most this often.
const ROUGH: f64 = 1e-4;
const EXTRA: u32 = 100;
/// Rows that are left with more than this share have no solution.
const BAD: f64 = 0.05;
/// Gaps that differ by less are equal, m.
const FLUSH: f64 = 1e-10;
/// A contact whose gap is less than this at the start of a step is held as it is, m: it is not asked for the speed that closes it.
const CLOSED: f64 = 1e-8;

/// One contact of the last step, in the world.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactPoint {
    /// Indices into `Model::colliders`.
    pub colliders: [usize; 2],
    /// m.
    pub point: V3<f64>,
    /// Unit, from the first collider to the second.
    pub normal: V3<f64>,
    /// By how much the two overlap at the end of the step; below 0: a gap; m.
    pub depth: f64,
    /// On the second, averaged over the step, N.
    pub force: V3<f64>,
}

/// What a pass knows of its step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass<'a> {
    /// Coordinates of the pass (nq).
    pub q: &'a [f64],
    /// Velocities at the start of the step (nv).
    pub v0: &'a [f64],
    /// s.
    pub h: f64,
    /// Do coordinates move with the mean of the velocities?
    pub mean: bool,
    /// At most.
    pub sweeps: u32,
}

/// All contacts of a model. Makes its memory once, and more only when there are more contacts than ever before.
#[derive(Clone, Debug)]
pub struct Contacts {
    detector: Detector,
    touches: Vec<Touch>,
    /// Per body: it rests.
    rests: Vec<bool>,
    points: Vec<Point>,
    /// Of the last step, ordered by key.
    old: Vec<Point>,
    start: Posed,
    middle: Kinematics,
    end: Kinematics,
    /// The state after the step.
    after: Posed,
    /// Bodies of contacts that are live, and all that carry them, ascending.
    chain: Vec<usize>,
    on_chain: Vec<bool>,
    v1: Vec<f64>,
    ids: Vec<u32>,
    columns: BodyColumns,
    /// Blocks that give way by less (trace, 1/kg) do not: what two bodies of a locked limb do to each other is rounding.
    least: f64,
    /// Per body: force of the contacts in the last step, N.
    received: Vec<V3<f64>>,
    /// Step of the impulses of `old`, s.
    h: f64,
    /// The deepest penetration at the start of a step so far, m.
    pub worst: f64,
    /// Passes whose bounces were reduced, because they would have made energy.
    pub tempered: u64,
    /// What the last solve left, m/s.
    pub residual: f64,
    /// Does any pair of surfaces bounce?
    bounces: bool,
    /// Has any pair rolling or spinning friction?
    resists_turning: bool,
}

impl Contacts {
    /// `None` if nothing can touch.
    pub fn new(m: &Model) -> Option<Self> {
        let detector = Detector::new(m)?;
        let k = Kinematics::new(m);
        Some(Self {
            detector,
            touches: vec![],
            rests: vec![false; m.bodies.len()],
            points: vec![],
            old: vec![],
            start: Posed::new(m),
            middle: k.clone(),
            end: k,
            after: Posed::new(m),
            chain: Vec::with_capacity(m.bodies.len()),
            on_chain: vec![false; m.bodies.len()],
            v1: vec![0.0; m.nv],
            ids: vec![],
            columns: BodyColumns::new(m),
            least: HELD / m.bodies.iter().map(|b| b.mass).sum::<f64>(),
            received: vec![V3::default(); m.bodies.len()],
            h: 0.0,
            worst: 0.0,
            tempered: 0,
            residual: 0.0,
            bounces: m.pairs().any(|(_, s)| s.restitution > 0.0),
            resists_turning: m.pairs().any(|(_, s)| s.rolling > 0.0 || s.spinning > 0.0),
        })
    }

    /// How far two bodies that are near come towards each other within the step, as a multiple of the thickness of the
    /// thinner one ([`Detector::fastest`]).
    pub fn fastest(&self) -> f64 {
        self.detector.fastest()
    }

    /// Forgets the steps so far.
    pub fn reset(&mut self) {
        self.points.clear();
        self.old.clear();
        self.rests.fill(false);
        self.received.fill(V3::default());
        (self.h, self.worst) = (0.0, 0.0);
        self.forget();
    }

    /// Forgets the poses: the model has moved.
    pub fn forget(&mut self) {
        self.start.forget();
        self.after.forget();
    }

    /// Poses and velocities of the state that the step has led to.
    pub fn arrive(&mut self, m: &Model, q: &[f64], v: &[f64]) -> &Kinematics {
        self.after.update(m, q, v);
        &self.after.k
    }

    /// As the last [`Contacts::arrive`] found them.
    pub fn end(&self) -> &Kinematics {
        &self.after.k
    }

    /// Poses and velocities at the start of the step.
    pub fn start(&self) -> &Kinematics {
        &self.start.k
    }

    /// Did a contact carry something in the last pass?
    pub fn carries(&self) -> bool {
        self.points.iter().any(Point::carries)
    }

    /// The bodies of contacts that carried something in the last step, or pushed bodies out of each other.
    pub fn acting_bodies(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.points.iter().filter(|p| p.carries() || (p.is_live() && p.lifts)).map(|p| p.touch.bodies)
    }

    /// Which bodies rest: to what moves they are as heavy as the world, and what lies between them stays as it is.
    pub fn rest(&mut self, rests: impl Fn(usize) -> bool) {
        self.rests.iter_mut().enumerate().for_each(|(body, flag)| *flag = rests(body));
    }

    /// The bodies of touches that are closed at these poses, or will be within `ahead` seconds of their motion.
    pub fn near<'a>(&'a self, k: &'a Kinematics, ahead: f64) -> impl Iterator<Item = [usize; 2]> + Clone + 'a {
        let closes = move |p: &&Point| {
            let placed = p.touch.placed(k);
            placed.gap + ahead * placed.normal.dot(approach(k, &p.touch, placed.point)).min(0.0) < FLUSH
        };
        self.points.iter().filter(closes).map(|p| p.touch.bodies)
    }

    /// The bodies of touches that were closed at the start of the last step.
    pub fn touching_bodies(&self) -> impl Iterator<Item = [usize; 2]> + Clone + '_ {
        self.points.iter().filter(|p| p.gap < FLUSH).map(|p| p.touch.bodies)
    }

    /// Does something touch at the start of the step?
    pub fn touching(&self) -> bool {
        self.points.iter().any(|p| p.gap < FLUSH)
    }

    /// Would the touches of the step overlap in this state?
    pub fn overlap(&mut self, m: &Model, q: &[f64], v: &[f64]) -> bool {
        if self.points.is_empty() {
            return false;
        }
        kinematics(m, &mut self.end, q, v);
        self.depth(&self.end) > 0.0
    }

    /// Is there nothing near that moves?
    pub fn is_empty(&self) -> bool {
        !self.points.iter().any(Point::is_live)
    }

    /// Finds the touches of a step of `h` from the state `q`, `v`.
    pub fn begin(&mut self, m: &Model, (q, v): (&[f64], &[f64]), h: f64) {
        std::mem::swap(&mut self.points, &mut self.old);
        self.points.clear();
        if self.after.is_at(q, v) {
            std::mem::swap(&mut self.start, &mut self.after);
        }
        self.start.update(m, q, v);
        let start = &self.start.k;
        self.detector.find(start, h, &mut self.touches);
        let scale = if self.h > 0.0 { h / self.h } else { 0.0 };
        let mut known = self.old.iter().peekable();
        for touch in &self.touches {
            let placed = touch.placed(start);
            let u = approach(start, touch, placed.point);
            while known.peek().is_some_and(|old| old.touch.key() < touch.key()) {
                known.next();
            }
            let impulse =
                known.peek().filter(|old| old.touch.key() == touch.key()).map(|old| old.impulse.scaled(scale));
            self.worst = self.worst.max(-placed.gap);
            let acts = touch.bodies.map(|b| if self.rests[b] { 0 } else { b });
            self.points.push(Point {
                touch: *touch,
                acts,
                surface: self.detector.surface(touch.pair),
                gap: placed.gap,
                start: (u, placed.normal.dot(u)),
                placed,
                axes: axes(placed.normal),
                middle: Default::default(),
                floor: 0.0,
                closes: None,
                bounce: None,
                free: 0.0,
                block: 0,
                lifts: false,
                rolling: None,
                spinning: None,
                impulse: impulse.unwrap_or_default(),
                bounced: Impulse::default(),
            });
        }
        self.h = h;
        self.find_chain(m);
    }

    fn find_chain(&mut self, m: &Model) {
        self.chain.clear();
        if self.is_empty() {
            return;
        }
        self.on_chain.fill(false);
        for mut body in self.points.iter().filter(|p| p.is_live()).flat_map(|p| p.touch.bodies) {
            while !std::mem::replace(&mut self.on_chain[body], true) {
                body = m.bodies[body].parent;
            }
        }
        self.chain.extend((1..m.bodies.len()).filter(|body| self.on_chain[*body]));
    }

    /// Asks the rows for what is missing in a motion with these speeds (nv), so that nothing ends inside of something else. False
    /// if nothing is.
    pub(super) fn aim_lift(
        &mut self,
        (m, ws): (&Model, &Workspace<f64>),
        rows: &mut Rows,
        pass: &Pass,
        speeds: impl Fn(&mut [f64]),
    ) -> bool {
        speeds(&mut self.v1);
        velocities_of(m, (ws, &self.middle), &mut self.end, (pass.q, &self.v1), &self.chain);
        let mut wanted = false;
        for point in self.points.iter_mut().filter(|p| p.is_live()) {
            point.lifts = false;
            let way = pass.h * point.along(0, approach(&self.end, &point.touch, point.placed.point));
            let (target, kind) = match point.bounce {
                Some((_, gap)) => (gap, LiftKind::Exactly),
                None => ((1.0 - ERP) * point.gap.min(0.0), LiftKind::AtLeast),
            };
            let missing = point.gap + way - target;
            wanted |= missing < -FLUSH || (kind == LiftKind::Exactly && missing > FLUSH);
            *rows.lift(point.block) = Lift { kind, bias: missing / pass.h, impulse: 0.0 };
        }
        wanted
    }

    /// The greatest speed that a lift was asked for, m/s.
    pub(super) fn most_missing(&self, rows: &Rows) -> f64 {
        let missing = |p: &Point| match rows.lift_of(p.block) {
            Lift { kind: LiftKind::Exactly, bias, .. } => bias.abs(),
            Lift { bias, .. } => -bias,
        };
        self.points.iter().filter(|p| p.is_live()).map(missing).fold(0.0, f64::max)
    }

    /// Pushes with the impulses of the lift.
    pub(super) fn push_lift(&mut self, response: &mut Response, rows: &mut Rows) {
        for point in self.points.iter_mut().filter(|p| p.is_live()) {
            let impulse = rows.lift(point.block).impulse;
            point.lifts = impulse != 0.0;
            let force = point.axes[0] * impulse;
            for push in point.pushes(&self.middle, (force, V3::default())) {
                response.push(&push, 1.0);
            }
        }
    }

    /// The contacts of the last step that carry something, at these poses.
    pub fn shown<'a>(&'a self, k: &'a Kinematics) -> impl Iterator<Item = ContactPoint> + 'a {
        let carrying = self.points.iter().filter(|p| p.impulse.normal > 0.0);
        carrying.map(|p| {
            let placed = p.touch.placed(k);
            ContactPoint {
                colliders: p.touch.pair.map(|c| c as usize),
                point: placed.point,
                normal: placed.normal,
                depth: -placed.gap,
                force: (p.axes[0] * p.impulse.normal + p.impulse.tangent) * (1.0 / self.h),
            }
        })
    }

    /// The deepest penetration at these poses, m.
    pub fn depth(&self, k: &Kinematics) -> f64 {
        self.points.iter().map(|p| -p.touch.placed(k).gap).fold(0.0, f64::max)
    }
}

/// Velocities at the end of the step (nv). A floating body's are advanced along the axes of the body in the middle of the step;
/// where coordinates move with the velocities at the end, along those of the world.
pub(super) fn end_velocities(m: &Model, pass: &Pass, qdd: &[f64], out: &mut [f64]) {
    for (v1, (v0, a)) in out.iter_mut().zip(pass.v0.iter().zip(qdd)) {
        *v1 = v0 + pass.h * a;
    }
    if pass.mean {
        return;
    }
    for b in m.bodies.iter().skip(1).filter(|b| b.joint == JointType::Floating) {
        let v = |n: usize| V3::new(pass.v0[b.v + n], pass.v0[b.v + n + 1], pass.v0[b.v + n + 2]);
        let turned = v(0).cross(v(3)) * pass.h;
        for (to, from) in out[b.v + 3..b.v + 6].iter_mut().zip([turned.x, turned.y, turned.z]) {
            *to += from;
        }
    }
}

/// Velocity of side 1 against side 0 at a point, along the world's axes.
fn approach(k: &Kinematics, touch: &Touch, point: V3<f64>) -> V3<f64> {
    // The world stands still.
    let of = |body: usize| if body == 0 { V3::default() } else { k.velocity_at(body, point) };
    of(touch.bodies[1]) - of(touch.bodies[0])
}

/// Angular velocity of side 1 against side 0, along the world's axes.
fn turning(k: &Kinematics, touch: &Touch) -> V3<f64> {
    let of = |body: usize| k.r[body].mv(k.w[body]);
    of(touch.bodies[1]) - of(touch.bodies[0])
}
