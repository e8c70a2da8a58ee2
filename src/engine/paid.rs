//! Steps in contact make no energy: what drives, weight and laws have not paid for is taken out, counted and added up.
//!
//! Impacts, and rows that are not solved to the last bit, act through velocities of the middle of a step on limbs that turn on;
//! the energy of a step is right to its order, but errors of one sign add up where a robot lies and jerks. So an island of trees
//! that contacts hold together may end a step with at most the energy it began with and the work of its axes; else all its
//! velocities are scaled alike, which keeps standing points standing and rolling ones rolling. Free motion is left alone.

use super::forest::{Forest, Islands};
use super::rbx::{Rbx, State, StepReport};
use crate::dynamics::{Energy, Kinematics, body_energy, kinematics};
use crate::model::Model;

/// Buffers, per tree.
#[derive(Clone, Debug)]
pub(super) struct Paid {
    forest: Forest,
    islands: Islands,
    kinematics: Kinematics,
    accounts: Vec<Account>,
}

/// Of one tree, or of all of an island, J.
#[derive(Clone, Copy, Debug, Default)]
struct Account {
    before: Energy,
    after: Energy,
    /// Work of the axes with the speeds at the start and at the end.
    paid: (f64, f64),
    /// Does a contact act on it?
    touched: bool,
    /// What its velocities are multiplied by.
    share: f64,
}

impl Paid {
    pub fn new(m: &Model) -> Self {
        let forest = Forest::of(m);
        let accounts = vec![Account::default(); forest.count];
        Self { islands: Islands::new(forest.count), kinematics: Kinematics::new(m), accounts, forest }
    }
}

impl Rbx {
    /// Ends a piece of a step that began with the state `start` (of `Contacts::start`).
    pub(super) fn pay(&mut self, m: &Model, start: &State, gravity: [f64; 3], report: &mut StepReport) {
        let Some(mut paid) = self.paid.take() else { return };
        if self.touched(&mut paid) {
            self.balance(m, &mut paid, start, gravity);
            for body in 1..m.bodies.len() {
                let tree = paid.islands.of(paid.forest.of_body[body]);
                let (b, share) = (&m.bodies[body], paid.accounts[tree].share);
                if share < 1.0 {
                    self.state.v[b.v..b.v + b.joint.nv()].iter_mut().for_each(|v| *v *= share);
                }
            }
            for account in paid.accounts.iter().filter(|a| a.share < 1.0) {
                report.trimmed_energy += (1.0 - account.share * account.share) * account.after.kinetic;
            }
        }
        self.paid = Some(paid);
    }

    /// Joins the trees that contacts hold together; true if there are contacts that carry something.
    fn touched(&self, paid: &mut Paid) -> bool {
        paid.accounts.fill(Account { share: 1.0, ..Account::default() });
        paid.islands.part();
        let mut any = false;
        for bodies in self.axes.contacts().into_iter().flat_map(|c| c.carrying_bodies()) {
            let [a, b] = bodies.map(|body| paid.forest.of_body[body]);
            paid.islands.join(a, b);
            for tree in [a, b] {
                if let Some(account) = paid.accounts.get_mut(tree) {
                    account.touched = true;
                }
            }
            any = true;
        }
        any
    }

    /// Adds up the accounts of each island in its first tree, and finds its share.
    fn balance(&self, m: &Model, paid: &mut Paid, start: &State, gravity: [f64; 3]) {
        let Paid { forest, islands, kinematics: k, accounts } = paid;
        let Some(contacts) = self.axes.contacts() else { return };
        kinematics(m, k, &self.state.q, &self.state.v);
        let add = |to: &mut Energy, e: Energy| {
            (to.kinetic, to.potential) = (to.kinetic + e.kinetic, to.potential + e.potential)
        };
        for body in 1..m.bodies.len() {
            let account = &mut accounts[islands.of(forest.of_body[body])];
            add(&mut account.before, body_energy(m, contacts.start(), gravity, body));
            add(&mut account.after, body_energy(m, k, gravity, body));
        }
        let softs = m.softs.iter().map(|s| m.body_of(s.v).map_or(forest.count, |b| forest.of_body[b]));
        for (tree, by) in forest.of_axis.iter().copied().chain(softs).zip(self.axes.paid_by()) {
            if tree < forest.count {
                let account = &mut accounts[islands.of(tree)];
                account.paid = (account.paid.0 + by.0, account.paid.1 + by.1);
            }
        }
        for (axis, rotor) in self.axes.rotors().enumerate().filter(|(_, rotor)| *rotor > 0.0) {
            let tree = forest.of_axis[axis];
            if tree < forest.count {
                let account = &mut accounts[islands.of(tree)];
                let kinetic = |s: &State| 0.5 * rotor * s.axis(m, axis).1.powi(2);
                account.before.kinetic += kinetic(start);
                account.after.kinetic += kinetic(&self.state);
            }
        }
        for tree in 0..forest.count {
            if accounts[tree].touched {
                let island = &mut accounts[islands.of(tree)];
                island.share = island.affordable();
            }
        }
    }
}

impl Account {
    /// The share s ≤ 1 of the velocities with `s² T = E₀ − V + paid₀ + s paid₁`, or 1 if that is less than what there is.
    fn affordable(&self) -> f64 {
        let held = self.before.kinetic + self.before.potential - self.after.potential + self.paid.0;
        let (kinetic, by_end) = (self.after.kinetic, self.paid.1);
        if kinetic <= held + by_end || kinetic <= 0.0 {
            return 1.0;
        }
        let share = (by_end + (by_end * by_end + 4.0 * kinetic * held.max(0.0)).sqrt()) / (2.0 * kinetic);
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 1.0 }
    }
}
