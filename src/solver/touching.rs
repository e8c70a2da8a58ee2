//! What the contacts of a step say.

use super::axis_set::{AxisSet, StateRef};
use super::contacts::Contacts;
use crate::model::Model;

impl AxisSet {
    /// Do contacts make the step from its start, or to this state, anything but smooth?
    pub fn collides(&mut self, m: &Model, end: Option<StateRef>) -> bool {
        let Some(contacts) = self.contacts_mut() else { return false };
        match end {
            None => contacts.touching(),
            Some(s) => contacts.overlap(m, s.q, s.v),
        }
    }

    /// The same, to be changed.
    pub fn contacts_mut(&mut self) -> Option<&mut Contacts> {
        self.couplings.as_mut().and_then(|c| c.contacts.as_mut())
    }

    /// Tells the contacts which bodies rest.
    pub fn rest(&mut self, rests: impl Fn(usize) -> bool) {
        if let Some(contacts) = self.contacts_mut() {
            contacts.rest(rests);
        }
    }

    /// Did a contact carry something in the last pass?
    pub fn touches(&self) -> bool {
        self.contacts().is_some_and(Contacts::carries)
    }

    /// What the contacts' rows were left with in the last pass, m/s.
    pub fn residual(&self) -> f64 {
        self.contacts().map_or(0.0, |c| if c.is_empty() { 0.0 } else { c.residual })
    }

    /// Passes so far whose bounces were made smaller.
    pub fn tempered(&self) -> u64 {
        self.contacts().map_or(0, |c| c.tempered)
    }

    /// All contacts, if anything can touch.
    pub fn contacts(&self) -> Option<&Contacts> {
        self.couplings.as_ref().and_then(|c| c.contacts())
    }

    /// May bodies that are near pass through each other within the step that was prepared?
    pub fn is_fast(&self) -> bool {
        self.contacts().is_some_and(|c| c.fastest() > 1.0)
    }
}
