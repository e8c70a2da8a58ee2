"""A leg on a stand swings through and kicks a ball, at half speed: ros2 launch launch-scripts/leg_and_ball.launch.py, with the arguments of scene.launch.py"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

HERE = Path(__file__).resolve().parent
CONFIG = HERE.parent / "config"


def generate_launch_description():
    scene = PythonLaunchDescriptionSource(str(HERE / "scene.launch.py"))
    arguments = {"scene": str(CONFIG / "leg_and_ball.yaml"), "params": str(CONFIG / "leg_and_ball.params.yaml")}
    return LaunchDescription([IncludeLaunchDescription(scene, launch_arguments=arguments.items())])
