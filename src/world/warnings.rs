//! Warnings with their history (W-16). A step that has nothing to warn of allocates nothing.

use super::{Stats, World};
use crate::model::AxisSlot;
use std::borrow::Cow;
use std::collections::VecDeque;

/// Warnings that are kept; older ones are counted.
const KEPT: usize = 256;
/// Warnings for which there is room from the start.
const ROOM: usize = 16;
/// An axis that cannot move and is nearer to 0 than this stands at 0, rad or m.
const AT_ZERO: f64 = 1e-9;

/// What a warning is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WarningKind {
    /// An axis that cannot move is not at 0 (a frozen transform).
    FrozenTransform,
    /// A separate rig has no position reference (table 6-21).
    Reference,
    /// A joint came apart.
    JointApart,
    /// A link was taken out, and its joint with it.
    JointConfigurationFault,
    /// A step would not have been finite: the world stands still.
    Diverged,
    /// Limbs too fast for any step were slowed down.
    SlowedDown,
    /// Bodies moved so far in a step that they may have passed through each other.
    TooFast,
}

impl WarningKind {
    /// Its name in services and diagnostics.
    pub fn name(self) -> &'static str {
        match self {
            Self::FrozenTransform => "frozen-transform",
            Self::Reference => "reference",
            Self::JointApart => "joint-came-apart",
            Self::JointConfigurationFault => "joint-configuration-fault",
            Self::Diverged => "diverged",
            Self::SlowedDown => "slowed-down",
            Self::TooFast => "too-fast",
        }
    }
}

/// A warning.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// Simulated time, ns.
    pub stamp_ns: i64,
    /// Name of the link, joint or axis; empty: the world.
    pub element: String,
    /// What it is about.
    pub kind: WarningKind,
    /// For people.
    pub text: Cow<'static, str>,
}

/// The warnings of a world, the oldest first.
#[derive(Clone, Debug)]
pub struct Warnings {
    kept: VecDeque<Warning>,
    /// Older ones that are not kept.
    pub omitted: u64,
    /// Counters up to which there are warnings.
    seen: Stats,
    broken: usize,
    faulty: bool,
}

impl Default for Warnings {
    /// With room for the first ones, so that a step that warns allocates nothing.
    fn default() -> Self {
        Self { kept: VecDeque::with_capacity(ROOM), omitted: 0, seen: Stats::default(), broken: 0, faulty: false }
    }
}

impl Warnings {
    /// The oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &Warning> {
        self.kept.iter()
    }

    /// All that there have ever been.
    pub fn count(&self) -> u64 {
        self.omitted + self.kept.len() as u64
    }

    fn push(&mut self, warning: Warning) {
        // The setup is looked at again after changes.
        let same = |w: &Warning| w.element == warning.element && w.kind == warning.kind && w.text == warning.text;
        let of_setup = matches!(warning.kind, WarningKind::FrozenTransform | WarningKind::Reference);
        if of_setup && self.kept.iter().any(same) {
            return;
        }
        if self.kept.len() == KEPT {
            self.kept.pop_front();
            self.omitted += 1;
        }
        self.kept.push_back(warning);
    }
}

impl World {
    /// Warnings since the world was made; a reset does not clear them.
    pub fn warnings(&self) -> &Warnings {
        &self.warnings
    }

    /// Looks at how the world is set up.
    pub(super) fn warn_of_setup(&mut self) {
        for axis in 0..self.model.axes.len() {
            let (a, position) = (&self.model.axes[axis], self.state().axis(&self.model, axis).0);
            let frozen = a.lower >= a.upper && !matches!(a.slot, AxisSlot::Apart { .. });
            if frozen && position.abs() > AT_ZERO {
                let text = format!("the axis cannot move and stands at {position}, not at 0");
                self.warn(a.name.clone(), WarningKind::FrozenTransform, text.into());
            }
        }
        for i in 0..self.model.rigs.len() {
            let rig = &self.model.rigs[i];
            if rig.reference.is_none() {
                let text = "the separate rig has no position reference: it stands at the origin of its group";
                self.warn(rig.name.clone(), WarningKind::Reference, text.into());
            }
        }
    }

    /// Looks at what has happened since the last call. Allocates only if there is something to warn of.
    pub(super) fn warn_of_events(&mut self) {
        let (now, seen) = (self.stats, self.warnings.seen);
        let began = |now: u64, seen: u64| now > 0 && seen == 0;
        if began(now.diverged_steps, seen.diverged_steps) {
            let text =
                "a step would have given values that are not finite: the world stands still at the state before it";
            self.warn(String::new(), WarningKind::Diverged, text.into());
        }
        if began(now.guarded_pieces, seen.guarded_pieces) {
            let text = "limbs too fast for any step were slowed down to the energy that was paid for (guarded_pieces)";
            self.warn(String::new(), WarningKind::SlowedDown, text.into());
        }
        if began(now.fast_pieces, seen.fast_pieces) {
            let text = "bodies moved further in 1/64 of a step than they are thick: they may have passed (fast_pieces)";
            self.warn(String::new(), WarningKind::TooFast, text.into());
        }
        self.warnings.seen = now;
        for i in self.warnings.broken.min(self.broken().len())..self.broken().len() {
            let broken = &self.broken()[i];
            let (joint, text) = (broken.joint.to_string(), broken.to_string());
            self.warn(joint, WarningKind::JointApart, text.into());
        }
        self.warnings.broken = self.broken().len();
        if self.history.faulty && !self.warnings.faulty {
            let text = "a link was taken out, and its joint with it: nothing moves until the world is rebuilt or reset";
            self.warn(String::new(), WarningKind::JointConfigurationFault, text.into());
        }
        self.warnings.faulty = self.history.faulty;
    }

    fn warn(&mut self, element: String, kind: WarningKind, text: Cow<'static, str>) {
        self.warnings.push(Warning { stamp_ns: self.stamp_ns, element, kind, text });
    }
}
