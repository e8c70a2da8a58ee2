//! A body about its centre of mass, along its principal axes: as engines have it that know no other frame.

use super::EngineKind;
use super::honour::name_of;
use crate::dynamics::{Kinematics, body_pose};
use crate::math::{M3, Mat3, Pose, V3, Vec3};
use crate::model::Model;
use nalgebra::{Rotation3, SymmetricEigen, Translation3, UnitQuaternion};

/// A body of such an engine.
#[derive(Clone, Debug)]
pub struct Principal {
    /// Index into [`Model::bodies`].
    pub body: usize,
    /// `X_BC`: centre of mass and principal axes in the body's frame.
    pub frame: Pose,
    /// Principal moments, kg·m².
    pub moments: Vec3,
}

/// Where a centre of mass is, along the principal axes, and how it moves in the world.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// `X_WC`.
    pub pose: Pose,
    /// rad/s.
    pub angular: Vec3,
    /// m/s.
    pub linear: Vec3,
}

impl Principal {
    /// Of a body with mass.
    ///
    /// # Errors
    /// Moments that are not above 0, which the engine needs.
    pub fn of(m: &Model, body: usize, engine: EngineKind) -> Result<Self, String> {
        let b = &m.bodies[body];
        let center = Vec3::from(b.mc) / b.mass;
        let square = Mat3::from_diagonal_element(center.norm_squared()) - center * center.transpose();
        let inertia = Mat3::from(b.inertia) - square * b.mass;
        let principal = SymmetricEigen::new(inertia);
        let moments = principal.eigenvalues;
        if !moments.iter().all(|x| *x > 0.0 && x.is_finite()) {
            let [x, y, z] = moments.into();
            let (name, engine): (String, &str) = (name_of(m, body), engine.name());
            return Err(format!(
                "{name} has the principal moments of inertia {x:e}, {y:e}, {z:e} kg·m²; {engine} needs all of them above 0"
            ));
        }
        let mut axes = principal.eigenvectors;
        if axes.determinant() < 0.0 {
            axes.swap_columns(0, 1);
        }
        let moments = (axes.transpose() * inertia * axes).diagonal();
        let turned = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        Ok(Self { body, frame: Pose::from_parts(Translation3::from(center), turned), moments })
    }

    /// Where it is if the model's body is there.
    pub fn motion(&self, k: &Kinematics) -> Motion {
        let (w, v) = (Vec3::from(k.w[self.body]), Vec3::from(k.v[self.body]));
        let x_wb = body_pose(k, self.body);
        let center = v + w.cross(&self.frame.translation.vector);
        Motion { pose: x_wb * self.frame, angular: x_wb.rotation * w, linear: x_wb.rotation * center }
    }

    /// Writes where the model's body is; the other way round.
    pub fn write(&self, at: &Motion, k: &mut Kinematics) {
        let (x_wb, i) = (at.pose * self.frame.inverse(), self.body);
        let origin = at.linear - at.angular.cross(&(x_wb.rotation * self.frame.translation.vector));
        let back = x_wb.rotation.inverse();
        k.r[i] = M3::from(*x_wb.rotation.to_rotation_matrix().matrix());
        k.p[i] = V3::from(x_wb.translation.vector);
        (k.w[i], k.v[i]) = (V3::from(back * at.angular), V3::from(back * origin));
    }
}
