//! The velocity pass of all contacts: rows, bounces, and what to do with rows that have no solution.

use super::point::{Impulse, Point, Target};
use super::{AIM, BAD, Contacts, EXTRA, FEW, Pass, ROUGH, TRIES, end_velocities};
use crate::dynamics::{Response, Workspace, kinematics_of, velocities_of};
use crate::model::Model;
use crate::solver::rows::{Rows, Solved};

impl Contacts {
    /// Solves the rows that are there together with those of all contacts, for velocities `v₀ + h qdd` without them, and pushes
    /// with the impulses of the contacts.
    pub(in crate::solver) fn solve(
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
        if self.bounces && self.bounce(rows, pass.h) {
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
        velocities_of(m, (ws, &self.middle), &mut self.end, (pass.q, &self.v1), &self.chain);
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
            point.aim(target.rows, &self.end);
            if self.resists_turning {
                point.add_discs(&mut target, &self.middle, &self.end);
            }
            point.write(rows, &point.impulse);
        }
    }

    /// After the first solve: contacts that bounce. True if there are any; then the rows are to be solved again. Two bodies bounce
    /// once, when the first of their points closes: points that left at times of their own would turn the bodies against each
    /// other as no velocity does.
    fn bounce(&mut self, rows: &mut Rows, h: f64) -> bool {
        for point in self.points.iter_mut() {
            let may = point.is_live() && point.surface.restitution > 0.0 && rows.impulse(point.block, 0) > 0.0;
            (point.closes, point.bounce) = (if may { point.closes(h) } else { None }, None);
        }
        let mut any = false;
        for i in 0..self.points.len() {
            if self.points[i].closes.is_some() {
                let bodies = self.points[i].touch.bodies;
                let same = self.points.iter().filter(|p| p.touch.bodies == bodies);
                let first = same.filter_map(|p| p.closes).fold(h, f64::min);
                any |= self.points[i].rebound(rows, first, h);
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
        let share = if size > 0.0 { (0.5 - work / size).clamp(0.0, 1.0) } else { 1.0 };
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
}

/// Where a parabola that is `p` at 0, ½ and 1, with p[0] ≤ 0 < p[2], crosses 0.
fn crossing(p: [f64; 3]) -> f64 {
    let (a, b) = (2.0 * (p[0] - 2.0 * p[1] + p[2]), 4.0 * p[1] - 3.0 * p[0] - p[2]);
    let root = (b * b - 4.0 * a * p[0]).max(0.0).sqrt();
    let s = if b >= 0.0 { -2.0 * p[0] / (b + root) } else { (root - b) / (2.0 * a) };
    if s.is_finite() { s.clamp(0.0, 1.0) } else { 0.0 }
}
