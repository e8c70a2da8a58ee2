//! What can be asked of a world between two steps, as data: it can be recorded, and done again.

use super::{Mode, Side, World};
use crate::math::{Pose, Quat, Vec3};
use crate::model::{DriveLimits, JointType};
use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// Quaternions whose length is further from 1 are refused: they are a mistake, not rounding.
const UNIT_WITHIN: f64 = 1e-3;

/// Something that is done between two steps. It may allocate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "order", rename_all = "snake_case", deny_unknown_fields)]
pub enum Order {
    /// Back to the start.
    Reset {
        /// Time becomes 0.
        time: bool,
        /// Poses, angles and speeds become those at start, joints whole; commands end, counters become 0.
        state: bool,
        /// W-7: with `state`, the angles of the joints become those at start, too; else they stay, and stand still.
        joints: bool,
    },
    /// Sets the positions of axes (J-12), one after the other, all or none; [`World::set_joint_angle`].
    SetAngles {
        /// Index in `Model::axes`, and position in rad or m.
        positions: Vec<(usize, f64)>,
        /// Which side moves.
        side: Side,
    },
    /// Puts what floats somewhere, with a speed.
    Place {
        /// Index of its root link.
        link: usize,
        /// Link frame in the world: x, y, z (m), qx, qy, qz, qw.
        pose: [f64; 7],
        /// Of the origin of the link frame, along the axes of the world: angular (rad/s), then linear (m/s).
        twist: [f64; 6],
    },
    /// Takes a robot, a body or a link out; [`World::remove`].
    Remove {
        /// Its name.
        name: String,
    },
    /// Builds the world again, at its initial state; [`World::rebuild`].
    Rebuild {
        /// With all that was ever taken out.
        all: bool,
    },
    /// Short-circuits the motors of drives that no torque is applied to, or ends that (J-13 g).
    ShortBrake {
        /// Indices into `Model::axes`.
        axes: Vec<usize>,
        /// On or off.
        on: bool,
    },
    /// Makes where everything is now the initial state (B-13, J-10); [`World::remember`].
    Remember,
}

impl Order {
    /// Its name, as in records.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Reset { .. } => "reset",
            Self::SetAngles { .. } => "set_angles",
            Self::Place { .. } => "place",
            Self::Remove { .. } => "remove",
            Self::Rebuild { .. } => "rebuild",
            Self::ShortBrake { .. } => "short_brake",
            Self::Remember => "remember",
        }
    }
}

impl World {
    /// Does what is ordered.
    ///
    /// # Errors
    /// Says why not; nothing changes then.
    pub fn execute(&mut self, order: &Order) -> Result<(), String> {
        match order {
            Order::Reset { time, state, joints } => {
                let positions = self.state().positions(&self.model);
                if *state {
                    self.reset_state();
                }
                if *state && !*joints {
                    self.put_joints(&positions);
                }
                if *time {
                    self.reset_time();
                }
                Ok(())
            }
            Order::SetAngles { positions, side } => {
                // On a copy first: all or none.
                self.clone().set_angles(positions, *side)?;
                self.set_angles(positions, *side)
            }
            Order::Place { link, pose, twist } => self.place(*link, pose, twist),
            Order::Remove { name } => self.remove(name),
            Order::Rebuild { all } => self.rebuild(*all),
            Order::ShortBrake { axes, on } => axes.iter().try_for_each(|axis| self.set_short_brake(*axis, *on)),
            Order::Remember if self.remember() => Ok(()),
            Order::Remember => {
                Err("a joint has come apart; the initial state is one of the whole robot: reset the state first".into())
            }
        }
    }

    /// Puts all axes where they were, at rest; servos of the start hold them there.
    fn put_joints(&mut self, positions: &[f64]) {
        let mut state = self.engine.state().clone();
        for (i, &position) in positions.iter().enumerate() {
            state.set_axis(&self.model, i, position, 0.0);
        }
        for (command, &position) in self.commands.iter_mut().zip(positions) {
            if command.mode == Mode::Servo {
                command.target = position;
            }
        }
        self.engine.place(&self.model, &state);
        self.update();
    }

    fn set_short_brake(&mut self, axis: usize, on: bool) -> Result<(), String> {
        let none = || format!("there is no axis {axis}; there are {}", self.model.axes.len());
        let drive = *self.drive(axis).ok_or_else(none)?;
        self.set_drive(axis, DriveLimits { short_brake: on, ..drive })
    }

    fn set_angles(&mut self, positions: &[(usize, f64)], side: Side) -> Result<(), String> {
        positions.iter().try_for_each(|(axis, position)| self.set_joint_angle(*axis, *position, side))
    }

    fn place(&mut self, link: usize, pose: &[f64; 7], twist: &[f64; 6]) -> Result<(), String> {
        let Some(info) = self.model.links.get(link) else {
            return Err(format!("there is no link {link}; there are {}", self.model.links.len()));
        };
        let body = info.frame.body();
        if self.model.bodies[body].joint != JointType::Floating {
            return Err(format!("link '{}' does not float: it cannot be put somewhere else", info.name));
        }
        let x_wl = checked_pose(pose)?;
        if twist.iter().any(|x| !x.is_finite()) {
            return Err(format!("the twist {twist:?} is not finite"));
        }
        let motion = x_wl * self.link_pose(link).inverse();
        self.move_floating(body, &motion);
        self.update();
        let x_wb = self.body_pose(body);
        let (w, v) = (Vec3::from_row_slice(&twist[..3]), Vec3::from_row_slice(&twist[3..]));
        let v = v + w.cross(&(x_wb.translation.vector - x_wl.translation.vector));
        let back = x_wb.rotation.inverse();
        let mut state = self.engine.state().clone();
        let at = self.model.bodies[body].v;
        state.v[at..at + 3].copy_from_slice((back * w).as_slice());
        state.v[at + 3..at + 6].copy_from_slice((back * v).as_slice());
        self.engine.place(&self.model, &state);
        self.update();
        Ok(())
    }
}

/// The pose of x, y, z (m), qx, qy, qz, qw.
///
/// # Errors
/// Says which number makes it none.
pub fn checked_pose(p: &[f64; 7]) -> Result<Pose, String> {
    if p.iter().any(|x| !x.is_finite()) {
        return Err(format!("the pose {p:?} is not finite"));
    }
    let q = Quaternion::new(p[6], p[3], p[4], p[5]);
    if (q.norm() - 1.0).abs() > UNIT_WITHIN {
        return Err(format!("the quaternion {:?} has length {}; it must be 1", &p[3..], q.norm()));
    }
    let q: Quat = UnitQuaternion::from_quaternion(q);
    Ok(Pose::from_parts(Translation3::new(p[0], p[1], p[2]), q))
}
