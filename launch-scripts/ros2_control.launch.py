"""The humanoid on a stand under ros2_control: ros2 launch launch-scripts/ros2_control.launch.py

Needs ros-jazzy-ros2-control, ros-jazzy-ros2-controllers and ros-jazzy-joint-state-topic-hardware-interface. The controller manager takes
the robot from the topic robot_description, which the node publishes; config/ros2_control/ has its block and its controllers.
"""

import re
import tempfile
from pathlib import Path

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
CONTROLLERS = ROOT / "config/ros2_control/controllers.yaml"


def controlled_robot():
    """A file with the humanoid and its <ros2_control> block: what xacro would make of an <xacro:include>."""
    included = (ROOT / "config/ros2_control/origin.ros2_control.xacro").read_text()
    block = re.search(r"<ros2_control.*</ros2_control>", included, re.S)[0]
    robot = (ROOT / "urdf/origin.urdf").read_text().replace("</robot>", f"  {block}\n</robot>")
    with tempfile.NamedTemporaryFile("w", suffix=".urdf", prefix="origin_ros2_control_", delete=False) as file:
        file.write(robot)
    return file.name


def spawner(*controllers):
    arguments = [*controllers, "--param-file", str(CONTROLLERS)]
    return Node(package="controller_manager", executable="spawner", arguments=arguments, output="screen")


def generate_launch_description():
    bench = PythonLaunchDescriptionSource(str(HERE / "bench.launch.py"))
    manager = Node(
        package="controller_manager",
        executable="ros2_control_node",
        parameters=[str(CONTROLLERS)],
        output="screen",
    )
    return LaunchDescription([
        IncludeLaunchDescription(bench, launch_arguments={"urdf": controlled_robot()}.items()),
        manager,
        spawner("joint_state_broadcaster", "trajectory_controller"),
        spawner("effort_controller", "--inactive"),
    ])
