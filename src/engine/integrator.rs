//! Which integrators there are.

/// How the state is advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Second order, the same forwards and backwards in time, so that the energy of free motion does not drift; damping,
    /// servos, stops and friction implicit. It iterates; a step whose iteration does not contract is halved, and counted.
    /// The default.
    #[default]
    ImplicitMidpoint,
    /// First order; damping, servos, stops and friction implicit, the velocity products explicit. Steps of which it would make energy
    /// (light limbs that whirl, light links between heavy ones), or what is left of them, are made by the default instead, and counted.
    SemiImplicitEuler,
    /// Classical fourth order; axes that stand still stand. Steps in which an axis begins or ceases to stand (in its dry
    /// friction, at a stop, at a servo's target), a servo is on its way, or a viscous term or a whirl is stiffer than the
    /// step, are made by the default instead, and counted.
    Rk4,
    /// Order 4 to 20, by extrapolation (Gragg–Bulirsch–Stoer): order and pieces of a step follow from `accuracy`. Smooth up to an
    /// event (an axis reaches a stop, begins or ceases to stand; bodies begin to touch), and smooth behind it. What is not smooth
    /// all the time is made by the default, and counted.
    Extrapolation,
}

impl Integrator {
    /// Names for `--integrator` and the parameter `integrator`.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("implicit_midpoint", Self::ImplicitMidpoint),
        ("semi_implicit_euler", Self::SemiImplicitEuler),
        ("rk4", Self::Rk4),
        ("extrapolation", Self::Extrapolation),
    ];

    /// By name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(n, _)| *n == name).map(|(_, i)| *i)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, i)| *i == self).map_or("", |(n, _)| n)
    }
}
