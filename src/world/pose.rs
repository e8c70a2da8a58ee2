//! Setting the angle of a joint (J-12): either side of it may be the one that moves.

use super::World;
use crate::dynamics::{link_pose, normalize};
use crate::math::{Mat3, Pose, Quat, Vec3};
use crate::model::{AxisSlot, JointType};
use nalgebra::{Rotation3, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Which side of a joint moves when its angle is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// What hangs on the joint.
    Tip,
    /// The chain behind it, up to its base; everything from the joint outwards stays where it is.
    Root,
}

impl World {
    /// Sets the position of an axis (rad or m). Its speed stays, and so do all other positions and speeds but those of axes that
    /// are coupled to it (`<mimic>`). From the root
    /// side the base of the chain moves: a free base in the state, a fixed one in the model; [`World::reset`] takes both back.
    /// May allocate: not for the control loop.
    ///
    /// # Errors
    /// Says which axis cannot stand there, and its range; nothing changes then.
    pub fn set_joint_angle(&mut self, axis: usize, position: f64, side: Side) -> Result<(), String> {
        self.check_position(axis, position)?;
        let link = self.model.carried(axis).filter(|_| side == Side::Root);
        if side == Side::Root && link.is_none() {
            return Err(format!("axis '{}' carries no link that could stay where it is", self.model.axes[axis].name));
        }
        let before = link.map(|link| self.link_pose(link));
        let speed = self.engine.state().axis(&self.model, axis).1;
        let mut state = self.engine.state().clone();
        state.set_axis(&self.model, axis, position, speed);
        state.couple_given(&self.model, &[axis])?;
        self.engine.place(&self.model, &state);
        self.update();
        if let (Some(link), Some(before)) = (link, before) {
            let back = before * self.link_pose(link).inverse();
            self.move_base_behind(axis, &back);
            self.update();
        }
        Ok(())
    }

    fn check_position(&self, axis: usize, position: f64) -> Result<(), String> {
        let Some(a) = self.model.axes.get(axis) else {
            return Err(format!("there is no axis {axis}; there are {}", self.model.axes.len()));
        };
        if matches!(a.slot, AxisSlot::Apart { .. }) {
            return Err(format!("axis '{}' cannot be set: its joint has come apart", a.name));
        }
        if !(position.is_finite() && position >= a.lower && position <= a.upper) {
            return Err(format!(
                "axis '{}' cannot stand at {position}: its range is {} to {}",
                a.name, a.lower, a.upper
            ));
        }
        Ok(())
    }

    pub(super) fn link_pose(&self, link: usize) -> Pose {
        let state = self.engine.state();
        link_pose(&self.model, &self.kinematics, &state.q, &state.angles, link)
    }

    /// Moves the base of the chain behind an axis by a rigid motion in the world: the floating joint nearest to the axis, or
    /// the fixed base.
    fn move_base_behind(&mut self, axis: usize, motion: &Pose) {
        match self.floating_behind(axis) {
            Some(body) => self.move_floating(body, motion),
            None => {
                self.unmoved.get_or_insert_with(|| self.model.clone());
                Arc::make_mut(&mut self.model).move_fixed_base(axis, motion);
                self.engine.moved(&self.model);
            }
        }
    }

    fn floating_behind(&self, axis: usize) -> Option<usize> {
        let m = &self.model;
        let parent = |i: &usize| Some(m.bodies[*i].parent).filter(|p| *p > 0);
        std::iter::successors(m.carrier(axis), parent).find(|i| m.bodies[*i].joint == JointType::Floating)
    }

    pub(super) fn move_floating(&mut self, body: usize, motion: &Pose) {
        let b = &self.model.bodies[body];
        let (x_wp, x_wb) = (self.body_pose(b.parent), self.body_pose(body));
        let x_pj = pose(&Mat3::from(b.tree_r), b.tree_p.into());
        let x_jb = (x_wp * x_pj).inverse() * motion * x_wb;
        let (p, r) = (x_jb.translation, x_jb.rotation);
        let mut state = self.engine.state().clone();
        let q = &mut state.q[b.q..b.q + 7];
        q.copy_from_slice(&[p.x, p.y, p.z, r.w, r.i, r.j, r.k]);
        normalize(&mut q[3..]);
        self.engine.place(&self.model, &state);
    }

    pub(super) fn body_pose(&self, body: usize) -> Pose {
        pose(&Mat3::from(self.kinematics.r[body]), self.kinematics.p[body].into())
    }
}

fn pose(r: &Mat3, p: Vec3) -> Pose {
    let q: Quat = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*r));
    Pose::from_parts(Translation3::from(p), q)
}
