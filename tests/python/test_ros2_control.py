"""robot_joint_states and robot_joint_commands, as joint_state_topic_hardware_interface 1.1 speaks them.

ros2_control has no wheel: the plug-in is emulated here, its packing and its reading, after what its source does.
"""

import math
import re
import xml.etree.ElementTree as ElementTree

import pytest
import yaml
from conftest import ARM, HERE, wait_until
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import JointState

CONFIG = HERE / "../../config/ros2_control"
FIELDS = ("position", "velocity", "effort")
NAN = math.nan


class Plugin:
    """What JointStateTopicSystem does with its topics."""

    def __init__(self, probe, block):
        self.node = probe.node
        hardware = {p.get("name"): p.text for p in block.iter("param")}
        of = lambda joint, tag: [interface.get("name") for interface in joint.iter(tag)]
        self.commands = {joint.get("name"): {kind: NAN for kind in of(joint, "command_interface")} for joint in block.iter("joint")}
        self.states = {joint.get("name"): {kind: NAN for kind in of(joint, "state_interface")} for joint in block.iter("joint")}
        topic = hardware.get("joint_commands_topic", "/robot_joint_commands")
        self.publisher = self.node.create_publisher(JointState, topic, QoSProfile(depth=1))
        topic = hardware.get("joint_states_topic", "/robot_joint_states")
        self.received = probe.listen(JointState, topic, qos_profile_sensor_data)
        wait_until(lambda: self.publisher.get_subscription_count() > 0, what="a subscriber of the commands")

    def read(self):
        """Takes the latest message over; a state that was not declared is an error, as in the plug-in."""
        message = wait_until(lambda: self.received, what="robot_joint_states")[-1]
        assert len(message.position) == len(message.name)
        for i, name in enumerate(message.name):
            for kind in FIELDS:
                values = getattr(message, kind)
                if name in self.states and (len(values) or kind == "position") and math.isfinite(values[i]):
                    assert kind in self.states[name], f"the plug-in throws: {name}/{kind} was not declared"
                    self.states[name][kind] = values[i]
        return self.states

    def write(self):
        """All names, and each array only with those that declare its interface."""
        message = JointState(name=list(self.commands))
        for name, interfaces in self.commands.items():
            for kind in interfaces:
                getattr(message, kind).append(interfaces[kind])
        self.publisher.publish(message)


def block(joints, topics=""):
    text = "".join(
        f'<joint name="{name}">'
        + "".join(f'<command_interface name="{kind}"/>' for kind in commands)
        + "".join(f'<state_interface name="{kind}"/>' for kind in states)
        + "</joint>"
        for name, commands, states in joints
    )
    plugin = "<plugin>joint_state_topic_hardware_interface/JointStateTopicSystem</plugin>"
    return f'<ros2_control name="arm" type="system"><hardware>{plugin}{topics}</hardware>{text}</ros2_control>'


MIXED = block([
    ("knee", ["effort", "velocity"], ["position", "velocity", "effort"]),
    ("hip", ["position"], ["position"]),
    ("ankle", [], ["position", "velocity"]),
])


@pytest.fixture
def control(start, tmp_path):
    """A bench of the arm with a block, and the plug-in."""

    def starter(text, *arguments):
        urdf = tmp_path / "arm.urdf"
        urdf.write_text(ARM.read_text().replace("</robot>", f"{text}</robot>"))
        bench = start(*arguments, urdf=urdf)
        return bench, Plugin(bench.probe, ElementTree.fromstring(text))

    return starter


def refused(bench, kind):
    return int(bench.count(": commands", f"robot_joint_commands refused: {kind}") or 0)


def accepted(bench):
    return int(bench.count(": commands", "robot_joint_commands accepted") or 0)


def test_mixed_interfaces_are_told_apart_by_the_block(control):
    bench, plugin = control(MIXED)
    plugin.commands["hip"]["position"] = 0.4
    plugin.commands["knee"]["effort"] = 0.05
    plugin.write()
    wait_until(lambda: abs(bench.axis("hip")[0] - 0.4) < 1e-3, what="the hip to servo")
    wait_until(lambda: bench.axis("knee")[2] == pytest.approx(0.05, rel=0.2), what="the knee's torque")
    wait_until(lambda: plugin.read()["hip"]["position"] == pytest.approx(0.4, abs=1e-2), what="the plug-in to read it")
    states = plugin.read()
    assert set(states["hip"]) == {"position"}
    assert math.isfinite(states["knee"]["effort"]) and math.isfinite(states["ankle"]["velocity"])
    [state] = plugin.received[-1:]
    assert list(state.name) == ["knee", "hip", "ankle"] and math.isnan(state.velocity[1])
    assert refused(bench, "wrong size") == 0


def test_before_a_controller_is_active_everything_is_nan_and_nothing_changes(control):
    bench, plugin = control(MIXED)
    bench.probe.publisher(JointState, "joint_command").publish(JointState(name=["hip"], position=[0.3]))
    wait_until(lambda: abs(bench.axis("hip")[0] - 0.3) < 1e-3, what="the hip")
    for _ in range(20):
        plugin.write()
    wait_until(lambda: accepted(bench) > 0, what="the messages to be counted")
    assert abs(bench.axis("hip")[0] - 0.3) < 1e-3
    assert not bench.logged("robot_joint_commands refused")
    assert all(bench.count(": commands", f"robot_joint_commands refused: {kind}") == "0" for kind in ("not finite", "no values"))


def test_a_velocity_moves_the_axis_at_that_speed_and_zero_holds_it(control):
    bench, plugin = control(MIXED)
    plugin.commands["knee"]["velocity"] = -0.8
    plugin.write()
    # Of all the states: it goes on to its stop.
    knee = bench.states[-1].name.index("knee")
    wait_until(lambda: any(abs(s.velocity[knee] + 0.8) < 0.01 for s in list(bench.states)), what="the knee at its speed")
    plugin.commands["knee"]["velocity"] = 0.0
    plugin.write()
    wait_until(lambda: abs(bench.axis("knee")[1]) < 1e-3, what="the knee to stop")
    before = bench.axis("knee")[0]
    # The hip turns under it: a loose knee would swing.
    plugin.commands["hip"]["position"] = 0.5
    plugin.write()
    wait_until(lambda: abs(bench.axis("hip")[0] - 0.5) < 1e-3, what="the hip")
    assert abs(bench.axis("knee")[0] - before) < 2e-2


def test_what_cannot_be_told_apart_is_refused_with_the_reason(control):
    bench, plugin = control(MIXED)
    cases = {
        "wrong size": JointState(name=["knee", "hip", "ankle"], position=[0.1, 0.2]),
        "not finite": JointState(name=["hip"], position=[math.inf]),
        "unknown name": JointState(name=["elbow"], position=[0.1]),
        # A drive whose tag forbids another mode, and a torque against a speed: the rules of joint_command.
        "mode switch": JointState(name=["ankle"], position=[0.1]),
        "torque against speed": JointState(name=["knee"], velocity=[-1.0], effort=[1.0]),
    }
    said = {}
    for kind, message in cases.items():
        # Sent again and again, as the plug-in does: it keeps one message, and does not care whether that arrived.
        again = lambda: plugin.publisher.publish(message) or bench.logged(f"robot_joint_commands refused, {kind}")
        [said[kind]] = wait_until(again, what=f"the reason: {kind}")
    assert "position has 2 values for 3 names, of which 1 have <command_interface" in said["wrong size"]
    wait_until(lambda: refused(bench, "wrong size") and refused(bench, "torque against speed"), what="the counters")
    assert all(abs(bench.axis(name)[0]) < 1e-6 for name in ("hip", "knee"))


def test_the_topics_are_those_that_the_block_names(control):
    topics = '<param name="joint_commands_topic">/left/commands</param><param name="joint_states_topic">/left/states</param>'
    bench, plugin = control(block([("hip", ["position"], ["position"])], topics), "-r", "__ns:=/")
    plugin.commands["hip"]["position"] = -0.2
    plugin.write()
    wait_until(lambda: plugin.read()["hip"]["position"] < -0.19, what="the hip")
    assert "/robot_joint_states" not in dict(bench.probe.node.get_topic_names_and_types())


@pytest.mark.parametrize("text, value, there", [
    ("", "auto", False), ("", "always", True), (MIXED, "never", False), (MIXED, "auto", True),
    (MIXED.replace("joint_state_topic_hardware_interface/JointStateTopicSystem", "mock_components/GenericSystem"), "auto", False),
])
def test_it_is_there_if_the_robot_or_the_parameter_asks_for_it(start, tmp_path, text, value, there):
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(ARM.read_text().replace("</robot>", f"{text}</robot>"))
    bench = start("-p", f"ros2_control:={value}", urdf=urdf)
    topics = lambda: set(dict(bench.probe.node.get_topic_names_and_types()))
    wanted = {"/robot_joint_commands", "/robot_joint_states"}
    others = {"/joint_states", "/joint_command", "/servo_command", "/effort_command", "/diagnostics", "/joint_monitors", "/body_states"}
    wait_until(lambda: others | (wanted if there else set()) <= topics(), what="the topics to be found")
    assert there or not wanted & topics()


def test_a_joint_of_the_block_that_does_not_move_is_warned_of(start, tmp_path):
    urdf = tmp_path / "arm.urdf"
    text = block([("sole", ["position"], ["position"]), ("hip", ["position"], ["position"])])
    urdf.write_text(ARM.read_text().replace("</robot>", f"{text}</robot>"))
    bench = start(urdf=urdf)
    bench.simulator.stop()
    assert "no moving joint is named 'sole'" in bench.simulator.errors


def test_the_example_has_every_axis_of_the_humanoid(start, tmp_path):
    text = (CONFIG / "origin.ros2_control.xacro").read_text()
    example = ElementTree.fromstring(text).find("ros2_control")
    humanoid = (HERE / "../../urdf/origin.urdf").read_text()
    urdf = tmp_path / "origin.urdf"
    inner = re.search(r"<ros2_control.*</ros2_control>", text, re.S)[0]
    urdf.write_text(humanoid.replace("</robot>", f"{inner}</robot>"))
    bench = start(urdf=urdf)
    plugin = Plugin(bench.probe, example)
    assert list(plugin.commands) == list(bench.states[0].name)
    thresholds = [p.text for p in example.iter("param") if p.get("name") == "trigger_joint_command_threshold"]
    assert thresholds == ["-1"]
    controllers = yaml.safe_load((CONFIG / "controllers.yaml").read_text())
    for name in ("trajectory_controller", "effort_controller"):
        assert controllers[name]["ros__parameters"]["joints"] == list(bench.states[0].name), name
    plugin.commands["left_elbow"]["position"] = -0.5
    plugin.write()
    wait_until(lambda: abs(bench.axis("left_elbow")[0] + 0.5) < 0.01, what="the elbow")
    # Two topics, of which either may be behind.
    read = lambda: plugin.read()["left_elbow"]
    wait_until(lambda: read()["position"] == pytest.approx(-0.5, abs=0.01), what="the elbow, read by the plug-in")
    wait_until(lambda: read()["effort"] == pytest.approx(bench.axis("left_elbow")[2], abs=1.0), what="the same effort")
