//! Description + mass properties → [`Model`]: immutable, arrays, parent before child.

use crate::description::{Description, DriveMode, MonitorFrame};

/// How the root link is held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Base {
    /// On a test stand.
    #[default]
    Fixed,
    /// Six free degrees of freedom.
    Free,
}

/// Rotary or linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisKind {
    /// rad, N·m.
    Rotary,
    /// m, N.
    Linear,
}

/// One driven axis: a revolute, continuous or prismatic joint of the URDF, also when it is part of a group.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Joint name in the URDF.
    pub name: String,
    /// Rotary or linear.
    pub kind: AxisKind,
    /// rad or m; −∞ where unlimited.
    pub lower: f64,
    /// rad or m; +∞ where unlimited.
    pub upper: f64,
    /// N·m or N; +∞ where nothing bounds it.
    pub max_torque: f64,
    /// rad/s or m/s; +∞ where nothing bounds it.
    pub no_load_speed: f64,
    /// Mode at start.
    pub mode: DriveMode,
    /// May a command switch the mode?
    pub switchable: bool,
}

/// One link of the URDF.
#[derive(Clone, Debug)]
pub struct LinkInfo {
    /// Name.
    pub name: String,
    /// Index of the parent link; `None` for the root.
    pub parent: Option<usize>,
    /// True if the joint to the parent is fixed (its transform never changes).
    pub fixed: bool,
    /// Monitor tag.
    pub monitor: Option<MonitorFrame>,
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
    /// How the root is held.
    pub base: Base,
}

impl Model {
    /// Stub.
    pub fn build(d: &Description, base: Base) -> Model {
        let _ = d;
        Model { name: d.name.clone(), axes: vec![], links: vec![], base }
    }
}
