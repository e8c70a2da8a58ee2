//! Parts of stages that can be switched off by themselves.

use super::Effects;
use crate::model::{Collider, DriveLimits, Model, Surface};
use std::sync::Arc;

/// A part of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// `<dynamics friction>`.
    JointFriction,
    /// `<drive static_resistance>`; off, as much as the dynamic one.
    StaticResistance,
    /// `<drive dynamic_resistance>`.
    DynamicResistance,
    /// `<constraint stop_cfm>`; off, stops are hard.
    SoftStops,
    /// The torque of a drive falls with its speed; off, it is what is applied at every speed.
    TorqueSpeedLine,
    /// Motors without power brake (`<drive short_brake>`); off, they turn freely.
    ShortBrake,
    /// Servo commands; off, an axis that is to hold a position has no torque.
    Servo,
    /// Coulomb friction of contacts; rolling and spinning friction, which are products with it, go with it.
    ContactFriction,
    /// `<surface rolling_friction>`.
    RollingResistance,
    /// `<surface spinning_friction>`.
    SpinningFriction,
    /// `<surface restitution>`.
    Restitution,
    /// Steps are divided where bodies might pass through each other.
    ContinuousDetection,
}

impl Part {
    /// All of them with their names and the stages that they are parts of.
    pub const ALL: [(Self, &'static str, &'static str); 12] = [
        (Self::JointFriction, "joint_friction", "friction"),
        (Self::StaticResistance, "static_resistance", "friction"),
        (Self::DynamicResistance, "dynamic_resistance", "friction"),
        (Self::SoftStops, "soft_stops", "limits"),
        (Self::TorqueSpeedLine, "torque_speed_line", "drives"),
        (Self::ShortBrake, "short_brake", "drives"),
        (Self::Servo, "servo", "drives"),
        (Self::ContactFriction, "contact_friction", "contact"),
        (Self::RollingResistance, "rolling_resistance", "contact"),
        (Self::SpinningFriction, "spinning_friction", "contact"),
        (Self::Restitution, "restitution", "contact"),
        (Self::ContinuousDetection, "continuous_detection", "contact"),
    ];

    /// By name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, own, _)| *own == name).map(|(part, ..)| *part)
    }

    /// Name of the stage that it is a part of.
    pub fn stage(self) -> &'static str {
        Self::ALL.iter().find(|(part, ..)| *part == self).map_or("", |(_, _, stage)| stage)
    }
}

/// A set of parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts(u16);

impl Parts {
    /// None of them.
    pub const NONE: Self = Self(0);

    /// Is it in the set?
    #[inline(always)]
    pub fn has(self, part: Part) -> bool {
        self.0 & (1 << part as u16) != 0
    }

    /// Puts it in or takes it out.
    pub fn set(&mut self, part: Part, member: bool) {
        let bit = 1 << part as u16;
        self.0 = if member { self.0 | bit } else { self.0 & !bit };
    }
}

impl Effects {
    /// A drive without the resistances that are switched off.
    pub fn drive_in_force(&self, mut d: DriveLimits) -> DriveLimits {
        if self.off.has(Part::DynamicResistance) {
            d.dynamic_resistance = 0.0;
        }
        if self.off.has(Part::StaticResistance) {
            d.static_resistance = d.dynamic_resistance;
        }
        d
    }

    /// A surface without what is switched off.
    pub fn surface_in_force(&self, mut s: Surface) -> Surface {
        for (part, value) in [
            (Part::ContactFriction, &mut s.friction),
            (Part::RollingResistance, &mut s.rolling),
            (Part::SpinningFriction, &mut s.spinning),
            (Part::Restitution, &mut s.restitution),
        ] {
            if self.off.has(part) {
                *value = 0.0;
            }
        }
        s
    }
}

impl Model {
    /// What engines are to simulate: this model, or a copy without the numbers of parts that are switched off.
    pub fn in_force(self: &Arc<Self>) -> Arc<Self> {
        if self.effects.off == Parts::NONE {
            return self.clone();
        }
        let (mut m, effects) = (Self::clone(self), self.effects);
        for axis in &mut m.axes {
            axis.drive = effects.drive_in_force(axis.drive);
            if effects.off.has(Part::JointFriction) {
                axis.friction = 0.0;
            }
            if effects.off.has(Part::SoftStops) {
                axis.stop.cfm = 0.0;
            }
        }
        for collider in &mut m.colliders {
            collider.surface = effects.surface_in_force(collider.surface);
        }
        Arc::new(m)
    }

    /// Of all pairs of colliders that may move against each other: how they touch.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = ([&Collider; 2], Surface)> {
        let rest = move |i: usize| self.colliders[i + 1..].iter();
        let pairs = (self.colliders.iter().enumerate()).flat_map(move |(i, a)| rest(i).map(move |b| [a, b]));
        let may = pairs.filter(|[a, b]| self.seat_of(a).0 != self.seat_of(b).0);
        may.map(|[a, b]| ([a, b], a.surface.with(&b.surface)))
    }
}
