"""The node on a test stand: ros2 launch launch-scripts/bench.launch.py [namespace:=/bench] [urdf:=FILE] [params:=FILE]

Starts the program that REALNOID_BIN names, else the one installed beside these files, else the one that `cargo build --release` has
made in this folder.
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
    "urdf": (ROOT / "urdf/origin.urdf", "robot"),
    "params": (ROOT / "config/bench.params.yaml", "parameter file"),
    "namespace": ("/", "namespace, beginning with a slash"),
    "base": ("fixed", "fixed: held on the stand; free"),
    "gravity": ("[0.0, 0.0, -9.80665]", "m/s^2, world frame"),
}


def generate_launch_description():
    value = LaunchConfiguration
    declared = [
        DeclareLaunchArgument(name, default_value=str(default), description=text)
        for name, (default, text) in ARGUMENTS.items()
    ]
    command = [PROGRAM, "run", value("urdf"), "--ros-args", "--params-file", value("params")]
    command += ["-r", ["__ns:=", value("namespace")]]
    command += ["-p", ["base:=", value("base")], "-p", ["gravity:=", value("gravity")]]
    return LaunchDescription([*declared, ExecuteProcess(cmd=command, output="screen")])
