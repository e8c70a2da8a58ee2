//! The rbx core: pure functions over a model, a workspace and the state. Nothing here allocates after set-up.
//!
//! Notation (Featherstone, *Rigid Body Dynamics Algorithms*, 2008): spatial vectors are (angular, linear) in the body's
//! own frame; an articulated inertia is `[J H; Hᵀ M]`; `R` turns child coordinates into the parent's; `p` is the child's
//! origin in the parent's frame. The world's acceleration is −g, which stands for the weight of every body (eq. 5.x, §5.3).

mod aba;
mod articulated;
mod ball;
mod batch;
mod check;
mod columns;
mod crba;
mod damping;
mod eliminate;
mod energy;
mod factor;
mod hybrid;
mod impulses;
mod integrate;
mod joint;
mod joint_force;
mod kinematics;
mod layout;
mod limbs;
mod response;
mod rnea;
mod scalars;
mod together;
mod turn;
mod velocities;

pub use aba::{Dof, Workspace, aba};
pub use ball::{BallIn, BallLock};
pub use batch::{AbaBatch, LaneKind};
pub use check::singular_axes;
pub use columns::Columns;
pub use crba::crba;
pub use damping::{Scheme, damping_power, damping_powers, write_damping};
pub use energy::{Energy, Momentum, body_energy, body_momentum, energy, momentum, momentum_of};
pub use hybrid::aba_hybrid;
pub use integrate::{coordinate_rates, exponential_step, move_coordinates, normalize, turn};
pub use joint::joint_transform;
pub(crate) use joint::universal_axis;
pub use joint_force::{JointForces, Outside};
pub use kinematics::{Kinematics, Posed, body_pose, kinematics, kinematics_of, link_pose, link_twist};
pub use layout::{CHUNK, Layout};
pub use limbs::{Limbs, aba_limbs};
pub use response::{Mobility, Push, Response};
pub use rnea::rnea;
pub use scalars::{aba_fused, aba_twofold};
pub use together::{Asked, Turn, own_turn, take_turns};
pub use velocities::velocities_of;

/// Inputs of one velocity coordinate to the hybrid dynamics: a free one gets a torque, a locked one an acceleration.
#[derive(Clone, Copy, Debug)]
pub struct DofIn<T> {
    /// Torque or force, N·m or N.
    pub tau: T,
    /// Added to the diagonal of the mass matrix: implicit damping and stiffness, rotor inertia; kg·m² or kg.
    pub diagonal: T,
    /// 1 free, 0 locked.
    pub free: T,
    /// Prescribed acceleration of a locked one, rad/s² or m/s².
    pub acceleration: T,
    /// True if free and without diagonal (a lane type cannot compare, so this stands beside the values).
    pub plain: bool,
}

impl<T: crate::math::Real> DofIn<T> {
    /// Free, with a torque.
    #[inline(always)]
    pub fn free(tau: T) -> Self {
        Self { tau, diagonal: T::of(0.0), free: T::of(1.0), acceleration: T::of(0.0), plain: true }
    }
    /// Free, with a torque and something on the diagonal.
    #[inline(always)]
    pub fn implicit(tau: T, diagonal: T) -> Self {
        Self { diagonal, plain: false, ..Self::free(tau) }
    }
    /// Locked to an acceleration. The diagonal has no effect then but to keep a division finite where nothing has inertia.
    #[inline(always)]
    pub fn locked(acceleration: T) -> Self {
        Self { tau: T::of(0.0), diagonal: T::of(1.0), free: T::of(0.0), acceleration, plain: false }
    }
}
