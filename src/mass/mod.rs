//! Shape + specific gravity, or `<inertial>` → mass properties.

use crate::math::{Mat3, Vec3};

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
