//! The semi-implicit Euler rule: accelerations of the start of a step, velocities of its end.

use super::midpoint::DEEPEST;
use super::rbx::{Rbx, StepReport, StepSettings};
use crate::dynamics::{Scheme, exponential_step, move_coordinates, write_damping};
use crate::model::Model;
use crate::solver::{AxisCommand, StepStart, write_softs};

impl Rbx {
    /// One step of `s.h`, in halves, quarters … where bodies might pass through each other.
    pub(super) fn euler(&mut self, m: &Model, commands: &[AxisCommand], s: &StepSettings, report: &mut StepReport) {
        let pieces = 1u32 << DEEPEST;
        let (mut done, mut depth) = (0, 0);
        while done < pieces {
            let piece = pieces >> depth;
            let part = StepSettings { h: s.h * f64::from(piece) / f64::from(pieces), ..*s };
            if !self.euler_piece(m, commands, (&part, depth < DEEPEST), report) {
                depth += 1;
                report.divided = true;
                continue;
            }
            done += piece;
            while depth > 0 && done % (pieces >> (depth - 1)) == 0 {
                depth -= 1;
            }
        }
    }

    /// False, with the state as before, if the piece is too long and may be divided.
    fn euler_piece(
        &mut self,
        m: &Model,
        commands: &[AxisCommand],
        (s, may_divide): (&StepSettings, bool),
        report: &mut StepReport,
    ) -> bool {
        let at = self.state.as_ref();
        let start = StepStart { state: at, commands, h: s.h, whole: self.whole_step, mean: false, sweeps: s.passes };
        report.at_pole |= self.axes.prepare(m, &start, s.effects);
        if self.axes.is_fast() {
            if may_divide {
                return false;
            }
            report.fast += 1;
        }
        self.piece.copy_from(&self.state);
        let at = self.state.as_ref();
        let start = StepStart { state: at, ..start };
        write_softs(m, &mut self.ws, &start, s.effects);
        write_damping(m, &mut self.ws, (s.h, Scheme::Start), s.effects.body_damping);
        report.unsettled |= !self.axes.settle(m, &mut self.ws, at, (s.gravity, s.h, s.passes), &mut self.qdd);
        self.axes.finish(m, &self.ws, &self.state.q, (s.h, &self.qdd));
        self.axes.add_soft_work(m, &self.ws, at.v, (s.h, &self.qdd));
        self.axes.add_damping_work(m, &mut self.ws, (at.q, at.v), (s.h, &self.qdd));
        self.axes.book_contacts(m, (at.q, at.v, &self.qdd), (s.h, self.whole_step));
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
        true
    }
}
