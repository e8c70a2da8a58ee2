//! `<mimic>` → couplings: every follower follows the first joint of its chain.

use super::{AxisSlot, Coupling, Model};
use crate::description::{Description, Joint, JointKind};

/// The couplings of the axes of `m`, in the order of the axes. A follower of a follower follows the first leader; one
/// whose leader cannot move is held where the leader's 0 puts it. What leads nowhere is left out: the checks of the
/// description have told it.
pub(super) fn couplings(d: &Description, m: &Model) -> Vec<Coupling> {
    let followers = m.axes.iter().enumerate().filter(|(_, axis)| !matches!(axis.slot, AxisSlot::Apart { .. }));
    followers.filter_map(|(follower, axis)| coupling(d, m, follower, &axis.name)).collect()
}

fn coupling(d: &Description, m: &Model, follower: usize, name: &str) -> Option<Coupling> {
    let joint = |name: &str| d.joints.iter().find(|j| j.name == name);
    let mut at: &Joint = joint(name)?;
    let (mut ratio, mut offset) = (1.0, 0.0);
    for _ in 0..d.joints.len() {
        let Some(mimic) = &at.mimic else { break };
        offset += ratio * mimic.offset;
        ratio *= mimic.multiplier;
        at = joint(&mimic.joint)?;
    }
    if at.name == name || at.mimic.is_some() {
        return None;
    }
    match m.axis(&at.name) {
        Some(leader) => Some(Coupling { follower, leader, ratio, offset }),
        None if at.kind == JointKind::Fixed => Some(Coupling { follower, leader: follower, ratio: 0.0, offset }),
        None => None,
    }
}

impl Coupling {
    /// Where the follower belongs, given the position of the leader (rad or m).
    pub fn position(&self, leader: f64) -> f64 {
        self.ratio * leader + self.offset
    }

    /// Where the leader belongs, given the position of the follower; `None` if the follower does not depend on it.
    pub fn leader_position(&self, follower: f64) -> Option<f64> {
        (self.ratio != 0.0).then(|| (follower - self.offset) / self.ratio)
    }
}

impl Model {
    /// The couplings in force: none if the effect is off.
    pub fn couplings_in_force(&self) -> &[Coupling] {
        if self.effects.mimic { &self.couplings } else { &[] }
    }

    /// The range of a leader in which it and its followers stay inside their stops (rad or m). Lower is above upper if there
    /// is none.
    pub fn common_range(&self, leader: usize) -> (f64, f64) {
        let own = &self.axes[leader];
        let (mut lower, mut upper) = (own.lower, own.upper);
        for c in self.couplings_in_force().iter().filter(|c| c.leader == leader) {
            let follower = &self.axes[c.follower];
            if let (Some(a), Some(b)) = (c.leader_position(follower.lower), c.leader_position(follower.upper)) {
                (lower, upper) = (lower.max(a.min(b)), upper.min(a.max(b)));
            }
        }
        (lower, upper)
    }
}
