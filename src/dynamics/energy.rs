//! Energy and momentum of a state.

use super::Kinematics;
use crate::math::{S3, V3, Vec3};
use crate::model::Model;

/// Energies in J; the potential is zero with every centre of mass at the height of the world's origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// ½ vᵀ M v.
    pub kinetic: f64,
    /// −Σ m g·c.
    pub potential: f64,
}

/// Momentum in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Momentum {
    /// About the common centre of mass, kg·m²/s.
    pub angular: Vec3,
    /// kg·m/s.
    pub linear: Vec3,
    /// Common centre of mass, m.
    pub center: Vec3,
}

/// Energy of the moving bodies under gravity (m/s², world).
pub fn energy(m: &Model, k: &Kinematics, gravity: [f64; 3]) -> Energy {
    let add = |sum: Energy, body| {
        let e = body_energy(m, k, gravity, body);
        Energy { kinetic: sum.kinetic + e.kinetic, potential: sum.potential + e.potential }
    };
    (1..m.bodies.len()).fold(Energy::default(), add)
}

/// Energy of one body.
pub fn body_energy(m: &Model, k: &Kinematics, gravity: [f64; 3], body: usize) -> Energy {
    let (b, w, v) = (&m.bodies[body], k.w[body], k.v[body]);
    let linear = v * b.mass + w.cross(b.mc);
    let angular = S3::mv(&b.inertia, w) + b.mc.cross(v);
    let g = V3::from(gravity);
    Energy {
        kinetic: 0.5 * (w.dot(angular) + v.dot(linear)),
        potential: -g.dot(k.r[body].mv(b.mc) + k.p[body] * b.mass),
    }
}

/// Linear momentum of one body, along the world's axes, kg·m/s.
pub fn body_momentum(m: &Model, k: &Kinematics, body: usize) -> V3<f64> {
    let b = &m.bodies[body];
    k.r[body].mv(k.v[body] * b.mass + k.w[body].cross(b.mc))
}

/// Momentum of the moving bodies.
pub fn momentum(m: &Model, k: &Kinematics) -> Momentum {
    momentum_of(m, k, 1..m.bodies.len())
}

/// Momentum of some bodies, about their common centre of mass.
pub fn momentum_of(m: &Model, k: &Kinematics, bodies: impl Iterator<Item = usize>) -> Momentum {
    let (mut about_origin, mut linear, mut moment, mut mass) = (V3::default(), V3::default(), V3::default(), 0.0);
    for i in bodies {
        let (b, w, v) = (&m.bodies[i], k.w[i], k.v[i]);
        let p = body_momentum(m, k, i);
        let l = k.r[i].mv(b.inertia.mv(w) + b.mc.cross(v));
        about_origin += l + k.p[i].cross(p);
        linear += p;
        moment += k.r[i].mv(b.mc) + k.p[i] * b.mass;
        mass += b.mass;
    }
    let center = if mass > 0.0 { moment * (1.0 / mass) } else { moment };
    let angular = about_origin - center.cross(linear);
    Momentum { angular: angular.into(), linear: linear.into(), center: center.into() }
}
