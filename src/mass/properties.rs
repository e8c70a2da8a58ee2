//! Mass, centre and inertia as one value: moving, turning and adding them.

use crate::math::{Mat3, Pose, Vec3};

/// Mass properties of a link in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// kg.
    pub mass: f64,
    /// Centre of mass in the link frame, m.
    pub center: Vec3,
    /// Inertia about the centre of mass along the link's axes, kg·m².
    pub inertia: Mat3,
}

/// Principal moments and axes (B-10 E).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principal {
    /// Ascending, kg·m².
    pub moments: Vec3,
    /// Columns: the axis of each moment in the link frame; right-handed.
    pub axes: Mat3,
}

impl MassProperties {
    /// No mass at all.
    pub const ZERO: Self =
        Self { mass: 0.0, center: Vec3::new(0.0, 0.0, 0.0), inertia: Mat3::from_array_storage(ZEROS) };

    /// The same body seen from frame A; `x_ab` takes coordinates in the present frame B to A.
    pub fn placed(&self, x_ab: &Pose) -> Self {
        let r = x_ab.rotation.to_rotation_matrix();
        Self {
            mass: self.mass,
            center: (x_ab * nalgebra::Point3::from(self.center)).coords,
            inertia: symmetric(r.matrix() * self.inertia * r.matrix().transpose()),
        }
    }

    /// All `parts`, given in one frame, as one rigid body: each part's own mass at its own distance from the centre
    /// of mass of the whole.
    pub fn sum(parts: &[Self]) -> Self {
        let mass: f64 = parts.iter().map(|p| p.mass).sum();
        if mass == 0.0 {
            return Self::ZERO;
        }
        let center = parts.iter().fold(Vec3::zeros(), |c, p| c + p.center * (p.mass / mass));
        let inertia =
            parts.iter().fold(Mat3::zeros(), |i, p| i + p.inertia + point_inertia(p.mass, &(p.center - center)));
        Self { mass, center, inertia: symmetric(inertia) }
    }

    /// Inertia about the link's origin along the link's axes, kg·m² (B-10 D).
    pub fn inertia_at_origin(&self) -> Mat3 {
        self.inertia + point_inertia(self.mass, &self.center)
    }

    /// Principal moments and axes about the centre of mass.
    pub fn principal(&self) -> Principal {
        super::jacobi::principal(&self.inertia)
    }

    /// Could a body have this inertia: no negative moment, none greater than the sum of the other two? 1e-9 of the
    /// greatest aside, which is room for rounding: the least moment of a needle drowns in it.
    pub fn is_physical(&self) -> bool {
        let m = self.principal().moments;
        let rounding = 1e-9 * m[2];
        self.is_finite() && m[0] >= -rounding && m[0] + m[1] >= m[2] - rounding
    }

    /// Are all its numbers finite?
    pub fn is_finite(&self) -> bool {
        let mut all = self.inertia.iter().chain(self.center.iter()).chain(std::iter::once(&self.mass));
        all.all(|x| x.is_finite())
    }

    /// B-10: elements of the inertia tensor below 10^`exponent` kg·m² become 0.
    pub fn rounded(&self, exponent: i32) -> Self {
        let least = 10.0_f64.powi(exponent);
        Self { inertia: self.inertia.map(|x| if x.abs() < least { 0.0 } else { x }), ..*self }
    }
}

const ZEROS: nalgebra::ArrayStorage<f64, 3, 3> = nalgebra::ArrayStorage([[0.0; 3]; 3]);

/// Inertia of a point mass at `arm` from the reference point.
fn point_inertia(mass: f64, arm: &Vec3) -> Mat3 {
    (Mat3::from_diagonal_element(arm.norm_squared()) - arm * arm.transpose()) * mass
}

/// Takes out the rounding difference between the two triangles, so that the tensor is symmetric to the bit.
pub(super) fn symmetric(m: Mat3) -> Mat3 {
    (m + m.transpose()) * 0.5
}
