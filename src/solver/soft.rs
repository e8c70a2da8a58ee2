//! Soft joints (J-18): the law of each direction in which a joint yields.
//!
//! With e the error, v⁺ the velocity at the end of a step of h seconds, the force is
//!
//! ```text
//! f = −ERP/(CFM h) e − v⁺/CFM
//! ```
//!
//! which is a spring k = ERP/(CFM h) with a damper d = (1 − ERP)/CFM, taken by implicit Euler: −k (e + h v⁺) − d v⁺; so
//! ERP = h k/(h k + d) and CFM = 1/(h k + d). A part of a step keeps the spring and the damper of the whole one. The damping
//! is on the diagonal of the mass matrix; no step is too long for it.

use super::{AxisSet, StepStart};
use crate::dynamics::{DofIn, Workspace};
use crate::model::{Effects, Model, SoftDof};

/// Hands the directions in which joints yield to the hybrid dynamics, for all passes of a step, which may be a part of one of
/// `whole` seconds. They are held where they are if the effect is off.
pub fn write_softs(m: &Model, ws: &mut Workspace<f64>, start: &StepStart, effects: Effects, whole: f64) {
    for soft in &m.softs {
        let yields = effects.compliance && soft.softness.cfm > 0.0;
        ws.dofs[soft.v] =
            if yields { law(soft, start, whole) } else { DofIn::locked(-start.state.v[soft.v] / start.h) };
    }
}

fn law(soft: &SoftDof, start: &StepStart, whole: f64) -> DofIn<f64> {
    let (erp, cfm, h) = (soft.softness.erp, soft.softness.cfm, start.h);
    let (e, v) = (start.state.q[soft.q], start.state.v[soft.v]);
    // h k + d; exactly 1/cfm for a whole step.
    let damping = (1.0 - erp * (1.0 - h / whole)) / cfm;
    DofIn::implicit(-(erp / (cfm * whole) * e + damping * v), h * damping)
}

impl AxisSet {
    /// Adds the work of a step from the velocities `v` with these accelerations to what was taken from the robot: what a spring
    /// stores, it may give back.
    pub fn add_soft_work(&mut self, m: &Model, ws: &Workspace<f64>, v: &[f64], (h, qdd): (f64, &[f64])) {
        for soft in &m.softs {
            let (input, a) = (&ws.dofs[soft.v], qdd[soft.v]);
            let force = if input.free > 0.0 { input.tau - input.diagonal * a } else { ws.reaction[soft.v] };
            let (start, end) = (v[soft.v], v[soft.v] + h * a);
            self.paid.0 += 0.5 * h * force * start;
            self.paid.1 += 0.5 * h * force * end;
            self.work.losses -= 0.5 * h * force * (start + end);
        }
    }
}
