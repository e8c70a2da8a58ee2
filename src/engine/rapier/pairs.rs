//! The row that H and B of a 3DOF group make together near its pole ([`crate::engine::pairs`]).

use super::joints::{insert, seat, watch};
use super::parts::Parts;
use super::sim::Sim;
use crate::dynamics::Kinematics;
use crate::engine::State;
use crate::engine::actuation::Actuation;
use crate::engine::pairs;
use crate::math::M3;
use crate::model::Model;
use rapier3d_f64::math::Pose;
use rapier3d_f64::prelude::{ImpulseJointHandle, JointAxesMask, JointAxis};

/// The turn about x of a group whose H and B have stops.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    of: pairs::Pair,
    /// Bodies of the model.
    parent: usize,
    child: usize,
    joint: ImpulseJointHandle,
}

impl Pair {
    /// `None` if H or B has no hard stops.
    pub fn new(m: &Model, sim: &mut Sim, parts: &Parts, (q, group): (&[f64], usize)) -> Option<Self> {
        let of = pairs::Pair::of(m, group)?;
        let child = m.eulers[group].body;
        let (parent, at) = seat(m, q, child, false);
        let joint = insert(sim, parts, (child, Pose::IDENTITY), (parent, at), JointAxesMask::empty())?;
        Some(Self { of, parent, child, joint })
    }

    /// For a step from this state.
    pub fn set(&self, sim: &mut Sim, laws: &Actuation, k: &Kinematics, state: &State) {
        let Some(joint) = sim.joints.get_mut(self.joint, false) else { return };
        match self.of.range(laws, state) {
            Some(range) => {
                let relative = k.r[self.parent].tmm(&k.r[self.child]);
                watch(&mut joint.data, &relative, &M3::identity(), range);
            }
            None => joint.data.limit_axes = JointAxesMask::empty(),
        }
    }

    /// Adds what it gave in the last substep, which lasted `h` seconds and began with `state`, to H and B, N·m.
    pub fn read(&self, sim: &Sim, h: f64, state: &State, stops: &mut [f64]) {
        let Some(joint) = sim.joints.get(self.joint).filter(|j| !j.data.limit_axes.is_empty()) else { return };
        let [yaw, roll] = self.of.torques(state, joint.data.limits[JointAxis::AngX as usize].impulse / h);
        stops[self.of.yaw] += yaw;
        stops[self.of.roll] += roll;
    }
}
