//! A body between two steps, in double precision.

use super::plan::Seat;
use super::spec::Moving;
use crate::engine::principal::Motion;
use crate::math::{Pose, Quat, Vec3};
use nalgebra::{Quaternion, Translation3};

/// Where a body of PhysX is and how it moves, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Centre of mass and principal axes.
    pub pose: Pose,
    /// rad/s.
    pub w: Vec3,
    /// Of the centre of mass, m/s.
    pub v: Vec3,
}

impl Flight {
    /// From single precision; the quaternion becomes a unit one.
    pub fn new(moving: &Moving) -> Self {
        let [px, py, pz, x, y, z, w] = moving.pose.map(f64::from);
        let turned = Quat::new_normalize(Quaternion::new(w, x, y, z));
        Self {
            pose: Pose::from_parts(Translation3::new(px, py, pz), turned),
            w: Vec3::from(moving.angular.map(f64::from)),
            v: Vec3::from(moving.linear.map(f64::from)),
        }
    }

    /// To single precision.
    pub fn single(v: Vec3) -> [f32; 3] {
        [v.x as f32, v.y as f32, v.z as f32]
    }

    /// As the model's body is to be told.
    pub fn motion(&self) -> Motion {
        Motion { pose: self.pose, angular: self.w, linear: self.v }
    }

    /// Kinetic energy of turning, J.
    pub fn turning(&self, seat: &Seat) -> f64 {
        let own = self.pose.rotation.inverse() * self.w;
        0.5 * own.component_mul(&own).dot(&seat.own.moments)
    }

    /// Answer of a body to a torque about a unit vector of the world, 1/(kg·m²).
    pub fn mobility(&self, seat: &Seat, about: &Vec3) -> f64 {
        let own = self.pose.rotation.inverse() * about;
        own.component_mul(&own).component_div(&seat.own.moments).sum()
    }

    /// Turned by an angular impulse of the world, N·m·s.
    pub fn spin(&mut self, seat: &Seat, impulse: &Vec3) {
        let own = self.pose.rotation.inverse() * impulse;
        self.w += self.pose.rotation * own.component_div(&seat.own.moments);
    }
}
