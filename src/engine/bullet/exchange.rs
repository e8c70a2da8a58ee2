//! What a step tells Bullet, and what it reads back.

use super::bridge::{MotorInput, PairInput};
use super::{Bullet, plan, turns};
use crate::dynamics::kinematics_of;
use crate::engine::maximal::read_state;
use crate::engine::principal::Motion;
use crate::math::{V3, Vec3};
use crate::model::{AxisSlot, Model};

impl Bullet {
    /// What a row of Bullet's counts of a unit of an axis: it goes along the unit vector of the axis' gradient; along its
    /// opposite, negative.
    fn scale(&self, m: &Model, axis: usize) -> f64 {
        match m.axes[axis].slot {
            AxisSlot::Euler { group, angle } => {
                let g = self.actuation.gradient(group, angle);
                // Bullet's middle axis is z × x, which turns over where cos P changes its sign.
                let over = angle == 1 && crate::math::sin_cos(self.from.0.angles[group][1]).1 < 0.0;
                if over { -g.dot(g).sqrt() } else { g.dot(g).sqrt() }
            }
            _ => turns::scale(&self.plan.links, &m.axes[axis].slot, m, &self.state),
        }
    }

    pub(super) fn write_inputs(&mut self, m: &Model, h: f64) {
        for axis in 0..m.axes.len() {
            let Some(driven) = self.plan.axes[axis] else { continue };
            let (piece, scale) = (self.actuation.motor(axis, h), self.scale(m, axis));
            let [low, high] = self.actuation.stop(axis).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            let (sense, scale) = (driven.sense * scale.signum(), scale.abs());
            let soft = if piece.damping.is_finite() { 1.0 / (piece.damping * scale * scale) } else { 0.0 };
            self.inputs[driven.motor] = MotorInput {
                torque: sense * piece.torque * scale,
                speed: sense * piece.speed / scale,
                cfm: if piece.damping > 0.0 { soft } else { 0.0 },
                bound: if piece.damping > 0.0 { piece.bound * scale } else { 0.0 },
                stop: if sense > 0.0 { [low / scale, high / scale] } else { [-high / scale, -low / scale] },
            };
        }
        for (input, pair) in self.pairs.iter_mut().zip(&self.plan.pairs) {
            let range = pair.range(&self.actuation, &self.from.0);
            *input = PairInput { on: range.is_some(), stop: range.unwrap_or_default() };
        }
    }

    pub(super) fn read_motors(&mut self, m: &Model) {
        for axis in 0..m.axes.len() {
            if let Some(driven) = self.plan.axes[axis] {
                self.motors[axis] = driven.sense * self.given[driven.motor] / self.scale(m, axis);
            }
        }
    }

    /// From Bullet's bodies to the state.
    pub(super) fn read(&mut self, m: &Model) {
        for (seat, moving) in self.plan.bodies.iter().zip(&self.bodies) {
            let (angular, linear) = (Vec3::from(moving.angular), Vec3::from(moving.linear));
            seat.write(&Motion { pose: plan::pose(&moving.pose), angular, linear }, &mut self.k);
        }
        for link in self.plan.links.iter().filter(|l| !l.turns.is_empty()) {
            turns::read(m, link, &self.k, &mut self.state);
        }
        kinematics_of(m, &mut self.k, (&self.state.q, &self.state.v), &self.plan.carried);
        self.drift = self.drift.max(read_state(m, &self.k, &mut self.state).linear);
    }

    /// `share`: of the step that the part is which they are of.
    pub(super) fn read_contacts(&mut self, m: &Model, share: f64) -> Result<(), String> {
        if self.plan.spec.shapes.is_empty() {
            return Ok(());
        }
        if let Ok(world) = self.world.get().as_ref().map_err(|_| ()) {
            world.contacts(&mut self.contacts).map_err(|e| e.to_string())?;
        }
        for c in &self.contacts {
            self.worst_penetration = self.worst_penetration.max(c.depth);
            let force = V3::from(c.force);
            for (shape, force) in c.shapes.iter().zip([-force, force]) {
                let body = self.plan.spec.shapes.get(*shape as usize).map_or(-1, |s| s.body);
                if let Some(seat) = usize::try_from(body).ok().and_then(|i| self.plan.bodies.get(i)) {
                    self.received[seat.body] += force * share;
                }
            }
        }
        debug_assert!(self.received.len() == m.bodies.len());
        Ok(())
    }
}
