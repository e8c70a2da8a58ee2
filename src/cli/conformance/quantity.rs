//! What can be looked at in a world.

use crate::cli::simulate::unaccounted;
use crate::dynamics::Momentum;
use crate::math::Vec3;
use crate::model::Model;
use crate::world::{Snapshot, World};

/// What case files can look at, for `--help`.
pub(super) fn help() -> String {
    let row = |a: &About| format!("  {:<24} {:<14} {}\n", a.name, a.unit, a.means);
    let rows: String = QUANTITIES.iter().map(row).collect();
    let parts: Vec<&str> = PARTS.iter().map(|(name, _)| *name).collect();
    format!("Quantities of case files (docs/conformance.md):\n{rows}Parts of a vector: {}", parts.join(", "))
}

/// What a quantity belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    World,
    Link,
    Axis,
}

/// A quantity of [`QUANTITIES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Position,
    Velocity,
    AngularVelocity,
    ContactForce,
    AxisPosition,
    AxisSpeed,
    AxisEffort,
    CrossingTime,
    KineticEnergy,
    KineticEnergyRatio,
    TotalEnergy,
    EnergyGain,
    EnergyUnaccounted,
    Momentum,
    AngularMomentum,
    AngularMomentumRatio,
    AngularMomentumTurn,
    Penetration,
    JointDrift,
    StopViolation,
}

/// A quantity by its name in files.
#[derive(Debug)]
pub(super) struct About {
    pub name: &'static str,
    pub quantity: Quantity,
    pub owner: Owner,
    pub is_vector: bool,
    pub unit: &'static str,
    /// For the documentation.
    pub means: &'static str,
}

const fn about(
    name: &'static str,
    quantity: Quantity,
    (owner, is_vector): (Owner, bool),
    (unit, means): (&'static str, &'static str),
) -> About {
    About { name, quantity, owner, is_vector, unit, means }
}

/// All that there are.
pub(super) const QUANTITIES: [About; 20] = [
    about(
        "position",
        Quantity::Position,
        (Owner::Link, true),
        ("m", "of the link's origin, or of `point`, in the world"),
    ),
    about("velocity", Quantity::Velocity, (Owner::Link, true), ("m/s", "of the same, along the axes of the world")),
    about("angular_velocity", Quantity::AngularVelocity, (Owner::Link, true), ("rad/s", "along the axes of the world")),
    about(
        "contact_force",
        Quantity::ContactForce,
        (Owner::Link, true),
        ("N", "sum of the forces of all contacts on the link, averaged over the last step"),
    ),
    about("axis_position", Quantity::AxisPosition, (Owner::Axis, false), ("rad or m", "whole turns count")),
    about("axis_speed", Quantity::AxisSpeed, (Owner::Axis, false), ("rad/s or m/s", "its rate")),
    about(
        "axis_effort",
        Quantity::AxisEffort,
        (Owner::Axis, false),
        ("N·m or N", "what the drive really applied in the last step"),
    ),
    about(
        "crossing_time",
        Quantity::CrossingTime,
        (Owner::Axis, false),
        (
            "s",
            "when the axis passed 0 for the `count`-th time, either way, between two control intervals by proportion",
        ),
    ),
    about("kinetic_energy", Quantity::KineticEnergy, (Owner::World, false), ("J", "of everything")),
    about("kinetic_energy_ratio", Quantity::KineticEnergyRatio, (Owner::World, false), ("1", "against the start")),
    about("total_energy", Quantity::TotalEnergy, (Owner::World, false), ("J", "kinetic and potential")),
    about("energy_gain", Quantity::EnergyGain, (Owner::World, false), ("J", "of the total energy since the start")),
    about(
        "energy_unaccounted",
        Quantity::EnergyUnaccounted,
        (Owner::World, false),
        (
            "J",
            "energy gained since the start, less the work of drives, plus what was lost: the error of the integrator",
        ),
    ),
    about("momentum", Quantity::Momentum, (Owner::World, true), ("N·s", "of everything")),
    about(
        "angular_momentum",
        Quantity::AngularMomentum,
        (Owner::World, true),
        ("N·m·s", "of everything, about the common centre of mass"),
    ),
    about(
        "angular_momentum_ratio",
        Quantity::AngularMomentumRatio,
        (Owner::World, false),
        ("1", "length against the start"),
    ),
    about(
        "angular_momentum_turn",
        Quantity::AngularMomentumTurn,
        (Owner::World, false),
        ("rad", "angle between its direction and that at the start"),
    ),
    about("penetration", Quantity::Penetration, (Owner::World, false), ("m", "the deepest since the start")),
    about(
        "joint_drift",
        Quantity::JointDrift,
        (Owner::World, false),
        ("m", "the widest gap of a joint since the start"),
    ),
    about(
        "stop_violation",
        Quantity::StopViolation,
        (Owner::World, false),
        ("rad or m", "the furthest that an axis was outside its range since the start"),
    ),
];

/// The part of a vector that counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    X,
    Y,
    Z,
    /// Of all of it.
    Length,
    /// Length of the part in the plane of x and y.
    Horizontal,
    /// Of length 1.
    Direction,
    /// All of it.
    Whole,
}

/// By name.
pub(super) const PARTS: [(&str, Part); 6] = [
    ("x", Part::X),
    ("y", Part::Y),
    ("z", Part::Z),
    ("length", Part::Length),
    ("horizontal", Part::Horizontal),
    ("direction", Part::Direction),
];

impl Part {
    /// Three numbers, not one.
    pub fn is_vector(self) -> bool {
        matches!(self, Self::Direction | Self::Whole)
    }

    /// A single number is the first of the three.
    fn of(self, v: Vec3) -> Vec3 {
        let one = |x: f64| Vec3::new(x, 0.0, 0.0);
        match self {
            Self::X => one(v.x),
            Self::Y => one(v.y),
            Self::Z => one(v.z),
            Self::Length => one(v.norm()),
            Self::Horizontal => one(v.x.hypot(v.y)),
            Self::Direction => v / v.norm(),
            Self::Whole => v,
        }
    }
}

/// Where one looks.
#[derive(Clone, Debug)]
pub(super) struct Probe {
    pub about: &'static About,
    /// Link or axis.
    pub index: usize,
    /// The axis is a linear one.
    pub linear: bool,
    pub part: Part,
    /// In the link's frame, m.
    pub point: Vec3,
}

/// What ratios refer to.
#[derive(Clone, Debug)]
pub(super) struct Beginning {
    kinetic: f64,
    total: f64,
    momentum: Momentum,
}

impl Beginning {
    /// Of a world that has not moved yet.
    pub fn of(w: &World) -> Self {
        let e = w.energy();
        Self { kinetic: e.kinetic, total: e.kinetic + e.potential, momentum: w.momentum() }
    }
}

impl Probe {
    /// The unit of value and error.
    pub fn unit(&self) -> &'static str {
        match (self.about.owner, self.about.unit.split_once(" or ")) {
            _ if self.part == Part::Direction => "1",
            (Owner::Axis, Some((rotary, linear))) => {
                if self.linear {
                    linear
                } else {
                    rotary
                }
            }
            _ => self.about.unit,
        }
    }

    /// The present value; a single number is the first of the three. Crossings are not read here.
    pub fn read(&self, w: &World, s: &Snapshot, start: &Beginning) -> Vec3 {
        let one = |x: f64| Vec3::new(x, 0.0, 0.0);
        let i = self.index;
        match self.about.quantity {
            Quantity::Position => self.part.of((s.link_pose[i] * nalgebra::Point3::from(self.point)).coords),
            Quantity::Velocity => {
                let t = s.link_twist[i];
                self.part.of(s.link_pose[i].rotation * (t.linear + t.angular.cross(&self.point)))
            }
            Quantity::AngularVelocity => self.part.of(s.link_pose[i].rotation * s.link_twist[i].angular),
            Quantity::ContactForce => self.part.of(s.link_wrench[i].force),
            Quantity::AxisPosition | Quantity::CrossingTime => one(s.position[i]),
            Quantity::AxisSpeed => one(s.velocity[i]),
            Quantity::AxisEffort => one(s.effort[i]),
            Quantity::KineticEnergy => one(s.kinetic_energy),
            Quantity::KineticEnergyRatio => one(s.kinetic_energy / start.kinetic),
            Quantity::TotalEnergy => one(s.kinetic_energy + s.potential_energy),
            Quantity::EnergyGain => one(s.kinetic_energy + s.potential_energy - start.total),
            Quantity::EnergyUnaccounted => one(unaccounted(w, start.total)),
            Quantity::Momentum => self.part.of(w.momentum().linear),
            Quantity::AngularMomentum => self.part.of(w.momentum().angular),
            Quantity::AngularMomentumRatio => one(w.momentum().angular.norm() / start.momentum.angular.norm()),
            Quantity::AngularMomentumTurn => one(turn(&w.momentum().angular, &start.momentum.angular)),
            Quantity::Penetration => one(s.stats.worst_penetration),
            Quantity::JointDrift => one(w.joint_drift()),
            Quantity::StopViolation => one(s.stats.worst_stop_violation),
        }
    }
}

/// Exact for small angles, too.
fn turn(a: &Vec3, b: &Vec3) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}

/// The index of a link or axis.
///
/// # Errors
/// Names those that there are.
pub(super) fn index(m: &Model, owner: Owner, of: Option<&str>) -> Result<usize, String> {
    let (kind, names): (&str, Vec<&str>) = match owner {
        Owner::World if of.is_some() => return Err("of: this quantity is that of the whole world; leave it out".into()),
        Owner::World => return Ok(0),
        Owner::Link => ("link", m.links.iter().map(|l| l.name.as_str()).collect()),
        Owner::Axis => ("axis", m.axes.iter().map(|a| a.name.as_str()).collect()),
    };
    let Some(of) = of else { return Err(format!("of is missing: which {kind}?")) };
    let unknown = || format!("of: there is no {kind} '{of}'; there are: {}", names.join(", "));
    names.iter().position(|name| *name == of).ok_or_else(unknown)
}
