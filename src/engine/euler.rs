//! The semi-implicit Euler rule: accelerations of the start of a step, velocities of its end.

use super::midpoint::DEEPEST;
use super::rbx::{Rbx, StepReport, StepSettings};
use super::whirl::Seen;
use crate::dynamics::{Scheme, exponential_step, move_coordinates, write_damping};
use crate::model::Model;
use crate::solver::{AxisCommand, StepStart, write_softs};

/// A whirl of which h |λ| is more than this grows by more than 0.2 % per step.
const WHIRLS: f64 = 0.0625;

/// How a piece ended.
enum End {
    Done,
    /// Too long, and it may be divided; the state is as before.
    TooFast,
    /// The rule would make energy of it; the state is as before.
    Whirls,
}

impl Rbx {
    /// One step of `s.h`, in halves, quarters … where bodies might pass through each other. Returns what is left of it, s: that of which the
    /// rule would make energy.
    pub(super) fn euler(
        &mut self,
        m: &Model,
        commands: &[AxisCommand],
        s: &StepSettings,
        report: &mut StepReport,
    ) -> f64 {
        let pieces = 1u32 << DEEPEST;
        let (mut done, mut depth) = (0, 0);
        while done < pieces {
            let piece = pieces >> depth;
            let part = StepSettings { h: s.h * f64::from(piece) / f64::from(pieces), ..*s };
            match self.euler_piece(m, commands, (&part, depth < DEEPEST), report) {
                End::Done => {}
                End::TooFast => {
                    depth += 1;
                    report.divided = true;
                    continue;
                }
                End::Whirls => return s.h * f64::from(pieces - done) / f64::from(pieces),
            }
            done += piece;
            while depth > 0 && done % (pieces >> (depth - 1)) == 0 {
                depth -= 1;
            }
        }
        0.0
    }

    fn euler_piece(
        &mut self,
        m: &Model,
        commands: &[AxisCommand],
        (s, may_divide): (&StepSettings, bool),
        report: &mut StepReport,
    ) -> End {
        let at = self.state.as_ref();
        let start = StepStart { state: at, commands, h: s.h, whole: self.whole_step, mean: false, sweeps: s.passes };
        report.at_pole |= self.axes.prepare(m, &start, s.effects);
        if self.axes.is_fast() {
            if may_divide {
                return End::TooFast;
            }
            report.fast += 1;
        }
        self.piece.copy_from(&self.state);
        let at = self.state.as_ref();
        let start = StepStart { state: at, ..start };
        write_softs(m, &mut self.ws, &start, s.effects);
        write_damping(m, &mut self.ws, (s.h, Scheme::Start), s.effects.body_damping);
        let settled = self.axes.settle(m, &mut self.ws, at, (s.gravity, s.h, s.passes), &mut self.qdd);
        if self.whirls(m, s.h) {
            return End::Whirls;
        }
        let at = self.state.as_ref();
        report.unsettled |= !settled;
        self.axes.finish(m, &self.ws, &self.state.q, (s.h, &self.qdd));
        self.axes.add_soft_work(m, &self.ws, at.v, (s.h, &self.qdd));
        self.axes.add_damping_work(m, &mut self.ws, (at.q, at.v), (s.h, &self.qdd));
        self.axes.book_contacts((m, &self.ws), (at.q, at.v, &self.qdd), (s.h, self.whole_step));
        let lifted = self.axes.lift(m, &self.ws, (at.q, at.v, &self.qdd), s.h, &mut self.lift);
        exponential_step(m, &mut self.state.q, &mut self.state.v, &self.qdd, s.h);
        if lifted {
            self.book_lift(m, None, (s.h, s.gravity));
            self.unlifted.copy_from_slice(&self.state.q);
            move_coordinates(m, &self.unlifted, &self.lift, s.h, &mut self.state.q);
        }
        self.axes.round_speeds(m, &mut self.state.v);
        self.put_back(m);
        let piece = std::mem::take(&mut self.piece);
        self.pay(m, &piece, s.gravity, report);
        self.piece = piece;
        End::Done
    }

    /// Would the rule make energy of a piece with these accelerations? What joints and contacts do is no whirl, and neither are laws that
    /// change, unless they throw velocities about. Shorter pieces are looked at for that only: changes since another piece are not of
    /// their length.
    fn whirls(&mut self, m: &Model, h: f64) -> bool {
        let least = if self.axes.is_calm() && h == self.whole_step { WHIRLS } else { f64::INFINITY };
        let Some(trees) = &mut self.trees else { return false };
        for body in self.axes.contacts().into_iter().flat_map(|c| c.acting_bodies()).flatten() {
            trees.touch(body);
        }
        let touches = self.axes.contacts().is_some();
        let Some(driven) = &mut self.axes.driven else { return false };
        let (qdd, v) = (&self.qdd, &self.state.v);
        let mut whirls = trees.grow(&Seen::new((qdd, v), driven, touches), (h, least));
        if whirls {
            driven.explain(m, &self.ws, &self.state.q);
            whirls = trees.grow(&Seen::new((qdd, v), driven, touches), (h, least));
        }
        trees.end_step(qdd, h);
        driven.end_step();
        whirls
    }
}
