//! Message definitions, by which a bag explains itself to readers that do not know ROS.

use std::fmt::Write;

/// A message type with a topic of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageType {
    /// Package.
    pub package: &'static str,
    /// Name in the package.
    pub name: &'static str,
    /// REP-2016 hash of the type description.
    pub hash: &'static str,
}

/// rosgraph_msgs/msg/Clock.
pub const CLOCK: MessageType = MessageType {
    package: "rosgraph_msgs",
    name: "Clock",
    hash: "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564",
};
/// sensor_msgs/msg/JointState.
pub const JOINT_STATE: MessageType = MessageType {
    package: "sensor_msgs",
    name: "JointState",
    hash: "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
};
/// nav_msgs/msg/Odometry.
pub const ODOMETRY: MessageType = MessageType {
    package: "nav_msgs",
    name: "Odometry",
    hash: "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
};

/// Fields of every type that a recorded message contains.
const FIELDS: &[(&str, &str)] = &[
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"),
    ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"),
    ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"),
    ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"),
    ("geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    (
        "nav_msgs/Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
         geometry_msgs/TwistWithCovariance twist\n",
    ),
    ("rosgraph_msgs/Clock", "builtin_interfaces/Time clock\n"),
    (
        "sensor_msgs/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    ),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
];

impl MessageType {
    /// `package/msg/Name`.
    pub fn full_name(&self) -> String {
        format!("{}/msg/{}", self.package, self.name)
    }

    /// The definition in the form `ros2msg`: the fields, then those of every type contained, each behind a line of `=`.
    pub fn definition(&self) -> String {
        let root = format!("{}/{}", self.package, self.name);
        let mut text = fields(&root).to_owned();
        let mut contained = Vec::new();
        collect(&root, &mut contained);
        for name in contained {
            // Writing to a string cannot fail.
            let _ = write!(text, "{}\nMSG: {name}\n{}", "=".repeat(80), fields(name));
        }
        text
    }
}

fn fields(name: &str) -> &'static str {
    FIELDS.iter().find(|(n, _)| *n == name).map_or("", |(_, fields)| fields)
}

fn collect(name: &str, found: &mut Vec<&'static str>) {
    let types = fields(name).lines().filter_map(|line| line.split(' ').next());
    for inner in types.filter(|t| t.contains('/')) {
        if !found.contains(&inner) {
            found.push(inner);
            collect(inner, found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_that_a_definition_names_is_known() {
        for kind in [CLOCK, JOINT_STATE, ODOMETRY] {
            let text = kind.definition();
            let named = text.lines().filter_map(|line| line.split(' ').next()).filter(|t| t.contains('/'));
            for name in named {
                assert!(!fields(name).is_empty(), "{name}");
                assert_eq!(text.matches(&format!("\nMSG: {name}\n")).count(), 1, "{name}");
            }
        }
    }
}
