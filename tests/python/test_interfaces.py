"""Messages and services of our own: every field says what it is and in which unit, and real rclpy speaks each type. How the program is
started by `ros2 run` and by launch_ros."""

import importlib
import os
import re
import signal
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
import yaml
from conftest import BINARY, Probe, free_domain, wait_until
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState

ROOT = Path(__file__).resolve().parents[2]
INTERFACES = sorted([*ROOT.glob("msg/*.msg"), *ROOT.glob("srv/*.srv")])
FIELD = re.compile(r"^(?P<type>[\w/]+(\[\d*\])?) +(?P<name>\w+)( *= *(?P<value>\S+))?( [^#]*)?(# (?P<comment>.*))?$")
# What a comment must contain if the field is of this type.
UNITS = {
    "float64": r"\b(m|rad|N|N·m|kg|s|m/s|rad/s|J|Hz)\b|\d|share|factor",
    "geometry_msgs/Pose": r"\bm\b.*quaternion|quaternion.*\bm\b",
    "geometry_msgs/Twist": r"m/s.*rad/s.*frame|m/s.*rad/s",
    "geometry_msgs/Wrench": r"\bN\b.*N·m",
    "std_msgs/Header": r"stamp: .*frame_id",
    "builtin_interfaces/Time": r"simulated time|real time",
}


def fields(path):
    """The lines that declare something."""
    lines = [line.strip() for line in path.read_text().splitlines()]
    return [line for line in lines if line and not line.startswith("#") and line != "---"]


def parsed(line):
    match = FIELD.match(line)
    assert match, f"cannot read: {line}"
    return match


def test_there_are_interfaces_of_both_kinds():
    assert {"JointMonitors.msg", "BodyStates.msg", "SetJointAngles.srv"} <= {path.name for path in INTERFACES}


@pytest.mark.parametrize("path", INTERFACES, ids=lambda path: path.name)
def test_every_field_says_what_it_is_and_in_which_unit(path):
    assert path.read_text().startswith("# "), "the file says what it is"
    for line in fields(path):
        field = parsed(line)
        assert field["comment"], f"{path.name}: no comment: {line}"
        unit = UNITS.get(field["type"].split("[")[0])
        if unit and field["value"] is None:
            assert re.search(unit, field["comment"]), f"{path.name}: no unit or frame: {line}"


def test_a_field_without_a_comment_would_be_seen():
    assert parsed("float64 mass")["comment"] is None
    assert not re.search(UNITS["float64"], parsed("float64 mass  # of it")["comment"])
    assert parsed("uint8 IDLE=0      # nothing")["value"] == "0"
    assert parsed("float64[] torque  # N·m or N")["type"] == "float64[]"


@pytest.mark.parametrize("path", INTERFACES, ids=lambda path: path.name)
def test_rclpy_has_the_type_with_these_fields(path):
    module = importlib.import_module(f"realnoid.{path.suffix[1:]}")
    kind = getattr(module, path.stem)
    parts = [kind] if path.suffix == ".msg" else [kind.Request, kind.Response]
    texts = path.read_text().split("\n---\n")
    assert len(texts) == len(parts)
    for part, text in zip(parts, texts):
        lines = [line.strip() for line in text.splitlines()]
        declared = [parsed(line) for line in lines if line and not line.startswith("#") and line != "---"]
        names = [field["name"] for field in declared if field["value"] is None]
        assert [name for name in part.get_fields_and_field_types() if not name.startswith("structure_needs")] == names
        for field in declared:
            if field["value"] is not None:
                assert getattr(part, field["name"]) == int(field["value"])
        assert deserialize_message(serialize_message(part()), part) == part()


# Every type on a topic or service of the node is spoken with. Services are tried by the tests of what they do.


def test_topics_of_our_types_are_heard(start):
    bench = start(urdf=None)
    found = lambda: {t: kinds[0] for t, kinds in bench.probe.node.get_topic_names_and_types() if kinds[0].startswith("realnoid/")}
    wait_until(lambda: {"/joint_monitors", "/body_states"} <= set(found()), what="our topics")
    own = found()
    for topic, kind in own.items():
        if topic in ("/joint_monitors", "/body_states"):
            received = bench.probe.listen(getattr(importlib.import_module("realnoid.msg"), kind.split("/")[-1]), topic)
            wait_until(lambda: received, what=topic)


# As ros2 run and launch_ros start it


def started(arguments, states="joint_states", domain=None):
    """Runs the program without a subcommand until it publishes; its report."""
    domain = free_domain() if domain is None else domain
    probe = Probe(domain)
    messages = probe.listen(JointState, states)
    variables = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    node = subprocess.Popen([BINARY, *map(str, arguments)], env=variables, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        wait_until(lambda: messages or node.poll() is not None, what="a state")
        node.send_signal(signal.SIGINT)
        output, errors = node.communicate(timeout=30)
        assert node.returncode == 0, errors
        return output
    finally:
        node.kill()
        probe.close()


def test_ros_arguments_are_accepted_without_a_subcommand(tmp_path):
    """`ros2 run realnoid realnoid --ros-args …`, and what launch_ros' Node adds."""
    parameters = tmp_path / "launch_params_x"
    parameters.write_text(yaml.safe_dump({"/**": {"ros__parameters": {"tf_rate": 20.0, "use_sim_time": True}}}))
    arguments = ["--ros-args", "-r", "__node:=bench", "-r", "__ns:=/left", "--params-file", parameters, "-r", "joint_states:=states"]
    report = started(arguments, states="/left/states")
    assert report.startswith("/left/bench: 'origin'") and "tf_rate 20.0" in report


def test_an_installed_tree_would_have_what_the_package_file_names():
    package = ElementTree.parse(ROOT / "package.xml").getroot()
    assert package.findtext("name") == "realnoid"
    needed = {e.text for e in package if e.tag.endswith("depend")}
    for path in INTERFACES:
        for line in fields(path):
            foreign = parsed(line)["type"].split("/")[0] if "/" in parsed(line)["type"] else None
            assert foreign in (None, *needed), f"{path.name} needs {foreign}"
    assert '<member_of_group>rosidl_interface_packages</member_of_group>' in (ROOT / "package.xml").read_text()
