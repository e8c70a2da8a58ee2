//! Contacts as rows: Coulomb's cone, rolling and spinning friction, restitution, and what keeps bodies out of each other.
//!
//! Notation: J(q) takes velocities v to the velocity u of side 1 against side 0 at a contact, along (normal, tangent, tangent);
//! 0, m, 1 mark the start, the middle and the end of a step of h. Derived in `docs/decisions/0016-contacts.md`.

mod booked;

use super::lifts::{Lift, LiftKind};
use super::rows::{Kind, Rows, Solved};
use crate::contact::{Detector, Placed, Touch};
use crate::dynamics::{Columns, Kinematics, Layout, Posed, Push, Response, Workspace, kinematics, kinematics_of};
use crate::math::V3;
use crate::model::{JointType, LinkFrame, Model, Surface};

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

/// What one touch is asked and gives.
#[derive(Clone, Copy, Debug)]
struct Point {
    touch: Touch,
    surface: Surface,
    /// The bodies that it acts on: 0 for one that rests.
    acts: [usize; 2],
    /// At the start of the step: gap, and J₀ v₀ as a vector of the world and its normal part.
    gap: f64,
    start: (V3<f64>, f64),
    /// In the middle of the step.
    placed: Placed,
    axes: [V3<f64>; 3],
    /// Jₘ v₀ along the normal.
    middle_speed: f64,
    /// Least normal velocity at the end of the step, m/s.
    floor: f64,
    /// Velocity and gap at the end of the step after a bounce, if it bounces.
    bounce: Option<(f64, f64)>,
    /// Normal velocity at the end of the step without impulses of contacts, m/s.
    free: f64,
    /// Blocks of the cone, and of rolling and spinning friction, where there is any.
    block: usize,
    rolling: Option<usize>,
    spinning: Option<usize>,
    impulse: Impulse,
    /// The same with bounces.
    bounced: Impulse,
}

/// Impulses of a contact on side 1, along the world's axes.
#[derive(Clone, Copy, Debug, Default)]
struct Impulse {
    /// N·s.
    normal: f64,
    /// N·s.
    tangent: V3<f64>,
    /// N·m·s.
    rolling: V3<f64>,
    /// N·m·s.
    spinning: f64,
}

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

    /// The bodies of contacts that carried something in the last step and act on something.
    pub fn carrying_bodies(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.points.iter().filter(|p| p.is_live() && p.impulse.normal > 0.0).map(|p| p.touch.bodies)
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
                middle_speed: 0.0,
                floor: 0.0,
                bounce: None,
                free: 0.0,
                block: 0,
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

    /// Solves the rows that are there together with those of all contacts, for velocities `v₀ + h qdd` without them, and pushes
    /// with the impulses of the contacts.
    pub(super) fn solve(
        &mut self,
        m: &Model,
        ws: &Workspace<f64>,
        (response, rows): (&mut Response, &mut Rows),
        pass: &Pass,
        qdd: &[f64],
    ) -> Solved {
        self.columns.forget();
        self.write(m, ws, (&*response, rows), pass, qdd);
        let sweeps = if rows.rows().len() > FEW { pass.sweeps.max(1) } else { 0 };
        let mut solved = rows.solve_within((sweeps, TRIES), AIM);
        // Against the velocities without impulses: those of the last pass may be what went wrong.
        let scale = rows.most_bias();
        let within = |solved: &Solved, share: f64| solved.residual <= share * scale;
        if !within(&solved, ROUGH) {
            solved = rows.solve(EXTRA, ROUGH);
        }
        if !within(&solved, BAD) {
            solved = self.settle_for(rows);
        }
        self.take(rows);
        if self.bounce(rows, pass.h) {
            solved = rows.solve_within((sweeps, TRIES), AIM);
            self.temper(rows);
            self.take(rows);
        }
        self.push(response, pass.h);
        self.residual = solved.residual;
        solved
    }

    /// Adds the rows of all contacts after the blocks that `rows` holds, for velocities `v₀ + h qdd` without them.
    fn write(
        &mut self,
        m: &Model,
        ws: &Workspace<f64>,
        (response, rows): (&Response, &mut Rows),
        pass: &Pass,
        qdd: &[f64],
    ) {
        if self.start.is_at(pass.q, pass.v0) {
            self.middle.copy_of(&self.start.k, &self.chain);
        } else {
            kinematics_of(m, &mut self.middle, (pass.q, pass.v0), &self.chain);
        }
        end_velocities(m, pass, qdd, &mut self.v1);
        kinematics_of(m, &mut self.end, (pass.q, &self.v1), &self.chain);
        for point in self.points.iter_mut().filter(|p| p.is_live()) {
            point.place(&self.middle, pass);
            let mut target = Target {
                m,
                ws,
                response,
                rows: &mut *rows,
                ids: &mut self.ids,
                columns: &mut self.columns,
                q: pass.q,
                least: self.least,
            };
            point.add_cone(&mut target, &self.middle);
            point.aim(target.rows, &self.middle, &self.end);
            point.add_discs(&mut target, &self.middle, &self.end);
            point.write(rows, &point.impulse);
        }
    }

    /// After the first solve: contacts that bounce. True if there are any; then the rows are to be solved again.
    fn bounce(&mut self, rows: &mut Rows, h: f64) -> bool {
        let mut any = false;
        for point in self.points.iter_mut().filter(|p| p.is_live()) {
            point.bounce = None;
            if point.surface.restitution > 0.0 && rows.impulse(point.block, 0) > 0.0 {
                any |= point.rebound(rows, h);
            }
        }
        any
    }

    /// Reduces the bounces to what leaves no more energy than there was: with friction, Newton's law of restitution can make
    /// some. Between the solution without bounces and the one with them the work is a parabola.
    fn temper(&mut self, rows: &mut Rows) {
        for point in self.points.iter_mut().filter(|p| p.is_live()) {
            point.bounced = point.read(rows);
        }
        let (plain, half, full) = (self.work(rows, 0.0), self.work(rows, 0.5), self.work(rows, 1.0));
        let bound = plain.max(0.0);
        let share = if full <= bound { 1.0 } else { crossing([plain - bound, half - bound, full - bound]) };
        self.tempered += u64::from(share < 1.0);
        self.blend(rows, share);
    }

    /// Impulses between those without bounces (share 0) and those with them (1).
    fn blend(&self, rows: &mut Rows, share: f64) {
        for point in self.points.iter().filter(|p| p.is_live()) {
            point.write(rows, &point.impulse.mixed(&point.bounced, share));
        }
        rows.gather();
    }

    /// What the impulses change the kinetic energy by, relative to the end of the step without them, J.
    fn work(&self, rows: &mut Rows, share: f64) -> f64 {
        self.blend(rows, share);
        let wanted = |p: &Point| rows.impulse(p.block, 0) * (p.free - rows.rows()[rows.first_row(p.block)].bias);
        rows.work() + self.points.iter().filter(|p| p.is_live()).map(wanted).sum::<f64>()
    }

    /// Rows that cannot all have what they want (limbs wedged in each other by what curves) diverge. Then nothing is asked for
    /// but that nothing comes nearer, which standing still satisfies, and of the impulses no more is taken than what leaves least
    /// kinetic energy: `T(s) = s x·u + s² |w|²/2`.
    fn settle_for(&mut self, rows: &mut Rows) -> Solved {
        for point in self.points.iter_mut().filter(|p| p.is_live()) {
            point.floor = point.floor.min(0.0);
            rows.row(point.block, 0).bias = point.free - point.floor;
            point.write(rows, &Impulse::default());
        }
        let solved = rows.solve(EXTRA, ROUGH);
        let wanted = |p: &Point| rows.impulse(p.block, 0) * p.floor;
        let work = rows.work() + self.points.iter().filter(|p| p.is_live()).map(wanted).sum::<f64>();
        let size = rows.size();
        let share = if size > 0.0 { (0.5 - work / size).max(0.0).min(1.0) } else { 1.0 };
        rows.scale_impulses(if share.is_finite() { share } else { 0.0 });
        rows.gather();
        solved
    }

    fn take(&mut self, rows: &Rows) {
        for point in self.points.iter_mut().filter(|p| p.is_live()) {
            point.impulse = point.read(rows);
        }
    }

    fn push(&self, response: &mut Response, h: f64) {
        for point in self.points.iter().filter(|p| p.is_live()) {
            let force = (point.axes[0] * point.impulse.normal + point.impulse.tangent) * (1.0 / h);
            let torque = (point.axes[0] * point.impulse.spinning + point.impulse.rolling) * (1.0 / h);
            for push in point.pushes(&self.middle, (force, torque)) {
                response.push(&push, 1.0);
            }
        }
    }

    /// Asks the rows for what is missing in a motion with these speeds (nv), so that nothing ends inside of something else. False
    /// if nothing is.
    pub(super) fn aim_lift(&mut self, m: &Model, rows: &mut Rows, pass: &Pass, speeds: impl Fn(&mut [f64])) -> bool {
        speeds(&mut self.v1);
        kinematics_of(m, &mut self.end, (pass.q, &self.v1), &self.chain);
        let mut wanted = false;
        for point in self.points.iter().filter(|p| p.is_live()) {
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
    pub(super) fn push_lift(&self, response: &mut Response, rows: &mut Rows) {
        for point in self.points.iter().filter(|p| p.is_live()) {
            let force = point.axes[0] * rows.lift(point.block).impulse;
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

impl Point {
    /// Where it is in the middle of the step, and the least normal velocity at its end.
    ///
    /// What persists has u₁ = 0 with J₁ and had u₀ = 0 with J₀; with the rows of the middle that is `Jₘ v₁ = (J₀ − Jₘ) v₀`, of
    /// second order, and the contact does no work. What closes in the step may come as near as 0.
    fn place(&mut self, middle: &Kinematics, pass: &Pass) {
        self.placed = self.touch.placed(middle);
        self.axes = axes(self.placed.normal);
        self.middle_speed = self.placed.normal.dot(approach(middle, &self.touch, self.placed.point));
        let touching = if pass.mean { self.start.1 - self.middle_speed } else { 0.0 };
        let closing = if pass.mean { -2.0 * self.gap / pass.h - self.middle_speed } else { -self.gap / pass.h };
        self.floor = touching.min(closing);
    }

    fn add_cone(&mut self, t: &mut Target, middle: &Kinematics) {
        let wrench = |p: &Self, n: usize| (p.axes[n], V3::default());
        self.block = self.add(t, Kind::Cone { friction: self.surface.friction }, (middle, &[0, 1, 2]), wrench);
    }

    /// Rows of rolling and of spinning friction, where the pair has them.
    fn add_discs(&mut self, t: &mut Target, middle: &Kinematics, end: &Kinematics) {
        let normal = t.rows.first_row(self.block);
        let turning = turning(end, &self.touch);
        let wrench = |p: &Self, n: usize| (V3::default(), p.axes[n]);
        (self.rolling, self.spinning) = (None, None);
        if self.surface.rolling > 0.0 {
            let kind = Kind::Disc { ratio: self.surface.rolling, normal };
            let block = self.add(t, kind, (middle, &[1, 2]), wrench);
            for n in [1, 2] {
                t.rows.row(block, n - 1).bias = self.along(n, turning);
            }
            self.rolling = Some(block);
        }
        if self.surface.spinning > 0.0 {
            let kind = Kind::Disc { ratio: self.surface.spinning, normal };
            let block = self.add(t, kind, (middle, &[0]), wrench);
            t.rows.row(block, 0).bias = self.along(0, turning);
            self.spinning = Some(block);
        }
    }

    /// Adds a block of rows along some of the axes, of which `wrench` gives force and torque.
    fn add(
        &self,
        t: &mut Target,
        kind: Kind,
        (middle, axes): (&Kinematics, &[usize]),
        wrench: impl Fn(&Self, usize) -> (V3<f64>, V3<f64>),
    ) -> usize {
        t.ids.clear();
        t.response.layout.join(self.acts[0], self.acts[1], t.ids);
        let block = t.rows.add(kind, axes.len(), t.ids);
        for (n, axis) in axes.iter().enumerate() {
            let (ids, out) = t.rows.response(block, n);
            for push in self.pushes(middle, wrench(self, *axis)) {
                t.columns.of(t.response, (t.m, t.ws, t.q), push.body).combine(&push, ids, out);
            }
        }
        t.rows.seal(block);
        if t.rows.trace(block) < t.least {
            t.rows.switch_off(block);
        }
        block
    }

    /// Velocities without impulses, minus the wanted ones.
    fn aim(&mut self, rows: &mut Rows, middle: &Kinematics, end: &Kinematics) {
        let free = approach(end, &self.touch, self.placed.point);
        let curve = approach(middle, &self.touch, self.placed.point) - self.start.0;
        self.free = self.along(0, free);
        rows.row(self.block, 0).bias = self.free - self.floor;
        for n in [1, 2] {
            rows.row(self.block, n).bias = self.along(n, free + curve);
        }
    }

    /// Between bodies that both rest, it stays as it was.
    fn is_live(&self) -> bool {
        self.acts != [0, 0]
    }

    /// A force and a torque (world) at the point on side 1, and their opposites on side 0; none on the world.
    #[inline(always)]
    fn pushes(&self, k: &Kinematics, (force, torque): (V3<f64>, V3<f64>)) -> impl Iterator<Item = Push> {
        let sides = [(0, -1.0), (1, 1.0)].into_iter().filter(|(side, _)| self.acts[*side] != 0);
        sides.map(move |(side, sign)| {
            let body = self.acts[side];
            let (r, arm) = (&k.r[body], self.placed.point - k.p[body]);
            let (f, t) = (force * sign, torque * sign);
            Push { body, torque: r.tv(arm.cross_add(f, t)), force: r.tv(f), ..Push::default() }
        })
    }

    fn along(&self, n: usize, v: V3<f64>) -> f64 {
        self.axes[n].dot(v)
    }

    /// The bounce of a contact that closes within the step: it falls freely until then, leaves with `restitution` times the
    /// speed that it has then, and is slowed down by the same acceleration for the rest of the step. So a bounce neither gains nor
    /// loses by the step. False if it would come back within the step: then it rests.
    fn rebound(&mut self, rows: &mut Rows, h: f64) -> bool {
        let (u, a) = (self.middle_speed, (self.free - self.middle_speed) / h);
        let Some(t) = closing(self.gap, u, a).filter(|t| *t <= h) else { return false };
        let (leaves, rest) = (-self.surface.restitution * (u + a * t), h - t);
        let speed = leaves + a * rest;
        if speed <= 0.0 {
            return false;
        }
        self.bounce = Some((speed, (leaves + 0.5 * a * rest) * rest));
        rows.row(self.block, 0).bias = self.free - speed;
        true
    }

    fn write(&self, rows: &mut Rows, x: &Impulse) {
        if rows.is_off(self.block) {
            return;
        }
        let cone = [x.normal, self.along(1, x.tangent), self.along(2, x.tangent)];
        for (n, x) in cone.into_iter().enumerate() {
            rows.row(self.block, n).impulse = x;
        }
        if let Some(block) = self.rolling {
            rows.row(block, 0).impulse = self.along(1, x.rolling);
            rows.row(block, 1).impulse = self.along(2, x.rolling);
        }
        if let Some(block) = self.spinning {
            rows.row(block, 0).impulse = x.spinning;
        }
    }

    fn read(&self, rows: &Rows) -> Impulse {
        let x = |block: Option<usize>, n: usize| block.map_or(0.0, |b| rows.impulse(b, n));
        let cone = Some(self.block);
        Impulse {
            normal: x(cone, 0),
            tangent: self.axes[1] * x(cone, 1) + self.axes[2] * x(cone, 2),
            rolling: self.axes[1] * x(self.rolling, 0) + self.axes[2] * x(self.rolling, 1),
            spinning: x(self.spinning, 0),
        }
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

/// Responses of the bodies that are touched, found once per pass.
#[derive(Clone, Debug)]
struct BodyColumns {
    /// Per body: its place in `columns`; none if nothing on it collides.
    place: Vec<usize>,
    columns: Vec<Columns>,
    fresh: Vec<bool>,
}

impl BodyColumns {
    fn new(m: &Model) -> Self {
        let layout = Layout::new(m);
        let mut place = vec![usize::MAX; m.bodies.len()];
        let mut columns = vec![];
        for link in m.colliders.iter().filter_map(|c| c.link) {
            let (LinkFrame::OnBody { body, .. } | LinkFrame::InGroup { body, .. }) = m.links[link].frame;
            if body != 0 && place[body] == usize::MAX {
                place[body] = columns.len();
                columns.push(Columns::new(&layout));
            }
        }
        Self { place, fresh: vec![false; columns.len()], columns }
    }

    /// Another pass has been made.
    fn forget(&mut self) {
        self.fresh.fill(false);
    }

    fn of(&mut self, response: &Response, (m, ws, q): (&Model, &Workspace<f64>, &[f64]), body: usize) -> &Columns {
        let place = self.place[body];
        if !std::mem::replace(&mut self.fresh[place], true) {
            response.columns(m, ws, q, body, &mut self.columns[place]);
        }
        &self.columns[place]
    }
}

/// Where rows go to.
struct Target<'a> {
    m: &'a Model,
    ws: &'a Workspace<f64>,
    response: &'a Response,
    rows: &'a mut Rows,
    ids: &'a mut Vec<u32>,
    columns: &'a mut BodyColumns,
    q: &'a [f64],
    /// Less mobility is rounding.
    least: f64,
}

impl Impulse {
    fn scaled(self, factor: f64) -> Self {
        Self {
            normal: self.normal * factor,
            tangent: self.tangent * factor,
            rolling: self.rolling * factor,
            spinning: self.spinning * factor,
        }
    }

    fn mixed(&self, other: &Self, share: f64) -> Self {
        let (own, other) = (self.scaled(1.0 - share), other.scaled(share));
        Self {
            normal: own.normal + other.normal,
            tangent: own.tangent + other.tangent,
            rolling: own.rolling + other.rolling,
            spinning: own.spinning + other.spinning,
        }
    }
}

/// Where a parabola that is `p` at 0, ½ and 1, with p[0] ≤ 0 < p[2], crosses 0.
fn crossing(p: [f64; 3]) -> f64 {
    let (a, b) = (2.0 * (p[0] - 2.0 * p[1] + p[2]), 4.0 * p[1] - 3.0 * p[0] - p[2]);
    let root = (b * b - 4.0 * a * p[0]).max(0.0).sqrt();
    let s = if b >= 0.0 { -2.0 * p[0] / (b + root) } else { (root - b) / (2.0 * a) };
    if s.is_finite() { s.clamp(0.0, 1.0) } else { 0.0 }
}

/// When a gap closes that opens with speed `u` and acceleration `a`; 0 if it is closed and not opening.
fn closing(gap: f64, u: f64, a: f64) -> Option<f64> {
    if gap <= 0.0 {
        return (u < 0.0).then_some(0.0);
    }
    let root = u * u - 2.0 * a * gap;
    if root < 0.0 {
        return None;
    }
    // The smaller root of gap + u t + a t²/2, without cancellation.
    let t = 2.0 * gap / (root.sqrt() - u);
    (t >= 0.0).then_some(t)
}

/// Velocity of side 1 against side 0 at a point, along the world's axes.
fn approach(k: &Kinematics, touch: &Touch, point: V3<f64>) -> V3<f64> {
    let at = |body: usize| k.r[body].mv(k.v[body]) + k.r[body].mv(k.w[body]).cross(point - k.p[body]);
    at(touch.bodies[1]) - at(touch.bodies[0])
}

/// Angular velocity of side 1 against side 0, along the world's axes.
fn turning(k: &Kinematics, touch: &Touch) -> V3<f64> {
    let of = |body: usize| k.r[body].mv(k.w[body]);
    of(touch.bodies[1]) - of(touch.bodies[0])
}

/// The normal and two tangents, right-handed.
fn axes(n: V3<f64>) -> [V3<f64>; 3] {
    let (x, y) = (V3::new(1.0, 0.0, 0.0), V3::new(0.0, 1.0, 0.0));
    let side = if n.x.abs() < 0.7 { x } else { y };
    let t = side - n * n.dot(side);
    let t = t * (1.0 / t.dot(t).sqrt());
    [n, t, n.cross(t)]
}
