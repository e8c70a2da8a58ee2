"""The three command topics move the robot; a bad command leaves it alone, is counted, and is said once."""

import math

import pytest
from conftest import nanoseconds, wait_until
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

NAN, INFINITY = math.nan, math.inf


def array(*values):
    return Float64MultiArray(data=values)


def joints(name, position=(), velocity=(), effort=()):
    return JointState(name=list(name), position=list(position), velocity=list(velocity), effort=list(effort))


def test_every_axis_holds_its_initial_position_at_start(bench):
    wait_until(lambda: len(bench.states) > 200, what="states")
    assert all(abs(q) < 1e-6 for q in bench.states[-1].position)


@pytest.mark.parametrize("torque", [0.4, -0.4])
def test_effort_command_turns_the_axis_its_way_and_is_reported(bench, torque):
    bench.probe.publisher(Float64MultiArray, "effort_command").publish(array(torque, 0.0, 0.0))
    # The first such state: later ones are at the stop.
    turned = lambda: next((s for s in list(bench.states) if s.position[0] * torque > 0.02), None)
    state = wait_until(turned, what="the hip to turn")
    assert state.name[0] == "hip"
    velocity, effort = state.velocity[0], state.effort[0]
    assert velocity * torque > 0
    assert 0 < effort / torque <= 1 + 1e-9, "torque on the line from applied torque at rest to zero at no-load speed"


def test_servo_command_reaches_its_target_without_leaving_the_modes_that_are_fixed(start):
    bench = start()
    publisher = bench.probe.publisher(JointState, "joint_command")
    publisher.publish(joints(["hip", "knee"], position=[0.3, -0.2]))
    wait_until(lambda: abs(bench.axis("hip")[0] - 0.3) < 0.01 and abs(bench.axis("knee")[0] + 0.2) < 0.01, what="the targets")


def test_servo_command_by_array(start, tmp_path):
    from conftest import ARM

    urdf = tmp_path / "arm.urdf"
    urdf.write_text(ARM.read_text().replace('switchable="false"', ""))
    bench = start(urdf=urdf)
    bench.probe.publisher(Float64MultiArray, "servo_command").publish(array(0.2, 0.1, -0.1))
    wait_until(lambda: all(abs(q - t) < 0.01 for q, t in zip(bench.states[-1].position, (0.2, 0.1, -0.1))), what="the targets")


def test_joint_command_by_effort_moves_only_the_named_axis(bench):
    bench.probe.publisher(JointState, "joint_command").publish(joints(["knee"], velocity=[2.0], effort=[1.0]))
    wait_until(lambda: bench.axis("knee")[0] > 0.1, what="the knee to turn")
    assert abs(bench.axis("hip")[0]) < 0.05, "the hip holds"


BAD = [
    ("effort_command", array(1.0), "wrong size"),
    ("effort_command", array(5.0, NAN, 0.0), "not finite"),
    ("effort_command", array(), "wrong size"),
    ("servo_command", array(0.5, INFINITY, 0.0), "not finite"),
    ("servo_command", array(0.5, 0.5, 0.5, 0.5), "wrong size"),
    ("servo_command", array(0.5, 0.5, 0.5), "mode switch not allowed"),
    ("joint_command", joints(["hip", "elbow"], effort=[5.0, 5.0]), "unknown name"),
    ("joint_command", joints(["hip", "hip"], effort=[5.0, 5.0]), "duplicate name"),
    ("joint_command", joints(["hip", "knee"], position=[0.5]), "wrong size"),
    ("joint_command", joints(["hip", "knee"], position=[0.5, NAN]), "not finite"),
    ("joint_command", joints(["hip", "ankle"], position=[0.5, 0.5]), "mode switch not allowed"),
    ("joint_command", joints(["hip"], velocity=[-1.0], effort=[5.0]), "torque against speed"),
    ("joint_command", joints(["hip"], velocity=[0.0], effort=[5.0]), "torque against speed"),
    ("joint_command", joints(["hip"]), "no values"),
]


def test_each_bad_command_is_refused_whole_counted_and_said_once(bench):
    publishers = {t: bench.probe.publisher(type(m), t) for t, m, _ in BAD}
    expected = {}
    for topic, message, kind in BAD:
        for _ in range(3):
            publishers[topic].publish(message)
            expected[topic, kind] = expected.get((topic, kind), 0) + 1
    total = sum(expected.values())

    def counted():
        return {key: int(bench.count("commands", f"{key[0]} refused: {key[1]}") or 0) for key in expected}

    wait_until(lambda: sum(counted().values()) == total, what=f"{total} refusals")
    assert counted() == expected
    for topic, kind in expected:
        said = wait_until(lambda: bench.logged(f"{topic} refused, {kind}"), what=f"the log of {topic}, {kind}")
        assert len(said) == 1, f"{topic}, {kind}: said {len(said)} times"
        assert len(said[0]) > len(f"{topic} refused, {kind}: "), "with its reason"
    assert all(bench.count("commands", f"{topic} accepted") == "0" for topic in publishers)
    for state in list(bench.states):
        assert all(abs(q) < 1e-6 for q in state.position), f"moved at {nanoseconds(state.header.stamp)} ns"


def test_mode_switches_can_be_forbidden_by_parameter(start):
    bench = start("-p", "allow_mode_switch:=false")
    publisher = bench.probe.publisher(JointState, "joint_command")
    publisher.publish(joints(["hip"], effort=[1.0]))
    wait_until(lambda: bench.logged("parameter allow_mode_switch forbids"), what="the refusal")
    publisher.publish(joints(["hip"], position=[0.2]))
    wait_until(lambda: abs(bench.axis("hip")[0] - 0.2) < 0.01, what="the servo, which it is in already")
    [result] = bench.probe.set(bench.probe.parameters(), allow_mode_switch=True)
    assert result.successful
    publisher.publish(joints(["hip"], effort=[1.0]))
    wait_until(lambda: bench.axis("hip")[0] > 0.4, what="the torque")


def test_start_free_leaves_the_modes_of_the_drive_tags(start):
    bench = start("-p", "start:=free")
    bench.probe.publisher(JointState, "joint_command").publish(joints(["ankle"], effort=[0.05]))
    wait_until(lambda: abs(bench.axis("knee")[0]) > 0.005, what="the idle knee to be dragged along")
    assert bench.axis("knee")[2] == 0.0, "an idle drive gives no torque"
