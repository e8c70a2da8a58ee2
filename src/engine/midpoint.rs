//! The implicit midpoint rule on the group of motions (Hairer, Lubich, Wanner: *Geometric Numerical Integration*, 2006,
//! §II.1.4, V): accelerations at the mean of the velocities and half-way between the poses.
//!
//! The rule is solved by fixed-point iteration, together with the axis set: every pass takes the middle of the step from the
//! accelerations of the pass before. That contracts while h · (speeds of the velocity products) is below 1; where it does
//! not, as on light limbs that whirl, the step is halved, which is more work and not less accuracy.

use super::guard::Guard;
use super::rbx::{Rbx, State, StepReport, StepSettings};
use crate::dynamics::{Scheme, move_coordinates, write_damping};
use crate::model::Model;
use crate::solver::{AxisCommand, StepStart, write_softs};

/// The middle of the step may still move by this, relative to 1 rad/s or m/s and the speed, when the iteration ends; what
/// is left after the last pass is smaller by the rate of contraction.
const TOLERANCE: f64 = 1e-8;
/// An iteration that shrinks by less than this factor per pass does not contract.
const CONTRACTION: f64 = 0.5;
/// Where bodies touch, what the middle still moves by makes no energy (`paid`), and what begins or ceases to slide makes it jump:
/// the tolerance, and a move that is no sign of a step that is too long.
const TOUCHING: f64 = 1e-6;
const JUMPS: f64 = 1e-3;
/// Velocities that the rows of contacts leave open, m/s, move the middle by about this many times as much.
const NOISE: f64 = 30.0;
/// When its passes are used up, a step whose middle moves by less than this is taken; one that had enough of them is halved.
const COARSE: f64 = 1e-6;
const ENOUGH: u32 = 5;
/// The same for a step whose axes do not all fit their laws: shorter ones would not make them fit.
const ROUGH: f64 = 1e-2;
/// A piece of a halved step whose motion would have to be slowed down by less than this share is as it should be.
const RESOLVED: f64 = 1e-4;
/// A step is halved at most this many times.
pub(super) const DEEPEST: u32 = 6;

/// Buffers of the rule.
#[derive(Clone, Debug)]
pub(super) struct Midpoint {
    /// State at the start of the (maybe halved) step.
    pub start: State,
    /// Half-way.
    middle: State,
    /// Speeds with which the coordinates move.
    u: Vec<f64>,
    /// The last piece moved with `Rbx::lift`, too.
    lifted: bool,
    /// Accelerations of the last step, the first guess for the next one.
    guess: Vec<f64>,
    pub guard: Guard,
    /// Is the piece longer than the shortest one?
    may_divide: bool,
}

impl Midpoint {
    pub fn new(m: &Model) -> Self {
        let state = State::initial(m);
        Self {
            middle: state.clone(),
            start: state,
            u: vec![0.0; m.nv],
            lifted: false,
            guess: vec![0.0; m.nv],
            guard: Guard::new(m),
            may_divide: false,
        }
    }

    pub fn forget(&mut self) {
        self.guess.fill(0.0);
    }
}

/// How the iteration of one step ended.
enum End {
    Converged,
    /// Out of passes, or some axis does not fit its law.
    Unsettled,
    NoContraction,
    /// Bodies might pass through each other unseen.
    TooFast,
}

impl Rbx {
    /// One step of `s.h`, in halves, quarters … where the iteration does not contract, or bodies might pass through each other.
    pub(super) fn midpoint_step(
        &mut self,
        m: &Model,
        mid: &mut Midpoint,
        commands: &[AxisCommand],
        s: &StepSettings,
        report: &mut StepReport,
    ) {
        let pieces = 1u32 << DEEPEST;
        let (mut done, mut depth) = (0, 0);
        while done < pieces {
            let piece = pieces >> depth;
            let part = StepSettings { h: s.h * f64::from(piece) / f64::from(pieces), ..*s };
            mid.start.copy_from(&self.state);
            mid.may_divide = depth < DEEPEST;
            match self.iterate(m, mid, commands, &part, report) {
                End::TooFast => {
                    depth += 1;
                    report.divided = true;
                    continue;
                }
                End::NoContraction if depth < DEEPEST => {
                    self.state.copy_from(&mid.start);
                    mid.forget();
                    depth += 1;
                    report.halvings += 1;
                    continue;
                }
                end @ (End::Converged | End::Unsettled) => {
                    report.unsettled |= matches!(end, End::Unsettled);
                    self.take(m, mid, (part.h, part.gravity));
                    if depth > 0 && report.halvings > 0 {
                        self.guard(m, mid, (part.gravity, 1.0 - RESOLVED), report);
                    }
                    let owed = self.pay(m, &mid.start, part.gravity, report);
                    report.trimmed_energy += self.lower(m, mid, part.h, (part.gravity, owed));
                }
                End::NoContraction => {
                    report.unsettled = true;
                    self.explicit_piece(m, mid, commands, &part);
                    self.guard(m, mid, (part.gravity, 1.0), report);
                    self.pay(m, &mid.start, part.gravity, report);
                }
            }
            done += piece;
            // Back to longer pieces where they fit.
            while depth > 0 && done % (pieces >> (depth - 1)) == 0 {
                depth -= 1;
            }
        }
    }

    fn iterate(
        &mut self,
        m: &Model,
        mid: &mut Midpoint,
        commands: &[AxisCommand],
        s: &StepSettings,
        report: &mut StepReport,
    ) -> End {
        let start = StepStart {
            state: mid.start.as_ref(),
            commands,
            h: s.h,
            whole: self.whole_step,
            mean: true,
            sweeps: s.passes,
        };
        report.at_pole |= self.axes.prepare(m, &start, s.effects);
        if self.axes.is_fast() {
            if mid.may_divide {
                return End::TooFast;
            }
            report.fast += 1;
        }
        write_softs(m, &mut self.ws, &start, s.effects);
        write_damping(m, &mut self.ws, (s.h, Scheme::Middle), s.effects.body_damping);
        self.qdd.copy_from_slice(&mid.guess);
        self.mean_velocities(mid, s.h);
        self.half_way(m, mid, s.h);
        let (mut pass, mut last) = (0, f64::INFINITY);
        loop {
            pass += 1;
            let wanted = pass < s.passes;
            let at = (mid.middle.as_ref(), &mid.start.v[..]);
            let misfits = self.axes.pass(m, &mut self.ws, at, (s.gravity, s.h), (&mut self.qdd, wanted));
            // Accelerations of laws that do not fit may be wild: the middle does not follow them.
            let moved = if misfits == 0 || !wanted { self.mean_velocities(mid, s.h) } else { 1.0 };
            let touches = self.axes.touches();
            let tolerance = if touches { TOUCHING } else { TOLERANCE };
            if misfits == 0 && moved <= tolerance.max(NOISE * self.axes.residual()) {
                return End::Converged;
            }
            let jumps = if touches { JUMPS } else { 0.0 };
            if !moved.is_finite() || (misfits == 0 && pass > 2 && moved > (CONTRACTION * last).max(jumps)) {
                return End::NoContraction;
            }
            if !wanted {
                let near = if misfits == 0 && !touches { COARSE } else { ROUGH };
                return match misfits {
                    0 if moved <= COARSE => End::Converged,
                    _ if moved > near && pass >= ENOUGH => End::NoContraction,
                    _ => End::Unsettled,
                };
            }
            if misfits == 0 {
                self.half_way(m, mid, s.h);
            }
            last = if misfits == 0 { moved } else { f64::INFINITY };
        }
    }

    /// The last resort: accelerations of the start of the piece.
    fn explicit_piece(&mut self, m: &Model, mid: &mut Midpoint, commands: &[AxisCommand], s: &StepSettings) {
        let start = StepStart {
            state: mid.start.as_ref(),
            commands,
            h: s.h,
            whole: self.whole_step,
            mean: true,
            sweeps: s.passes,
        };
        self.axes.prepare(m, &start, s.effects);
        let bounds = (s.gravity, s.h, s.passes.max(ENOUGH));
        self.axes.settle(m, &mut self.ws, mid.start.as_ref(), bounds, &mut self.qdd);
        self.take(m, mid, (s.h, s.gravity));
        mid.forget();
    }

    /// Takes the velocities of the middle from the accelerations; returns by how much they have moved.
    fn mean_velocities(&mut self, mid: &mut Midpoint, h: f64) -> f64 {
        let (mut moved, mut finite) = (0.0_f64, true);
        for (v, (v0, a)) in mid.middle.v.iter_mut().zip(mid.start.v.iter().zip(&self.qdd)) {
            let new = v0 + 0.5 * h * a;
            let step = (new - *v).abs() / (1.0 + new.abs());
            (moved, finite) = (moved.max(step), finite && step.is_finite());
            *v = new;
        }
        if finite { moved } else { f64::INFINITY }
    }

    /// Moves half-way with the speeds that the coordinates have by the accelerations.
    fn half_way(&mut self, m: &Model, mid: &mut Midpoint, h: f64) {
        self.take_speeds(mid, h);
        move_coordinates(m, &mid.start.q, &mid.u, 0.5 * h, &mut mid.middle.q);
        if !m.eulers.is_empty() {
            mid.middle.angles.copy_from_slice(&mid.start.angles);
            mid.middle.read_angles(m);
        }
    }

    /// The speeds with which the coordinates move, by the accelerations.
    fn take_speeds(&self, mid: &mut Midpoint, h: f64) {
        let rates = mid.start.v.iter().zip(self.qdd.iter().zip(&self.axes.weight));
        for (u, (v0, (a, weight))) in mid.u.iter_mut().zip(rates) {
            *u = v0 + weight * h * a;
        }
    }

    /// Where even standing still would not pay for the height that a step has gained (`owed`, J), bodies are lifted out of each other
    /// by less, and if that is not it, the whole step goes less far. Returns by how much potential energy that is less, J.
    fn lower(&mut self, m: &Model, mid: &mut Midpoint, h: f64, (gravity, mut owed): ([f64; 3], f64)) -> f64 {
        if owed <= 0.0 {
            return 0.0;
        }
        let mut full = self.potential(m, gravity);
        let high = full;
        if mid.lifted {
            mid.u.iter_mut().zip(&self.lift).for_each(|(u, lift)| *u -= lift);
            self.move_from(m, mid, h);
            let raised = full - self.potential(m, gravity);
            let share = affordable(raised, owed);
            mid.u.iter_mut().zip(&self.lift).for_each(|(u, lift)| *u += share * lift);
            self.move_from(m, mid, h);
            let now = self.potential(m, gravity);
            (owed, full) = (owed - (full - now), now);
        }
        if owed > 0.0 {
            self.state.q.copy_from_slice(&mid.start.q);
            let share = affordable(full - self.potential(m, gravity), owed);
            mid.u.iter_mut().for_each(|u| *u *= share);
            self.move_from(m, mid, h);
            full = self.potential(m, gravity);
        }
        high - full
    }

    /// Moves from the start of the piece with its speeds.
    fn move_from(&mut self, m: &Model, mid: &Midpoint, h: f64) {
        move_coordinates(m, &mid.start.q, &mid.u, h, &mut self.state.q);
        self.put_back(m);
    }

    /// Takes the step with the accelerations of the last pass.
    fn take(&mut self, m: &Model, mid: &mut Midpoint, (h, gravity): (f64, [f64; 3])) {
        self.axes.finish(m, &self.ws, &mid.middle.q, (h, &self.qdd));
        self.axes.add_soft_work(m, &self.ws, &mid.start.v, (h, &self.qdd));
        self.axes.add_damping_work(m, &mut self.ws, (&mid.middle.q, &mid.start.v), (h, &self.qdd));
        self.axes.book_contacts((m, &self.ws), (&mid.middle.q, &mid.start.v, &self.qdd), (h, self.whole_step));
        for (v, (v0, a)) in self.state.v.iter_mut().zip(mid.start.v.iter().zip(&self.qdd)) {
            *v = v0 + h * a;
        }
        self.take_speeds(mid, h);
        mid.lifted = self.axes.lift(m, &self.ws, (&mid.middle.q, &mid.start.v, &self.qdd), h, &mut self.lift);
        if mid.lifted {
            self.book_lift(m, Some(&mid.middle.q), (h, gravity));
            mid.u.iter_mut().zip(&self.lift).for_each(|(u, lift)| *u += lift);
        }
        self.axes.round_speeds(m, &mut self.state.v);
        self.move_from(m, mid, h);
        if self.axes.is_calm() {
            mid.guess.copy_from_slice(&self.qdd);
        } else {
            mid.forget();
        }
    }
}

/// The share of a rise that is paid for, if `owed` of it is not.
fn affordable(raised: f64, owed: f64) -> f64 {
    if raised > 0.0 { (1.0 - owed / raised).max(0.0) } else { 1.0 }
}
