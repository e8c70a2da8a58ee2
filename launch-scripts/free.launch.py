"""The humanoid free and weightless, without a ground: ros2 launch launch-scripts/free.launch.py, with the arguments of bench.launch.py

With a ground to stand on: on_the_ground.launch.py.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration

BENCH = Path(__file__).resolve().with_name("bench.launch.py")


def generate_launch_description():
    weightless = DeclareLaunchArgument("gravity", default_value="[0.0, 0.0, 0.0]", description="m/s^2, world frame")
    bench = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(str(BENCH)),
        launch_arguments={"base": "free", "gravity": LaunchConfiguration("gravity")}.items(),
    )
    return LaunchDescription([weightless, bench])
