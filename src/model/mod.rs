//! Description + mass properties → [`Model`]: immutable, arrays, parent before child.
//!
//! invariant: `bodies[0]` is the world; for every other body `parent < index`, so a loop upwards visits parents first.
//! invariant: every body's joint frame has its (last) axis along z; the frame of a body is its joint frame.

mod bodies;
mod build;
mod chain;
mod collider;
mod constraint;
mod coupling;
mod damping;
mod drive;
mod effects;
mod group;
mod join;
mod joint_set;
mod membership;
mod rig;

pub use bodies::Bodies;
pub use build::Base;
pub use chain::LinkChain;
pub use collider::{Collider, Surface};
pub use constraint::{Breakable, Coupling, SoftDof, Softness};
pub use damping::BodyDamping;
pub use drive::{DriveLimits, SERVO_TIME};
pub use effects::{EFFECT_NAMES, EFFECTS, Effect, Effects, Kind, Listed, Part, Parts};
pub use group::{EulerFrame, EulerRates, POLE, rotation};
pub use join::Joined;
pub use joint_set::JointSet;
pub use membership::Membership;
pub use rig::Rig;

use crate::description::{DriveMode, MonitorFrame};
use crate::math::{M3, Mat3, Pose, S3, V3, Vec3};

/// Rotary or linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisKind {
    /// rad, N·m.
    Rotary,
    /// m, N.
    Linear,
}

/// Where the coordinates of an axis are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxisSlot {
    /// One coordinate of its own: `q[q]`, `v[v]`.
    Scalar {
        /// Index into q.
        q: usize,
        /// Index into v.
        v: usize,
    },
    /// Angle `angle` (0 = H, 1 = P, 2 = B) of the 3DOF group `group`.
    Euler {
        /// Index into [`Model::eulers`].
        group: usize,
        /// 0 = H, 1 = P, 2 = B.
        angle: usize,
    },
    /// Its joint has come apart: the axis keeps its last position and feels nothing.
    Apart {
        /// rad or m.
        position: f64,
    },
}

/// One axis: a revolute, continuous or prismatic joint of the URDF, also when it is part of a group.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Joint name in the URDF.
    pub name: String,
    /// Rotary or linear.
    pub kind: AxisKind,
    /// Coordinates.
    pub slot: AxisSlot,
    /// Unit vector of the axis in the frame of the link that it carries.
    pub direction: Vec3,
    /// rad or m; −∞ where unlimited.
    pub lower: f64,
    /// rad or m; +∞ where unlimited.
    pub upper: f64,
    /// Softness of the stops (J-18).
    pub stop: Softness,
    /// What bounds the drive (J-13 a, b, e, f, g), at start.
    pub drive: DriveLimits,
    /// Viscous damping, N·m·s/rad or N·s/m.
    pub damping: f64,
    /// Coulomb friction, N·m or N.
    pub friction: f64,
    /// Mode at start.
    pub mode: DriveMode,
    /// May a command switch the mode?
    pub switchable: bool,
}

impl Axis {
    /// Does a torque on it act? At the pole of a group (`rates`: of all groups) H turns about the same line as B; and nothing acts
    /// on an axis whose joint has come apart.
    pub fn is_graspable(&self, rates: &[EulerRates]) -> bool {
        match self.slot {
            AxisSlot::Euler { group, angle: 0 } => !rates[group].at_pole,
            AxisSlot::Apart { .. } => false,
            _ => true,
        }
    }

    /// Has it a range whose ends do not yield?
    pub fn has_hard_stops(&self) -> bool {
        (self.lower.is_finite() || self.upper.is_finite()) && self.stop.cfm == 0.0
    }
}

/// One link of the URDF.
#[derive(Clone, Debug)]
pub struct LinkInfo {
    /// Name.
    pub name: String,
    /// Index of the parent link; `None` for the root.
    pub parent: Option<usize>,
    /// True if the joint to the parent is fixed and neither yields nor breaks (its transform never changes).
    pub fixed: bool,
    /// Monitor tag.
    pub monitor: Option<MonitorFrame>,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the link frame, m.
    pub center: Vec3,
    /// Inertia about the centre of mass along the axes of the link frame, kg·m².
    pub inertia: Mat3,
    /// The joint whose link it belongs to; `None`: fixed to the root.
    pub membership: Option<Membership>,
    /// When it may leave the computation (B-9); `None`: never.
    pub deactivation: Option<Deactivation>,
    /// Where the frame is.
    pub frame: LinkFrame,
    /// Taken out of the world (W-11): it stands still where it was, without mass, and nothing touches it.
    pub removed: bool,
}

/// A body below both thresholds for longer than the delay leaves the computation (B-9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deactivation {
    /// Speed of the centre of mass, m/s.
    pub linear: f64,
    /// rad/s.
    pub angular: f64,
    /// s.
    pub after: f64,
}

/// How a link's frame follows from the state.
#[derive(Clone, Copy, Debug)]
pub enum LinkFrame {
    /// Rigidly on a body.
    OnBody {
        /// Index into [`Model::bodies`].
        body: usize,
        /// `X_BL`: link frame in the body frame.
        offset: Pose,
    },
    /// A massless link inside a group: after the first `turns` of the turns that make up the joint of `body`.
    InGroup {
        /// The group's body.
        body: usize,
        /// 1 or 2.
        turns: usize,
        /// Link frame in the joint frame after those turns.
        offset: Pose,
    },
}

impl LinkFrame {
    /// The body that the link is on, or that its group moves.
    pub fn body(&self) -> usize {
        match self {
            Self::OnBody { body, .. } | Self::InGroup { body, .. } => *body,
        }
    }
}

/// Kinds of joints of the kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointType {
    /// Rotation about z. q: angle.
    Revolute,
    /// Translation along z. q: distance.
    Prismatic,
    /// Rotation about x, then about the new z. q: two angles.
    Universal,
    /// q: unit quaternion (w, x, y, z), child → joint frame; v: angular velocity in the child frame.
    Spherical,
    /// q: position in the joint frame, then as spherical; v: twist in the child frame, angular first.
    Floating,
}

impl JointType {
    /// Coordinates.
    pub fn nq(self) -> usize {
        match self {
            Self::Revolute | Self::Prismatic => 1,
            Self::Universal => 2,
            Self::Spherical => 4,
            Self::Floating => 7,
        }
    }
    /// Velocities.
    pub fn nv(self) -> usize {
        match self {
            Self::Revolute | Self::Prismatic => 1,
            Self::Universal => 2,
            Self::Spherical => 3,
            Self::Floating => 6,
        }
    }
}

/// An axis of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Along {
    X,
    Y,
    Z,
}

/// A rigid body with the joint that carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Index of the parent body.
    pub parent: usize,
    /// Joint to the parent.
    pub joint: JointType,
    /// First coordinate.
    pub q: usize,
    /// First velocity.
    pub v: usize,
    /// Index among the spherical joints, if this is one.
    pub ball: usize,
    /// Joint frame's axes in the parent body's frame.
    pub tree_r: M3<f64>,
    /// Joint frame's origin in the parent body's frame, m.
    pub tree_p: V3<f64>,
    /// Axis of the parent body's frame that the joint frame's z lies along, either way, if its other numbers are exactly zero.
    /// The dynamics leave products with these zeros out.
    pub along: Option<Along>,
    /// kg.
    pub mass: f64,
    /// Mass × centre of mass in the body frame, kg·m.
    pub mc: V3<f64>,
    /// Inertia about the body frame's origin, kg·m².
    pub inertia: S3<f64>,
}

impl Body {
    /// Puts the joint frame (axes, origin) into the parent body's frame. Where z lies along an axis but for rounding, it does
    /// so exactly.
    pub fn put(&mut self, (r, p): (M3<f64>, V3<f64>)) {
        (self.tree_r, self.tree_p, self.along) = (r, p, None);
        let z = r.col2();
        let small = |x: f64| x.abs() < 8.0 * f64::EPSILON;
        for (k, along) in [Along::X, Along::Y, Along::Z].into_iter().enumerate() {
            let others = [[z.y, z.z], [z.x, z.z], [z.x, z.y]][k];
            if others.into_iter().chain([r.r[k].x, r.r[k].y]).all(small) {
                self.tree_r.r.iter_mut().for_each(|row| row.z = 0.0);
                self.tree_r.r[k] = V3::new(0.0, 0.0, r.r[k].z.signum());
                self.along = Some(along);
            }
        }
    }
}

/// The immutable model.
#[derive(Clone, Debug)]
pub struct Model {
    /// Robot name.
    pub name: String,
    /// Axes in the order of the URDF.
    pub axes: Vec<Axis>,
    /// Links in the order of the URDF.
    pub links: Vec<LinkInfo>,
    /// Bodies; the first is the world.
    pub bodies: Bodies,
    /// 3DOF groups.
    pub eulers: Vec<EulerFrame>,
    /// How the root is held.
    pub base: Base,
    /// Root link of a fixed base in the world; that of a free base is in the state.
    pub base_pose: Pose,
    /// Index of the root link.
    pub root_link: usize,
    /// Coordinates.
    pub nq: usize,
    /// Velocities.
    pub nv: usize,
    /// Number of spherical joints.
    pub balls: usize,
    /// Degrees of freedom that soft joints (J-18, CFM > 0), and fixed joints that may break, add; none where there is no such
    /// joint.
    pub softs: Vec<SoftDof>,
    /// Axes that follow others (`<mimic>`).
    pub couplings: Vec<Coupling>,
    /// Joints with a break threshold.
    pub breakables: Vec<Breakable>,
    /// Chains of links (J-3, J-7, J-9).
    pub chains: Vec<LinkChain>,
    /// Groups, and axes in none, in the order of the URDF.
    pub joints: Vec<JointSet>,
    /// Frames that mirror groups (J-4).
    pub rigs: Vec<Rig>,
    /// Bodies that lose velocity by themselves.
    pub dampings: Vec<BodyDamping>,
    /// Robots and bodies beside the first robot.
    pub joined: Vec<Joined>,
    /// What collides: shapes of links, and what stands still in the world.
    pub colliders: Vec<Collider>,
    /// Pairs of links (both ascending) whose colliders never touch.
    pub excluded_pairs: Vec<[usize; 2]>,
    /// What the scene calls for.
    pub effects: Effects,
}

impl Model {
    /// The body whose joint has this velocity coordinate.
    pub fn body_of(&self, v: usize) -> Option<usize> {
        let holds = |b: &Body| (b.v..b.v + b.joint.nv()).contains(&v);
        self.bodies.iter().skip(1).position(holds).map(|b| b + 1)
    }
    /// The body that an axis carries, by itself or as part of a group; `None` if its joint has come apart.
    pub fn carrier(&self, axis: usize) -> Option<usize> {
        match self.axes[axis].slot {
            AxisSlot::Scalar { v, .. } => self.body_of(v),
            AxisSlot::Euler { group, .. } => Some(self.eulers[group].body),
            AxisSlot::Apart { .. } => None,
        }
    }
    /// Writes the gradients of all 3DOF angles at these angles; true if one of the groups is at its pole.
    pub fn write_rates(&self, angles: &[[f64; 3]], rates: &mut [EulerRates]) -> bool {
        let mut at_pole = false;
        for (rates, (group, angles)) in rates.iter_mut().zip(self.eulers.iter().zip(angles)) {
            *rates = group.rates(*angles);
            at_pole |= rates.at_pole;
        }
        at_pole
    }
    /// The body that a collider is on, and its frame there; body 0, the world, for what stands still.
    pub fn seat_of(&self, c: &Collider) -> (usize, Pose) {
        match c.link.map(|link| &self.links[link].frame) {
            Some(LinkFrame::OnBody { body, offset } | LinkFrame::InGroup { body, offset, .. }) => {
                (*body, offset * c.pose)
            }
            None => (0, c.pose),
        }
    }
    /// Gives the model what collides; [`Effects`] are as they would have been with it from the start.
    pub fn set_colliders(&mut self, colliders: Vec<Collider>) {
        self.colliders = colliders;
        self.effects.contact = Effects::called_for(self).contact;
    }
    /// Total mass of all links, kg.
    pub fn mass(&self) -> f64 {
        self.links.iter().map(|l| l.mass).sum()
    }
    /// Index of an axis by its URDF joint name.
    pub fn axis(&self, name: &str) -> Option<usize> {
        self.axes.iter().position(|a| a.name == name)
    }
    /// Moves the fixed base of the robot that has this axis, and what stands on it, by a rigid motion in the world; what
    /// floats stays.
    pub fn move_fixed_base(&mut self, axis: usize, motion: &Pose) {
        let r = M3::from(*motion.rotation.to_rotation_matrix().matrix());
        let p = V3::from(motion.translation.vector);
        let (links, robot) = self.robot_of(axis);
        let mut stands = vec![false; self.bodies.len()];
        for link in &mut self.links[links] {
            match &mut link.frame {
                LinkFrame::OnBody { body: 0, offset } => *offset = motion * *offset,
                LinkFrame::OnBody { body, .. } | LinkFrame::InGroup { body, .. } => stands[*body] = true,
            }
        }
        for i in (1..self.bodies.len()).rev() {
            stands[self.bodies[i].parent] |= stands[i] && self.bodies[i].joint != JointType::Floating;
        }
        for (b, _) in self.bodies.iter_mut().zip(stands).skip(1).filter(|(_, stands)| *stands) {
            if b.parent == 0 && b.joint != JointType::Floating {
                b.put((r.mm(&b.tree_r), r.mv(b.tree_p) + p));
            }
        }
        let base_pose = robot.map_or(&mut self.base_pose, |i| &mut self.joined[i].base_pose);
        *base_pose = motion * *base_pose;
    }
    /// Index of the link that an axis itself carries.
    pub fn carried(&self, axis: usize) -> Option<usize> {
        let name = &self.axes[axis].name;
        self.links.iter().position(|l| l.membership.as_ref().is_some_and(|m| m.root && m.axis == *name))
    }
    /// The coordinates at which every angle is 0 and every quaternion 1.
    pub fn neutral(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.nq];
        for b in &self.bodies[1..] {
            match b.joint {
                JointType::Spherical => q[b.q] = 1.0,
                JointType::Floating => q[b.q + 3] = 1.0,
                _ => {}
            }
        }
        q
    }
}
