"""A scene: ros2 launch launch-scripts/scene.launch.py scene:=FILE [params:=FILE] [namespace:=/bench]

What a scene file says of the world holds where the parameter file does not say otherwise.
"""

import os
from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration

HERE = Path(__file__).resolve().parent
# The repository, or share/realnoid of an installation.
ROOT = HERE.parent
INSTALLED = HERE.parents[2] / "lib/realnoid/realnoid"
PROGRAM = os.environ.get("REALNOID_BIN", str(INSTALLED if INSTALLED.exists() else ROOT / "target/release/realnoid"))
ARGUMENTS = {
    "scene": (ROOT / "config/on_the_ground.yaml", "scene file"),
    "params": (ROOT / "config/scene.params.yaml", "parameter file"),
    "namespace": ("/", "namespace, beginning with a slash"),
}


def generate_launch_description():
    value = LaunchConfiguration
    declared = [
        DeclareLaunchArgument(name, default_value=str(default), description=text)
        for name, (default, text) in ARGUMENTS.items()
    ]
    command = [PROGRAM, "run", "--ros-args", "--params-file", value("params")]
    command += ["-r", ["__ns:=", value("namespace")], "-p", ["scene:=", value("scene")]]
    return LaunchDescription([*declared, ExecuteProcess(cmd=command, output="screen")])
