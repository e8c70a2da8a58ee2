//! Checked values of all parameters, and what they mean.

use super::table::{Definition, EFFECTS, Range, SWITCH, When, table};
use crate::model::{Base, EFFECT_NAMES};
use crate::ros::exchange::Pace;
use crate::ros::markers::MarkerSettings;
use crate::ros::watchdog::OnTimeout;
use crate::world::{EngineKind, Integrator, Settings};
use ros2_client::ParameterValue as V;

/// Names of the integrators; the first one is the default.
pub(super) const INTEGRATORS: [&str; Integrator::NAMES.len()] =
    [Integrator::NAMES[0].0, Integrator::NAMES[1].0, Integrator::NAMES[2].0, Integrator::NAMES[3].0];

/// Names of the engines, built in or not; the first one is the default.
pub(super) const ENGINES: [&str; EngineKind::NAMES.len()] =
    [EngineKind::NAMES[0].0, EngineKind::NAMES[1].0, EngineKind::NAMES[2].0, EngineKind::NAMES[3].0];

/// Every parameter with a value that its definition accepts.
#[derive(Clone, Debug)]
pub struct Values {
    definitions: Vec<Definition>,
    values: Vec<V>,
    /// Set before the start.
    given: Vec<bool>,
}

impl Default for Values {
    fn default() -> Self {
        let definitions = table();
        let values = definitions.iter().map(|d| d.default.clone()).collect();
        let given = vec![false; definitions.len()];
        Self { definitions, values, given }
    }
}

impl Values {
    /// Definitions with values, in the order of the table.
    pub fn iter(&self) -> impl Iterator<Item = (&Definition, &V)> {
        self.definitions.iter().zip(&self.values)
    }

    /// Definition and value of `name`.
    pub fn get(&self, name: &str) -> Option<(&Definition, &V)> {
        self.iter().find(|(d, _)| d.name == name)
    }

    /// Sets a parameter before the start. An integer will do for a double. `Err` says what is wrong with it.
    pub fn set_at_start(&mut self, name: &str, value: V) -> Result<(), String> {
        let index = self.index(name)?;
        let definition = &self.definitions[index];
        if definition.when == When::Never {
            return Err(format!("parameter '{name}' is read-only"));
        }
        let value = widen(value, definition);
        definition.check(&value)?;
        self.replace(index, value)?;
        self.given[index] = true;
        Ok(())
    }

    /// Takes settings from a scene, where they were not given as parameters. `Err`: the world does not accept them together.
    pub fn adopt(&mut self, settings: &Settings, names: &[&'static str]) -> Result<(), String> {
        for name in names {
            let index = self.index(name)?;
            let value = match *name {
                "control_interval" => V::Double(settings.control_interval_ns as f64 * 1e-9),
                "steps_per_interval" => V::Integer(settings.steps_per_interval.into()),
                "solver_iterations" => V::Integer(settings.solver_iterations.into()),
                "time_scale" => V::Double(settings.time_scale),
                "gravity" => V::DoubleArray(settings.gravity.to_vec()),
                "integrator" => V::String(settings.integrator.name().into()),
                "engine" => V::String(settings.engine.name().into()),
                "accuracy" => V::Double(settings.accuracy),
                _ => continue,
            };
            if !self.given[index] {
                self.replace(index, value)?;
            }
        }
        Ok(())
    }

    /// True if the parameter was set before the start.
    pub fn is_given(&self, name: &str) -> bool {
        self.index(name).is_ok_and(|index| self.given[index])
    }

    /// `start: paused` is `paused: true` from the start.
    pub fn pause_at_start(&mut self) -> Result<(), String> {
        if self.text("start") == "paused" { self.set_running("paused", V::Boolean(true)) } else { Ok(()) }
    }

    /// Parameter `scene`; `None` if there is none.
    pub fn scene(&self) -> Option<&std::path::Path> {
        Some(self.text("scene")).filter(|s| !s.is_empty()).map(std::path::Path::new)
    }

    /// Parameter `ground`.
    pub fn ground(&self) -> bool {
        self.flag("ground")
    }

    /// Effects that parameters `effects.NAME` switch: the parameter, the effect, and whether it is on.
    pub fn effects(&self) -> impl Iterator<Item = (&'static str, &'static str, bool)> {
        let switched = |name: &'static str| match self.text(name) {
            "on" => Some(true),
            "off" => Some(false),
            _ => None,
        };
        EFFECTS.into_iter().zip(EFFECT_NAMES).filter_map(move |(name, effect)| Some((name, effect, switched(name)?)))
    }

    /// Sets a parameter of a running node. `Err` says what is wrong with it; nothing has changed then.
    pub fn set_running(&mut self, name: &str, value: V) -> Result<(), String> {
        let index = self.index(name)?;
        let definition = &self.definitions[index];
        definition.check(&value)?;
        if definition.when != When::Always && value != self.values[index] {
            let when = definition.when_text();
            return Err(format!("parameter '{name}' cannot be set to {} now: {when}", super::show(&value)));
        }
        self.replace(index, value)
    }

    /// The world has the last word on its settings.
    fn replace(&mut self, index: usize, value: V) -> Result<(), String> {
        let present = std::mem::replace(&mut self.values[index], value);
        let checked = self.pace().settings.check();
        if checked.is_err() {
            self.values[index] = present;
        }
        checked
    }

    /// Fills in the read-only list of axes.
    pub fn set_axes(&mut self, names: Vec<String>) {
        if let Ok(index) = self.index("axes") {
            self.values[index] = V::StringArray(names);
        }
    }

    /// Settings of the world and pace of the loop.
    pub fn pace(&self) -> Pace {
        let gravity = match self.value("gravity") {
            V::DoubleArray(a) if a.len() == 3 => [a[0], a[1], a[2]],
            _ => Settings::default().gravity,
        };
        let settings = Settings {
            control_interval_ns: (self.double("control_interval") * 1e9).round() as i64,
            steps_per_interval: self.integer("steps_per_interval") as u32,
            solver_iterations: self.integer("solver_iterations") as u32,
            time_scale: self.double("time_scale"),
            gravity,
            integrator: Integrator::by_name(self.text("integrator")).unwrap_or_default(),
            engine: EngineKind::by_name(self.text("engine")).unwrap_or_default(),
            accuracy: self.double("accuracy"),
        };
        Pace {
            settings,
            paused: self.flag("paused"),
            real_time_factor: self.double("real_time_factor"),
            max_catch_up: self.integer("max_catch_up") as u32,
            reset_joints: self.flag("reset_joints"),
            reset_at_start: self.flag("reset_at_start"),
            estimate_error: self.flag("estimate_error"),
            lockstep: self.flag("lockstep"),
            lockstep_timeout_ns: (self.double("lockstep_timeout") * 1e9).round() as u64,
            command_timeout_ns: (self.double("command_timeout") * 1e9).round() as i64,
            on_timeout: OnTimeout::by_name(self.text("on_timeout")),
            allow_mode_switch: self.allow_mode_switch(),
        }
    }

    /// Parameter `base`.
    pub fn base(&self) -> Base {
        if self.text("base") == "free" { Base::Free } else { Base::Fixed }
    }

    /// Parameter `start`: do the axes hold their initial position?
    pub fn hold_at_start(&self) -> bool {
        self.text("start") != "free"
    }

    /// Parameter `allow_mode_switch`.
    pub fn allow_mode_switch(&self) -> bool {
        self.flag("allow_mode_switch")
    }

    /// Parameter `allow_shared_topics`.
    pub fn allow_shared_topics(&self) -> bool {
        self.flag("allow_shared_topics")
    }

    /// Parameter `tf_rate`, Hz.
    pub fn tf_rate(&self) -> f64 {
        self.double("tf_rate")
    }

    /// Parameter `ros2_control`: auto, always or never.
    pub fn ros2_control(&self) -> &str {
        self.text("ros2_control")
    }

    /// Parameters `markers…`.
    pub fn markers(&self) -> MarkerSettings {
        let kinds = if let V::StringArray(kinds) = self.value("markers") { kinds.as_slice() } else { &[] };
        let color = match self.value("markers_color") {
            V::DoubleArray(c) if c.len() == 4 => [c[0], c[1], c[2], c[3]],
            _ => [1.0; 4],
        };
        MarkerSettings::new(self.double("markers_rate"), kinds, self.double("markers_size"), color)
    }

    /// Parameter `realtime_priority`.
    pub fn realtime_priority(&self) -> i32 {
        self.integer("realtime_priority") as i32
    }

    fn index(&self, name: &str) -> Result<usize, String> {
        self.definitions.iter().position(|d| d.name == name).ok_or_else(|| {
            let names: Vec<_> = self.definitions.iter().map(|d| d.name).collect();
            format!("there is no parameter '{name}'; there are: {}", names.join(", "))
        })
    }

    fn value(&self, name: &str) -> &V {
        self.get(name).map_or(&V::NotSet, |(_, value)| value)
    }

    fn flag(&self, name: &str) -> bool {
        *self.value(name) == V::Boolean(true)
    }

    // The check has made sure of the types, so the fallbacks below are never used.
    fn double(&self, name: &str) -> f64 {
        if let V::Double(d) = self.value(name) { *d } else { f64::NAN }
    }

    fn integer(&self, name: &str) -> i64 {
        if let V::Integer(i) = self.value(name) { *i } else { 0 }
    }

    fn text(&self, name: &str) -> &str {
        if let V::String(s) = self.value(name) { s } else { "" }
    }
}

/// On the command line and in YAML, `1` may stand for `1.0`; and `on` and `off`, unquoted, may be read as truth values.
fn widen(value: V, definition: &Definition) -> V {
    match (value, &definition.default) {
        (V::Boolean(on), V::String(_)) if definition.range == Range::OneOf(&SWITCH) => {
            V::String(if on { "on" } else { "off" }.into())
        }
        (V::Integer(i), V::Double(_)) => V::Double(i as f64),
        (V::IntegerArray(a), V::DoubleArray(_)) => V::DoubleArray(a.into_iter().map(|i| i as f64).collect()),
        (value, _) => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_accepted_by_their_own_definitions() {
        for (definition, value) in Values::default().iter() {
            definition.check(value).unwrap();
        }
    }

    #[test]
    fn default_settings_are_those_of_the_world() {
        assert_eq!(Values::default().pace().settings, Settings::default());
    }

    #[test]
    fn a_refusal_names_parameter_value_and_range() {
        let mut values = Values::default();
        let reason = values.set_running("steps_per_interval", V::Integer(0)).unwrap_err();
        assert_eq!(reason, "parameter 'steps_per_interval' = 0 is out of range: 1 … 1000");
        let reason = values.set_running("time_scale", V::Double(f64::NAN)).unwrap_err();
        assert!(reason.contains("NaN") && reason.contains("0.0 … 100.0"), "{reason}");
        let reason = values.set_running("gravity", V::DoubleArray(vec![0.0])).unwrap_err();
        assert!(reason.contains("3 finite numbers m/s^2"), "{reason}");
        let reason = values.set_running("gravity", V::DoubleArray(vec![0.0, 0.0, 1e9])).unwrap_err();
        assert!(reason.contains("gravity z") && reason.contains("1000"), "{reason}");
        assert!(values.set_running("nonsense", V::Integer(0)).unwrap_err().contains("there is no parameter"));
        assert_eq!(values.pace().settings, Settings::default());
    }

    #[test]
    fn only_the_start_accepts_start_parameters_and_integers_for_doubles() {
        let mut values = Values::default();
        values.set_at_start("base", V::String("free".into())).unwrap();
        assert_eq!(values.base(), Base::Free);
        assert!(values.set_running("base", V::String("fixed".into())).unwrap_err().contains("at start only"));
        values.set_at_start("tf_rate", V::Integer(10)).unwrap();
        assert_eq!(values.tf_rate(), 10.0);
        assert!(values.set_running("tf_rate", V::Integer(10)).unwrap_err().contains("type double"));
        assert!(values.set_at_start("axes", V::StringArray(vec![])).unwrap_err().contains("read-only"));
    }

    #[test]
    fn the_engine_may_change_while_running() {
        let mut values = Values::default();
        for (name, kind) in EngineKind::NAMES {
            let set = values.set_running("engine", V::String(name.into()));
            // One that is not built in says how to build it.
            match kind.available() {
                Ok(()) => assert_eq!(values.pace().settings.engine, kind),
                Err(reason) => assert_eq!(set.unwrap_err(), reason),
            }
        }
        assert!(values.set_running("engine", V::String("newton".into())).unwrap_err().contains("rapier"));
    }

    #[test]
    fn every_integrator_has_its_name() {
        let mut values = Values::default();
        values.set_running("integrator", V::String("rk4".into())).unwrap();
        assert_eq!(values.pace().settings.integrator, Integrator::Rk4);
        assert!(values.set_running("integrator", V::String("rk45".into())).is_err());
    }
}
