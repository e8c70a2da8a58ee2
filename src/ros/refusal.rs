//! Why commands are refused.

/// Why a message was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RefusalKind {
    /// An array has the wrong length.
    WrongSize,
    /// A value is NaN or infinite.
    NotFinite,
    /// No axis has this name.
    UnknownName,
    /// An axis is named twice.
    DuplicateName,
    /// The axis or the parameter `allow_mode_switch` forbids to switch the drive's mode.
    ModeSwitch,
    /// Applied torque and applied speed contradict each other.
    OppositeSigns,
    /// Names axes, but gives no values.
    Empty,
    /// Lock-step: the stamp is that of a state from which the world has gone on.
    LateStamp,
    /// Lock-step: the stamp is that of no state yet.
    EarlyStamp,
}

impl RefusalKind {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::WrongSize,
        Self::NotFinite,
        Self::UnknownName,
        Self::DuplicateName,
        Self::ModeSwitch,
        Self::OppositeSigns,
        Self::Empty,
        Self::LateStamp,
        Self::EarlyStamp,
    ];

    /// Name in `/diagnostics`.
    pub fn name(self) -> &'static str {
        match self {
            Self::WrongSize => "wrong size",
            Self::NotFinite => "not finite",
            Self::UnknownName => "unknown name",
            Self::DuplicateName => "duplicate name",
            Self::ModeSwitch => "mode switch not allowed",
            Self::OppositeSigns => "torque against speed",
            Self::Empty => "no values",
            Self::LateStamp => "stamp of the past",
            Self::EarlyStamp => "stamp of the future",
        }
    }
}

/// A refused message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// For counting.
    pub kind: RefusalKind,
    /// For people: names the axis, the value and what would be accepted.
    pub reason: String,
}
