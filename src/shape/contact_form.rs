//! What a shape is to contact.

use super::TriMesh;
use crate::math::Vec3;
use std::sync::Arc;

/// A shape that collides, in its own frame, metres; solids of revolution along z.
#[derive(Clone, Debug)]
pub enum ContactForm {
    /// All of z ≤ 0.
    HalfSpace,
    /// About the origin.
    Ball {
        /// m.
        radius: f64,
    },
    /// About the origin.
    Cuboid {
        /// Half of each edge, m.
        half: [f64; 3],
    },
    /// Balls about all points of a cuboid: a box whose edges are rounded.
    RoundCuboid {
        /// Half of each edge of the cuboid inside, m.
        half: [f64; 3],
        /// Of the balls, m.
        radius: f64,
    },
    /// The hull of two balls, at z = −half and z = half.
    Capsule {
        /// Radius at −half, m.
        bottom: f64,
        /// Radius at half, m.
        top: f64,
        /// m.
        half: f64,
    },
    /// About the origin.
    Ellipsoid {
        /// Half axes, m.
        radii: [f64; 3],
    },
    /// From z = −half to half.
    Cylinder {
        /// m.
        radius: f64,
        /// m.
        half: f64,
    },
    /// From z = −half (base) to half (tip).
    Cone {
        /// Of the base, m.
        radius: f64,
        /// m.
        half: f64,
    },
    /// From an ellipse at z = −half to one `top` times as large at z = half: elliptic cylinder, cone and frustum; with
    /// half = 0 a disc.
    Frustum {
        /// Half axes of the base, m.
        radii: [f64; 2],
        /// 0 to 1.
        top: f64,
        /// m.
        half: f64,
    },
    /// The convex hull of these corners.
    Hull(Arc<[Vec3]>),
    /// A surface; only of what stands still.
    Surface(Arc<TriMesh>),
}

impl ContactForm {
    /// What people call it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::HalfSpace => "half-space",
            Self::Ball { .. } => "ball",
            Self::Cuboid { .. } => "cuboid",
            Self::RoundCuboid { .. } => "round cuboid",
            Self::Capsule { .. } => "capsule",
            Self::Ellipsoid { .. } => "ellipsoid",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Frustum { .. } => "frustum",
            Self::Hull(_) => "hull",
            Self::Surface(_) => "surface",
        }
    }
}
