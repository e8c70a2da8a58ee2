//! The way to ros2_control without a plug-in of ours: topics as `joint_state_topic_hardware_interface` speaks them
//! (docs/decisions/0029).
//!
//! That plug-in names all joints of its `<ros2_control>` block, but puts into each array only the values of those joints that declare
//! the interface; and what no controller commands is NaN.

use super::messages::{Header, JointState, Shared, Time};
use super::refusal::{Refusal, RefusalKind};
use crate::description::{ControlBlock, ControlJoint, INTERFACES};
use crate::model::Model;
use crate::world::Snapshot;
use std::collections::HashMap;

/// Where the plug-in looks if its block does not say.
const TOPICS: [&str; 2] = ["/robot_joint_states", "/robot_joint_commands"];

/// Position, velocity and effort for one joint; `None`: no command.
pub type Entry = [Option<f64>; 3];

/// What the `<ros2_control>` blocks of a robot say.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Topic of the states.
    pub states_topic: String,
    /// Topic of the commands.
    pub commands_topic: String,
    joints: Vec<ControlJoint>,
    /// Per axis of the model: what its drive has at most, N·m or N.
    pub(super) max_torque: Vec<f64>,
}

impl Control {
    /// From the blocks of a robot. Parameter `ros2_control`: `never`; `auto`: only if a block has a plug-in that speaks over topics;
    /// `always`. Without a block all axes of `m` have all interfaces.
    pub fn of(blocks: &[ControlBlock], m: &Model, when: &str) -> Option<Self> {
        let over_topics = || blocks.iter().filter(|block| block.over_topics);
        let used: Vec<&ControlBlock> = match when {
            "always" if over_topics().next().is_none() => blocks.iter().collect(),
            "always" | "auto" => over_topics().collect(),
            _ => return None,
        };
        if used.is_empty() && when != "always" {
            return None;
        }
        let topic = |of: fn(&ControlBlock) -> &Option<String>, default: &str| {
            used.iter().find_map(|block| of(block).clone()).unwrap_or(default.to_owned())
        };
        let every = |name: &String| ControlJoint {
            name: name.clone(),
            commands: [true; 3],
            states: [true; 3],
            ..ControlJoint::default()
        };
        let joints: Vec<ControlJoint> = match used.is_empty() {
            true => m.axes.iter().map(|axis| every(&axis.name)).collect(),
            false => used.iter().flat_map(|block| block.joints.clone()).collect(),
        };
        Some(Self {
            states_topic: topic(|block| &block.states_topic, TOPICS[0]),
            commands_topic: topic(|block| &block.commands_topic, TOPICS[1]),
            joints,
            max_torque: m.axes.iter().map(|axis| axis.drive.max_torque).collect(),
        })
    }

    /// All axes with all interfaces and drives of this torque.
    #[cfg(test)]
    pub(super) fn for_tests(names: &[&str], max_torque: f64) -> Self {
        let (commands, states) = ([true; 3], [true; 3]);
        let joint = |name: &&str| ControlJoint { name: (*name).into(), commands, states, ..ControlJoint::default() };
        Self {
            states_topic: TOPICS[0].into(),
            commands_topic: TOPICS[1].into(),
            joints: names.iter().map(joint).collect(),
            max_torque: vec![max_torque; names.len()],
        }
    }

    /// What a message commands to each of its joints.
    ///
    /// # Errors
    /// An array whose values cannot be told apart, or a value that is infinite.
    pub fn entries(&self, message: &JointState) -> Result<Vec<Entry>, Refusal> {
        let by_name: HashMap<&str, &ControlJoint> = self.joints.iter().map(|j| (j.name.as_str(), j)).collect();
        let mut entries = vec![[None; 3]; message.name.len()];
        for (kind, values) in [&message.position, &message.velocity, &message.effort].into_iter().enumerate() {
            let declares = |name: &String| by_name.get(name.as_str()).is_some_and(|j| j.commands[kind]);
            let declared: Vec<usize> = (0..entries.len()).filter(|i| declares(&message.name[*i])).collect();
            let targets: Vec<usize> = match values.len() {
                0 => vec![],
                n if n == declared.len() => declared,
                n if n == entries.len() => (0..n).collect(),
                n => return Err(misaligned(kind, n, &declared, message)),
            };
            for (target, &value) in targets.into_iter().zip(values) {
                if value.is_infinite() {
                    let reason = format!("axis '{}': {} is {value}", message.name[target], INTERFACES[kind]);
                    return Err(Refusal { kind: RefusalKind::NotFinite, reason });
                }
                entries[target][kind] = Some(value).filter(|v| !v.is_nan());
            }
        }
        Ok(entries)
    }
}

fn misaligned(kind: usize, count: usize, declared: &[usize], message: &JointState) -> Refusal {
    let (names, declared, kind) = (message.name.len(), declared.len(), INTERFACES[kind]);
    let reason = format!(
        "{kind} has {count} values for {names} names, of which {declared} have <command_interface name=\"{kind}\"/> in the \
         <ros2_control> block; it must have none, {declared} or {names}"
    );
    Refusal { kind: RefusalKind::WrongSize, reason }
}

/// The states as the plug-in reads them.
#[derive(Clone, Debug)]
pub struct ControlStates {
    names: Shared<Vec<String>>,
    /// Per joint: index of its axis, and which interfaces it declares.
    joints: Vec<(usize, [bool; 3])>,
    /// Which arrays there are: the plug-in reads positions always.
    arrays: [bool; 3],
}

impl ControlStates {
    /// Of the joints in the blocks that are axes of `m`.
    pub fn new(control: &Control, m: &Model) -> Self {
        let known = || control.joints.iter().filter_map(|j| Some((j, m.axis(&j.name)?)));
        let any = |kind: usize| kind == 0 || known().any(|(j, _)| j.states[kind]);
        Self {
            names: Shared::new(known().map(|(j, _)| j.name.clone()).collect()),
            joints: known().map(|(j, axis)| (axis, j.states)).collect(),
            arrays: [any(0), any(1), any(2)],
        }
    }

    /// The message; NaN, which the plug-in skips, where a joint does not declare the interface.
    pub fn message(&self, s: &Snapshot, stamp: Time) -> JointState<Shared<Vec<String>>> {
        let array = |kind: usize, values: &[f64]| -> Vec<f64> {
            let value = |(axis, states): &(usize, [bool; 3])| if states[kind] { values[*axis] } else { f64::NAN };
            self.joints.iter().filter(|_| self.arrays[kind]).map(value).collect()
        };
        JointState {
            header: Header { stamp, frame_id: String::new() },
            name: self.names.clone(),
            position: array(0, &s.position),
            velocity: array(1, &s.velocity),
            effort: array(2, &s.effort),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::commands::tests::joint as message;

    const P: [bool; 3] = [true, false, false];
    const V: [bool; 3] = [false, true, false];
    const E: [bool; 3] = [false, false, true];

    fn control() -> Control {
        let joint = |name: &str, commands| ControlJoint {
            name: name.into(),
            commands,
            states: [true, true, false],
            ..ControlJoint::default()
        };
        Control {
            states_topic: String::new(),
            commands_topic: String::new(),
            joints: vec![
                joint("hip", P),
                joint("knee", E),
                joint("ankle", P),
                joint("wheel", V),
                joint("eye", [false; 3]),
            ],
            max_torque: vec![],
        }
    }

    #[test]
    fn short_arrays_belong_to_those_that_declare_the_interface() {
        let all = ["hip", "knee", "ankle", "wheel", "eye"];
        let entries = control().entries(&message(&all, &[0.1, 0.2], &[3.0], &[4.0])).unwrap();
        let expected = [
            [Some(0.1), None, None],
            [None, None, Some(4.0)],
            [Some(0.2), None, None],
            [None, Some(3.0), None],
            [None; 3],
        ];
        assert_eq!(entries, expected);
    }

    #[test]
    fn nan_is_no_command_and_full_arrays_go_by_name() {
        let entries = control().entries(&message(&["knee", "hip"], &[], &[], &[f64::NAN, 2.0])).unwrap();
        assert_eq!(entries, [[None; 3], [None, None, Some(2.0)]]);
        assert_eq!(control().entries(&message(&["eye"], &[], &[], &[])).unwrap(), [[None; 3]]);
    }

    #[test]
    fn what_cannot_be_told_apart_is_refused() {
        let refusal = control().entries(&message(&["hip", "knee", "ankle"], &[], &[1.0], &[])).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::WrongSize);
        assert!(refusal.reason.contains("velocity has 1 values for 3 names, of which 0"), "{}", refusal.reason);
        let refusal = control().entries(&message(&["hip"], &[f64::INFINITY], &[], &[])).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::NotFinite);
    }
}
