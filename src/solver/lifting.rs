//! The position pass: nothing ends a step inside of something else, and no joint beyond its stop because of that.

use super::axis_set::AxisSet;
use super::contacts::{Pass, end_velocities};
use super::couplings::{AIM, Couplings};
use super::law::{LOWER, UPPER, WALL_LEFT, WALL_RIGHT};
use super::lifts::{Lift, LiftKind};
use super::rows::Kind;
use super::seat::Seat;
use crate::dynamics::{Push, Workspace};
use crate::model::{AxisSlot, Model};

/// Stops may be reached by lifts that other stops have changed: at most this often.
const ROUNDS: u32 = 4;
/// A lift moves no joint by more than this many times the speed that is missing, rad/s per m/s: the lever of 2 cm.
const AMPLE: f64 = 50.0;
/// Beyond its stop by less than this speed, an axis is at it; rad/s or m/s.
const SLACK: f64 = 1e-9;

/// A stop that a lift would pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reached {
    axis: usize,
    /// 1 for the lower stop, −1 for the upper one.
    sense: f64,
    block: usize,
    push: Push,
}

impl AxisSet {
    /// The speeds to move with in an implicit step of `h` besides those of its last pass at `q`, so that nothing ends inside of
    /// something else: to `lift` (nv). False if there are none.
    pub fn lift(
        &mut self,
        m: &Model,
        ws: &Workspace<f64>,
        (q, v0, qdd): (&[f64], &[f64], &[f64]),
        h: f64,
        lift: &mut [f64],
    ) -> bool {
        let Some(mut couplings) = self.couplings.take_if(|c| !c.idle()) else { return false };
        let pass = Pass { q, v0, h, mean: self.mean, sweeps: self.sweeps };
        let lifted = self.lift_by(m, ws, &mut couplings, &pass, (qdd, lift));
        self.couplings = Some(couplings);
        lifted
    }

    fn lift_by(
        &self,
        m: &Model,
        ws: &Workspace<f64>,
        c: &mut Couplings,
        pass: &Pass,
        (qdd, lift): (&[f64], &mut [f64]),
    ) -> bool {
        let Some(contacts) = c.contacts.as_mut().filter(|contacts| !contacts.is_empty()) else { return false };
        if !contacts.aim_lift((m, ws), &mut c.rows, pass, |u| self.speeds(m, pass, qdd, u)) {
            return false;
        }
        for k in 0..c.pairs.len() {
            *c.rows.lift(k) = Lift { kind: LiftKind::Exactly, bias: 0.0, impulse: 0.0 };
        }
        c.reached.clear();
        for _ in 0..ROUNDS {
            c.rows.solve_lifts(pass.sweeps, AIM);
            push_all(c);
            lift.fill(0.0);
            c.response.velocity(m, ws, pass.q, lift);
            if !self.reach(m, ws, c, pass, (qdd, lift)) {
                break;
            }
        }
        moderate(c, lift);
        true
    }

    /// The speeds with which the coordinates move, what puts axes back into their range included.
    fn speeds(&self, m: &Model, pass: &Pass, qdd: &[f64], u: &mut [f64]) {
        if pass.mean {
            for (u, (v0, (a, w))) in u.iter_mut().zip(pass.v0.iter().zip(qdd.iter().zip(&self.weight))) {
                *u = v0 + w * pass.h * a;
            }
        } else {
            end_velocities(m, pass, qdd, u);
        }
        if !self.pushes {
            return;
        }
        for (axis, law) in m.axes.iter().zip(&self.laws).filter(|(_, law)| law.push != 0.0) {
            if let AxisSlot::Scalar { v, .. } = axis.slot {
                u[v] += law.push / pass.h;
            }
        }
    }

    /// Adds rows for the stops that the lift would pass; false if there are none.
    fn reach(
        &self,
        m: &Model,
        ws: &Workspace<f64>,
        c: &mut Couplings,
        pass: &Pass,
        (qdd, lift): (&[f64], &[f64]),
    ) -> bool {
        let before = c.reached.len();
        for (i, axis) in m.axes.iter().enumerate() {
            let (law, by) = (&self.laws[i], self.axis_rate(m, axis, lift));
            if by == 0.0 || !law.has_stop() || self.rests(i) {
                continue;
            }
            let share = if self.at_end[i] || !self.mean { 1.0 } else { 0.5 };
            let u = self.speed[i] + share * pass.h * self.axis_rate(m, axis, qdd);
            for knot in &law.knots[..law.count] {
                let (sense, wall) = if knot.kinds & LOWER != 0 { (1.0, WALL_LEFT) } else { (-1.0, WALL_RIGHT) };
                let stops = knot.kinds & (LOWER | UPPER) != 0 && knot.kinds & wall != 0;
                let room = sense * (u - knot.speed);
                let known = c.reached.iter().any(|r| r.axis == i && r.sense == sense);
                if stops && !known && sense * by < 0.0 && room + sense * by < -SLACK {
                    self.add_stop(m, ws, c, pass, (i, sense, room.max(0.0)));
                }
            }
        }
        c.reached.len() > before
    }

    fn add_stop(
        &self,
        m: &Model,
        ws: &Workspace<f64>,
        c: &mut Couplings,
        pass: &Pass,
        (axis, sense, room): (usize, f64, f64),
    ) {
        let Some(seat) = Seat::of(m, axis) else { return };
        let push = self.push_of(m, axis, seat, sense);
        let block = c.rows.add(Kind::EQUALITY, 1, c.response.layout.chunks(push.body));
        c.response.row(m, ws, pass.q, &[push, Push::default()], c.rows.response(block, 0));
        c.rows.seal(block);
        *c.rows.lift(block) = Lift { kind: LiftKind::AtLeast, bias: room, impulse: 0.0 };
        c.reached.push(Reached { axis, sense, block, push });
    }
}

/// Pushes with the impulses of the position pass.
fn push_all(c: &mut Couplings) {
    let Couplings { contacts, rows, response, pairs, reached, .. } = c;
    if let Some(contacts) = contacts {
        contacts.push_lift(response, rows);
    }
    for (k, pair) in pairs.iter().enumerate() {
        let force = rows.lift(k).impulse;
        pair.pushes.iter().for_each(|push| response.push(push, force));
    }
    for r in reached {
        response.push(&r.push, rows.lift(r.block).impulse);
    }
}

/// Bodies that limbs at their locks hold in each other are not to be had apart by small moves: the solution may turn joints
/// through whole turns. Then all go the same way, but less far; the next steps take the rest.
fn moderate(c: &Couplings, lift: &mut [f64]) {
    let needed = c.contacts.as_ref().map_or(0.0, |contacts| contacts.most_missing(&c.rows));
    let most = lift.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
    if most > AMPLE * needed {
        let share = AMPLE * needed / most;
        lift.iter_mut().for_each(|u| *u *= share);
    }
}
