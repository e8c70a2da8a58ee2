//! A body between two steps, in double precision.

use super::plan::Seat;
use super::spec::Moving;
use crate::dynamics::Kinematics;
use crate::math::{M3, Pose, Quat, V3, Vec3};
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

    /// Writes where the model's body is.
    pub fn write(&self, seat: &Seat, k: &mut Kinematics) {
        let (x_wb, i) = (self.pose * seat.frame.inverse(), seat.body);
        let origin = self.v - self.w.cross(&(x_wb.rotation * seat.frame.translation.vector));
        let back = x_wb.rotation.inverse();
        k.r[i] = M3::from(*x_wb.rotation.to_rotation_matrix().matrix());
        k.p[i] = V3::from(x_wb.translation.vector);
        (k.w[i], k.v[i]) = (V3::from(back * self.w), V3::from(back * origin));
    }

    /// Kinetic energy of turning, J.
    pub fn turning(&self, seat: &Seat) -> f64 {
        let own = self.pose.rotation.inverse() * self.w;
        0.5 * own.component_mul(&own).dot(&seat.moments)
    }

    /// Answer of a body to a torque about a unit vector of the world, 1/(kg·m²).
    pub fn mobility(&self, seat: &Seat, about: &Vec3) -> f64 {
        let own = self.pose.rotation.inverse() * about;
        own.component_mul(&own).component_div(&seat.moments).sum()
    }

    /// Turned by an angular impulse of the world, N·m·s.
    pub fn spin(&mut self, seat: &Seat, impulse: &Vec3) {
        let own = self.pose.rotation.inverse() * impulse;
        self.w += self.pose.rotation * own.component_div(&seat.moments);
    }
}
