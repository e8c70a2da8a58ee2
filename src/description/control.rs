//! `<ros2_control>`: which joints a controller commands and sees, and through which topics. Nothing else of it matters here: other
//! tools read it, too.

use super::Position;
use super::element::Element;
use super::finding::{Finding, Place};
use super::report::Report;

/// Plug-ins of ros2_control that speak over topics.
const TOPIC_PLUGINS: [&str; 2] =
    ["joint_state_topic_hardware_interface/JointStateTopicSystem", "topic_based_ros2_control/TopicBasedSystem"];

/// One `<ros2_control>` block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ControlBlock {
    /// Where.
    pub at: Position,
    /// `<param name="joint_commands_topic">`.
    pub commands_topic: Option<String>,
    /// `<param name="joint_states_topic">`.
    pub states_topic: Option<String>,
    /// Is its plug-in one that speaks over topics?
    pub over_topics: bool,
    /// Its joints, in order.
    pub joints: Vec<ControlJoint>,
}

/// `<joint>` of a block.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ControlJoint {
    /// Name of a joint of the URDF.
    pub name: String,
    /// Where.
    pub at: Position,
    /// `<command_interface>`: position, velocity, effort.
    pub commands: [bool; 3],
    /// `<state_interface>`: position, velocity, effort.
    pub states: [bool; 3],
}

/// Names of the interfaces, in the order of [`ControlJoint::commands`].
pub const INTERFACES: [&str; 3] = ["position", "velocity", "effort"];

/// Reads a block.
pub(super) fn read(element: &Element, report: &mut Report) -> ControlBlock {
    let hardware = element.all("hardware").next();
    let text = |e: Element| e.node.text().map(|t| t.trim().to_owned()).filter(|t| !t.is_empty());
    let plugin = hardware.as_ref().and_then(|h| h.all("plugin").next()).and_then(text);
    let parameter = |name: &str| {
        let mut parameters = hardware.as_ref()?.all("param").filter(|p| p.value("name") == Some(name));
        text(parameters.next()?)
    };
    ControlBlock {
        at: element.place(report).at,
        commands_topic: parameter("joint_commands_topic"),
        states_topic: parameter("joint_states_topic"),
        over_topics: plugin.is_some_and(|p| TOPIC_PLUGINS.contains(&p.as_str())),
        joints: element.all("joint").filter_map(|joint| read_joint(&joint, report)).collect(),
    }
}

fn read_joint(element: &Element, report: &Report) -> Option<ControlJoint> {
    let has = |tag: &'static str| {
        INTERFACES.map(|kind| element.all(tag).any(|interface| interface.value("name").map(str::trim) == Some(kind)))
    };
    Some(ControlJoint {
        name: element.value("name")?.to_owned(),
        at: element.place(report).at,
        commands: has("command_interface"),
        states: has("state_interface"),
    })
}

/// Joints of blocks that no moving joint of the URDF is: `moves` says which names are.
pub(super) fn check(blocks: &[ControlBlock], moves: impl Fn(&str) -> bool, report: &mut Report) {
    for joint in blocks.iter().flat_map(|block| &block.joints).filter(|joint| !moves(&joint.name)) {
        let message = format!("no moving joint is named '{}': commands for it will be refused", joint.name);
        let place = Place { element: format!("<ros2_control> joint '{}'", joint.name), at: joint.at };
        let mend = "name a joint of this robot that moves, or take it out of the block";
        report.add(Finding::warning("control-joint", place, message, mend));
    }
}

#[cfg(test)]
mod tests {
    use crate::description::{Description, Severity, read};

    const BLOCK: &str = r#"<ros2_control name="arm" type="system"><hardware>
          <plugin>
            joint_state_topic_hardware_interface/JointStateTopicSystem
          </plugin><param name="joint_states_topic">/states</param></hardware>
          <joint name="j"><command_interface name="effort"/><state_interface name="position"/><state_interface name="velocity"/></joint>
          <joint name="elbow"><command_interface name="position"/></joint></ros2_control>"#;

    fn reading(block: &str) -> (Description, Vec<crate::description::Finding>) {
        let robot = format!(
            r#"<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
            <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>{block}</robot>"#
        );
        let reading = read(&robot, "r.urdf");
        (reading.description.unwrap(), reading.findings)
    }

    #[test]
    fn interfaces_and_topics_are_read() {
        let (d, findings) = reading(BLOCK);
        let [block] = d.controls.as_slice() else { panic!("{:?}", d.controls) };
        assert!(block.over_topics);
        assert_eq!((block.states_topic.as_deref(), &block.commands_topic), (Some("/states"), &None));
        assert_eq!((block.joints[0].commands, block.joints[0].states), ([false, false, true], [true, true, false]));
        let told: Vec<_> = findings.iter().filter(|f| f.code == "control-joint").collect();
        assert!(told.len() == 1 && told[0].severity == Severity::Warning && told[0].message.contains("'elbow'"));
        assert!(!findings.iter().any(|f| f.message.contains("<ros2_control> inside")), "{findings:?}");
    }

    #[test]
    fn a_robot_without_a_block_has_none() {
        assert!(reading("").0.controls.is_empty());
    }
}
