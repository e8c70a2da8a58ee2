//! What a URDF with our tags says, item by item, with the place where it says it.
//!
//! Nothing is inferred here: a value that the text does not give is `None`, an angle is what was written
//! (radians), and every item keeps its [`Position`]. Units are SI, frames REP-103 unless said otherwise.

use super::{Body, ControlBlock, PlacedShape};
use crate::math::{Pose, Quat, Vec3, from_roll_pitch_yaw};
use std::collections::HashMap;
use std::sync::Arc;

/// A place in the text: 1-based line and column, and the byte range for underlining.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Position {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Byte offset of the first byte.
    pub start: usize,
    /// Byte offset after the last byte.
    pub end: usize,
}

/// A checked reading of one URDF text.
#[derive(Clone, Debug)]
pub struct Description {
    /// `<robot name>`.
    pub name: String,
    /// File name or label, for messages.
    pub file: Arc<str>,
    /// The text as it was read.
    pub text: Arc<str>,
    /// Links in the order of the text.
    pub links: Vec<Link>,
    /// Joints in the order of the text.
    pub joints: Vec<Joint>,
    /// `<joint_group>` tags.
    pub groups: Vec<JointGroup>,
    /// `<chain>` tags.
    pub chains: Vec<Chain>,
    /// `<separate_rig>` tags.
    pub rigs: Vec<SeparateRig>,
    /// `<ros2_control>` blocks.
    pub controls: Vec<ControlBlock>,
}

impl Description {
    /// The joint that carries each link, by the link's name; the root is not in it.
    pub fn joints_above(&self) -> HashMap<&str, &Joint> {
        self.joints.iter().map(|joint| (joint.child.as_str(), joint)).collect()
    }

    /// A joint by its name.
    pub fn joint(&self, name: &str) -> Option<&Joint> {
        self.joints.iter().find(|joint| joint.name == name)
    }

    /// A group by its name.
    pub fn group(&self, name: &str) -> Option<&JointGroup> {
        self.groups.iter().find(|group| group.name == name)
    }

    /// The group that a joint is an axis of.
    pub fn group_of(&self, joint: &str) -> Option<&JointGroup> {
        self.groups.iter().find(|group| group.axes().any(|(_, name)| name == joint))
    }

    /// The joint nearest the root of what `name` stands for: a group's first axis, or the joint itself.
    pub fn first_joint(&self, name: &str) -> Option<&Joint> {
        match self.group(name) {
            Some(group) => group.axes().find_map(|(_, axis)| self.joint(axis)),
            None => self.joint(name),
        }
    }
}

/// Position of a frame in its parent frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Origin {
    /// Translation, metres.
    pub xyz: [f64; 3],
    /// Fixed-axis roll, pitch, yaw, radians (URDF convention: R = Rz(yaw) Ry(pitch) Rx(roll)).
    pub rpy: [f64; 3],
}

impl Origin {
    /// As a rotation, with the same bits on every machine.
    pub fn rotation(&self) -> Quat {
        from_roll_pitch_yaw(self.rpy)
    }

    /// As a rigid transform: coordinates in the placed frame → coordinates in the parent frame.
    pub fn pose(&self) -> Pose {
        Pose::from_parts(Vec3::from(self.xyz).into(), self.rotation())
    }
}

/// `<link>`.
#[derive(Clone, Debug)]
pub struct Link {
    /// Name, unique.
    pub name: String,
    /// Where the element starts.
    pub at: Position,
    /// `<inertial>`.
    pub inertial: Option<Inertial>,
    /// `<visual>` shapes, in order.
    pub visuals: Vec<PlacedShape>,
    /// `<collision>` shapes, in order.
    pub collisions: Vec<PlacedShape>,
    /// `<realnoid><body>`: mass from the visual shapes.
    pub body: Option<Body>,
    /// `<realnoid><proxy>`: what collides, instead of `<collision>`.
    pub proxies: Vec<PlacedShape>,
    /// `<realnoid><surface>`.
    pub surface: Option<Surface>,
    /// `<realnoid><damping>`.
    pub damping: Option<BodyDamping>,
    /// `<realnoid><deactivate>`.
    pub deactivate: Option<Deactivate>,
    /// `<realnoid><monitor frame>`.
    pub monitor: Option<MonitorFrame>,
}

/// `<inertial>`: mass in kg, inertia (kg·m²) about the centre of mass along the axes of `origin`.
#[derive(Clone, Debug)]
pub struct Inertial {
    /// Where the element starts.
    pub at: Position,
    /// Frame of the centre of mass in the link frame.
    pub origin: Origin,
    /// kg.
    pub mass: f64,
    /// ixx, ixy, ixz, iyy, iyz, izz.
    pub inertia: [f64; 6],
}

/// Greatest coefficient of friction, of rolling (m) and of spinning friction (m): as good as stuck, and pairs are far from overflow.
pub const MOST_FRICTION: f64 = 1e6;

/// `<surface>` (B-8); `None` = not given, the scene's default holds.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Where.
    pub at: Position,
    /// ≥ 0.
    pub friction: Option<f64>,
    /// ≥ 0, metres.
    pub rolling_friction: Option<f64>,
    /// ≥ 0, metres.
    pub spinning_friction: Option<f64>,
    /// 0…1.
    pub restitution: Option<f64>,
    /// ≥ 0, metres.
    pub margin: Option<f64>,
}

/// `<damping linear angular>`: v ← v·(1−d)^dt (B-8 I, J).
#[derive(Clone, Debug)]
pub struct BodyDamping {
    /// Where.
    pub at: Position,
    /// 0…1 per second.
    pub linear: f64,
    /// 0…1 per second.
    pub angular: f64,
}

/// `<deactivate linear angular after>` (B-9).
#[derive(Clone, Debug)]
pub struct Deactivate {
    /// Where.
    pub at: Position,
    /// m/s.
    pub linear: f64,
    /// rad/s.
    pub angular: f64,
    /// s.
    pub after: f64,
}

/// In which frame a monitored body's twist is expressed (B-16).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MonitorFrame {
    /// The link's own axes.
    Body,
    /// The world's axes.
    World,
}

/// URDF joint types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// No motion.
    Fixed,
    /// One limited rotation.
    Revolute,
    /// One unlimited rotation.
    Continuous,
    /// One translation.
    Prismatic,
    /// Six degrees of freedom.
    Floating,
    /// Two translations, one rotation: read, refused with the mend until it is simulated.
    Planar,
    /// Three rotations about one point (URDF 1.2).
    Spherical,
}

/// `<joint>`.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name, unique.
    pub name: String,
    /// Where the element starts.
    pub at: Position,
    /// Type.
    pub kind: JointKind,
    /// Name of the parent link.
    pub parent: String,
    /// Where the parent is named.
    pub parent_at: Position,
    /// Name of the child link.
    pub child: String,
    /// Where the child is named.
    pub child_at: Position,
    /// Joint frame in the parent link frame.
    pub origin: Origin,
    /// Axis in the joint frame, unit length (normalised by the reader; URDF's default is X).
    pub axis: [f64; 3],
    /// `<limit>`.
    pub limit: Option<Limit>,
    /// `<dynamics damping>`: N·m·s/rad or N·s/m.
    pub damping: f64,
    /// `<dynamics friction>`: N·m or N.
    pub friction: f64,
    /// `<mimic>`.
    pub mimic: Option<Mimic>,
    /// `<realnoid><drive>`.
    pub drive: Option<Drive>,
    /// `<realnoid><constraint>`.
    pub constraint: Option<Constraint>,
}

/// `<limit>`.
#[derive(Clone, Debug)]
pub struct Limit {
    /// Where.
    pub at: Position,
    /// rad or m; −∞ for a continuous joint, and where URDF 1.2 leaves it out.
    pub lower: f64,
    /// rad or m; +∞ for a continuous joint, and where URDF 1.2 leaves it out.
    pub upper: f64,
    /// N·m or N; `None` where the text gives none or the placeholder 0.
    pub effort: Option<f64>,
    /// rad/s or m/s; `None` where the text gives none or the placeholder 0.
    pub velocity: Option<f64>,
    /// Names of the bounds that stand there beyond these: acceleration, deceleration, jerk (URDF 1.2).
    pub beyond: Vec<&'static str>,
}

/// `<mimic joint multiplier offset>`.
#[derive(Clone, Debug)]
pub struct Mimic {
    /// Where.
    pub at: Position,
    /// The joint that is followed.
    pub joint: String,
    /// Default 1.
    pub multiplier: f64,
    /// Default 0.
    pub offset: f64,
}

/// Drive modes (J-13).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveMode {
    /// No drive torque.
    Idle,
    /// Applied torque.
    Torque,
    /// Target angle.
    Servo,
}

/// `<drive>` (J-13, J-14).
#[derive(Clone, Debug)]
pub struct Drive {
    /// Where.
    pub at: Position,
    /// Mode at start.
    pub mode: DriveMode,
    /// (a) N·m or N.
    pub max_torque: Option<f64>,
    /// (b) rad/s or m/s.
    pub no_load_speed: Option<f64>,
    /// (e) N·m or N.
    pub static_resistance: Option<f64>,
    /// (f) N·m or N.
    pub dynamic_resistance: Option<f64>,
    /// (g).
    pub short_brake: bool,
    /// Bandwidth of the servo's position loop, Hz.
    pub bandwidth: Option<f64>,
    /// kg·m² on the motor side.
    pub rotor_inertia: Option<f64>,
    /// motor turns per axis turn.
    pub gear_ratio: Option<f64>,
    /// May a command switch the mode? Default true.
    pub switchable: bool,
}

/// `<constraint>` (J-18); `None` = off.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Where.
    pub at: Position,
    /// 0…1.
    pub erp: Option<f64>,
    /// 0…1.
    pub stop_erp: Option<f64>,
    /// ≥ 0.
    pub cfm: Option<f64>,
    /// ≥ 0.
    pub stop_cfm: Option<f64>,
    /// N.
    pub break_threshold: Option<f64>,
}

/// `<joint_group type>` (J-2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupKind {
    /// H, P, B stacked, each with a link of its own.
    CombinedHinge,
    /// H and P share origin and link.
    Cardan,
    /// H, P, B share origin and link.
    ThreeDof,
}

/// `<joint_group>`.
#[derive(Clone, Debug)]
pub struct JointGroup {
    /// Name, unique.
    pub name: String,
    /// Where.
    pub at: Position,
    /// Type.
    pub kind: GroupKind,
    /// Joint names of H, P, B, E; `None` = that axis is physically fixed.
    pub h: Option<String>,
    /// Pitch.
    pub p: Option<String>,
    /// Bank.
    pub b: Option<String>,
    /// Extension.
    pub e: Option<String>,
}

impl JointGroup {
    /// Letters and joint names of the axes that are given, from the root outwards.
    pub fn axes(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let given = [("h", &self.h), ("p", &self.p), ("b", &self.b), ("e", &self.e)];
        given.into_iter().filter_map(|(letter, name)| Some((letter, name.as_deref()?)))
    }
}

/// What a chain is anchored to that stands on the fixed base of the robot, where no link has that name.
pub const WORLD_ANCHOR: &str = "world";

/// `<chain>`.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Where.
    pub at: Position,
    /// Joint or group that is the root.
    pub root: String,
    /// Link the root is anchored to, or [`WORLD_ANCHOR`].
    pub anchor: Option<String>,
    /// J-9.
    pub self_collision: bool,
}

/// `<separate_rig>` (J-4): a frame outside the tree of links that mirrors a group.
#[derive(Clone, Debug)]
pub struct SeparateRig {
    /// Where.
    pub at: Position,
    /// Name of the frame, unique among frames.
    pub name: String,
    /// The group whose angles it mirrors.
    pub group: String,
    /// Link under which the frame stands; `None`: the link that carries the group.
    pub anchor: Option<String>,
}
