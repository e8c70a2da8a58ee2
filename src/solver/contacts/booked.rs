//! What contacts have done in a step: the energy they have taken, and the forces on bodies.

use super::{Contacts, Pass, approach, end_velocities, turning};
use crate::dynamics::{Workspace, velocities_of};
use crate::math::V3;
use crate::model::Model;
use crate::solver::AxisSet;

impl Contacts {
    /// Force of all contacts on each body in the last step, averaged over it, along the world's axes, N. A body that rests
    /// keeps that of its last step.
    pub fn received(&self) -> &[V3<f64>] {
        &self.received
    }

    /// Before a step.
    fn forget_received(&mut self) {
        let moving = self.received.iter_mut().zip(&self.rests).filter(|(_, rests)| !**rests);
        moving.for_each(|(force, _)| *force = V3::default());
    }

    /// Books a piece, taken with `qdd`, of a step of `whole` seconds. Returns the work of the impulses x of the piece, J:
    /// Σ x·(u₀ + u₁)/2 with the rows of the pass, as the energy balance of the midpoint rule has it.
    fn book(&mut self, (m, ws): (&Model, &Workspace<f64>), pass: &Pass, qdd: &[f64], whole: f64) -> f64 {
        end_velocities(m, pass, qdd, &mut self.v1);
        self.v1.iter_mut().zip(pass.v0).for_each(|(v1, v0)| *v1 = 0.5 * (*v1 + v0));
        velocities_of(m, (ws, &self.middle), &mut self.end, (pass.q, &self.v1), &self.chain);
        let mut work = 0.0;
        for point in self.points.iter().filter(|p| p.is_live()) {
            let (n, x) = (point.axes[0], &point.impulse);
            let (force, torque) = (n * x.normal + x.tangent, n * x.spinning + x.rolling);
            work += force.dot(approach(&self.end, &point.touch, point.placed.point));
            work += torque.dot(turning(&self.end, &point.touch));
            let mean = force * (1.0 / whole);
            self.received[point.acts[0]] += -mean;
            self.received[point.acts[1]] += mean;
        }
        work
    }
}

impl AxisSet {
    /// Before a step: forgets the forces of contacts in the last one.
    pub fn open_books(&mut self) {
        if let Some(contacts) = self.couplings.as_mut().and_then(|c| c.contacts.as_mut()) {
            contacts.forget_received();
        }
    }

    /// Books what contacts do in a piece of `h` seconds of a step of `whole`, taken from the velocities `v0` with `qdd` (nv);
    /// `q` (nq) is the state of the last pass, in `ws`.
    pub fn book_contacts(
        &mut self,
        (m, ws): (&Model, &Workspace<f64>),
        (q, v0, qdd): (&[f64], &[f64], &[f64]),
        (h, whole): (f64, f64),
    ) {
        let Some(contacts) = self.couplings.as_mut().and_then(|c| c.contacts.as_mut()) else { return };
        if !contacts.is_empty() {
            let pass = Pass { q, v0, h, mean: self.mean, sweeps: self.sweeps };
            self.books.work.contacts -= contacts.book((m, ws), &pass, qdd, whole);
        }
    }
}
