//! Soft and breaking joints (J-18): massless bodies in front of a joint, one for each direction in which it yields.

use super::{Builder, Seat};
use crate::description::Constraint;
use crate::math::{Pose, Quat};
use crate::model::{Breakable, JointType, SoftDof, Softness};
use nalgebra::{Quaternion, Translation3};

/// Softer than this is soft, (m/s)/N or (rad/s)/(N·m). Below it a joint gives way by less than rounding under any force that
/// leaves the state finite, and the reciprocals of the law would overflow.
const HARD: f64 = 1e-30;

/// A direction of the joint frame: a shift along, or a turn about, axis 0 = x, 1 = y, 2 = z.
type Direction = (JointType, usize);

const SHIFT_X: Direction = (JointType::Prismatic, 0);
const SHIFT_Y: Direction = (JointType::Prismatic, 1);
const SHIFT_Z: Direction = (JointType::Prismatic, 2);
const TURN_X: Direction = (JointType::Revolute, 0);
const TURN_Y: Direction = (JointType::Revolute, 1);
const TURN_Z: Direction = (JointType::Revolute, 2);

/// What a hinge about z constrains.
pub(super) const HINGE: &[Direction] = &[SHIFT_X, SHIFT_Y, SHIFT_Z, TURN_X, TURN_Y];
/// What a slide along z constrains.
pub(super) const SLIDE: &[Direction] = &[SHIFT_X, SHIFT_Y, TURN_X, TURN_Y, TURN_Z];
/// What a 3DOF joint constrains; of a cardan joint, the part in front of its first axis.
pub(super) const POINT: &[Direction] = &[SHIFT_X, SHIFT_Y, SHIFT_Z];
/// What a cardan joint with its axes along x and z constrains between the two.
pub(super) const BETWEEN: &[Direction] = &[TURN_Y];
/// What a fixed joint constrains.
pub(super) const WELD: &[Direction] = &[SHIFT_X, SHIFT_Y, SHIFT_Z, TURN_X, TURN_Y, TURN_Z];

impl Builder<'_> {
    /// Softness of the joint that these URDF joints make up: each value is that of the first of them that gives it.
    /// `None`: hard.
    pub(super) fn softness(&self, joints: &[usize]) -> Option<Softness> {
        let first = |value: fn(&Constraint) -> Option<f64>| self.constraints(joints).find_map(|(_, c)| value(c));
        let cfm = first(|c| c.cfm).filter(|cfm| *cfm > HARD)?;
        Some(Softness { erp: first(|c| c.erp).unwrap_or(0.0), cfm })
    }

    /// Puts a massless body for each of the directions between a seat and what comes next; returns the seat of that.
    pub(super) fn soften(&mut self, seat: Seat, directions: &[Direction], softness: Option<Softness>) -> Seat {
        let Some(softness) = softness else { return seat };
        directions.iter().fold(seat, |seat, (joint, axis)| self.add_soft(seat, *joint, *axis, softness))
    }

    /// A single coordinate that is held where it is, for a fixed joint that may break.
    pub(super) fn hold(&mut self, seat: Seat) -> Seat {
        self.add_soft(seat, JointType::Prismatic, 2, Softness::HELD)
    }

    fn add_soft(&mut self, (parent, frame): Seat, joint: JointType, axis: usize, softness: Softness) -> Seat {
        let facing = facing(axis);
        let body = self.add_body(parent, joint, frame * facing);
        let (q, v) = (self.model.bodies[body].q, self.model.bodies[body].v);
        self.model.softs.push(SoftDof { q, v, softness });
        (body, Pose::from_parts(Translation3::identity(), facing.inverse()))
    }

    /// Notes the least break threshold of the URDF joints that make up the joint of a body.
    pub(super) fn note_threshold(&mut self, body: usize, joints: &[usize]) {
        let given = self.constraints(joints).filter_map(|(k, c)| Some((k, c.break_threshold?)));
        if let Some((k, threshold)) = given.min_by(|a, b| a.1.total_cmp(&b.1)) {
            self.model.breakables.push(Breakable { body, joint: self.d.joints[k].name.clone(), threshold });
        }
    }

    /// Has one of these URDF joints a break threshold?
    pub(super) fn may_break(&self, joints: &[usize]) -> bool {
        self.constraints(joints).any(|(_, c)| c.break_threshold.is_some())
    }

    fn constraints(&self, joints: &[usize]) -> impl Iterator<Item = (usize, &Constraint)> {
        let d = self.d;
        let joints = joints.to_vec();
        joints.into_iter().filter_map(move |k| Some((k, d.joints[k].constraint.as_ref()?)))
    }
}

/// A rotation that carries z to x, y or z: a cyclic permutation of the axes, without rounding.
pub(super) fn facing(axis: usize) -> Quat {
    let w = match axis {
        0 => 0.5,
        1 => -0.5,
        _ => return Quat::identity(),
    };
    Quat::new_unchecked(Quaternion::new(w, 0.5, 0.5, 0.5))
}

#[cfg(test)]
mod tests {
    use super::facing;
    use crate::math::Vec3;

    #[test]
    fn z_faces_along_the_axis_exactly() {
        for axis in 0..3 {
            let r = facing(axis).to_rotation_matrix();
            assert_eq!(r * Vec3::z(), Vec3::ith(axis, 1.0));
            assert_eq!(r.matrix().determinant(), 1.0);
        }
    }
}
