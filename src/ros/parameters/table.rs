//! The table of parameters.

use super::show;
use crate::model::EFFECT_NAMES;
use crate::ros::markers::KIND_NAMES;
use crate::ros::watchdog::OnTimeout;
use crate::world::{ACCURACY, Settings};
use ros2_client::ParameterValue as V;

/// When a parameter may be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// At start and while running.
    Always,
    /// At start only.
    Start,
    /// Never; it tells something.
    Never,
}

/// Accepted values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any value of the type.
    Any,
    /// Both ends included.
    Integer(i64, i64),
    /// Both ends included.
    Double(f64, f64),
    /// One of these strings.
    OneOf(&'static [&'static str]),
    /// This many finite numbers.
    Numbers(usize),
    /// This many numbers, each in this range.
    NumbersIn(usize, f64, f64),
    /// Any of these strings.
    SomeOf(&'static [&'static str]),
}

/// One parameter.
#[derive(Clone, Debug)]
pub struct Definition {
    /// Name.
    pub name: &'static str,
    /// Default; its type is the parameter's type.
    pub default: V,
    /// Accepted values.
    pub range: Range,
    /// Unit; empty where there is none.
    pub unit: &'static str,
    /// One or two sentences.
    pub doc: &'static str,
    /// When it may be set.
    pub when: When,
}

/// Every parameter, in the order in which they are documented.
pub fn table() -> Vec<Definition> {
    let mut all = world_parameters();
    all.extend(start_parameters());
    all.extend(loop_parameters());
    all.extend(reset_parameters());
    all.extend(command_parameters());
    all.extend(marker_parameters());
    all.extend(effect_parameters());
    all
}

fn world_parameters() -> Vec<Definition> {
    use When::Always;
    let s = Settings::default();
    vec![
        define(
            "control_interval",
            V::Double(s.control_interval_ns as f64 * 1e-9),
            Range::Double(1e-6, 1.0),
            "s",
            Always,
        )
        .doc("Simulated time between two states, before time_scale."),
        define("steps_per_interval", V::Integer(s.steps_per_interval.into()), Range::Integer(1, 1000), "", Always)
            .doc("Physics steps per control interval."),
        define("solver_iterations", V::Integer(s.solver_iterations.into()), Range::Integer(1, 10_000), "", Always)
            .doc("Iterations of the constraint solver per step."),
        define("time_scale", V::Double(s.time_scale), Range::Double(0.0, 100.0), "", Always)
            .doc("Factor on the simulated time of an interval; 0 stops time."),
        define("gravity", V::DoubleArray(s.gravity.to_vec()), Range::Numbers(3), "m/s^2", Always)
            .doc("Acceleration of gravity in the world frame, Z up."),
        define(
            "integrator",
            V::String(super::values::INTEGRATORS[0].into()),
            Range::OneOf(&super::values::INTEGRATORS),
            "",
            Always,
        )
        .doc("How the state is advanced."),
        define("accuracy", V::Double(s.accuracy), Range::Double(ACCURACY.0, ACCURACY.1), "", Always).doc(
            "Of the integrator extrapolation: error that it may make per second, relative to 1 rad, m, rad/s, m/s and the coordinate.",
        ),
        define("estimate_error", V::Boolean(false), Range::Any, "", Always).doc(
            "Makes every control interval again with half the step, and tells in /diagnostics what it was off by; costs some three times the step time.",
        ),
    ]
}

fn start_parameters() -> Vec<Definition> {
    use When::{Always, Never, Start};
    vec![
        define("engine", V::String(super::values::ENGINES[0].into()), Range::OneOf(&super::values::ENGINES), "", Always)
            .doc("Dynamics engine. Another one goes on from the present state; building it takes some milliseconds."),
        define("base", V::String("fixed".into()), Range::OneOf(&["fixed", "free"]), "", Start)
            .doc("fixed: the root link is held on a test stand; free: it has six degrees of freedom."),
        define("scene", V::String(String::new()), Range::Any, "", Start)
            .doc("Scene file (YAML): robots, bodies and the ground beside the robot, and world settings that parameters given win over."),
        define("ground", V::Boolean(false), Range::Any, "", Start)
            .doc("The flat ground z = 0, where the scene has none of its own."),
        define("axes", V::StringArray(vec![]), Range::Any, "", Never)
            .doc("Axis names in the order of effort_command and servo_command; from the URDF."),
        define("start", V::String("hold".into()), Range::OneOf(&["hold", "free", "paused"]), "", Start)
            .doc("hold: every axis whose drive may switch servos at its initial position until it is commanded; free: each axis starts in the mode of its <drive> tag; paused: as hold, and time stands until paused is set to false."),
        define("paused", V::Boolean(false), Range::Any, "", Always)
            .doc("Time stands still; /clock, /tf and the topics of the state are repeated all the same."),
        define("allow_mode_switch", V::Boolean(true), Range::Any, "", Always)
            .doc("May a command switch an axis between idle, torque and servo mode? The switchable attribute of its <drive> tag must allow it, too."),
        define("ros2_control", V::String("auto".into()), Range::OneOf(&["auto", "always", "never"]), "", Start)
            .doc("Topics for ros2_control's joint_state_topic_hardware_interface. auto: if the URDF has a <ros2_control> block with a plug-in that speaks over topics; always: even without one, then for all axes; never: not at all."),
    ]
}

fn loop_parameters() -> Vec<Definition> {
    use When::{Always, Start};
    vec![
        define("tf_rate", V::Double(50.0), Range::Double(0.0, 10_000.0), "Hz", Always)
            .doc("Rate of /tf in simulated time; 0: none."),
        define("max_catch_up", V::Integer(100), Range::Integer(0, 1_000_000), "", Always).doc(
            "Control intervals that a late loop catches up; beyond that the lost real time is given up and counted.",
        ),
        define("real_time_factor", V::Double(1.0), Range::Double(0.0, 1000.0), "", Always).doc(
            "Control intervals per control interval of real time; 0: as fast as possible, without dropping a state.",
        ),
        define("realtime_priority", V::Integer(0), Range::Integer(0, 99), "", Start)
            .doc("SCHED_FIFO priority of the control thread; 0: ordinary scheduling."),
        define("allow_shared_topics", V::Boolean(false), Range::Any, "", Always).doc(
            "May somebody else publish our topics? Else the node does not start where joint_states is published already, and warns if that happens later.",
        ),
        define("use_sim_time", V::Boolean(false), Range::Any, "", Always)
            .doc("Accepted because launch files set it; this node is the source of /clock, so it has no effect."),
    ]
}

fn reset_parameters() -> Vec<Definition> {
    use When::Always;
    vec![
        define("reset_joints", V::Boolean(true), Range::Any, "", Always).doc(
            "Does a reset of the state put the joints back to their positions at start? Else they stay where they are, at rest.",
        ),
        define("reset_at_start", V::Boolean(false), Range::Any, "", Always)
            .doc("Is the state reset whenever the simulation goes from paused or stopped to playing? Time goes on."),
    ]
}

fn command_parameters() -> Vec<Definition> {
    use When::Always;
    vec![
        define("lockstep", V::Boolean(false), Range::Any, "", Always).doc(
            "The world makes one control interval for each joint_command that carries the stamp of the latest state, and for step_simulation; else it stands.",
        ),
        define("lockstep_timeout", V::Double(0.0), Range::Double(0.0, 3600.0), "s", Always).doc(
            "Real time without such a command after which lock-step makes one interval with the commands in force; 0: it waits for ever.",
        ),
        define("command_timeout", V::Double(0.0), Range::Double(0.0, 3600.0), "s", Always)
            .doc("Simulated time since the last accepted command after which on_timeout comes into force; 0: never."),
        define("on_timeout", V::String(OnTimeout::NAMES[0].into()), Range::OneOf(&OnTimeout::NAMES), "", Always).doc(
            "hold: every axis servos where it is; idle: drives give no torque; brake: motors are short-circuited. Only axes that may switch their mode do; the next command ends it.",
        ),
    ]
}

fn marker_parameters() -> Vec<Definition> {
    use When::Always;
    let kinds = KIND_NAMES.iter().filter(|name| **name != "normals").map(|name| (*name).to_owned()).collect();
    vec![
        define("markers_rate", V::Double(10.0), Range::Double(0.0, 1000.0), "Hz", Always)
            .doc("Rate of debug/markers in real time, while somebody subscribes; 0: none."),
        define("markers", V::StringArray(kinds), Range::SomeOf(&KIND_NAMES), "", Always)
            .doc("What debug/markers shows; the names are the namespaces of the markers."),
        define("markers_size", V::Double(0.005), Range::Double(0.0, 1.0), "m", Always)
            .doc("Radius of the centres of mass in debug/markers; 0: the least half edge of the box around the collision shapes of the link. Principal axes are 40 times as long, those of what a joint moves 20 times."),
        define("markers_color", V::DoubleArray(vec![1.0, 0.0, 1.0, 1.0]), Range::NumbersIn(4, 0.0, 1.0), "", Always)
            .doc("Red, green, blue and opacity of the centres of mass in debug/markers."),
    ]
}

/// `effects.NAME` for every effect, in the order of `model::EFFECT_NAMES`.
pub(super) const EFFECTS: [&str; EFFECT_NAMES.len()] = [
    "effects.gravity",
    "effects.damping",
    "effects.friction",
    "effects.joint_friction",
    "effects.static_resistance",
    "effects.dynamic_resistance",
    "effects.limits",
    "effects.soft_stops",
    "effects.drives",
    "effects.torque_speed_line",
    "effects.short_brake",
    "effects.servo",
    "effects.rotor_inertia",
    "effects.compliance",
    "effects.mimic",
    "effects.breaking",
    "effects.body_damping",
    "effects.contact",
    "effects.contact_friction",
    "effects.rolling_resistance",
    "effects.spinning_friction",
    "effects.restitution",
    "effects.continuous_detection",
    "effects.deactivation",
];

/// Values of an effect.
pub(super) const SWITCH: [&str; 3] = ["auto", "on", "off"];

fn effect_parameters() -> Vec<Definition> {
    let doc = "auto: as the scene says, else on where the scene or the robot calls for it. on, off: whatever they say.";
    let effect = |name: &&'static str| {
        define(name, V::String(SWITCH[0].into()), Range::OneOf(&SWITCH), "", When::Start).doc(doc)
    };
    EFFECTS.iter().map(effect).collect()
}

fn define(name: &'static str, default: V, range: Range, unit: &'static str, when: When) -> Definition {
    Definition { name, default, range, unit, doc: "", when }
}

impl Definition {
    fn doc(mut self, doc: &'static str) -> Self {
        self.doc = doc;
        self
    }

    /// Range and unit for people; empty if any value of the type will do.
    pub fn range_text(&self) -> String {
        let text = match self.range {
            Range::Any => String::new(),
            Range::Integer(low, high) => format!("{low} … {high}"),
            Range::Double(low, high) => format!("{low:?} … {high:?}"),
            Range::OneOf(names) => names.join(" | "),
            Range::Numbers(n) => format!("{n} finite numbers"),
            Range::NumbersIn(n, low, high) => format!("{n} numbers {low:?} … {high:?}"),
            Range::SomeOf(names) => format!("any of {}", names.join(", ")),
        };
        if self.unit.is_empty() { text } else { format!("{text} {}", self.unit).trim_start().into() }
    }

    /// When it may be set, for people; empty if always.
    pub fn when_text(&self) -> &'static str {
        match self.when {
            When::Always => "",
            When::Start => "at start only",
            When::Never => "read-only",
        }
    }

    /// `Err` carries name, value and what is accepted.
    pub fn check(&self, value: &V) -> Result<(), String> {
        if std::mem::discriminant(value) != std::mem::discriminant(&self.default) {
            return Err(format!(
                "parameter '{}' is of type {}, {} is of type {}",
                self.name,
                super::type_name(&self.default),
                show(value),
                super::type_name(value)
            ));
        }
        let accepted = match (self.range, value) {
            (Range::Integer(low, high), V::Integer(i)) => (low..=high).contains(i),
            (Range::Double(low, high), V::Double(d)) => (low..=high).contains(d),
            (Range::OneOf(names), V::String(s)) => names.contains(&s.as_str()),
            (Range::Numbers(n), V::DoubleArray(a)) => a.len() == n && a.iter().all(|x| x.is_finite()),
            (Range::NumbersIn(n, low, high), V::DoubleArray(a)) => {
                a.len() == n && a.iter().all(|x| (low..=high).contains(x))
            }
            (Range::SomeOf(names), V::StringArray(a)) => a.iter().all(|name| names.contains(&name.as_str())),
            _ => true,
        };
        if accepted {
            return Ok(());
        }
        Err(format!("parameter '{}' = {} is out of range: {}", self.name, show(value), self.range_text()))
    }
}

/// The table as text for `--help`.
pub fn help() -> String {
    let mut text = String::from("Parameters (-p NAME:=VALUE after --ros-args):\n");
    for d in table() {
        let facts: Vec<String> = [format!("default {}", show(&d.default)), d.range_text(), d.when_text().to_string()]
            .into_iter()
            .filter(|s| !s.is_empty())
            .collect();
        text += &format!("  {:<21} {}\n  {:<21} [{}]\n", d.name, d.doc, "", facts.join("; "));
    }
    text
}

/// `config/default.yaml`: every parameter that can be set, with its default and a comment.
pub fn default_yaml() -> String {
    let mut text = String::from(
        "# Every parameter of realnoid with its default. Copy, change, and start with\n\
         #   realnoid run --ros-args --params-file my.yaml\n\
         # or set one on the command line: --ros-args -p time_scale:=0.5\n\
         /**:\n  ros__parameters:\n",
    );
    let mut said = "";
    for d in table().iter().filter(|d| d.when != When::Never) {
        let facts = [d.range_text(), d.when_text().into()];
        let facts: Vec<_> = facts.into_iter().filter(|s: &String| !s.is_empty()).collect();
        let facts = if facts.is_empty() { String::new() } else { format!(" [{}]", facts.join("; ")) };
        if d.doc != said {
            text += &format!("    # {}{facts}\n", d.doc);
        }
        text += &format!("    {}: {}\n", d.name, yaml(&d.default));
        said = d.doc;
    }
    text
}

/// A number with an exponent is a number to YAML 1.1 only if it has a point.
fn yaml(value: &V) -> String {
    let text = show(value);
    let bare = matches!(value, V::Double(_)) && !text.contains('.');
    if bare { text.replace('e', ".0e") } else { text }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_default_file_is_the_table() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/config/default.yaml");
        let file = std::fs::read_to_string(path).unwrap();
        let mend = "write what ros::parameters::default_yaml gives into config/default.yaml";
        assert!(file == super::default_yaml(), "{mend}:\n{}", super::default_yaml());
    }

    #[test]
    fn every_effect_has_its_parameter() {
        let names = super::EFFECT_NAMES.map(|name| format!("effects.{name}"));
        assert_eq!(super::EFFECTS.map(str::to_string), names);
    }

    #[test]
    fn help_names_every_parameter() {
        let help = super::help();
        for d in super::table() {
            assert!(help.contains(d.name) && help.contains(d.doc) && !d.doc.is_empty(), "{}", d.name);
        }
    }
}
