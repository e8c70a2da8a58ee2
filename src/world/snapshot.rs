//! What a world shows after an interval. All buffers are made once; writing a snapshot allocates nothing.

use crate::math::{Pose, Twist};

/// The state of a world at one instant.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Control intervals since the start.
    pub interval: u64,
    /// Simulated time, ns.
    pub stamp_ns: i64,
    /// Per axis, rad or m, continuous (not wrapped).
    pub position: Vec<f64>,
    /// Per axis, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Per axis, N·m or N: the drive torque really applied in the last step.
    pub effort: Vec<f64>,
    /// Per link, in the order of `Model::links`: frame in the world.
    pub link_pose: Vec<Pose>,
    /// Per link: velocity of the link frame's origin, along the link's own axes.
    pub link_twist: Vec<Twist>,
    /// Per link: has the joint to its parent come apart? Its frame is then one of the world's.
    pub cut_off: Vec<bool>,
    /// The joints that have come apart.
    pub broken: Vec<super::Broken>,
    /// J.
    pub kinetic_energy: f64,
    /// J, zero with every centre of mass at the world's origin height.
    pub potential_energy: f64,
    /// Counters.
    pub stats: super::Stats,
    /// False once the world has diverged and stands still.
    pub finite: bool,
}
