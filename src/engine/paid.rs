//! Steps in contact make no energy: what drives, weight and laws have not paid for is taken out, counted and added up.
//! The same in scenes with contacts for trees of which an axis is at its hard stop, which is a blow or a support as well.
//!
//! Impacts, and rows that are not solved to the last bit, act through velocities of the middle of a step on limbs that turn on;
//! the energy of a step is right to its order, but errors of one sign add up where a robot lies and jerks. So an island of trees
//! that contacts hold together may end a step with at most the energy it began with and the work of its axes; else all its
//! velocities are scaled alike, which keeps standing points standing and rolling ones rolling. Free motion is left alone.

use super::forest::{Forest, Islands};
use super::rbx::{Rbx, State, StepReport};
use crate::dynamics::{Energy, Kinematics, body_energy, body_momentum, energy, kinematics};
use crate::math::V3;
use crate::model::Model;

/// Buffers, per tree.
#[derive(Clone, Debug)]
pub(super) struct Paid {
    forest: Forest,
    islands: Islands,
    /// Of states that are not shown.
    kinematics: Kinematics,
    accounts: Vec<Account>,
    ended: Ended,
}

/// How the last piece ended: mostly the next one begins there.
#[derive(Clone, Debug)]
struct Ended {
    state: State,
    gravity: [f64; 3],
    /// Per body.
    energies: Vec<Energy>,
    known: bool,
}

impl Ended {
    /// Are these the energies of this state?
    fn is(&self, state: &State, gravity: [f64; 3]) -> bool {
        self.known && self.gravity == gravity && self.state.q == state.q && self.state.v == state.v
    }
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
        let energies = vec![Energy::default(); m.bodies.len()];
        let ended = Ended { state: State::initial(m), gravity: [0.0; 3], energies, known: false };
        Self { islands: Islands::new(forest.count), kinematics: Kinematics::new(m), accounts, forest, ended }
    }

    /// The model has moved.
    pub fn forget(&mut self) {
        self.ended.known = false;
    }
}

impl Rbx {
    /// Ends a piece of a step that began with the state `start` (of `Contacts::start`).
    /// Returns what even standing still does not pay for: bodies that were lifted out of each other, J.
    pub(super) fn pay(&mut self, m: &Model, start: &State, gravity: [f64; 3], report: &mut StepReport) -> f64 {
        let acts = || self.axes.contacts().is_some_and(|c| c.acting_bodies().next().is_some());
        let stopped = || (0..m.axes.len()).any(|axis| self.axes.is_stopped(axis));
        let Some(mut paid) = self.paid.take_if(|_| acts() || stopped()) else { return 0.0 };
        self.join_touched(&mut paid);
        if let Some(contacts) = self.axes.contacts_mut() {
            contacts.arrive(m, &self.state.q, &self.state.v);
        }
        self.balance(m, &mut paid, start, gravity);
        for body in 1..m.bodies.len() {
            let tree = paid.islands.of(paid.forest.of_body[body]);
            let (b, share) = (&m.bodies[body], paid.accounts[tree].share);
            if share < 1.0 {
                self.state.v[b.v..b.v + b.joint.nv()].iter_mut().for_each(|v| *v *= share);
            }
        }
        let mut owed = 0.0;
        for account in paid.accounts.iter().filter(|a| a.share < 1.0) {
            report.trimmed_energy += (1.0 - account.share * account.share) * account.after.kinetic;
            owed += (-account.held()).max(0.0);
        }
        self.paid = Some(paid);
        owed
    }

    /// Potential energy of a state, J.
    pub(super) fn potential(&mut self, m: &Model, gravity: [f64; 3]) -> f64 {
        let Some(paid) = &mut self.paid else { return 0.0 };
        kinematics(m, &mut paid.kinematics, &self.state.q, &self.state.v);
        energy(m, &paid.kinematics, gravity).potential
    }

    /// Books the potential energy that keeping bodies out of each other makes, moving them with `self.lift` for h seconds, as
    /// given by contacts; to the first order of that way. `q` (nq) is where they are, if not at the state's.
    pub(super) fn book_lift(&mut self, m: &Model, q: Option<&[f64]>, (h, gravity): (f64, [f64; 3])) {
        let Some(paid) = &mut self.paid else { return };
        let k = &mut paid.kinematics;
        kinematics(m, k, q.unwrap_or(&self.state.q), &self.lift);
        let g = V3::from(gravity);
        let raised: f64 = (1..m.bodies.len()).map(|body| -h * g.dot(body_momentum(m, k, body))).sum();
        self.axes.books.work.contacts -= raised;
    }

    /// Joins the trees that contacts hold together.
    fn join_touched(&self, paid: &mut Paid) {
        paid.accounts.fill(Account { share: 1.0, ..Account::default() });
        paid.islands.part();
        for (axis, tree) in paid.forest.of_axis.iter().enumerate() {
            if self.axes.is_stopped(axis)
                && let Some(account) = paid.accounts.get_mut(*tree)
            {
                account.touched = true;
            }
        }
        for bodies in self.axes.contacts().into_iter().flat_map(|c| c.acting_bodies()) {
            let [a, b] = bodies.map(|body| paid.forest.of_body[body]);
            paid.islands.join(a, b);
            for tree in [a, b] {
                if let Some(account) = paid.accounts.get_mut(tree) {
                    account.touched = true;
                }
            }
        }
    }

    /// Adds up the accounts of each island in its first tree, and finds its share.
    fn balance(&self, m: &Model, paid: &mut Paid, start: &State, gravity: [f64; 3]) {
        let Paid { forest, islands, accounts, ended, .. } = paid;
        let Some(contacts) = self.axes.contacts() else { return };
        let add = |to: &mut Energy, e: Energy| {
            (to.kinetic, to.potential) = (to.kinetic + e.kinetic, to.potential + e.potential)
        };
        let known = ended.is(start, gravity);
        for body in 1..m.bodies.len() {
            let account = &mut accounts[islands.of(forest.of_body[body])];
            let energy = &mut ended.energies[body];
            add(&mut account.before, if known { *energy } else { body_energy(m, contacts.start(), gravity, body) });
            *energy = body_energy(m, contacts.end(), gravity, body);
            add(&mut account.after, *energy);
        }
        ended.state.copy_from(&self.state);
        (ended.gravity, ended.known) = (gravity, true);
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
    /// Kinetic energy that is paid for, without the work at the end of the step.
    fn held(&self) -> f64 {
        self.before.kinetic + self.before.potential - self.after.potential + self.paid.0
    }

    /// The share s ≤ 1 of the velocities with `s² T = E₀ − V + paid₀ + s paid₁`, or 1 if that is less than what there is.
    fn affordable(&self) -> f64 {
        let (held, kinetic, by_end) = (self.held(), self.after.kinetic, self.paid.1);
        if kinetic <= held + by_end || kinetic <= 0.0 {
            return 1.0;
        }
        let share = share_of(kinetic, held, by_end);
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 1.0 }
    }
}

/// The share s ≥ 0 of the speeds with `s² T = held + s by_end`: of a motion with kinetic energy T > 0, that is paid for with `held` and, at
/// the end of the step, as much as the speeds there have a share in.
pub(super) fn share_of(kinetic: f64, held: f64, by_end: f64) -> f64 {
    (by_end + (by_end * by_end + 4.0 * kinetic * held.max(0.0)).sqrt()) / (2.0 * kinetic)
}
