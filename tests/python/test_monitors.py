"""joint_monitors (J-15, J-16, J-4), body_states (B-15, B-16) and odom: what they say, and that they are made only while somebody listens."""

import math
import re

import pytest
from conftest import ARM, HERE, nanoseconds, wait_until
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from realnoid.msg import BodyStates, JointMonitors
from sensor_msgs.msg import JointState
from simulation import BLOCK
from std_msgs.msg import Float64MultiArray

ORIGIN = (HERE / "../../urdf/origin.urdf").read_text()
LETTERS = {"h": "heading", "p": "pitch", "b": "bank", "e": "extension"}
G = 9.80665
SLIDER = """<robot name="slider"><link name="base"/>
  <link name="sled"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="rail" type="prismatic"><parent link="base"/><child link="sled"/><axis xyz="1 0 0"/>
    <limit lower="-50" upper="50" effort="50" velocity="10"/>
    <realnoid><drive mode="torque" no_load_speed="10"/></realnoid></joint>
</robot>
"""


def same_stamps(messages, others):
    """The pairs of messages of one instant."""
    by_stamp = {nanoseconds(m.header.stamp): m for m in list(others)}
    return [(m, by_stamp[t]) for m in list(messages) if (t := nanoseconds(m.header.stamp)) in by_stamp]


def same_stamp(messages, others):
    """The last pair of messages of one instant."""
    return next(reversed(same_stamps(messages, others)), None)


def subscribers(bench, topic):
    return bench.count(": node", f"subscribers of {topic}")


def groups():
    """Name → letter → axis of the groups of the humanoid."""
    tags = re.findall(r"<joint_group ([^>]*)/>", ORIGIN)
    read = [dict(re.findall(r'(\w+)="([^"]*)"', tag)) for tag in tags]
    return {tag["name"]: {letter: tag[letter] for letter in "hpbe" if letter in tag} for tag in read}


def test_joint_monitors_have_every_axis_of_the_humanoid_once_under_its_group(start):
    bench = start("-p", "start:=free", urdf=None)
    monitors = bench.probe.listen(JointMonitors, "joint_monitors")
    wait_until(lambda: len(monitors) > 100, what="joint monitors")
    monitor, state = wait_until(lambda: same_stamp(monitors, bench.states), what="both of one instant")
    values = {name: v for name, *v in zip(state.name, state.position, state.velocity, state.effort)}
    grouped, seen = groups(), []
    for joint in monitor.joints:
        axes = grouped.get(joint.name, {"h": joint.name})
        for letter, field in LETTERS.items():
            effort = f"{field}_force" if letter == "e" else f"{field}_torque"
            shown = [getattr(joint, field), getattr(joint, f"{field}_speed"), getattr(joint, effort)]
            if letter in axes:
                assert shown == values[axes[letter]], (joint.name, letter)
                seen.append(axes[letter])
            else:
                assert all(map(math.isnan, shown)), (joint.name, letter)
    assert sorted(seen) == sorted(state.name)
    assert any(abs(v) > 1e-3 for s in list(bench.states) for v in s.velocity), "something moves"
    stamps = [nanoseconds(m.header.stamp) for m in list(monitors)]
    assert {b - a for a, b in zip(stamps, stamps[1:])} == {1_000_000}, "every control interval"


def test_a_lone_slider_is_an_extension_with_the_force_that_really_acts(start, tmp_path):
    urdf = tmp_path / "slider.urdf"
    urdf.write_text(SLIDER)
    bench = start("-p", "gravity:=[0.0, 0.0, 0.0]", "-p", "start:=free", urdf=urdf)
    monitors = bench.probe.listen(JointMonitors, "joint_monitors")
    wait_until(lambda: monitors, what="monitors of the start")
    bench.probe.publisher(Float64MultiArray, "effort_command").publish(Float64MultiArray(data=[3.0]))
    moving = wait_until(lambda: next((m.joints[0] for m in list(monitors) if m.joints[0].extension_speed > 1.0), None))
    assert moving.name == "rail" and moving.extension > 0 and math.isnan(moving.heading)
    # J-15: present torque follows the line from the applied torque at rest to zero at the applied speed (10 m/s). The force is that of
    # the step before, in which the speed rose by 1.5 mm/s at most: 0.45 mN.
    assert moving.extension_force == pytest.approx(3.0 * (1.0 - moving.extension_speed / 10.0), abs=5e-4)


RIG = """<realnoid version="1"><joint_group name="leg" type="combined_hinge" h="hip" p="knee"/>
  <separate_rig name="mirror" of="leg"/></realnoid></robot>"""


def test_a_separate_rig_mirrors_the_angles_of_its_group(start, tmp_path):
    """J-4."""
    urdf = tmp_path / "arm.urdf"
    arm = ARM.read_text().replace('<origin xyz="0.2 0 0"/><axis xyz="0 0 1"/>', '<origin xyz="0.2 0 0"/><axis xyz="0 1 0"/>', 1)
    urdf.write_text(arm.replace("</robot>", RIG))
    bench = start("-p", "gravity:=[0.0, 0.0, 0.0]", urdf=urdf)
    monitors = bench.probe.listen(JointMonitors, "joint_monitors")
    push = JointState(name=["hip", "knee"], position=[0.4, 0.2])
    bench.probe.publisher(JointState, "joint_command").publish(push)
    wait_until(lambda: monitors and monitors[-1].joints[0].heading > 0.39, what="the hip")
    both = lambda: [p for p in same_stamps(monitors, bench.states) if p[0].joints[0].heading > 0.39]
    message, state = wait_until(both, what="both of one instant")[-1]
    assert [joint.name for joint in message.joints] == ["leg", "ankle", "mirror"]
    leg, _, rig = message.joints
    assert (rig.heading, rig.pitch) == (leg.heading, leg.pitch) == tuple(state.position[:2])
    assert math.isfinite(leg.heading_torque) and math.isnan(rig.heading_torque)


def test_body_states_are_the_twists_and_wrenches_of_the_monitored_links(start):
    # Five streams at 1 kHz are more than rclpy reads on a slow machine.
    bench = start("-p", "control_interval:=0.004")
    twists = {link: bench.probe.listen(TwistStamped, f"twist/{token}") for link, token in
              {"thigh": "thigh", "shank": "shank", "foot-sole": "foot_sole"}.items()}
    states = bench.probe.listen(BodyStates, "body_states")
    # It moves for a second or two, until it is at its stop: everybody has to listen before.
    wait_until(lambda: states and all(twists.values()), what="messages of the start")
    bench.probe.publisher(Float64MultiArray, "effort_command").publish(Float64MultiArray(data=[0.5, 0.0, 0.0]))

    def moving(messages, others):
        fast = {nanoseconds(s.header.stamp) for s in list(bench.states) if abs(s.velocity[0]) > 0.5}
        return next((p for p in same_stamps(messages, others) if nanoseconds(p[0].header.stamp) in fast), None)

    names = ["thigh", "shank", "foot-sole"]
    for i, name in enumerate(names):
        message, twist = wait_until(lambda: moving(states, twists[name]), what="both of one instant, of a hip that moves")
        body = message.bodies[i]
        assert message.header.frame_id == "world" and [b.name for b in message.bodies] == names
        assert body.frame_id == twist.header.frame_id and body.twist == twist.twist
        assert abs(sum(getattr(body.pose.orientation, c) ** 2 for c in "xyzw") - 1.0) < 1e-12
    message, state = wait_until(lambda: moving(states, bench.states), what="both of one instant")
    knee, hip = message.bodies[1].pose.position, state.position[0]
    assert (knee.x, knee.y, knee.z) == pytest.approx((0.2 * math.cos(hip), 0.2 * math.sin(hip), 1.0), abs=1e-12)


def test_a_block_on_the_ground_has_its_weight_as_wrench_and_its_pose_as_odometry(start, tmp_path):
    urdf = tmp_path / "block.urdf"
    urdf.write_text(BLOCK.format(frame="world"))
    scene = tmp_path / "scene.yaml"
    scene.write_text("version: 1\nrobot: {pose: [1, 2, 0.11, 0, 0, 0, 1]}\nground: {}\n")
    bench = start("-p", "base:=free", "-p", f"scene:={scene}", topic="joint_states", urdf=urdf)
    states, odometry = bench.probe.listen(BodyStates, "body_states"), bench.probe.listen(Odometry, "odom")
    weight = 0.5 * 1000 * 0.2**3 * G
    resting = lambda: states and abs(states[-1].bodies[0].wrench.force.z - weight) < 1e-3 * weight and odometry
    wait_until(resting, what="the ground to carry the block")
    body, odom = wait_until(lambda: same_stamp(states, odometry), what="both of one instant")
    assert odom.header.frame_id == "world" and odom.child_frame_id == "block"
    assert odom.pose.pose == body.bodies[0].pose and set(odom.pose.covariance) == {0.0}
    p = odom.pose.pose.position
    assert (p.x, p.y, p.z) == pytest.approx((1.0, 2.0, 0.1), abs=1e-3)


def test_they_are_made_while_somebody_subscribes_and_odometry_only_of_what_floats(bench):
    topics = lambda: dict(bench.probe.node.get_topic_names_and_types())
    wait_until(lambda: {"/body_states", "/joint_monitors"} <= set(topics()), what="the topics to be found")
    assert "/odom" not in topics() and topics()["/body_states"] == ["realnoid/msg/BodyStates"]
    wait_until(lambda: subscribers(bench, "/joint_monitors") == "0", what="diagnostics")
    received = []
    subscription = bench.probe.node.create_subscription(JointMonitors, "joint_monitors", received.append, 10)
    bench.probe.executor.wake()
    wait_until(lambda: received and subscribers(bench, "/joint_monitors") == "1", what="a subscriber that is noticed")
    assert subscribers(bench, "/body_states") == "0"
    bench.probe.node.destroy_subscription(subscription)
    wait_until(lambda: subscribers(bench, "/joint_monitors") == "0", what="a subscriber that has gone")
