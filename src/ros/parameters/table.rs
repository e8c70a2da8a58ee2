//! The table of parameters.

use super::show;
use crate::world::Settings;
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
        define("use_sim_time", V::Boolean(false), Range::Any, "", Always)
            .doc("Accepted because launch files set it; this node is the source of /clock, so it has no effect."),
    ]
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
        text += &format!("  {:<19} {}\n  {:<19} [{}]\n", d.name, d.doc, "", facts.join("; "));
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
    for d in table().iter().filter(|d| d.when != When::Never) {
        let facts = [d.range_text(), d.when_text().into()];
        let facts: Vec<_> = facts.into_iter().filter(|s: &String| !s.is_empty()).collect();
        let facts = if facts.is_empty() { String::new() } else { format!(" [{}]", facts.join("; ")) };
        text += &format!("    # {}{facts}\n    {}: {}\n", d.doc, d.name, show(&d.default));
    }
    text
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
    fn help_names_every_parameter() {
        let help = super::help();
        for d in super::table() {
            assert!(help.contains(d.name) && help.contains(d.doc) && !d.doc.is_empty(), "{}", d.name);
        }
    }
}
