"""Lock-step: the world waits for a command that is stamped for its present state."""

import os
import struct
import subprocess
import sys
import time

from conftest import nanoseconds, wait_until
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from services import Services
from simulation_interfaces.srv import ResetSimulation, StepSimulation
from std_msgs.msg import Float64MultiArray

MS = 1_000_000
LOCKSTEP = ("-p", "lockstep:=true")


class Leader:
    """Answers states with commands, as a controller in lock-step does."""

    def __init__(self, bench):
        self.bench, self.publisher = bench, bench.probe.publisher(JointState, "joint_command")

    def command(self, stamp, **fields):
        message = JointState(**fields)
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 10**9)
        self.publisher.publish(message)

    def state(self, stamp):
        """The state at this time, as soon as there is one."""
        find = lambda: next((s for s in reversed(self.bench.states) if nanoseconds(s.header.stamp) == stamp), None)
        deadline = time.monotonic() + 30
        while time.monotonic() < deadline:
            if state := find():
                return state
            time.sleep(0.0002)
        raise AssertionError(f"no state at {stamp} ns")

    def lead(self, steps, torque):
        """Answers every state; the states, with all their bits."""
        history = []
        for i in range(steps):
            state = self.state(i * MS)
            history.append(struct.pack("<9d", *state.position, *state.velocity, *state.effort))
            self.command(i * MS, name=["hip", "knee"], effort=[torque(i), 0.1 * state.position[0]])
        return history


def latest(bench):
    return nanoseconds(bench.states[-1].header.stamp)


def refused(bench, kind):
    return int(bench.count("commands", f"joint_command refused: {kind}") or 0)


def accepted(bench, count, topic="joint_command"):
    wait_until(lambda: bench.count("commands", f"{topic} accepted") == str(count), what="the command")


def stays_at(bench, stamp):
    bench.states.clear()
    wait_until(lambda: len(bench.states) > 5, what="repeated states")
    return {nanoseconds(s.header.stamp) for s in bench.states} == {stamp}


def test_the_world_waits_and_repeats_clock_and_states(start):
    bench = start(*LOCKSTEP)
    clock = bench.probe.listen(Clock, "/clock")
    wait_until(lambda: len(clock) > 5, what="/clock")
    assert {nanoseconds(c.clock) for c in clock} == {0} and stays_at(bench, 0)
    cpu = lambda: sum(map(int, open(f"/proc/{bench.simulator.process.pid}/stat").read().split()[13:15]))
    before, began, diagnostics = cpu(), time.monotonic(), len(bench.diagnostics)
    wait_until(lambda: len(bench.diagnostics) >= diagnostics + 2 and time.monotonic() - began > 2, what="two seconds")
    share = (cpu() - before) / os.sysconf("SC_CLK_TCK") / (time.monotonic() - began)
    assert share < 0.2, "waiting takes next to no CPU time"


def test_each_stamped_command_makes_one_interval(start):
    bench = start(*LOCKSTEP)
    leader = Leader(bench)
    leader.lead(20, lambda i: 0.2)
    leader.state(20 * MS)
    assert stays_at(bench, 20 * MS)
    assert bench.axis("hip")[0] > 0, "the commands are in force"


def test_two_runs_have_the_same_bits_whatever_else_the_machine_does(start):
    def run():
        return Leader(start(*LOCKSTEP)).lead(300, lambda i: 0.5 if i % 7 < 4 else -0.3)

    quiet = run()
    burner = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        busy = run()
    finally:
        burner.kill()
        burner.wait()
    assert quiet == busy and len(set(quiet)) > 250


def test_other_stamps_are_refused_counted_and_said_once(start):
    bench = start(*LOCKSTEP)
    leader = Leader(bench)
    leader.lead(5, lambda i: 0.0)
    leader.state(5 * MS)
    for stamp in (4 * MS, 4 * MS, 6 * MS):
        leader.command(stamp, name=["hip"], effort=[1.0])
    wait_until(lambda: refused(bench, "stamp of the past") == 2 and refused(bench, "stamp of the future") == 1, what="refusals")
    assert stays_at(bench, 5 * MS)
    for text in ("stamp of the past", "stamp of the future"):
        assert len(wait_until(lambda: bench.logged(text), what="the log")) == 1
    # A command that is refused for another reason does not lead either, and leaves the place to the next one.
    leader.command(5 * MS, name=["elbow"], effort=[1.0])
    wait_until(lambda: refused(bench, "unknown name") == 1, what="the refusal")
    assert stays_at(bench, 5 * MS)
    leader.command(5 * MS, name=["hip"], effort=[0.0])
    leader.state(6 * MS)


def test_commands_without_a_stamp_take_effect_and_lead_nobody(start):
    bench = start(*LOCKSTEP)
    leader = Leader(bench)
    leader.lead(1, lambda i: 0.0)
    leader.state(1 * MS)
    leader.command(0, name=["knee"], effort=[3.0])
    accepted(bench, 2)
    bench.probe.publisher(Float64MultiArray, "effort_command").publish(Float64MultiArray(data=[2.0, 3.0, 0.0]))
    accepted(bench, 1, "effort_command")
    assert stays_at(bench, 1 * MS)
    leader.command(1 * MS, name=["ankle"], effort=[0.0])
    state = leader.state(2 * MS)
    assert state.effort[0] > 1 and state.effort[1] > 1, "they are in force in the next interval"


def test_steps_are_made_in_lock_step_too(start):
    bench = start(*LOCKSTEP)
    services, leader = Services(bench), Leader(bench)
    assert services(StepSimulation, steps=10).result.result == 1
    leader.state(10 * MS)
    leader.command(10 * MS, name=["hip"], effort=[0.0])
    leader.state(11 * MS)
    # Paused, only steps count; what comes for the present state leads on as soon as time goes on.
    client = bench.probe.parameters()
    assert bench.probe.set(client, paused=True)[0].successful
    leader.command(11 * MS, name=["hip"], effort=[0.0])
    accepted(bench, 2)
    assert stays_at(bench, 11 * MS)
    assert bench.probe.set(client, paused=False)[0].successful
    leader.state(12 * MS)
    assert stays_at(bench, 12 * MS)


def test_a_reset_of_time_begins_lock_step_anew(start):
    bench = start(*LOCKSTEP)
    leader = Leader(bench)
    first = leader.lead(20, lambda i: 0.7)
    leader.state(20 * MS)
    Services(bench)(ResetSimulation)
    wait_until(lambda: latest(bench) == 0, what="time 0")
    bench.states.clear()
    assert leader.lead(20, lambda i: 0.7) == first


def test_lock_step_is_switched_on_and_off_while_the_node_runs(bench):
    client = bench.probe.parameters()
    [bad] = bench.probe.set(client, lockstep=1)
    assert not bad.successful and "lockstep" in bad.reason
    assert bench.probe.set(client, lockstep=True)[0].successful
    leader, stamp = Leader(bench), bench.stands()
    leader.command(stamp, name=["hip"], effort=[0.0])
    leader.state(stamp + MS)
    assert bench.probe.set(client, lockstep=False)[0].successful
    wait_until(lambda: latest(bench) > stamp + 100 * MS, what="time to run")
    leader.command(1, name=["hip"], effort=[0.0])
    accepted(bench, 2)


def test_after_its_timeout_the_world_goes_on_by_one_interval(start):
    bench = start(*LOCKSTEP, "-p", "lockstep_timeout:=0.05")
    wait_until(lambda: latest(bench) >= 5 * MS, what="intervals without a command")
    stamps = sorted({nanoseconds(s.header.stamp) for s in bench.states})
    assert {b - a for a, b in zip(stamps, stamps[1:])} == {MS}
    wait_until(lambda: int(bench.count("commands", "lock-step intervals without a command") or 0) >= 5, what="the count")
    client = bench.probe.parameters()
    [bad] = bench.probe.set(client, lockstep_timeout=-1.0)
    assert not bad.successful and "0.0 … 3600.0" in bad.reason
    assert bench.probe.set(client, lockstep_timeout=0.0)[0].successful
    wait_until(lambda: stays_at(bench, latest(bench)), what="the world to stand")
