//! One contact: its rows, what they are asked, and what they give.

use super::{CLOSED, Pass, approach, turning};
use crate::contact::{Placed, Touch};
use crate::dynamics::{Columns, Kinematics, Layout, Push, Response, Workspace};
use crate::math::V3;
use crate::model::{Model, Surface};
use crate::solver::rows::{Kind, Rows};

/// What one touch is asked and gives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) touch: Touch,
    pub(super) surface: Surface,
    /// The bodies that it acts on: 0 for one that rests.
    pub(super) acts: [usize; 2],
    /// At the start of the step: gap, and J₀ v₀ as a vector of the world and its normal part.
    pub(super) gap: f64,
    pub(super) start: (V3<f64>, f64),
    /// In the middle of the step.
    pub(super) placed: Placed,
    pub(super) axes: [V3<f64>; 3],
    /// Jₘ v₀ as a vector of the world and its normal part.
    pub(super) middle: (V3<f64>, f64),
    /// Least normal velocity at the end of the step, m/s.
    pub(super) floor: f64,
    /// When in the step it closes by itself and would bounce, s.
    pub(super) closes: Option<f64>,
    /// Velocity and gap at the end of the step after a bounce, if it bounces.
    pub(super) bounce: Option<(f64, f64)>,
    /// Normal velocity at the end of the step without impulses of contacts, m/s.
    pub(super) free: f64,
    /// Blocks of the cone, and of rolling and spinning friction, where there is any.
    pub(super) block: usize,
    pub(super) rolling: Option<usize>,
    pub(super) spinning: Option<usize>,
    pub(super) impulse: Impulse,
    /// The same with bounces.
    pub(super) bounced: Impulse,
    /// It has pushed its bodies apart in the position pass.
    pub(super) lifts: bool,
}

/// Impulses of a contact on side 1, along the world's axes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Impulse {
    /// N·s.
    pub(super) normal: f64,
    /// N·s.
    pub(super) tangent: V3<f64>,
    /// N·m·s.
    pub(super) rolling: V3<f64>,
    /// N·m·s.
    pub(super) spinning: f64,
}

impl Point {
    /// Does it push, and act on something?
    pub(super) fn carries(&self) -> bool {
        self.is_live() && self.impulse.normal > 0.0
    }

    /// Where it is in the middle of the step, and the least normal velocity at its end.
    ///
    /// What persists has u₁ = 0 with J₁ and had u₀ = 0 with J₀; with the rows of the middle that is `Jₘ v₁ = (J₀ − Jₘ) v₀`, of
    /// second order, and the contact does no work. What closes in the step may come as near as 0.
    pub(super) fn place(&mut self, middle: &Kinematics, pass: &Pass) {
        self.placed = self.touch.placed(middle);
        self.axes = axes(self.placed.normal);
        let u = approach(middle, &self.touch, self.placed.point);
        self.middle = (u, self.placed.normal.dot(u));
        let touching = if pass.mean { self.start.1 - self.middle.1 } else { 0.0 };
        let closing = if pass.mean { -2.0 * self.gap / pass.h - self.middle.1 } else { -self.gap / pass.h };
        self.floor = if self.gap.abs() < CLOSED { touching } else { touching.min(closing) };
    }

    /// Coulomb's cone; without friction its normal row alone.
    pub(super) fn add_cone(&mut self, t: &mut Target, middle: &Kinematics) {
        let wrench = |p: &Self, n: usize| (p.axes[n], V3::default());
        self.block = match self.rubs() {
            true => self.add(t, Kind::Cone { friction: self.surface.friction }, (middle, &[0, 1, 2]), wrench),
            false => self.add(t, Kind::Bounds { lower: 0.0, upper: f64::INFINITY }, (middle, &[0]), wrench),
        };
    }

    /// Has it rows along its tangents?
    fn rubs(&self) -> bool {
        self.surface.friction > 0.0
    }

    /// Rows of rolling and of spinning friction, where the pair has them.
    pub(super) fn add_discs(&mut self, t: &mut Target, middle: &Kinematics, end: &Kinematics) {
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
    pub(super) fn add(
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
    pub(super) fn aim(&mut self, rows: &mut Rows, end: &Kinematics) {
        let free = approach(end, &self.touch, self.placed.point);
        self.free = self.along(0, free);
        rows.row(self.block, 0).bias = self.free - self.floor;
        if !self.rubs() {
            return;
        }
        let curve = self.middle.0 - self.start.0;
        for n in [1, 2] {
            rows.row(self.block, n).bias = self.along(n, free + curve);
        }
    }

    /// Between bodies that both rest, it stays as it was.
    pub(super) fn is_live(&self) -> bool {
        self.acts != [0, 0]
    }

    /// A force and a torque (world) at the point on side 1, and their opposites on side 0; none on the world.
    #[inline(always)]
    pub(super) fn pushes(&self, k: &Kinematics, (force, torque): (V3<f64>, V3<f64>)) -> impl Iterator<Item = Push> {
        let sides = [(0, -1.0), (1, 1.0)].into_iter().filter(|(side, _)| self.acts[*side] != 0);
        sides.map(move |(side, sign)| {
            let body = self.acts[side];
            let (r, arm) = (&k.r[body], self.placed.point - k.p[body]);
            let (f, t) = (force * sign, torque * sign);
            Push { body, torque: r.tv(arm.cross_add(f, t)), force: r.tv(f), ..Push::default() }
        })
    }

    pub(super) fn along(&self, n: usize, v: V3<f64>) -> f64 {
        self.axes[n].dot(v)
    }

    /// When within a step of `h` it closes, if it bounces then and does not come back within the step: else it rests. What counts as
    /// closed has been stopped by the first solve, however short the step: it bounces at once.
    pub(super) fn closes(&self, h: f64) -> Option<f64> {
        let t = closing(self.gap, self.middle.1, (self.free - self.middle.1) / h)?;
        let t = if t > h && self.gap.abs() < CLOSED { 0.0 } else { t };
        (t <= h && self.leaves(t, h).0 > 0.0).then_some(t)
    }

    /// Velocity and gap at the end of a step of `h` after a bounce at `t`: it falls freely until then, leaves with `restitution`
    /// times the speed that it has then, and is slowed down by the same acceleration for the rest of the step. So a bounce neither
    /// gains nor loses by the step.
    fn leaves(&self, t: f64, h: f64) -> (f64, f64) {
        let (u, a) = (self.middle.1, (self.free - self.middle.1) / h);
        let (leaves, rest) = (-self.surface.restitution * (u + a * t), h - t);
        let there = (self.gap + (u + 0.5 * a * t) * t).max(0.0);
        (leaves + a * rest, there + (leaves + 0.5 * a * rest) * rest)
    }

    /// Asks for the bounce at `t`; false if there is none then.
    pub(super) fn rebound(&mut self, rows: &mut Rows, t: f64, h: f64) -> bool {
        self.bounce = Some(self.leaves(t, h)).filter(|(speed, _)| *speed > 0.0);
        if let Some((speed, _)) = self.bounce {
            rows.row(self.block, 0).bias = self.free - speed;
        }
        self.bounce.is_some()
    }

    pub(super) fn write(&self, rows: &mut Rows, x: &Impulse) {
        if rows.is_off(self.block) {
            return;
        }
        rows.row(self.block, 0).impulse = x.normal;
        if self.rubs() {
            for n in [1, 2] {
                rows.row(self.block, n).impulse = self.along(n, x.tangent);
            }
        }
        if let Some(block) = self.rolling {
            rows.row(block, 0).impulse = self.along(1, x.rolling);
            rows.row(block, 1).impulse = self.along(2, x.rolling);
        }
        if let Some(block) = self.spinning {
            rows.row(block, 0).impulse = x.spinning;
        }
    }

    pub(super) fn read(&self, rows: &Rows) -> Impulse {
        let x = |block: Option<usize>, n: usize| block.map_or(0.0, |b| rows.impulse(b, n));
        let cone = Some(self.block);
        let tangents = cone.filter(|_| self.rubs());
        Impulse {
            normal: x(cone, 0),
            tangent: self.axes[1] * x(tangents, 1) + self.axes[2] * x(tangents, 2),
            rolling: self.axes[1] * x(self.rolling, 0) + self.axes[2] * x(self.rolling, 1),
            spinning: x(self.spinning, 0),
        }
    }
}

/// Responses of the bodies that are touched, found once per pass.
#[derive(Clone, Debug)]
pub(super) struct BodyColumns {
    /// Per body: its place in `columns`; none if nothing on it collides.
    pub(super) place: Vec<usize>,
    pub(super) columns: Vec<Columns>,
    pub(super) fresh: Vec<bool>,
}

impl BodyColumns {
    pub(super) fn new(m: &Model) -> Self {
        let layout = Layout::new(m);
        let mut place = vec![usize::MAX; m.bodies.len()];
        let mut columns = vec![];
        for link in m.colliders.iter().filter_map(|c| c.link) {
            let body = m.links[link].frame.body();
            if body != 0 && place[body] == usize::MAX {
                place[body] = columns.len();
                columns.push(Columns::new(&layout));
            }
        }
        Self { place, fresh: vec![false; columns.len()], columns }
    }

    /// Another pass has been made.
    pub(super) fn forget(&mut self) {
        self.fresh.fill(false);
    }

    pub(super) fn of(
        &mut self,
        response: &Response,
        (m, ws, q): (&Model, &Workspace<f64>, &[f64]),
        body: usize,
    ) -> &Columns {
        let place = self.place[body];
        if !std::mem::replace(&mut self.fresh[place], true) {
            response.columns(m, ws, q, body, &mut self.columns[place]);
        }
        &self.columns[place]
    }
}

/// Where rows go to.
pub(super) struct Target<'a> {
    pub(super) m: &'a Model,
    pub(super) ws: &'a Workspace<f64>,
    pub(super) response: &'a Response,
    pub(super) rows: &'a mut Rows,
    pub(super) ids: &'a mut Vec<u32>,
    pub(super) columns: &'a mut BodyColumns,
    pub(super) q: &'a [f64],
    /// Less mobility is rounding.
    pub(super) least: f64,
}

impl Impulse {
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            normal: self.normal * factor,
            tangent: self.tangent * factor,
            rolling: self.rolling * factor,
            spinning: self.spinning * factor,
        }
    }

    pub(super) fn mixed(&self, other: &Self, share: f64) -> Self {
        let (own, other) = (self.scaled(1.0 - share), other.scaled(share));
        Self {
            normal: own.normal + other.normal,
            tangent: own.tangent + other.tangent,
            rolling: own.rolling + other.rolling,
            spinning: own.spinning + other.spinning,
        }
    }
}

/// When a gap closes that opens with speed `u` and acceleration `a`; 0 if it is closed and not opening.
pub(super) fn closing(gap: f64, u: f64, a: f64) -> Option<f64> {
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

/// The normal and two tangents, right-handed.
pub(super) fn axes(n: V3<f64>) -> [V3<f64>; 3] {
    let (x, y) = (V3::new(1.0, 0.0, 0.0), V3::new(0.0, 1.0, 0.0));
    let side = if n.x.abs() < 0.7 { x } else { y };
    let t = side - n * n.dot(side);
    let t = t * (1.0 / t.dot(t).sqrt());
    [n, t, n.cross(t)]
}
