//! The work of the damping of bodies in the ledger.

use super::AxisSet;
use crate::dynamics::{Workspace, damping_powers};
use crate::model::Model;

impl AxisSet {
    /// Adds the work of a step from the velocities `v` with these accelerations to what was taken from the robot; `q` (nq) is
    /// the state of the last pass.
    pub fn add_damping_work(
        &mut self,
        m: &Model,
        ws: &mut Workspace<f64>,
        (q, v): (&[f64], &[f64]),
        (h, qdd): (f64, &[f64]),
    ) {
        let [start, end] = damping_powers(m, ws, q, [&|k| v[k], &|k| v[k] + h * qdd[k]]);
        self.damped = (0.5 * h * start, 0.5 * h * end);
        self.books.work.losses -= 0.5 * h * (start + end);
    }
}
