//! Which effects a scene calls for. A stage whose effect is not called for is neither built nor run.

use super::Model;

/// Names for `--on` and `--off`, in the order of the fields of [`Effects`].
pub const EFFECT_NAMES: [&str; 12] = [
    "gravity",
    "damping",
    "friction",
    "limits",
    "drives",
    "rotor_inertia",
    "compliance",
    "mimic",
    "breaking",
    "body_damping",
    "contact",
    "deactivation",
];

/// What calls for each of them.
pub const EFFECT_CAUSES: [&str; EFFECT_NAMES.len()] = [
    "mass",
    "<dynamics damping>",
    "<dynamics friction>, <drive static_resistance>",
    "<limit>",
    "axes",
    "<drive rotor_inertia>",
    "<constraint cfm>",
    "<mimic>",
    "<constraint break_threshold>",
    "<damping>",
    "something to touch: a ground, a robot, a body",
    "<deactivate>",
];

/// One switch per effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    };
    /// The switches in the order of [`EFFECT_NAMES`].
    pub fn as_array(&self) -> [bool; EFFECT_NAMES.len()] {
        [
            self.gravity,
            self.damping,
            self.friction,
            self.limits,
            self.drives,
            self.rotor_inertia,
            self.compliance,
            self.mimic,
            self.breaking,
            self.body_damping,
            self.contact,
            self.deactivation,
        ]
    }
    /// Switches one effect; `false` if there is none of that name.
    #[must_use]
    pub fn switch(&mut self, name: &str, on: bool) -> bool {
        let field = match name {
            "gravity" => &mut self.gravity,
            "damping" => &mut self.damping,
            "friction" => &mut self.friction,
            "limits" => &mut self.limits,
            "drives" => &mut self.drives,
            "rotor_inertia" => &mut self.rotor_inertia,
            "compliance" => &mut self.compliance,
            "mimic" => &mut self.mimic,
            "breaking" => &mut self.breaking,
            "body_damping" => &mut self.body_damping,
            "contact" => &mut self.contact,
            "deactivation" => &mut self.deactivation,
            _ => return false,
        };
        *field = on;
        true
    }
}
