//! A step of the extrapolation method with its events: smooth pieces up to where an axis leaves its law or bodies touch, the
//! implicit midpoint rule for the shortest piece that contains it, and smooth pieces again.
//!
//! An event is found by trying: a piece that ends beyond it is not taken, and a shorter one ends where a straight line between the
//! margins crosses 0. That encloses it from both sides, until what is between them is as short as the accuracy asks for.

use super::extrapolation::{Extrapolation, Piece};
use super::midpoint::Midpoint;
use super::rbx::{Rbx, StepReport, StepSettings};
use crate::dynamics::{Scheme, write_damping};
use crate::model::Model;
use crate::solver::{AxisCommand, Shape, StepStart, first_to_leave, share};

/// The piece with an event is as long as the accuracy, in seconds, but not shorter than this, s, …
const SHORTEST: f64 = 1e-11;
/// … and at most this share of the step.
const SHARE: f64 = 1.0 / 64.0;
/// A step has at most this many tries; the rest goes to the implicit midpoint rule.
const TRIES: u32 = 300;
/// Smooth pieces are not shorter than this share of the step, but at events.
const FINEST: f64 = 1.0 / 256.0;
/// After this many pieces in a row at whose end nothing was smooth yet the rest goes to the implicit midpoint rule …
const PATIENCE: u32 = 4;
/// … each of them this many times as long as the one before it.
const LONGER: f64 = 4.0;
/// A try ends at least this share of what is known not to be smooth away from both ends of it.
const INSIDE: f64 = 0.02;

/// What is handed over is made in pieces of at most this, s: that of the default control interval and steps. Who asks for an accuracy
/// and one step per interval does not ask for worse contacts.
const COARSEST: f64 = 2e-4;

/// How a run of smooth pieces ended.
enum Stretch {
    /// At the end of the step.
    Done,
    /// Before an event that comes within this many seconds.
    Event(f64),
    /// It is not smooth here, or not to be resolved.
    Rough,
}

/// What is left of a step.
struct Rest<'a> {
    commands: &'a [AxisCommand],
    s: &'a StepSettings,
    /// s.
    time: f64,
    tries: u32,
    /// Length of a piece with an event, s.
    shortest: f64,
}

/// Ahead of the present state something stops being smooth.
#[derive(Clone, Copy)]
struct Wall {
    /// Within this time, s.
    within: f64,
    /// The axis and its margin, and that margin there.
    margin: Option<(usize, usize, f64)>,
}

impl Rbx {
    /// A step of the extrapolation method.
    pub(super) fn extrapolated_step(
        &mut self,
        m: &Model,
        commands: &[AxisCommand],
        s: &StepSettings,
        report: &mut StepReport,
    ) {
        let (Some(mut x), Some(mut mid)) = (self.extrapolation.take(), self.midpoint.take()) else { return };
        let shortest = s.accuracy.max(SHORTEST).min(SHARE * s.h);
        let mut rest = Rest { commands, s, time: s.h, tries: 0, shortest };
        let mut rough = 0;
        while rest.time > 0.0 {
            let before = rest.time;
            let end = self.stretch(m, &mut x, &mut rest, report);
            let moved = rest.time < before;
            let piece = match end {
                Stretch::Done => break,
                Stretch::Event(within) => {
                    rough = 0;
                    within
                }
                Stretch::Rough if x.handed && !moved || rough >= PATIENCE || rest.tries >= TRIES => {
                    self.hand_over(m, (&mut mid, &mut x.handed), &mut rest, report);
                    report.fell_back = true;
                    break;
                }
                Stretch::Rough => {
                    rough = if moved { 1 } else { rough + 1 };
                    shortest * LONGER.powi(rough as i32 - 1)
                }
            };
            self.rough_piece(m, (&mut mid, false), &mut rest, piece, report);
        }
        (self.extrapolation, self.midpoint) = (Some(x), Some(mid));
    }

    /// The rest of the step by the implicit midpoint rule.
    fn hand_over(
        &mut self,
        m: &Model,
        (mid, handed): (&mut Midpoint, &mut bool),
        rest: &mut Rest,
        report: &mut StepReport,
    ) {
        while rest.time > 0.0 {
            let pieces = (rest.time / COARSEST).ceil().max(1.0);
            self.rough_piece(m, (&mut *mid, *handed), rest, rest.time / pieces, report);
            *handed = true;
        }
    }

    /// A piece of the implicit midpoint rule, which may go on from the one before it.
    fn rough_piece(
        &mut self,
        m: &Model,
        (mid, goes_on): (&mut Midpoint, bool),
        rest: &mut Rest,
        piece: f64,
        report: &mut StepReport,
    ) {
        let piece = piece.min(rest.time);
        if !goes_on {
            mid.forget();
        }
        self.midpoint_step(m, mid, rest.commands, &StepSettings { h: piece, ..*rest.s }, report);
        rest.time -= piece;
    }

    /// Smooth pieces from the present state on.
    fn stretch(&mut self, m: &Model, x: &mut Extrapolation, rest: &mut Rest, report: &mut StepReport) -> Stretch {
        let mut wall: Option<Wall> = None;
        let mut begun = None;
        while rest.time > 0.0 {
            if let Some(wall) = wall.filter(|wall| wall.within <= rest.shortest) {
                return Stretch::Event(wall.within);
            }
            rest.tries += 1;
            if rest.tries > TRIES {
                return Stretch::Rough;
            }
            let Some(shape) = begun.or_else(|| self.begin_piece(m, x, rest, report)) else { return Stretch::Rough };
            begun = Some(shape);
            let wanted = wall.map_or_else(|| x.part_of(rest.time), |wall| guess(x, &wall));
            let Some(h) = self.clear_way(m, wanted, rest, report) else { return Stretch::Rough };
            let p = Piece { h, gravity: rest.s.gravity, accuracy: rest.s.accuracy, shape };
            if !self.try_piece(m, x, &p) {
                self.state.copy_from(&x.from);
                if x.shrink(h) < FINEST * rest.s.h.min(wall.map_or(f64::INFINITY, |w| w.within)) {
                    return Stretch::Rough;
                }
                continue;
            }
            self.arrive(m, x);
            if let Some(margin) = self.leaves(m, x, &p) {
                self.state.copy_from(&x.from);
                wall = Some(Wall { within: h, margin });
                continue;
            }
            self.take_piece(m, x);
            x.handed = false;
            rest.time = if h == rest.time { 0.0 } else { rest.time - h };
            wall = wall.map(|wall| Wall { within: wall.within - h, ..wall });
            if wall.is_none() {
                x.learn(h, rest.s.h);
            }
            begun = None;
        }
        Stretch::Done
    }

    /// Sets the laws up at the present state, and the rates there. `None` if it is not smooth.
    fn begin_piece(&mut self, m: &Model, x: &mut Extrapolation, rest: &Rest, report: &mut StepReport) -> Option<Shape> {
        let s = rest.s;
        // As of the shortest piece: which stop comes near is seen by the positions.
        let h = rest.shortest.min(rest.time);
        let state = self.state.as_ref();
        let start = StepStart { state, commands: rest.commands, h, whole: s.h, mean: true, sweeps: s.passes };
        report.at_pole |= self.axes.prepare(m, &start, s.effects);
        let rough = !self.axes.is_smooth(m) || self.axes.in_soft_stop() || self.axes.collides(m, None);
        if rough {
            return None;
        }
        let shape = self.axes.shape();
        write_damping(m, &mut self.ws, (h, Scheme::Continuous), s.effects.body_damping);
        let p = Piece { h: x.part_of(rest.time), gravity: s.gravity, accuracy: s.accuracy, shape };
        if !self.first_rates(m, x, &p) || !self.axes.is_soft_enough(m, &self.ws, &self.state.q, FINEST * s.h) {
            return None;
        }
        if shape.bends {
            let at = (&self.ws, &x.slope[m.nq..m.nq + m.nv]);
            self.axes.write_margins(m, at, self.state.as_ref(), &mut x.margins);
            if self.axes.has_left(m, &x.margins) {
                return None;
            }
        }
        Some(shape)
    }

    /// The longest piece, at most as long as `wanted`, in which bodies that are near cannot pass through each other.
    fn clear_way(&mut self, m: &Model, wanted: f64, rest: &mut Rest, report: &mut StepReport) -> Option<f64> {
        let mut h = wanted;
        while rest.tries <= TRIES {
            let fastest = self.axes.look_ahead(m, (&self.state.q, &self.state.v), h);
            if fastest <= 1.0 {
                return Some(h);
            }
            rest.tries += 1;
            report.divided = true;
            h = (0.9 * h / fastest).max(rest.shortest);
        }
        None
    }

    /// Does the present state, or the way to it, not fit the laws of the piece? Says which margin is to blame, if it can be said.
    fn leaves(&mut self, m: &Model, x: &mut Extrapolation, p: &Piece) -> Option<Option<(usize, usize, f64)>> {
        if p.shape.bends {
            if p.shape.stands {
                let mut slope = std::mem::take(&mut x.way);
                // The way has been gone; its memory serves for the rates at its end.
                let powers = [slope[m.nq + m.nv], slope[m.nq + m.nv + 1]];
                self.rates(m, p, false, &mut slope);
                slope[m.nq + m.nv..].copy_from_slice(&powers);
                x.way = slope;
            }
            let at = (&self.ws, &x.way[m.nq..m.nq + m.nv]);
            self.axes.write_margins(m, at, self.state.as_ref(), &mut x.after);
            if let Some((_, axis, which)) = first_to_leave(&x.margins, &x.after) {
                return Some(Some((axis, which, x.after[axis][which])));
            }
        }
        let collides = self.axes.collides(m, Some(self.state.as_ref()));
        (collides || x.strayed()).then_some(None)
    }

    /// Takes the piece to the present state.
    fn take_piece(&mut self, m: &Model, x: &Extrapolation) {
        let at = m.nq + m.nv;
        let work = &mut self.axes.books.work;
        work.drives += x.way[at];
        work.losses += x.way[at + 1];
        self.axes.end_smooth(m, &self.ws, self.state.as_ref(), &x.way[m.nq..at]);
    }
}

/// How far to go next with an event ahead, s.
fn guess(x: &Extrapolation, wall: &Wall) -> f64 {
    let share = wall.margin.map_or(0.5, |(axis, which, there)| share(x.margins[axis][which], there));
    x.part_of(wall.within).min(share.clamp(INSIDE, 1.0 - INSIDE) * wall.within)
}
