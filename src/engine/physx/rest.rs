//! Bodies at rest (B-9). PhysX lets a body sleep by a measure and a time of its own; so its sleep is switched off, and a body is
//! put to sleep when it, and all that it touches, have been slow for as long as the model says.

use super::flight::Flight;
use super::plan::Plan;
use super::sys::Sim;
use crate::engine::forest::Islands;
use crate::model::Model;
use crate::solver::ContactPoint;

/// How long each body has been slow. Makes its memory once.
#[derive(Clone, Debug, Default)]
pub struct Rest {
    /// May any body sleep?
    sleepy: bool,
    /// s.
    slow: Vec<f64>,
    /// Of those that touch each other.
    islands: Islands,
    ready: Vec<bool>,
    /// Per body.
    pub asleep: Vec<bool>,
}

impl Rest {
    /// Nothing sleeps.
    pub fn new(plan: &Plan) -> Self {
        let n = plan.seats.len();
        let sleepy = plan.seats.iter().any(|s| s.rest.is_some());
        Self { sleepy, slow: vec![0.0; n], islands: Islands::new(n), ready: vec![false; n], asleep: vec![false; n] }
    }

    /// All awake, for as long as it takes anew.
    pub fn wake(&mut self, sim: &mut Sim) {
        for (i, slow) in self.slow.iter_mut().enumerate().filter(|_| self.sleepy) {
            *slow = 0.0;
            if std::mem::take(&mut self.asleep[i]) {
                sim.let_sleep(i, false);
            }
        }
    }

    /// After a step: who has been woken by a touch.
    pub fn look(&mut self, sim: &Sim) {
        for i in (0..self.asleep.len()).filter(|_| self.sleepy) {
            if self.asleep[i] && !sim.sleeps(i) {
                (self.asleep[i], self.slow[i]) = (false, 0.0);
            }
        }
    }

    /// After a part of `h` seconds: who goes to sleep.
    pub fn observe(
        &mut self,
        m: &Model,
        plan: &Plan,
        sim: &mut Sim,
        (now, touching, h): (&[Flight], &[ContactPoint], f64),
    ) {
        if !self.sleepy {
            return;
        }
        for (i, (seat, at)) in plan.seats.iter().zip(now).enumerate() {
            let slow = seat.rest.filter(|r| at.v.norm() <= r.linear && at.w.norm() <= r.angular);
            self.slow[i] = if slow.is_some() { self.slow[i] + h } else { 0.0 };
            self.ready[i] = self.asleep[i] || slow.is_some_and(|r| self.slow[i] > r.after);
        }
        self.islands.part();
        for p in touching {
            if let [Some(a), Some(b)] = p.colliders.map(|c| plan.carrier(m, c as u32)) {
                self.islands.join(a, b);
            }
        }
        for i in 0..self.ready.len() {
            let first = self.islands.of(i);
            self.ready[first] &= self.ready[i];
        }
        for i in 0..self.ready.len() {
            let first = self.islands.of(i);
            if self.ready[first] && !self.asleep[i] {
                self.asleep[i] = true;
                sim.let_sleep(i, true);
            }
        }
    }
}
