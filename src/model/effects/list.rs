//! Every effect there is: what it is, what calls for it, and whether it can be switched.

use super::causes::{self, Cause};
use super::{Model, Part};

/// How an effect comes into a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Called for by the scene; `--on`, `--off`, `effects.NAME`.
    Switched,
    /// Called for by the scene alone. The text says why there is no switch.
    Derived(&'static str),
    /// Made while somebody asks for it, outside of the steps. The text says who.
    OnDemand(&'static str),
}

/// One effect.
#[derive(Clone, Copy)]
pub struct Effect {
    /// As `--off` takes it.
    pub name: &'static str,
    /// One line.
    pub what: &'static str,
    /// Whether it can be switched.
    pub kind: Kind,
    pub(super) cause: fn(&Model) -> Cause,
}

/// An effect in a scene.
#[derive(Clone)]
pub struct Listed {
    /// Which.
    pub effect: &'static Effect,
    /// Does something in the scene call for it?
    pub called_for: bool,
    /// What calls for it, with names; what would, where nothing does.
    pub by: String,
    /// Is it simulated? A stage that is on though nothing calls for it has nothing to do.
    pub on: bool,
}

impl Listed {
    /// Would it be simulated, if it were not switched off?
    pub fn is_switched_off(&self) -> bool {
        self.called_for && !self.on && self.effect.kind == Kind::Switched
    }
}

impl Model {
    /// Every effect, and what this scene calls for.
    pub fn listed_effects(&self) -> Vec<Listed> {
        let listed = |effect: &'static Effect| {
            let cause = (effect.cause)(self);
            let on = match effect.kind {
                Kind::Switched => {
                    let part = Part::named(effect.name).is_some();
                    self.effects.is_on(effect.name).unwrap_or(false) && (cause.called_for || !part)
                }
                Kind::Derived(_) => cause.called_for,
                Kind::OnDemand(_) => false,
            };
            Listed { effect, called_for: cause.called_for, by: cause.by, on }
        };
        EFFECTS.iter().map(listed).collect()
    }
}

const fn switched(name: &'static str, what: &'static str, cause: fn(&Model) -> Cause) -> Effect {
    Effect { name, what, kind: Kind::Switched, cause }
}

const fn derived(name: &'static str, what: &'static str, why: &'static str, cause: fn(&Model) -> Cause) -> Effect {
    Effect { name, what, kind: Kind::Derived(why), cause }
}

const fn on_demand(name: &'static str, what: &'static str, who: &'static str) -> Effect {
    Effect { name, what, kind: Kind::OnDemand(who), cause: causes::nobody }
}

/// All of them. Those that can be switched are in the order of [`super::EFFECT_NAMES`].
pub const EFFECTS: [Effect; 38] = [
    switched("gravity", "weight of the bodies", causes::gravity),
    derived(
        "velocity_products",
        "Coriolis, centrifugal and gyroscopic forces of bodies that turn",
        "they are part of the equations of motion; where nothing turns, they are zero",
        causes::velocity_products,
    ),
    switched("damping", "viscous damping of the axes", causes::damping),
    switched("friction", "dry friction of the axes, of the three kinds that follow", causes::friction),
    switched("joint_friction", "dry friction that is the same at rest and in motion", causes::joint_friction),
    switched(
        "static_resistance",
        "what a drive that stands resists beyond its dynamic resistance",
        causes::static_resistance,
    ),
    switched("dynamic_resistance", "what a drive that turns resists", causes::dynamic_resistance),
    switched("limits", "stops, hard or soft", causes::limits),
    switched("soft_stops", "stops that yield; off, they are hard", causes::soft_stops),
    switched("drives", "drives; off, commands have no effect", causes::drives),
    switched("torque_speed_line", "the torque of a drive falls with its speed", causes::torque_speed_line),
    switched("short_brake", "a drive without power brakes", causes::short_brake),
    switched("servo", "axes that hold a position; off, they have no torque", causes::servo),
    switched("rotor_inertia", "reflected inertia of the motors", causes::rotor_inertia),
    switched("compliance", "joints that yield; off, they are hard", causes::compliance),
    switched("mimic", "axes that follow others; off, they move by themselves", causes::mimic),
    derived(
        "poles",
        "joint groups with angles that are near their pole",
        "without it a group could not be moved through its pole",
        causes::poles,
    ),
    switched("breaking", "joints that come apart", causes::breaking),
    switched("body_damping", "bodies lose velocity", causes::body_damping),
    switched("contact", "bodies cannot go through each other and the ground", causes::contact),
    switched(
        "contact_friction",
        "Coulomb friction of contacts; rolling and spinning friction go with it",
        causes::contact_friction,
    ),
    switched("rolling_resistance", "contacts resist rolling", causes::rolling_resistance),
    switched("spinning_friction", "contacts resist turning about their normal", causes::spinning_friction),
    switched("restitution", "bodies bounce", causes::restitution),
    switched(
        "continuous_detection",
        "steps are divided where bodies might pass through each other",
        causes::continuous_detection,
    ),
    derived(
        "pushing_apart",
        "penetrations are taken back by a position pass",
        "without it bodies would sink into each other",
        causes::contact,
    ),
    derived(
        "contact_books",
        "forces of contacts on bodies, and the energy that they take",
        "joints, monitors and the energy balance read them",
        causes::contact,
    ),
    derived(
        "energy_bound",
        "contacts do not end a step with more energy than was paid for",
        "without it contacts could make energy out of the error of the step",
        causes::contact,
    ),
    switched("deactivation", "bodies at rest leave the computation", causes::deactivation),
    derived(
        "step_guard",
        "steps that do not contract are halved, pieces that gain energy slowed down and counted",
        "without it light limbs that whirl would diverge",
        causes::velocity_products,
    ),
    on_demand(
        "link_monitors",
        "poses, twists and inertial values of links",
        "subscribers of twist/LINK and body_states",
    ),
    on_demand("joint_monitors", "values of what each axis moves", "subscribers of joint_monitors"),
    on_demand("contact_wrenches", "contacts and forces as messages", "subscribers of contacts; simulate --contacts"),
    on_demand("transforms", "/tf", "the parameter tf_rate"),
    on_demand("markers", "debug/markers", "subscribers of debug/markers"),
    on_demand("diagnostics", "timing, memory, counters as /diagnostics", "the clock, once a second"),
    on_demand("recording", "a bag of all that is published", "run --record, the service record"),
    on_demand("replay_log", "commands and orders, from which a run can be made again", "run --record"),
];
