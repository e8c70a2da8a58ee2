//! One point where two colliders touch or are about to, in a form that moves with the bodies.

use crate::dynamics::Kinematics;
use crate::math::V3;

/// The direction in which the gap opens.
#[derive(Clone, Copy, Debug)]
pub enum Normal {
    /// A unit vector fixed to the body of this side (0 or 1), from side 0 to side 1.
    On(usize, V3<f64>),
    /// From the core of side 0 to that of side 1: two round surfaces.
    Between,
}

/// A point of contact. Each side is a ball of `radius` (maybe 0) about a `core` fixed to its body: exact for balls, capsules
/// and corners as they move on; for other round surfaces their tangent at the time of the narrow phase.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Indices into `Model::colliders`, ascending.
    pub pair: [u32; 2],
    /// Which point of the pair; the same from step to step while the same features touch.
    pub feature: u32,
    /// Indices into `Model::bodies` of the two sides; 0 = the world.
    pub bodies: [usize; 2],
    /// Per side, in its body's frame, m.
    pub core: [V3<f64>; 2],
    /// Per side, m; the margin is part of it.
    pub radius: [f64; 2],
    /// Which way.
    pub normal: Normal,
}

/// A touch at poses of its bodies, in the world.
#[derive(Clone, Copy, Debug, Default)]
pub struct Placed {
    /// Half-way between the two surfaces, m.
    pub point: V3<f64>,
    /// Unit, from side 0 to side 1.
    pub normal: V3<f64>,
    /// Distance of the surfaces, m; below 0 where they overlap.
    pub gap: f64,
}

/// Cores nearer than this have no direction between them, m.
const SAME: f64 = 1e-12;

impl Touch {
    /// Where it is at these poses.
    pub fn placed(&self, k: &Kinematics) -> Placed {
        let at = |side: usize| k.r[self.bodies[side]].mv(self.core[side]) + k.p[self.bodies[side]];
        let (a, b) = (at(0), at(1));
        match self.normal {
            Normal::On(0, n) => {
                let normal = k.r[self.bodies[0]].mv(n);
                let surface = b - normal * self.radius[1];
                let gap = normal.dot(surface - a) - self.radius[0];
                Placed { point: surface - normal * (0.5 * gap), normal, gap }
            }
            Normal::On(_, n) => {
                let normal = k.r[self.bodies[1]].mv(n);
                let surface = a + normal * self.radius[0];
                let gap = normal.dot(b - surface) - self.radius[1];
                Placed { point: surface + normal * (0.5 * gap), normal, gap }
            }
            Normal::Between => {
                let way = b - a;
                let length = way.dot(way).sqrt();
                let normal = if length > SAME { way * (1.0 / length) } else { V3::new(0.0, 0.0, 1.0) };
                let gap = length - self.radius[0] - self.radius[1];
                Placed { point: a + normal * (self.radius[0] + 0.5 * gap), normal, gap }
            }
        }
    }

    /// Orders touches: by pair, then feature.
    pub fn key(&self) -> ([u32; 2], u32) {
        (self.pair, self.feature)
    }
}
