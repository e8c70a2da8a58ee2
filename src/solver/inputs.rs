//! From the places of the axes to the inputs of the hybrid dynamics, and back to torques.

use super::axis_set::AxisSet;
use crate::dynamics::{DofIn, Workspace, turn};
use crate::math::V3;
use crate::model::{AxisSlot, JointType, Model};

/// What the hybrid dynamics get of one axis.
pub(super) enum Input {
    /// Acceleration of the axis; for an angle of a group, gradient·ω̇.
    Locked(f64),
    /// Torque, and what is added to the diagonal of the mass matrix.
    Sliding { torque: f64, diagonal: f64 },
}

impl AxisSet {
    /// Laws of the step as torques, diagonals and locks.
    pub(super) fn write_inputs(&mut self, m: &Model, ws: &mut Workspace<f64>, h: f64) {
        clear_balls(ws);
        for i in 0..m.axes.len() {
            if self.between[i].on {
                self.write_between(ws, i, h);
                continue;
            }
            if self.rests(i) {
                continue;
            }
            if self.is_contested(i) {
                let input = self.contested_input(i, h);
                self.write(m, ws, i, input);
                continue;
            }
            let (law, place, v) = (&self.laws[i], self.place[i], self.speed[i]);
            let input = if place % 2 == 1 {
                Input::Locked((law.knots[place / 2].speed - v) / h)
            } else {
                let share = if self.at_end[i] { 1.0 } else { 0.5 };
                let slope = law.segments[place / 2].slope;
                let torque = law.on_segment(place / 2, v) + self.rotor[i] * self.turning[i];
                Input::Sliding { torque, diagonal: share * slope * h + self.rotor[i] }
            };
            self.write(m, ws, i, input);
        }
    }

    /// Hands one axis to the hybrid dynamics, through its own coordinate or the gradient of its angle.
    pub(super) fn write(&mut self, m: &Model, ws: &mut Workspace<f64>, i: usize, input: Input) {
        match (m.axes[i].slot, input) {
            (AxisSlot::Apart { .. }, _) => {}
            (AxisSlot::Scalar { v, .. }, Input::Locked(acceleration)) => ws.dofs[v] = DofIn::locked(acceleration),
            (AxisSlot::Scalar { v, .. }, Input::Sliding { torque, diagonal }) if diagonal > 0.0 => {
                ws.dofs[v] = DofIn::implicit(torque, diagonal);
            }
            (AxisSlot::Scalar { v, .. }, Input::Sliding { torque, .. }) => ws.dofs[v] = DofIn::free(torque),
            (AxisSlot::Euler { group, angle }, input) => {
                let g = self.rates[group].gradient[angle];
                let ball = &mut ws.ball_in[m.bodies[m.eulers[group].body].ball];
                match input {
                    Input::Locked(acceleration) => self.lock[i] = ball.add_lock(g, acceleration),
                    Input::Sliding { torque, diagonal } => {
                        ball.tau = g.mad(torque, ball.tau);
                        ball.inertia.sub_outer(g * -diagonal, g);
                    }
                }
            }
        }
    }

    /// Torque of the law that keeps a standing axis to its acceleration: what its joint needs, and its rotor.
    pub(super) fn riser_torque(&self, m: &Model, ws: &Workspace<f64>, i: usize, qdd: &[f64]) -> f64 {
        if self.is_contested(i) {
            return self.contested_torque(i, self.h);
        }
        let rotor = match self.rotor[i] {
            0.0 => 0.0,
            rotor => rotor * (self.axis_rate(m, &m.axes[i], qdd) - self.turning[i]),
        };
        let joint = match m.axes[i].slot {
            AxisSlot::Apart { .. } => 0.0,
            AxisSlot::Scalar { v, .. } => ws.reaction[v],
            AxisSlot::Euler { group, .. } => {
                ws.ball_in[m.bodies[m.eulers[group].body].ball].lock[self.lock[i]].reaction
            }
        };
        joint + rotor
    }

    /// Acceleration per torque of a sliding axis in the last pass, with the laws of all others at work and its base held.
    pub(super) fn mobility(&self, m: &Model, ws: &Workspace<f64>, i: usize) -> f64 {
        match m.axes[i].slot {
            AxisSlot::Apart { .. } => 0.0,
            AxisSlot::Scalar { v, .. } => ws.mobility(v),
            AxisSlot::Euler { group, angle } => {
                ws.ball_mobility(m.bodies[m.eulers[group].body].ball, self.rates[group].gradient[angle])
            }
        }
    }

    /// Angles at the state of the pass; the speeds at the start of the step, seen along their gradients.
    pub(super) fn take_rates(&mut self, m: &Model, at: super::StateRef, v0: &[f64]) {
        if m.eulers.is_empty() {
            return;
        }
        self.update_rates(m, at.angles);
        for (i, axis) in m.axes.iter().enumerate() {
            if let AxisSlot::Euler { group, angle } = axis.slot {
                self.speed[i] = self.axis_rate(m, axis, v0);
                if self.rotor[i] > 0.0 {
                    self.turning[i] = self.rates[group].gradient[angle].dot(self.turning(m, at, group));
                }
            }
        }
    }

    /// Velocity coordinates of axes that move with their speed at the end do so too; a group moves as one.
    pub(super) fn set_weights(&mut self, m: &Model) {
        self.share_ends(m);
        self.weight.fill(if self.mean { 0.5 } else { 1.0 });
        if !self.mean {
            return;
        }
        for soft in &m.softs {
            self.weight[soft.v] = 1.0;
        }
        for (axis, _) in m.axes.iter().zip(&self.at_end).filter(|(_, at_end)| **at_end) {
            match axis.slot {
                AxisSlot::Scalar { v, .. } => self.weight[v] = 1.0,
                AxisSlot::Euler { group, .. } => {
                    let at = m.eulers[group].v;
                    self.weight[at..at + JointType::Spherical.nv()].fill(1.0);
                }
                AxisSlot::Apart { .. } => {}
            }
        }
    }

    /// Puts axes that were outside their range back by the share of the way that their stop's ERP takes. True if there were
    /// any.
    pub fn push_back(&self, m: &Model, q: &mut [f64], angles: &[[f64; 3]]) -> bool {
        if !self.pushes {
            return false;
        }
        for (axis, law) in m.axes.iter().zip(&self.laws).filter(|(_, law)| law.push != 0.0) {
            match axis.slot {
                AxisSlot::Scalar { q: k, .. } => q[k] += law.push,
                AxisSlot::Euler { group, angle } => {
                    let e = &m.eulers[group];
                    turn(&mut q[e.q..e.q + 4], e.directions(angles[group])[angle] * law.push);
                }
                AxisSlot::Apart { .. } => {}
            }
        }
        true
    }

    /// Takes the rounding from the speeds: a standing axis has that of its riser to the last bit, and a sliding one that has
    /// been slowed down to a knot is not behind it.
    pub fn round_speeds(&self, m: &Model, v: &mut [f64]) {
        for (i, (axis, (law, place))) in m.axes.iter().zip(self.laws.iter().zip(&self.place)).enumerate() {
            if self.is_between(i, v) {
                continue;
            }
            if let AxisSlot::Scalar { v: k, .. } = axis.slot {
                v[k] = law.rounded(*place, v[k]);
            }
        }
    }

    /// The part of ω̇ of a group that the turning of its own axes makes: an angle at constant rate has `g·ω̇ = g·turning`.
    pub(super) fn turning(&self, m: &Model, s: super::StateRef, group: usize) -> V3<f64> {
        let e = &m.eulers[group];
        let w = V3::new(s.v[e.v], s.v[e.v + 1], s.v[e.v + 2]);
        e.direction_rates(s.angles[group], self.rates[group].gradient.map(|g| g.dot(w)))
    }
}

/// Axes add to the inputs of their group's joint, so these start from nothing.
pub(super) fn clear_balls(ws: &mut Workspace<f64>) {
    for input in &mut ws.ball_in {
        *input = Default::default();
    }
}
