//! Counters of command messages, shared by the listening and the publishing thread.

use super::commands::RefusalKind;
use super::watchdog::Lapses;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// The command topics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandTopic {
    /// `effort_command`.
    Effort,
    /// `servo_command`.
    Servo,
    /// `joint_command`.
    Joint,
    /// `robot_joint_commands`.
    Control,
}

impl CommandTopic {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Effort, Self::Servo, Self::Joint, Self::Control];

    /// Name before remapping.
    pub fn name(self) -> &'static str {
        match self {
            Self::Effort => "effort_command",
            Self::Servo => "servo_command",
            Self::Joint => "joint_command",
            Self::Control => "robot_joint_commands",
        }
    }
}

/// Messages since the start.
#[derive(Debug, Default)]
pub struct CommandCounts {
    accepted: [AtomicU64; CommandTopic::ALL.len()],
    refused: [[AtomicU64; RefusalKind::ALL.len()]; CommandTopic::ALL.len()],
    /// What happened because no command came.
    pub lapses: Lapses,
}

impl CommandCounts {
    /// Counts an accepted message.
    pub fn accept(&self, topic: CommandTopic) {
        self.accepted[topic as usize].fetch_add(1, Relaxed);
    }

    /// Counts a refused message; true if it is the first of its kind on this topic.
    pub fn refuse(&self, topic: CommandTopic, kind: RefusalKind) -> bool {
        self.refused[topic as usize][kind as usize].fetch_add(1, Relaxed) == 0
    }

    /// Accepted messages on `topic`.
    pub fn accepted(&self, topic: CommandTopic) -> u64 {
        self.accepted[topic as usize].load(Relaxed)
    }

    /// Refused messages of `kind` on `topic`.
    pub fn refused(&self, topic: CommandTopic, kind: RefusalKind) -> u64 {
        self.refused[topic as usize][kind as usize].load(Relaxed)
    }

    /// All refused messages.
    pub fn all_refused(&self) -> u64 {
        self.refused.iter().flatten().map(|n| n.load(Relaxed)).sum()
    }
}
