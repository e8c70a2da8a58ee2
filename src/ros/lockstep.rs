//! Lock-step: the world stands until a command comes that is stamped for its present state.

use super::commands::{Refusal, RefusalKind};
use std::sync::atomic::{AtomicI64, Ordering};

/// No command is awaited: the world moves, or is not in lock-step.
const CLOSED: i64 = i64::MIN;
/// A command with the right stamp is being looked at.
const RESERVED: i64 = i64::MIN + 1;
/// One has been accepted: on with the next interval.
const GO: i64 = i64::MIN + 2;

/// Between the control thread, which opens it, and the listening thread, which lets commands through. One command passes per opening.
#[derive(Debug)]
pub struct Gate {
    /// The stamp that is awaited, ns, or one of the constants.
    awaited: AtomicI64,
    /// Stamp of the latest state, ns.
    shown: AtomicI64,
}

/// Why a stamp is not the one that is awaited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Untimely {
    /// It is that of a state which is gone, or from which the world goes on already.
    Late,
    /// There is no such state yet.
    Early,
}

impl Untimely {
    /// Why a command with `stamp` is refused, when the latest state has the stamp `shown`; both in ns.
    pub fn refusal(self, stamp: i64, shown: i64) -> Refusal {
        let (kind, what) = match self {
            Self::Late => (RefusalKind::LateStamp, "the world goes on from there already, or waits for nobody"),
            Self::Early => (RefusalKind::EarlyStamp, "there is no such state yet"),
        };
        let [stamp, shown] = [stamp, shown].map(|ns| ns as f64 * 1e-9);
        let reason = format!(
            "header.stamp is {stamp:.9} s, the latest state has {shown:.9} s: {what}; give the stamp of the latest state, \
             or 0 for a command that leads nobody on"
        );
        Refusal { kind, reason }
    }
}

impl Default for Gate {
    fn default() -> Self {
        Self { awaited: AtomicI64::new(CLOSED), shown: AtomicI64::new(0) }
    }
}

impl Gate {
    /// Control: the world stands at `stamp`, ns, and waits.
    pub fn open(&self, stamp: i64) {
        self.shown.store(stamp, Ordering::Release);
        self.awaited.store(stamp, Ordering::Release);
    }

    /// Control: the world is at `stamp`, ns, and does not wait.
    pub fn close(&self, stamp: i64) {
        self.awaited.store(CLOSED, Ordering::Release);
        self.shown.store(stamp, Ordering::Release);
    }

    /// Control: has a command passed? Then the gate is closed now.
    pub fn take(&self) -> bool {
        self.swap(GO, CLOSED)
    }

    /// Control: waits no longer at `stamp`; false if a command has just come.
    pub fn expire(&self, stamp: i64) -> bool {
        self.swap(stamp, CLOSED)
    }

    /// Listening: takes the one place that there is for a command with this stamp, ns; [`Self::go`] or [`Self::give_back`] follows.
    ///
    /// # Errors
    /// It is not the stamp that is awaited.
    pub fn reserve(&self, stamp: i64) -> Result<(), Untimely> {
        if self.swap(stamp, RESERVED) {
            return Ok(());
        }
        Err(if stamp > self.shown() { Untimely::Early } else { Untimely::Late })
    }

    /// Listening: the command is in force.
    pub fn go(&self) {
        self.swap(RESERVED, GO);
    }

    /// Listening: the command was refused for another reason.
    pub fn give_back(&self, stamp: i64) {
        self.swap(RESERVED, stamp);
    }

    /// Stamp of the latest state, ns.
    pub fn shown(&self) -> i64 {
        self.shown.load(Ordering::Acquire)
    }

    fn swap(&self, from: i64, to: i64) -> bool {
        self.awaited.compare_exchange(from, to, Ordering::AcqRel, Ordering::Acquire).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_command_passes_per_opening() {
        let gate = Gate::default();
        assert_eq!(gate.reserve(0), Err(Untimely::Late), "closed");
        gate.open(5);
        assert_eq!(gate.reserve(4), Err(Untimely::Late));
        assert_eq!(gate.reserve(6), Err(Untimely::Early));
        assert!(!gate.take());
        gate.reserve(5).unwrap();
        assert!(!gate.expire(5), "a command is being looked at");
        assert!(!gate.take());
        gate.go();
        assert_eq!(gate.reserve(5), Err(Untimely::Late), "the place is taken");
        assert!(gate.take() && !gate.take());
        gate.open(6);
        gate.reserve(6).unwrap();
    }

    #[test]
    fn a_refused_command_leaves_the_place_to_another_one() {
        let gate = Gate::default();
        gate.open(5);
        gate.reserve(5).unwrap();
        gate.give_back(5);
        gate.reserve(5).unwrap();
        gate.open(0);
        gate.go();
        assert!(!gate.take(), "a reset in between: the place is gone");
        assert!(gate.expire(0));
        assert_eq!(gate.reserve(0), Err(Untimely::Late));
    }
}
