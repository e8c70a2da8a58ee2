"""What the node publishes, seen by rclpy (Fast DDS) and by Cyclone DDS."""

import math

from conftest import ARM, LATCHED, nanoseconds, wait_until
from cyclone import listen as cyclone_listen
from geometry_msgs.msg import TwistStamped
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, String


def test_joint_states_carry_every_axis_under_its_urdf_name(bench):
    state = bench.states[0]
    assert list(state.name) == ["hip", "knee", "ankle"]
    assert len(state.position) == len(state.velocity) == len(state.effort) == 3
    assert list(state.name) == bench.probe.get(bench.probe.parameters(), "axes")


def test_best_effort_subscribers_are_served_too(bench):
    states = bench.probe.listen(JointState, "joint_states", qos_profile_sensor_data)
    wait_until(lambda: len(states) > 10, what="best-effort samples")


def test_clock_and_joint_states_advance_together(bench):
    clocks = bench.probe.listen(Clock, "/clock")
    wait_until(lambda: len(clocks) > 200, what="/clock")
    stamps = [nanoseconds(c.clock) for c in clocks]
    assert {b - a for a, b in zip(stamps, stamps[1:])} == {1_000_000}
    assert bench.probe.node.get_publishers_info_by_topic("/clock")[0].topic_type == "rosgraph_msgs/msg/Clock"
    assert len(bench.probe.node.get_publishers_info_by_topic("/clock")) == 1


def test_twists_in_the_frame_that_the_monitor_tag_asks_for(start):
    # Four streams at 1 kHz are more than rclpy reads on a slow machine.
    bench = start("-p", "control_interval:=0.004")
    topics = {"thigh": "twist/thigh", "shank": "twist/shank", "foot-sole": "twist/foot_sole"}
    twists = {link: bench.probe.listen(TwistStamped, topic) for link, topic in topics.items()}
    # The hip moves for a second or two, until it is at its stop: everybody has to listen before.
    wait_until(lambda: all(twists.values()), what="twists")
    push = bench.probe.publisher(Float64MultiArray, "effort_command")
    push.publish(Float64MultiArray(data=[0.5, 0.0, 0.0]))
    frames = {"thigh": "thigh", "shank": "world", "foot-sole": "world"}
    for link, messages in twists.items():
        state, twist = wait_until(lambda: moving(bench.states, messages), what=f"the hip to move, and the twist of {link}")[-1]
        assert twist.header.frame_id == frames[link]
        axes_before = {"thigh": 1, "shank": 2, "foot-sole": 3}[link]
        turning = sum(state.velocity[:axes_before])
        assert math.isclose(twist.twist.angular.z, turning, rel_tol=1e-9, abs_tol=1e-9)
    check_linear_velocity_of_the_knee(moving(bench.states, twists["shank"]))
    assert wait_until(lambda: bench.logged("foot-sole"), what="the changed topic name in the log")


def moving(states, twists):
    """The states in which the hip is fast, each with the twist of its instant."""
    by_stamp = {nanoseconds(s.header.stamp): s for s in list(states) if abs(s.velocity[0]) > 0.5}
    return [(by_stamp[t], twist) for twist in list(twists) if (t := nanoseconds(twist.header.stamp)) in by_stamp]


def check_linear_velocity_of_the_knee(pairs):
    """The shank's origin is the knee, 0.2 m from the hip: along the world's axes it moves on a circle."""
    for state, twist in pairs[-50:]:
        q, v = state.position[0], state.velocity[0]
        assert math.isclose(twist.twist.linear.x, -0.2 * v * math.sin(q), rel_tol=1e-9, abs_tol=1e-9)
        assert math.isclose(twist.twist.linear.y, 0.2 * v * math.cos(q), rel_tol=1e-9, abs_tol=1e-9)


def test_a_late_joiner_gets_the_robot_description(bench):
    wait_until(lambda: len(bench.states) > 300, what="some time to pass")
    texts = bench.probe.listen(String, "robot_description", LATCHED)
    wait_until(lambda: texts, what="the latched robot_description")
    assert texts[0].data == ARM.read_text()


def test_tf_and_tf_static_as_a_second_dds_vendor_sees_them(bench):
    static = cyclone_listen("tf_static", bench.domain, latched=True)
    moving = cyclone_listen("tf", bench.domain)
    fixed = wait_until(static.take_all, what="/tf_static")[0].transforms
    assert {(t.header.frame_id, t.child_frame_id) for t in fixed} == {("world", "base"), ("foot-sole", "toe")}
    toe = next(t for t in fixed if t.child_frame_id == "toe").transform
    for value, urdf in zip((toe.translation.x, toe.translation.y, toe.translation.z), (0.1, 0.0, -0.02)):
        assert math.isclose(value, urdf, abs_tol=1e-12)
    messages = []
    wait_until(lambda: messages.extend(moving.take_all()) or len(messages) > 20, what="/tf")
    edges = {(t.header.frame_id, t.child_frame_id) for t in messages[0].transforms}
    assert edges == {("base", "thigh"), ("thigh", "shank"), ("shank", "foot-sole")}
    stamps = [nanoseconds(m.transforms[0].header.stamp) for m in messages]
    assert {b - a for a, b in zip(stamps, stamps[1:])} == {20_000_000}, "50 Hz of simulated time"
    quaternion = messages[0].transforms[0].transform.rotation
    assert math.isclose(quaternion.w, 1.0, abs_tol=1e-6)


def test_joint_states_reach_a_second_dds_vendor(bench):
    states = cyclone_listen("joint_states", bench.domain)
    messages = []
    wait_until(lambda: messages.extend(states.take_all()) or len(messages) > 500, what="joint_states by Cyclone DDS")
    stamps = [nanoseconds(m.header.stamp) for m in messages]
    assert {b - a for a, b in zip(stamps, stamps[1:])} == {1_000_000}
    assert list(messages[0].name) == ["hip", "knee", "ankle"]
