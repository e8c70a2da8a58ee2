//! Which effects a scene calls for. A stage whose effect is not called for is neither built nor run.
//!
//! An effect is a field of [`Effects`] that says whether its stage is there, or a [`Part`] of such a one. Parts are on unless they
//! are switched off, and cost nothing where nothing calls for them: most of them are numbers of the model (a coefficient, a
//! resistance), and a part that is off is that number set to zero before an engine sees it ([`Model::in_force`]), so no step asks.

mod causes;
mod list;
mod parts;

use super::Model;
pub use list::{EFFECTS, Effect, Kind, Listed};
pub use parts::{Part, Parts};

/// Names for `--on`, `--off`, scenes and parameters: the effects of [`EFFECTS`] that can be switched, in that order.
pub const EFFECT_NAMES: [&str; 24] = [
    "gravity",
    "damping",
    "friction",
    "joint_friction",
    "static_resistance",
    "dynamic_resistance",
    "limits",
    "soft_stops",
    "drives",
    "torque_speed_line",
    "short_brake",
    "servo",
    "rotor_inertia",
    "compliance",
    "mimic",
    "breaking",
    "body_damping",
    "contact",
    "contact_friction",
    "rolling_resistance",
    "spinning_friction",
    "restitution",
    "continuous_detection",
    "deactivation",
];

/// Of the switch of a stage.
type Field = fn(&mut Effects) -> &mut bool;

/// One switch per stage, and the parts of stages that are switched off.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Effects {
    /// Weight.
    pub gravity: bool,
    /// Viscous damping of the axes (`<dynamics damping>`).
    pub damping: bool,
    /// Dry friction of the axes: `<dynamics friction>`, static and dynamic resistance.
    pub friction: bool,
    /// Stops (`<limit lower upper>`).
    pub limits: bool,
    /// Drives: applied torques and servos.
    pub drives: bool,
    /// Reflected inertia of the motors (`<drive rotor_inertia gear_ratio>`).
    pub rotor_inertia: bool,
    /// Soft joints (`<constraint cfm>`); off, they are hard.
    pub compliance: bool,
    /// Axes that follow others (`<mimic>`); off, they move by themselves.
    pub mimic: bool,
    /// Joints that come apart (`<constraint break_threshold>`).
    pub breaking: bool,
    /// Damping of bodies (`<damping>`).
    pub body_damping: bool,
    /// Contacts of bodies with each other and with the ground.
    pub contact: bool,
    /// Bodies at rest leave the computation (`<deactivate>`).
    pub deactivation: bool,
    /// Parts of these that are switched off.
    pub off: Parts,
}

/// The digest of a model is one of this text: parts are shown only where one is off, so that bags from before there were any are
/// still known as those of their model.
impl std::fmt::Debug for Effects {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let mut shown = f.debug_struct("Effects");
        for (name, _) in Self::STAGES {
            shown.field(name, &self.is_on(name).unwrap_or(false));
        }
        if self.off != Parts::NONE {
            shown.field("off", &self.off);
        }
        shown.finish()
    }
}

impl Effects {
    /// What the scene calls for.
    pub fn called_for(m: &Model) -> Self {
        let any = |used: fn(&super::Axis) -> bool| m.axes.iter().any(used);
        Self {
            gravity: m.bodies[1..].iter().any(|b| b.mass > 0.0),
            damping: any(|a| a.damping > 0.0),
            friction: any(|a| a.friction > 0.0 || a.drive.static_resistance > 0.0),
            limits: any(|a| a.lower.is_finite() || a.upper.is_finite()),
            drives: !m.axes.is_empty(),
            rotor_inertia: any(|a| a.drive.rotor_inertia > 0.0),
            compliance: m.softs.iter().any(|s| s.softness.cfm > 0.0),
            mimic: !m.couplings.is_empty(),
            breaking: !m.breakables.is_empty(),
            body_damping: !m.dampings.is_empty(),
            contact: m.colliders.len() > 1,
            deactivation: m.links.iter().any(|l| l.deactivation.is_some()),
            off: Parts::NONE,
        }
    }

    /// No effect at all.
    pub const NONE: Self = Self {
        gravity: false,
        damping: false,
        friction: false,
        limits: false,
        drives: false,
        rotor_inertia: false,
        compliance: false,
        mimic: false,
        breaking: false,
        body_damping: false,
        contact: false,
        deactivation: false,
        off: Parts::NONE,
    };

    /// Is an effect that can be switched on? A part is on if it is not switched off and its stage is on. `None` if there is none of
    /// that name.
    pub fn is_on(&self, name: &str) -> Option<bool> {
        if let Some(part) = Part::named(name) {
            return Some(!self.off.has(part) && self.is_on(part.stage())?);
        }
        let mut copy = *self;
        copy.stage(name).map(|on| *on)
    }

    /// Switches one effect; `false` if there is none of that name.
    #[must_use]
    pub fn switch(&mut self, name: &str, on: bool) -> bool {
        if let Some(part) = Part::named(name) {
            self.off.set(part, !on);
            return true;
        }
        self.stage(name).map(|switch| *switch = on).is_some()
    }

    fn stage(&mut self, name: &str) -> Option<&mut bool> {
        Self::STAGES.iter().find(|(own, _)| *own == name).map(|(_, field)| field(self))
    }

    /// The stages in the order of the fields.
    const STAGES: [(&'static str, Field); 12] = [
        ("gravity", |e| &mut e.gravity),
        ("damping", |e| &mut e.damping),
        ("friction", |e| &mut e.friction),
        ("limits", |e| &mut e.limits),
        ("drives", |e| &mut e.drives),
        ("rotor_inertia", |e| &mut e.rotor_inertia),
        ("compliance", |e| &mut e.compliance),
        ("mimic", |e| &mut e.mimic),
        ("breaking", |e| &mut e.breaking),
        ("body_damping", |e| &mut e.body_damping),
        ("contact", |e| &mut e.contact),
        ("deactivation", |e| &mut e.deactivation),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_list_and_each_is_switched() {
        let switched: Vec<&str> = EFFECTS.iter().filter(|e| e.kind == Kind::Switched).map(|e| e.name).collect();
        assert_eq!(switched, EFFECT_NAMES);
        let mut names: Vec<&str> = EFFECTS.iter().map(|e| e.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), EFFECTS.len());
        for name in EFFECT_NAMES {
            let mut e = Effects::NONE;
            if let Some(part) = Part::named(name) {
                assert!(e.switch(part.stage(), true) && e.is_on(name) == Some(true), "{name} is on with its stage");
            }
            for on in [false, true] {
                assert!(e.switch(name, on));
                assert_eq!(e.is_on(name), Some(on), "{name}");
            }
        }
        assert!(!Effects::NONE.clone().switch("magic", true) && Effects::NONE.is_on("magic").is_none());
    }

    /// Written into bags by programs that knew no parts.
    #[test]
    fn the_text_of_effects_without_switched_parts_is_as_it_was() {
        let mut e = Effects { gravity: true, ..Effects::NONE };
        let old = "Effects { gravity: true, damping: false, friction: false, limits: false, drives: false, rotor_inertia: false, \
                   compliance: false, mimic: false, breaking: false, body_damping: false, contact: false, deactivation: false }";
        assert_eq!(format!("{e:?}"), old);
        assert!(e.switch("servo", false));
        assert_ne!(format!("{e:?}"), old);
    }
}
