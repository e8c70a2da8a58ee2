//! Which effects a scene calls for. A stage whose effect is not called for is neither built nor run.

use super::{Axis, Body};

/// Names for `--on` and `--off`, in the order of the fields of [`Effects`].
pub const EFFECT_NAMES: [&str; 5] = ["gravity", "damping", "friction", "limits", "drives"];

/// One switch per effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// Weight.
    pub gravity: bool,
    /// Viscous damping of the axes (`<dynamics damping>`).
    pub damping: bool,
    /// Coulomb friction of the axes (`<dynamics friction>`).
    pub friction: bool,
    /// Stops (`<limit lower upper>`).
    pub limits: bool,
    /// Drives: applied torques and servos.
    pub drives: bool,
}

impl Effects {
    /// What the scene calls for.
    pub fn called_for(axes: &[Axis], bodies: &[Body]) -> Self {
        Self {
            gravity: bodies[1..].iter().any(|b| b.mass > 0.0),
            damping: axes.iter().any(|a| a.damping > 0.0),
            friction: axes.iter().any(|a| a.friction > 0.0),
            limits: axes.iter().any(|a| a.lower.is_finite() || a.upper.is_finite()),
            drives: !axes.is_empty(),
        }
    }
    /// The switches in the order of [`EFFECT_NAMES`].
    pub fn as_array(&self) -> [bool; 5] {
        [self.gravity, self.damping, self.friction, self.limits, self.drives]
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
            _ => return false,
        };
        *field = on;
        true
    }
}
