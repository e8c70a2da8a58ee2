"""Ten seconds at 1 ms: nothing lost, stamps on the grid; and what happens to a node that was held up (W-17)."""

import re
import signal
import time

import pytest
from conftest import nanoseconds, wait_until

pytestmark = pytest.mark.alone

INTERVAL = 1_000_000


def steps(stamps):
    return {b - a for a, b in zip(stamps, stamps[1:])}


def test_ten_seconds_of_the_humanoid_at_one_millisecond_lose_nothing(start, capsys):
    bench = start(urdf=None)
    first = nanoseconds(bench.states[0].header.stamp)
    wait_until(lambda: nanoseconds(bench.states[-1].header.stamp) >= first + 10 * 10**9, what="10 s")
    states = list(bench.states)
    assert len(states[0].name) >= 30
    stamps = [nanoseconds(s.header.stamp) for s in states]
    assert steps(stamps) == {INTERVAL}, "a JointState was lost, or its stamp is off the grid"
    assert len(states) >= 10_001
    real_time = {key: bench.count("real time", key) for key in FIGURES}
    output = bench.simulator.stop()
    factor = float(re.search(r"real-time factor ([0-9.]+)", output)[1])
    with capsys.disabled():
        print(f"\n{len(states)} JointStates without a gap; last second: {real_time}\n{output[output.index('simulated'):]}")
    assert 0.99 < factor < 1.01
    assert "dropped snapshots 0" in output


FIGURES = ["real-time factor", "lateness p50 [us]", "lateness p99 [us]", "lateness max [us]",
           "step time p50 [us]", "step time p99 [us]", "step time max [us]", "dropped snapshots", "overruns"]


def slow_down(bench, client):
    """1000 steps of the humanoid take several control intervals."""
    assert bench.probe.set(client, steps_per_interval=1000)[0].successful


def test_a_backlog_is_caught_up_interval_by_interval(start):
    bench = start("-p", "max_catch_up:=100000", urdf=None)
    client = bench.probe.parameters()
    wait_until(lambda: bench.diagnostics, what="diagnostics")
    began, stamp = time.monotonic(), nanoseconds(bench.states[-1].header.stamp)

    def behind():
        return (time.monotonic() - began) - (nanoseconds(bench.states[-1].header.stamp) - stamp) * 1e-9

    slow_down(bench, client)
    wait_until(lambda: behind() > 0.2, what="the loop to fall behind")
    assert bench.probe.set(client, steps_per_interval=1)[0].successful
    wait_until(lambda: behind() < 0.05, what="the loop to catch up")
    seen = len(bench.diagnostics)
    wait_until(lambda: len(bench.diagnostics) > seen + 1, what="diagnostics after the backlog")
    assert int(bench.count("real time", "overruns")) > 100
    assert bench.count("real time", "deadline set anew") == "0"
    states = list(bench.states)
    first, last = nanoseconds(states[0].header.stamp), nanoseconds(states[-1].header.stamp)
    missing = (last - first) // INTERVAL + 1 - len(states)
    assert missing == int(bench.count("real time", "dropped snapshots")), "each interval is seen, or counted as dropped"


def test_beyond_the_bound_real_time_is_given_up_and_counted(start):
    bench = start("-p", "max_catch_up:=20", urdf=None)
    slow_down(bench, bench.probe.parameters())
    wait_until(lambda: bench.logged("too slow for real time"), what="the warning")
    # The log does not wait for the report.
    wait_until(lambda: int(bench.count("real time", "deadline set anew") or 0) > 0, what="the count")
    wait_until(lambda: float(bench.count("real time", "real time given up [s]")) > 0.01, what="the time given up")
    assert steps([nanoseconds(s.header.stamp) for s in list(bench.states)]) == {INTERVAL}, "simulated time has no gap"


def test_as_fast_as_possible_drops_no_state(start):
    bench = start("-p", "real_time_factor:=0", "-p", "tf_rate:=0", "-p", "control_interval:=0.01")
    wait_until(lambda: len(bench.diagnostics) > 1, what="diagnostics")
    assert bench.count("real time", "dropped snapshots") == "0"
    assert float(bench.count("real time", "real-time factor")) > 2


def test_half_speed(start):
    bench = start("-p", "real_time_factor:=0.5")
    wait_until(lambda: len(bench.diagnostics) > 1, what="diagnostics")
    assert abs(float(bench.count("real time", "real-time factor")) - 0.5) < 0.05


def test_time_stands_still_at_time_scale_0_and_clock_repeats(start):
    bench = start("-p", "time_scale:=0.0")
    wait_until(lambda: len(bench.states) > 50, what="states")
    assert {nanoseconds(s.header.stamp) for s in list(bench.states)} == {0}


def test_a_stopped_and_continued_process_connects_again(bench):
    """RustDDS ends its event loops when SIGSTOP interrupts them; Ctrl-Z and fg must not make the node mute."""
    bench.simulator.process.send_signal(signal.SIGSTOP)
    time.sleep(0.2)
    bench.simulator.process.send_signal(signal.SIGCONT)
    wait_until(lambda: bench.logged("connected to ROS again"), what="the new connection")
    before = len(bench.states)
    wait_until(lambda: len(bench.states) > before + 500, what="states")
    client = bench.probe.parameters()
    assert bench.probe.get(client, "engine") == "rbx"
