"""Launch files, parameter files and the RViz configuration: the commands that would be started are run; RViz and ros2_control are not."""

import os
import re
import signal
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
import yaml
from conftest import BINARY, LATCHED, Probe, free_domain, wait_until
from launched import Launched
from sensor_msgs.msg import JointState
from std_msgs.msg import String

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "launch-scripts"
LAUNCH_FILES = sorted(path.name.removesuffix(".launch.py") for path in SCRIPTS.glob("*.launch.py"))
PARAMETER_FILES = sorted((ROOT / "config").glob("*.params.yaml"))
DEFAULT = (ROOT / "config/default.yaml").read_text()


FACTS = {
    "bench": ["base fixed", "start hold", "-9.80665]"],
    "free": ["base free", "gravity [0.0, 0.0, 0.0]"],
    "leg_and_ball": ["steps_per_interval 2", "start free", "real_time_factor 0.5", "/ball/odom  nav_msgs/Odometry"],
    "on_the_ground": ["base free", "/odom  nav_msgs/Odometry"],
    "ros2_control": ["base fixed", "-> /robot_joint_states  sensor_msgs/JointState", "<- /robot_joint_commands"],
    "rviz": ["base free", "/debug/markers  visualization_msgs/MarkerArray"],
    "scene": ["base free", "/odom  nav_msgs/Odometry"],
}


@pytest.fixture
def launched(monkeypatch):
    """Runs the one command of a launch file, in a domain of its own; stopped as `ros2 launch` does."""
    processes = []

    def launcher(name, **given):
        monkeypatch.setenv("REALNOID_BIN", str(BINARY))
        launch = Launched(monkeypatch, SCRIPTS / f"{name}.launch.py", **given)
        [command] = launch.commands
        launch.domain = free_domain()
        probe = Probe(launch.domain)
        launch.states = probe.listen(JointState, f"{given.get('namespace', '')}/joint_states")
        launch.probe = probe
        variables = {**os.environ, "ROS_DOMAIN_ID": str(launch.domain)}
        node = subprocess.Popen(command, env=variables, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        processes.append((node, probe))
        launch.node = node
        wait_until(lambda: launch.states or node.poll() is not None, what="the first state")
        return launch

    yield launcher
    for node, probe in processes:
        node.kill()
        node.communicate()
        probe.close()


def ended(launch):
    launch.node.send_signal(signal.SIGINT)
    output, errors = launch.node.communicate(timeout=30)
    assert launch.node.returncode == 0, errors
    return output


def test_every_launch_file_is_tried():
    assert LAUNCH_FILES == sorted(FACTS)


@pytest.mark.parametrize("name", LAUNCH_FILES)
def test_the_node_starts_with_the_command_that_comes_out(name, launched):
    launch = launched(name)
    assert launch.states, launch.node.communicate()[1]
    report = ended(launch)
    for fact in FACTS[name]:
        assert fact in report, report


def test_a_namespace_moves_the_scene(launched):
    launch = launched("on_the_ground", namespace="/stand")
    assert launch.states and "-> /stand/debug/markers" in ended(launch)


def test_the_ball_is_kicked_away(launched):
    """What the leg-and-ball launch file is for; seen on the topics that its RViz would use."""
    from nav_msgs.msg import Odometry

    launch = launched("leg_and_ball")
    odometry = launch.probe.listen(Odometry, "/ball/odom")
    wait_until(lambda: odometry and odometry[-1].pose.pose.position.x > 1.0, what="the ball to roll away")


def test_rviz_gets_its_configuration_and_the_namespace(monkeypatch):
    [node] = Launched(monkeypatch, SCRIPTS / "rviz.launch.py", namespace="/stand").nodes
    package, executable, arguments, parameters, namespace = node
    assert (package, executable, namespace, arguments[0]) == ("rviz2", "rviz2", "/stand", "-d")
    assert parameters == [{"use_sim_time": True}] and Path(arguments[1]).exists()


def test_ros2_control_gets_a_robot_with_its_block_and_the_controllers(launched):
    launch = launched("ros2_control")
    texts = launch.probe.listen(String, "/robot_description", LATCHED)
    wait_until(lambda: texts, what="robot_description, from which the controller manager takes the robot")
    robot = ElementTree.fromstring(texts[0].data)
    [block] = robot.findall("ros2_control")
    assert {joint.get("name") for joint in block.iter("joint")} == set(launch.states[0].name)
    manager, *spawners = launch.nodes
    assert manager[:2] == ("controller_manager", "ros2_control_node")
    [file] = manager[3]
    controllers = yaml.safe_load(Path(file).read_text())
    spawned = {a for node in spawners for a in node[2] if not a.startswith("-") and a != file}
    assert spawned == set(controllers) - {"controller_manager"}
    assert all(node[:2] == ("controller_manager", "spawner") and file in node[2] for node in spawners)


# RViz and parameter files


def test_rviz_shows_robot_frames_and_markers_in_the_world():
    manager = yaml.safe_load((SCRIPTS / "realnoid.rviz").read_text())["Visualization Manager"]
    assert manager["Global Options"]["Fixed Frame"] == "world"
    displays = {d["Class"].split("/")[1]: d for d in manager["Displays"]}
    assert {"RobotModel", "TF", "MarkerArray"} <= set(displays)
    assert displays["MarkerArray"]["Topic"]["Value"] == "debug/markers"
    description = displays["RobotModel"]["Description Topic"]
    assert (description["Value"], description["Durability Policy"]) == ("robot_description", "Transient Local")


def test_there_are_parameter_files():
    assert {path.name for path in PARAMETER_FILES} >= {"bench.params.yaml", "scene.params.yaml", "leg_and_ball.params.yaml"}


@pytest.mark.parametrize("path", PARAMETER_FILES, ids=lambda path: path.name)
def test_every_key_of_a_parameter_file_has_the_comment_of_the_default_file(path):
    entry = re.compile(r"^    # (.+)\n    (\w+): (.+)$", re.M)
    comments = {name: comment for comment, name, _ in entry.findall(DEFAULT)}
    text = path.read_text()
    shown = {name: comment for comment, name, _ in entry.findall(text)}
    keys = yaml.safe_load(text)["/**"]["ros__parameters"]
    assert set(shown) == set(keys), "every key has a comment above it"
    assert shown == {name: comments[name] for name in keys}


@pytest.mark.parametrize("path", PARAMETER_FILES, ids=lambda path: path.name)
def test_the_node_takes_every_parameter_file(path, start):
    bench = start("--params-file", path)
    client = bench.probe.parameters()
    for name, value in yaml.safe_load(path.read_text())["/**"]["ros__parameters"].items():
        assert bench.probe.get(client, name) == value, name


def test_scene_files_and_controllers_have_comments_at_every_setting():
    for path in (ROOT / "config/on_the_ground.yaml", ROOT / "config/ros2_control/controllers.yaml"):
        for line in path.read_text().splitlines():
            if re.match(r"\s+(update_rate|use_sim_time|command_interfaces|goal_time|base|pose): ", line) and "sim_time" not in line:
                assert "#" in line, f"{path.name}: {line}"


def test_swing_leg_shows_the_monitor_of_the_hip(start, tmp_path):
    bench = start(urdf=None)
    variables = {**os.environ, "ROS_DOMAIN_ID": str(bench.domain)}
    # Without matplotlib it writes a table; a file of that name that cannot be imported stands for its absence.
    (tmp_path / "matplotlib.py").write_text("raise ImportError('not here')")
    path = os.pathsep.join([str(tmp_path), *filter(None, [variables.get("PYTHONPATH")])])
    command = [sys.executable, str(SCRIPTS / "swing_leg.py"), str(tmp_path / "swing")]
    result = subprocess.run(command, env={**variables, "PYTHONPATH": path}, capture_output=True, text=True, timeout=120)
    assert result.returncode == 0, result.stderr
    header, *rows = (tmp_path / "swing.csv").read_text().splitlines()
    assert header.split(",")[7:] == ["hip_pitch", "hip_pitch_speed", "hip_pitch_torque"]
    table = [list(map(float, row.split(","))) for row in rows]
    with_monitor = [row for row in table if row[7] == row[7]]
    # From when it heard the monitors, which may be seconds after it heard the first state.
    since = table[table.index(with_monitor[0]) :]
    assert len(with_monitor) > 500 and len(with_monitor) > 0.8 * len(since), "most instants have a monitor"
    assert min(row[7] for row in with_monitor) < -0.5 and max(abs(row[9]) for row in with_monitor) > 1.0
