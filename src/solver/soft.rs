//! Soft joints (J-18): the law of each direction in which a joint yields.
//!
//! With e the error, v⁺ the velocity at the end of a step of h seconds, the force is
//!
//! ```text
//! f = −ERP/(CFM h) e − v⁺/CFM
//! ```
//!
//! which is a spring k = ERP/(CFM h) with a damper d = (1 − ERP)/CFM, taken by implicit Euler: −k (e + h v⁺) − d v⁺; so
//! ERP = h k/(h k + d) and CFM = 1/(h k + d). The damping is on the diagonal of the mass matrix; no step is too long for it.

use super::StateRef;
use crate::dynamics::{DofIn, Workspace};
use crate::model::{Model, SoftDof};

/// Hands the directions in which joints yield to the hybrid dynamics of a step of `h` seconds. They are held where they are
/// if the effect is off.
pub(super) fn write(m: &Model, ws: &mut Workspace<f64>, s: StateRef, h: f64) {
    for soft in &m.softs {
        let yields = m.effects.compliance && soft.softness.cfm > 0.0;
        ws.dofs[soft.v] = if yields { law(soft, s, h) } else { DofIn::locked(-s.v[soft.v] / h) };
    }
}

fn law(soft: &SoftDof, s: StateRef, h: f64) -> DofIn<f64> {
    let (erp, cfm) = (soft.softness.erp, soft.softness.cfm);
    DofIn::implicit(-(erp / (cfm * h) * s.q[soft.q] + s.v[soft.v] / cfm), h / cfm)
}
