"""A scene with RViz: ros2 launch launch-scripts/rviz.launch.py, with the arguments of scene.launch.py

RViz shows the robot, its frames and debug/markers. The node publishes robot_description and /tf itself: no robot_state_publisher.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

HERE = Path(__file__).resolve().parent


def generate_launch_description():
    rviz = Node(
        package="rviz2",
        executable="rviz2",
        namespace=LaunchConfiguration("namespace"),
        arguments=["-d", str(HERE / "realnoid.rviz")],
        parameters=[{"use_sim_time": True}],
        output="screen",
    )
    namespace = DeclareLaunchArgument("namespace", default_value="/", description="namespace, beginning with a slash")
    scene = IncludeLaunchDescription(PythonLaunchDescriptionSource(str(HERE / "scene.launch.py")))
    return LaunchDescription([namespace, scene, rviz])
