"""The humanoid, free, standing on flat ground: ros2 launch launch-scripts/on_the_ground.launch.py, with the arguments of scene.launch.py"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

HERE = Path(__file__).resolve().parent
SCENE = HERE.parent / "config/on_the_ground.yaml"


def generate_launch_description():
    scene = PythonLaunchDescriptionSource(str(HERE / "scene.launch.py"))
    return LaunchDescription([IncludeLaunchDescription(scene, launch_arguments={"scene": str(SCENE)}.items())])
