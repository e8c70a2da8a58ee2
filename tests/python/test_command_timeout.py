"""Command timeout: what the axes do when nobody commands them any more."""

import struct

import pytest
from conftest import ARM, nanoseconds, wait_until
from sensor_msgs.msg import JointState
from services import Services
from simulation_interfaces.srv import ResetSimulation, StepSimulation

MS = 1_000_000


def start_with(start, policy, *arguments, **options):
    bench = start("-p", "command_timeout:=0.1", "-p", f"on_timeout:={policy}", *arguments, **options)
    return bench, bench.probe.publisher(JointState, "joint_command")


def timeouts(bench):
    return int(bench.count("commands", "command timeouts") or 0)


def joints(name, **fields):
    return JointState(name=name, **fields)


def after(bench, command, steps=100):
    """Bits of the states from the step after the command on, of a paused world."""
    publisher, services = bench.probe.publisher(JointState, "joint_command"), Services(bench)
    publisher.publish(command)
    wait_until(lambda: bench.count("commands", "joint_command accepted") == "1", what="the command")
    assert services(StepSimulation, steps=steps).result.result == 1
    done = lambda: nanoseconds(bench.states[-1].header.stamp) == steps * MS
    wait_until(done, what="the steps")
    wanted = {nanoseconds(s.header.stamp): s for s in bench.states}
    return [wanted[i * MS] for i in range(steps + 1)]


def test_nothing_times_out_before_the_first_command_and_without_the_parameter(start):
    bench, _ = start_with(start, "idle")
    wait_until(lambda: len(bench.states) > 400, what="states")
    assert all(abs(q) < 1e-6 for q in bench.states[-1].position), "the start holds on"
    wait_until(lambda: bench.count("commands", "command timeouts") == "0", what="the count")
    other = start()
    other.probe.publisher(JointState, "joint_command").publish(joints(["knee"], effort=[0.05]))
    wait_until(lambda: abs(other.axis("knee")[0]) > 0.1, what="the knee")
    wait_until(lambda: len(other.states) > 600, what="states")
    assert abs(other.axis("knee")[2]) > 0, "the command is still in force"


def test_hold_servos_where_the_axes_are(start):
    bench, publisher = start_with(start, "hold")
    publisher.publish(joints(["knee"], effort=[0.5]))
    wait_until(lambda: timeouts(bench) == 1, what="the timeout")
    # Not the rest before the command: reports and states are two topics.
    wait_until(lambda: bench.axis("knee")[0] > 0.01 and abs(bench.axis("knee")[1]) < 1e-9, what="rest")
    knee = bench.axis("knee")[0]
    assert 0.01 < knee < 1.99, "where it was, not at its stop"
    said = wait_until(lambda: bench.logged("no command for 0.1 s"), what="what is said of it")
    assert "hold" in said[0]
    left_out = wait_until(lambda: bench.logged("leaves axes out"), what="what is left out")
    assert len(left_out) == 1 and "ankle" in left_out[0] and "knee" not in left_out[0]
    # What was commanded before does not come back through a command for another axis; the next timeout counts anew.
    publisher.publish(joints(["hip"], position=[0.1]))
    wait_until(lambda: timeouts(bench) == 2, what="the second timeout")
    # The report may come before the states of the time that it is about.
    wait_until(lambda: bench.axis("hip")[0] > 0.05, what="the hip")
    assert abs(bench.axis("knee")[0] - knee) < 0.01


def test_idle_lets_go(start):
    bench, publisher = start_with(start, "idle")
    publisher.publish(joints(["hip", "knee"], position=[0.3, 0.0]))
    wait_until(lambda: timeouts(bench) == 1, what="the timeout")
    wait_until(lambda: any(s.position[0] > 0.01 for s in list(bench.states)), what="the hip, on its way")
    wait_until(lambda: bench.states[-1].effort[:2].tolist() == [0.0, 0.0], what="no torque")
    bench.states.clear()
    wait_until(lambda: len(bench.states) > 50, what="states")
    assert all(s.effort[:2].tolist() == [0.0, 0.0] for s in bench.states)


def test_brake_slows_down_as_the_short_circuited_motor_and_ends_with_the_next_command(start, tmp_path):
    """Gear and motor: torque = −(20 N·m / 10 rad/s) · speed, as if the tag had short_brake."""
    paused = ("-p", "start:=paused")
    bench, _ = start_with(start, "brake", *paused)
    states = after(bench, joints(["hip"], effort=[1.0], velocity=[10.0]), 130)
    # 100 ms after the interval that took the command: the first interval in which the brake works ends at 101 ms.
    for state in states[105:]:
        speed, effort = state.velocity[0], state.effort[0]
        assert speed > 0 > effort and effort == pytest.approx(-2.0 * speed, rel=0.05), "the brake"
    assert states[100].effort[0] > 0, "the command, to the last interval"
    # A command ends it: without torque the hip is free again.
    publisher = bench.probe.publisher(JointState, "joint_command")
    publisher.publish(joints(["hip"], effort=[0.0]))
    wait_until(lambda: bench.count("commands", "joint_command accepted") == "2", what="the command")
    assert Services(bench)(StepSimulation, steps=5).result.result == 1
    wait_until(lambda: nanoseconds(bench.states[-1].header.stamp) == 135 * MS, what="the steps")
    assert bench.axis("hip")[2] == 0.0


def test_the_tags_own_brake_is_left_alone(start, tmp_path):
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(ARM.read_text().replace('<drive mode="idle" ', '<drive mode="torque" short_brake="true" '))
    # In steps: the hip is still on its way when the next command comes, however long that takes.
    bench, publisher = start_with(start, "brake", "-p", "start:=free", "-p", "paused:=true", urdf=urdf)
    services, sent, done = Services(bench), 0, 0

    def commanded(effort, steps):
        nonlocal sent, done
        sent, done = sent + 1, done + steps
        publisher.publish(joints(["hip"], effort=[effort]))
        wait_until(lambda: bench.count("commands", "joint_command accepted") == str(sent), what="the command")
        assert services(StepSimulation, steps=steps).result.result == 1
        wait_until(lambda: nanoseconds(bench.states[-1].header.stamp) == done * MS, what="the steps")

    commanded(1.0, 150)
    wait_until(lambda: timeouts(bench) == 1, what="the timeout")
    services(ResetSimulation, scope=ResetSimulation.Request.SCOPE_STATE)
    commanded(5.0, 80)
    assert bench.axis("hip")[1] > 0.5, "the hip moves"
    commanded(0.0, 2)
    assert bench.axis("hip")[2] < -0.1, "the brake of the tag"
    assert timeouts(bench) == 1, "and not that of the timeout"


@pytest.mark.parametrize("policy", ["hold", "idle", "brake"])
def test_a_timeout_comes_at_the_same_step_every_time(start, policy):
    bits = lambda s: struct.pack("<9d", *s.position, *s.velocity, *s.effort)
    runs = []
    for _ in range(2):
        bench, _ = start_with(start, policy, "-p", "start:=paused")
        runs.append([bits(s) for s in after(bench, joints(["hip", "knee"], effort=[0.5, 0.2]), 150)])
    assert runs[0] == runs[1]
    never = start("-p", "start:=paused")
    without = [bits(s) for s in after(never, joints(["hip", "knee"], effort=[0.5, 0.2]), 150)]
    assert runs[0][:101] == without[:101] and runs[0][101] != without[101], "after 100 ms to the step"


def test_a_reset_ends_the_timeout(start):
    bench, publisher = start_with(start, "brake")
    publisher.publish(joints(["knee"], effort=[0.5]))
    wait_until(lambda: timeouts(bench) == 1, what="the timeout")
    wait_until(lambda: any("on_timeout is in force" in s.message for s in bench.diagnostics[-1].status), what="the warning")
    wait_until(lambda: abs(bench.axis("knee")[0]) > 0.01, what="the knee where the timeout left it")
    Services(bench)(ResetSimulation, scope=ResetSimulation.Request.SCOPE_STATE)
    wait_until(lambda: abs(bench.axis("knee")[0]) < 1e-6, what="the knee at its start")
    in_force = lambda: any("on_timeout is in force" in s.message for s in bench.diagnostics[-1].status)
    wait_until(lambda: not in_force(), what="the end of the warning")
    assert timeouts(bench) == 1 and abs(bench.axis("knee")[0]) < 1e-6, "held as at the start"


def test_values_that_make_no_sense_are_refused(bench):
    client = bench.probe.parameters()
    for name, value, reason in [
        ("command_timeout", -0.1, "0.0 … 3600.0 s"),
        ("command_timeout", 1, "type double"),
        ("on_timeout", "panic", "hold | idle | brake"),
    ]:
        [result] = bench.probe.set(client, **{name: value})
        assert not result.successful and name in result.reason and reason in result.reason
    assert bench.probe.set(client, command_timeout=0.5, on_timeout="brake")[0].successful
    assert bench.probe.get(client, "on_timeout") == "brake"
