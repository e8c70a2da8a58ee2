//! H and B of a 3DOF group near its pole, for engines that solve one row after the other.
//!
//! Their gradients are nearly one line there. When both are at their stops, what turns the child about its own x can be held only by
//! both stops against each other, with impulses that are 1/cos P times as large; rows that are solved one after the other need
//! some 1/cos² P sweeps to find them. Since ω_x is B's rate less sin P times H's, both ranges together make a third one, of
//! the turn about x. It follows from the two and so changes nothing, but holds at once.

use super::State;
use super::actuation::Actuation;
use crate::math::sin_cos;
use crate::model::{AxisSlot, Model};

/// |cos P| below which sweeps do not tell H and B apart: each takes |cos P|² of what is left.
const NEAR: f64 = 0.5;
/// |cos P| below which gradients must be fresh: at 7 rad/s they turn by 3 % in 1 ms at 0.2, and by 1/cos P more.
#[cfg(feature = "bullet")]
const STEEP: f64 = 0.2;

/// A group whose H and B have hard stops.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    /// Index into `Model::eulers`.
    pub group: usize,
    /// Axes of the model: H and B.
    pub yaw: usize,
    /// B.
    pub roll: usize,
    sense: f64,
}

impl Pair {
    /// `None` if H or B has no hard stops.
    pub fn of(m: &Model, group: usize) -> Option<Self> {
        let of = |angle| {
            let axis = m.axes.iter().position(|a| a.slot == AxisSlot::Euler { group, angle })?;
            m.axes[axis].has_hard_stops().then_some(axis)
        };
        Some(Self { group, yaw: of(0)?, roll: of(2)?, sense: m.eulers[group].sense })
    }

    /// How far the child may turn about its x in the step that was prepared, downwards (≤ 0 inside) and upwards, rad; `None`: as far as it
    /// likes, or as the rows of H and B say well enough.
    pub fn range(&self, laws: &Actuation, state: &State) -> Option<[f64; 2]> {
        let (yaw, roll) = (laws.stop(self.yaw)?, laws.stop(self.roll)?);
        if sin_cos(state.angles[self.group][1]).1.abs() > NEAR {
            return None;
        }
        let of_yaw = yaw.map(|way| self.share(state) * way);
        let (from, to) = (roll[0] - of_yaw[0].max(of_yaw[1]), roll[1] - of_yaw[0].min(of_yaw[1]));
        Some(if self.sense < 0.0 { [-to, -from] } else { [from, to] })
    }

    /// What a torque about the child's x is on H and on B.
    pub fn torques(&self, state: &State, about_x: f64) -> [f64; 2] {
        let on_roll = self.sense * about_x;
        [-self.share(state) * on_roll, on_roll]
    }

    /// What of H's rate is in that of B: `B = sense·ω_x + share·H`.
    fn share(&self, state: &State) -> f64 {
        self.sense * sin_cos(state.angles[self.group][1]).0
    }
}

/// Is a group so near to its pole that its gradients do not last for a step?
#[cfg(feature = "bullet")]
pub(super) fn is_steep(state: &State) -> bool {
    state.angles.iter().any(|hpb| sin_cos(hpb[1]).1.abs() < STEEP)
}
