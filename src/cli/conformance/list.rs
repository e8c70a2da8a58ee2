//! The engines there are: in this program or how to get them, and what they can.

use crate::engine::{Capabilities, EngineKind};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// A capability of an engine.
pub(super) struct Ability {
    /// In case files and JSON.
    pub name: &'static str,
    /// For people.
    pub means: &'static str,
    pub can: bool,
}

/// Every field of [`Capabilities`].
pub(super) fn abilities(c: &Capabilities) -> [Ability; 9] {
    // Taken apart, so that a new field cannot be forgotten here.
    let Capabilities {
        exact_copy,
        joints,
        reduced_coordinates,
        integrators,
        couplings,
        softness,
        rotor_inertia,
        breaking,
        rolling_friction,
    } = *c;
    let all = [
        ("exact_copy", "a copy goes on with the same bits", exact_copy),
        ("joints", "links and joints; else only bodies that no joint holds", joints),
        ("reduced_coordinates", "joints cannot drift apart", reduced_coordinates),
        ("integrators", "the chosen integrator; else it has its own", integrators),
        ("couplings", "<mimic>", couplings),
        ("softness", "<constraint cfm>: joints that yield", softness),
        ("rotor_inertia", "<drive rotor_inertia>", rotor_inertia),
        ("breaking", "<constraint break_threshold>", breaking),
        ("rolling_friction", "<surface rolling_friction spinning_friction>", rolling_friction),
    ];
    all.map(|(name, means, can)| Ability { name, means, can })
}

/// As a table.
pub(super) fn table() -> String {
    let mut text = String::new();
    for (name, kind) in EngineKind::NAMES {
        let there = kind.available().map_or_else(|how| how, |()| "in this program".into());
        let _ = writeln!(text, "{name:<8} {there}");
    }
    let _ = write!(text, "\n{:<20}", "capability");
    EngineKind::NAMES.iter().for_each(|(name, _)| text += &format!(" {name:<7}"));
    text += " \n";
    let all = EngineKind::NAMES.map(|(_, kind)| abilities(&kind.capabilities()));
    for (i, ability) in all[0].iter().enumerate() {
        let _ = write!(text, "{:<20}", ability.name);
        all.iter().for_each(|engine| text += &format!(" {:<7}", if engine[i].can { "yes" } else { "-" }));
        let _ = writeln!(text, " {}", ability.means);
    }
    text
}

/// The same for programs.
pub(super) fn json() -> Value {
    let one = |(name, kind): (&str, EngineKind)| {
        let can: Map<String, Value> =
            abilities(&kind.capabilities()).iter().map(|a| (a.name.into(), json!(a.can))).collect();
        json!({"name": name, "built": kind.available().is_ok(), "to_have_it": kind.available().err(), "capabilities": can})
    };
    json!({"engines": EngineKind::NAMES.map(one)})
}
