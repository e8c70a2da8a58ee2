//! The law of one axis: torque over its speed in the step.
//!
//! Dry friction is a riser at speed 0, a servo a riser at the speed that it wants, a hard stop a riser at the speed that just
//! reaches it; damping, the torque–speed line of a drive, a short brake and a soft stop are slopes. All of them only push
//! against motion, so their sum never rises:
//!
//! ```text
//! torque  ──╲ segment 0
//!            ╲ knot 0, a kink (end of the current limit)
//!             │ knot 1, a riser (friction, speed 0)
//!             ╲ segment 2
//!              │ knot 2, a riser to −∞ (hard stop)      → speed
//! ```

use super::AxisCommand;
use super::drive::{Brakes, DriveLaw};
use crate::model::{Axis, DriveLimits, Effects};

/// Knots at the most: friction, two of the drive, two stops.
const KNOTS: usize = 5;
/// Speeds nearer than this are one knot, rad/s or m/s.
pub(super) const SAME: f64 = 1e-12;
/// An axis this near to its stop touches it: rounding of the step that brought it there; rad or m, relative.
pub(super) const AT_STOP: f64 = 1e-14;
/// Relative tolerance of the fit.
const FIT: f64 = 1e-11;

/// What a riser is made of, as bits.
pub(super) const FRICTION: u8 = 1;
pub(super) const SERVO: u8 = 2;
pub(super) const LOWER: u8 = 4;
pub(super) const UPPER: u8 = 8;
/// Nothing gets past it to the left, or to the right: a hard stop; both: a servo without a bound.
pub(super) const WALL_LEFT: u8 = 16;
pub(super) const WALL_RIGHT: u8 = 32;

/// Where the law jumps or bends.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Knot {
    /// Speed at which it stands.
    pub speed: f64,
    /// Torque that is lost there, beside what its walls take.
    pub drop: f64,
    /// Slope of the segment behind it minus that of the one before it.
    pub steeper: f64,
    /// What it is made of.
    pub kinds: u8,
}

/// `torque = intercept − slope · speed`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Segment {
    pub intercept: f64,
    pub slope: f64,
}

impl Segment {
    fn at(&self, speed: f64) -> f64 {
        self.intercept - self.slope * speed
    }
}

/// The law of one axis in one step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Law {
    pub(super) knots: [Knot; KNOTS],
    pub(super) count: usize,
    pub(super) segments: [Segment; KNOTS + 1],
    /// By how much static friction exceeds the dynamic one while the axis is on the riser of its friction.
    pub(super) stiction: f64,
    /// The same for an axis that stood at the start of the step, 0 for others.
    pub(super) stood: f64,
    /// Soft stops: their torque per speed; of all stops the speeds at which they begin.
    pub(super) soft: (f64, f64, f64),
    /// Outside its range: by how much it is put back after the step, rad or m, signed.
    pub(super) push: f64,
    /// The axis stands in a soft stop: a spring, whose speed is that at the end of the step.
    pub(super) in_soft_stop: bool,
    /// Two hard stops or none, damping, and nothing else: see [`super::between`].
    pub(super) plain: bool,
    damping: f64,
    pub(super) friction: f64,
    pub(super) drive: DriveLaw,
}

/// What the law of an axis depends on.
#[derive(Clone, Copy, Debug)]
pub struct AxisInput<'a> {
    /// The axis.
    pub axis: &'a Axis,
    /// Its drive as it is now.
    pub limits: &'a DriveLimits,
    /// Its command.
    pub command: AxisCommand,
    /// Position, rad or m.
    pub q: f64,
    /// It stood still in its dry friction at the end of the last step.
    pub stuck: bool,
    /// What a servo knows of its load.
    pub brakes: Brakes,
}

impl Law {
    /// Becomes the law of an axis for a step of `h` seconds, which may be a piece of one of `whole`.
    pub fn set(&mut self, input: &AxisInput, effects: Effects, (h, whole): (f64, f64)) {
        self.clear();
        if effects.damping {
            self.damping = input.axis.damping;
            self.segments[0].slope = self.damping;
        }
        if effects.drives {
            self.drive = DriveLaw::of(input, h, effects.off);
        }
        if effects.limits {
            self.stops(input, (h, whole));
        }
        self.add_drive();
        if effects.friction {
            self.dry_friction(input);
        }
        self.finish();
    }

    /// No torque at all. Knots and segments that do not count stay as they are.
    pub fn clear(&mut self) {
        (self.count, self.segments[0]) = (0, Segment::default());
        (self.stiction, self.stood, self.push) = (0.0, 0.0, 0.0);
        (self.damping, self.friction, self.soft) = (0.0, 0.0, (0.0, f64::NEG_INFINITY, f64::INFINITY));
        (self.in_soft_stop, self.plain, self.drive) = (false, false, DriveLaw::Idle);
    }

    /// A servo without a bound on its torque wants what the stops allow.
    fn add_drive(&mut self) {
        let wall = |kind: u8| self.knots[..self.count].iter().find(|k| k.kinds & kind != 0).map(|k| k.speed);
        if let DriveLaw::Servo { wanted, torque: f64::INFINITY, .. } = &mut self.drive {
            *wanted = wanted.max(wall(WALL_LEFT).unwrap_or(f64::NEG_INFINITY));
            *wanted = wanted.min(wall(WALL_RIGHT).unwrap_or(f64::INFINITY));
        }
        let (start, knots) = self.drive.staircase();
        self.segments[0].intercept += start.intercept;
        self.segments[0].slope += start.slope;
        knots.into_iter().flatten().for_each(|k| self.insert(k));
    }

    fn dry_friction(&mut self, input: &AxisInput) {
        let limits = input.limits;
        self.friction = input.axis.friction + limits.dynamic_resistance;
        if input.stuck {
            self.stood = (limits.static_resistance - limits.dynamic_resistance).max(0.0);
            self.stiction = self.stood;
        }
        if self.friction + self.stiction > 0.0 {
            self.segments[0].intercept += self.friction;
            self.insert(Knot { speed: 0.0, drop: 2.0 * self.friction, steeper: 0.0, kinds: FRICTION });
        }
    }

    /// A stop is reached exactly at the end of the step. A soft one yields by its CFM per torque, and its ERP is that of its
    /// spring. Beyond a hard one the axis may only come back; its ERP's share of the way is a push that gives no speed.
    fn stops(&mut self, input: &AxisInput, (h, whole): (f64, f64)) {
        let (axis, soft) = (input.axis, input.axis.stop.cfm > 0.0);
        let touching = Self::touching(input.q);
        let slope = if soft { axis.stop.hk_plus_d(h, whole) } else { 0.0 };
        let room = |gap: f64| match gap {
            _ if gap.abs() <= touching => 0.0,
            _ if gap > 0.0 => gap / h,
            _ if soft => axis.stop.stiffness(whole) * gap / slope,
            _ => 0.0,
        };
        self.soft.0 = slope;
        for (gap, side, kind) in [(input.q - axis.lower, -1.0, LOWER), (axis.upper - input.q, 1.0, UPPER)] {
            if !gap.is_finite() {
                continue;
            }
            let speed = side * room(gap);
            if kind == LOWER {
                self.soft.1 = speed;
            } else {
                self.soft.2 = speed;
            }
            if soft && kind == LOWER {
                self.segments[0].slope += slope;
                self.segments[0].intercept += slope * speed;
            }
            if !soft && gap < -touching {
                self.push += side * axis.stop.erp * gap;
            }
            self.in_soft_stop |= soft && gap <= 0.0;
            let wall = if kind == LOWER { WALL_LEFT } else { WALL_RIGHT };
            let kinds = if soft { kind } else { kind | wall };
            self.insert(Knot { speed, drop: 0.0, steeper: side * slope, kinds });
        }
    }

    #[inline(always)]
    fn insert(&mut self, knot: Knot) {
        let mut at = 0;
        for k in &mut self.knots[..self.count] {
            if (k.speed - knot.speed).abs() <= SAME {
                k.drop += knot.drop;
                k.steeper += knot.steeper;
                k.kinds |= knot.kinds;
                return;
            }
            at += usize::from(k.speed < knot.speed);
        }
        if self.count < KNOTS {
            // Mostly they come in order; a call to move one or two would cost more.
            for k in (at..self.count).rev() {
                self.knots[k + 1] = self.knots[k];
            }
            self.knots[at] = knot;
            self.count += 1;
        }
    }

    /// The segments behind the first one follow from the knots.
    fn finish(&mut self) {
        for k in 0..self.count {
            let (knot, before) = (self.knots[k], self.segments[k]);
            let slope = before.slope + knot.steeper;
            let intercept = before.intercept + knot.steeper * knot.speed - knot.drop;
            self.segments[k + 1] = Segment { intercept, slope };
        }
        self.plain = self.is_plain();
    }

    /// How much more than this the torque can fall (`falls`) or rise before riser `k` is left; infinite at a wall.
    pub(super) fn room(&self, k: usize, torque: f64, falls: bool) -> f64 {
        let (left, right) = self.ends(k);
        let stiction = if self.knots[k].kinds & FRICTION != 0 { self.stiction } else { 0.0 };
        (if falls { torque - right } else { left - torque }) + stiction
    }

    /// Torques at the left (upper) and right (lower) end of a riser.
    fn ends(&self, k: usize) -> (f64, f64) {
        let knot = &self.knots[k];
        let wall = |kind: u8| knot.kinds & kind != 0;
        let left = if wall(WALL_LEFT) { f64::INFINITY } else { self.segments[k].at(knot.speed) };
        let right = if wall(WALL_RIGHT) { f64::NEG_INFINITY } else { self.segments[k + 1].at(knot.speed) };
        (left, right)
    }

    /// The same with what static friction adds.
    pub(super) fn held(&self, k: usize) -> (f64, f64) {
        let (left, right) = self.ends(k);
        let stiction = if self.knots[k].kinds & FRICTION != 0 { self.stiction } else { 0.0 };
        (left + stiction, right - stiction)
    }

    pub(super) fn is_riser(&self, k: usize) -> bool {
        let knot = &self.knots[k];
        let sticks = self.stood > 0.0 && knot.kinds & FRICTION != 0;
        knot.drop > 0.0 || knot.kinds & (WALL_LEFT | WALL_RIGHT) != 0 || sticks
    }

    /// Is it a hard stop?
    pub(super) fn is_hard_stop(&self, k: usize) -> bool {
        let kinds = self.knots[k].kinds;
        kinds & (LOWER | UPPER) != 0 && kinds & (WALL_LEFT | WALL_RIGHT) != 0
    }

    /// The part of the torque on a riser that its walls take.
    pub(super) fn at_walls(&self, k: usize, torque: f64) -> f64 {
        let knot = &self.knots[k];
        let (left, right) = (self.segments[k].at(knot.speed), self.segments[k + 1].at(knot.speed));
        let above = if knot.kinds & WALL_LEFT != 0 { (torque - left).max(0.0) } else { 0.0 };
        let below = if knot.kinds & WALL_RIGHT != 0 { (torque - right).min(0.0) } else { 0.0 };
        above + below
    }

    /// Places between the walls: 2 j on segment j, 2 k + 1 on riser k.
    fn within_walls(&self, place: usize) -> usize {
        let knots = &self.knots[..self.count];
        let wall = |kind: u8| move |k: &Knot| k.kinds & kind != 0;
        let low = knots.iter().rposition(wall(WALL_LEFT)).map_or(0, |k| 2 * k + 1);
        let high = knots.iter().position(wall(WALL_RIGHT)).map_or(2 * self.count, |k| 2 * k + 1);
        place.max(low).min(high.max(low))
    }

    /// First place: the riser it stood on, else by its speed.
    #[inline]
    pub(super) fn guess(&self, v: f64, memory: u8) -> usize {
        let knots = &self.knots[..self.count];
        for (k, knot) in knots.iter().enumerate() {
            if knot.kinds & memory != 0 && self.is_riser(k) {
                return self.within_walls(2 * k + 1);
            }
        }
        for (k, knot) in knots.iter().enumerate() {
            if knot.speed == v && self.is_riser(k) {
                return self.within_walls(2 * k + 1);
            }
        }
        // At a kink from rest, the side to which the drive pushes.
        let behind = |k: &&Knot| k.speed < v || (k.speed == v && k.steeper > 0.0);
        self.within_walls(2 * knots.iter().take_while(behind).count())
    }

    /// To which side the solution leaves riser `k`, whose law must give this torque: −1 left, 0 not at all, +1 right.
    #[inline]
    pub(super) fn leaves_riser(&self, k: usize, torque: f64) -> isize {
        let (left, right) = self.ends(k);
        let slack = FIT * (1.0 + torque.abs()) + if self.knots[k].kinds & FRICTION != 0 { self.stiction } else { 0.0 };
        isize::from(torque < right - slack) - isize::from(torque > left + slack)
    }

    /// To which side a speed is beyond segment `j`: −1, 0, +1.
    #[inline]
    pub(super) fn leaves_segment(&self, j: usize, v: f64) -> isize {
        let slack = FIT * (1.0 + v.abs());
        let below = j > 0 && v < self.knots[j - 1].speed - slack;
        let above = j < self.count && v > self.knots[j].speed + slack;
        isize::from(above) - isize::from(below)
    }

    /// A speed that fits this place, without the rounding that made it fit only nearly.
    #[inline]
    pub(super) fn rounded(&self, place: usize, v: f64) -> f64 {
        let j = place / 2;
        if place % 2 == 1 {
            return self.knots[j].speed;
        }
        if self.smooth() || self.leaves_segment(j, v) != 0 {
            return v;
        }
        let low = if j > 0 { self.knots[j - 1].speed } else { f64::NEG_INFINITY };
        let high = if j < self.count { self.knots[j].speed } else { f64::INFINITY };
        v.max(low).min(high)
    }

    /// Static friction holds an axis that stood at the start of the step as long as it stands: in the other parts of the law it has
    /// broken loose, but it may come back in a later pass, when the laws of the others fit.
    pub(super) fn hold(&mut self, place: usize) {
        let stands = place % 2 == 1 && self.knots[place / 2].kinds & FRICTION != 0;
        self.stiction = if stands { self.stood } else { 0.0 };
    }

    /// Is the drive a servo?
    pub(super) fn is_servo(&self) -> bool {
        matches!(self.drive, DriveLaw::Servo { .. })
    }

    /// The neighbouring place; a kink has no place of its own.
    pub(super) fn neighbour(&self, place: usize, side: isize) -> usize {
        let next = place.saturating_add_signed(side);
        let kink = next % 2 == 1 && !self.is_riser(next / 2);
        self.within_walls(if kink { next.saturating_add_signed(side) } else { next })
    }

    /// True if speed `v` is still on this segment; stops are checked by position instead.
    pub(super) fn stays_between_knots(&self, j: usize, v: f64) -> bool {
        let counts = |k: usize| self.knots[k].kinds & (LOWER | UPPER) == 0;
        let below = j > 0 && counts(j - 1) && v <= self.knots[j - 1].speed;
        let above = j < self.count && counts(j) && v >= self.knots[j].speed;
        !below && !above
    }

    /// True if only viscous and constant torques act.
    pub(super) fn smooth(&self) -> bool {
        self.count == 0
    }

    /// Is a hard or soft stop part of the law?
    pub(super) fn has_stop(&self) -> bool {
        self.knots[..self.count].iter().any(|k| k.kinds & (LOWER | UPPER) != 0)
    }

    /// Torque of the law on a segment.
    pub(super) fn on_segment(&self, j: usize, speed: f64) -> f64 {
        self.segments[j].at(speed)
    }

    /// Torque of the drive at this speed (J-15): on a segment, or on riser `k` where `total` is the torque of the whole law.
    /// On a riser friction takes its part first, then the drive; what is left is the stop's.
    pub(super) fn drive_torque(&self, speed: f64, riser: Option<(usize, f64)>) -> f64 {
        let beside = if speed > 0.0 { -self.friction } else { self.friction };
        match riser {
            Some((k, total)) if self.knots[k].kinds & SERVO != 0 => {
                let (slope, lower, upper) = self.soft;
                let soft_stop = slope * ((lower - speed).max(0.0) - (speed - upper).max(0.0));
                let rest = total + self.damping * speed - if slope > 0.0 { soft_stop } else { 0.0 };
                let held = self.friction + self.stiction;
                let friction = if self.knots[k].kinds & FRICTION != 0 { bounded(rest, held) } else { beside };
                let (low, high) = self.drive.range(speed);
                (rest - friction).max(low).min(high)
            }
            _ => self.drive.torque(speed),
        }
    }
}

/// `x` within ±`bound`; unlike `clamp` it cannot panic.
pub(super) fn bounded(x: f64, bound: f64) -> f64 {
    x.min(bound).max(-bound)
}
