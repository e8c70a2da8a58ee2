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

/// Hands the directions in which joints yield to the hybrid dynamics, for all passes of a step. They are held where they are
/// if the effect is off.
pub fn write_softs(m: &Model, ws: &mut Workspace<f64>, start: &StepStart, effects: Effects) {
    for soft in &m.softs {
        let yields = effects.compliance && soft.softness.cfm > 0.0;
        ws.dofs[soft.v] = if yields { law(soft, start) } else { DofIn::locked(-start.state.v[soft.v] / start.h) };
    }
}

fn law(soft: &SoftDof, start: &StepStart) -> DofIn<f64> {
    let damping = soft.softness.hk_plus_d(start.h, start.whole);
    let (e, v) = (start.state.q[soft.q], start.state.v[soft.v]);
    DofIn::implicit(-(soft.softness.stiffness(start.whole) * e + damping * v), start.h * damping)
}

impl AxisSet {
    /// Adds the work of a step from the velocities `v` with these accelerations to what was taken from the robot: what a spring
    /// stores, it may give back.
    pub fn add_soft_work(&mut self, m: &Model, ws: &Workspace<f64>, v: &[f64], (h, qdd): (f64, &[f64])) {
        for (k, soft) in m.softs.iter().enumerate() {
            let (input, a) = (&ws.dofs[soft.v], qdd[soft.v]);
            let force = if input.free > 0.0 { input.tau - input.diagonal * a } else { ws.reaction[soft.v] };
            let (start, end) = (v[soft.v], v[soft.v] + h * a);
            self.paid[m.axes.len() + k] = (0.5 * h * force * start, 0.5 * h * force * end);
            self.books.work.losses -= 0.5 * h * force * (start + end);
        }
    }
}
