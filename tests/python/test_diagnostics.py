"""/diagnostics once a second, /rosout, and the figures at exit."""

import math
import re
import time

import pytest
from conftest import HERE, wait_until
from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState

PARTS = ["real time", "simulation", "commands", "effects", "node", "topics"]


def part(bench, name):
    """The latest status of a part, and its figures."""
    status = next(s for s in bench.diagnostics[-1].status if s.name == f"/forward_dynamics: {name}")
    return status, {v.key: v.value for v in status.values}


def first_report(bench):
    return wait_until(lambda: bench.diagnostics, what="diagnostics")


def test_every_part_is_reported_once_with_the_robot_as_hardware(bench):
    report = first_report(bench)[0]
    assert [s.name for s in report.status] == [f"/forward_dynamics: {name}" for name in PARTS]
    assert {s.hardware_id for s in report.status} == {"arm"}
    for status in report.status:
        keys = [v.key for v in status.values]
        assert len(keys) == len(set(keys)) and status.message
        assert keys or status.name.endswith(": topics"), "nobody else publishes here"
    _, figures = part(bench, "real time")
    for key in ("real-time factor", "lateness p99 [us]", "step time p50 [us]", "step time max [us]", "dropped snapshots"):
        assert math.isfinite(float(figures[key])), key
    # The control loop hands its times over once a second, too.
    wait_until(lambda: float(part(bench, "real time")[1]["step time max [us]"]) > 0, what="step times")


@pytest.mark.alone
def test_reports_are_a_second_apart(bench):
    wait_until(lambda: len(bench.diagnostics) >= 4, what="four reports")
    stamps = [m.header.stamp.sec + 1e-9 * m.header.stamp.nanosec for m in bench.diagnostics[:4]]
    # Stamps are simulated time; the pace is real time. The machine may be late, but no report is left out.
    assert all(0.5 < b - a < 1.5 for a, b in zip(stamps, stamps[1:])), stamps


def test_the_state_is_told_and_the_settings_in_force(bench):
    client = bench.probe.parameters()
    first_report(bench)
    _, figures = part(bench, "simulation")
    assert (figures["state"], figures["engine"], figures["integrator"]) == ("running", "rbx", "implicit_midpoint")
    assert all(r.successful for r in bench.probe.set(client, paused=True, integrator="rk4"))
    wait_until(lambda: part(bench, "simulation")[1]["state"] == "paused", what="the state")
    assert part(bench, "simulation")[0].message == "paused"
    assert bench.probe.set(client, paused=False)[0].successful
    wait_until(lambda: part(bench, "simulation")[1]["integrator"] == "rk4", what="the integrator")


def test_the_error_is_estimated_on_request(bench):
    client = bench.probe.parameters()
    first_report(bench)
    named = lambda: [s for s in bench.diagnostics[-1].status if s.name.endswith(": error")]
    assert not named()
    assert all(r.successful for r in bench.probe.set(client, estimate_error=True, accuracy=1e-8, integrator="extrapolation"))
    # It may begin just before a report.
    told = lambda: next(({v.key: v.value for v in s.values} for s in named()), {})
    figures = wait_until(lambda: (f := told()) and int(f["intervals estimated"]) > 0 and f, what="an estimate")
    assert float(figures["time per estimate [µs]"]) > 0
    assert 0 <= float(figures["largest position error of an interval [rad or m]"]) < 1e-6
    assert bench.probe.set(client, estimate_error=False)[0].successful
    wait_until(lambda: not named(), what="its end")
    [refused] = bench.probe.set(client, accuracy=0.5)
    assert not refused.successful and "1e-14 … 0.01" in refused.reason


def test_effects_are_named_with_what_calls_for_them(start, tmp_path):
    bench = start()
    first_report(bench)
    status, figures = part(bench, "effects")
    assert figures["limits"] == "active, called for by 3 of 3 axes: hip, knee, ankle (<limit>)"
    assert figures["contact"] == figures["mimic"] == "off" and status.message == "gravity, limits, drives, torque_speed_line"
    standing = start("-p", f"scene:={HERE / '../../config/on_the_ground.yaml'}", urdf=None)
    first_report(standing)
    assert part(standing, "effects")[1]["contact"].startswith("active, called for by something to touch")


def test_memory_is_told_and_does_not_grow(bench):
    wait_until(lambda: len(bench.diagnostics) >= 2, what="two reports")
    resident = lambda: float(part(bench, "node")[1]["resident memory [MiB]"])
    before = resident()
    with open(f"/proc/{bench.simulator.process.pid}/status") as file:
        kernel = float(re.search(r"VmRSS:\s+(\d+) kB", file.read())[1]) / 1024
    assert abs(kernel - before) < 5.0
    seen = len(bench.diagnostics)
    wait_until(lambda: len(bench.diagnostics) >= seen + 3, what="three more")
    assert resident() < before + 10.0


def test_refused_commands_and_warnings_show_in_that_second_and_are_counted_on(start):
    # Without warnings of being late.
    bench = start("-p", "max_catch_up:=100000")
    first_report(bench)
    assert part(bench, "commands")[0].message == "none refused"
    # The name of the foot's topic was warned of at start.
    assert part(bench, "node")[1]["warnings"] == "1" and "foot-sole" in part(bench, "node")[1]["last warning"]
    bench.probe.publisher(JointState, "joint_command").publish(JointState(name=["elbow"], position=[0.0]))
    # The refusal and the warning may be told in two reports.
    wait_until(lambda: part(bench, "node")[1]["warnings"] == "2", what="the warning")
    wait_until(lambda: part(bench, "commands")[1]["joint_command refused: unknown name"] == "1", what="the refusal")
    assert "elbow" in part(bench, "node")[1]["last warning"]
    quiet = lambda: part(bench, "commands")[0].message == "none refused in the last second"
    wait_until(lambda: quiet() and part(bench, "node")[0].level == DiagnosticStatus.OK, what="a second without any")
    refused = [m for m in bench.diagnostics if m.status[2].level == bytes([1])]
    assert len(refused) == 1
    warned = [m.status[4] for m in bench.diagnostics if "elbow" in m.status[4].message]
    assert len(warned) == 1 and warned[0].level == DiagnosticStatus.WARN


def test_rosout_has_severity_name_text_and_place(bench):
    said = wait_until(lambda: [m for m in bench.log if "foot-sole" in m.msg], what="the log")[0]
    assert (said.level, said.name) == (30, "forward_dynamics") and said.file.endswith(".rs") and said.line > 0
    assert abs(said.stamp.sec - time.time()) < 60, "the log has real time"


def test_lateness_and_step_time_are_printed_at_the_end(bench):
    wait_until(lambda: len(bench.states) > 300, what="some intervals")
    output = bench.simulator.stop()
    for name in ("lateness", "step time"):
        p50, p99, most = map(float, re.search(rf"^{name} +([\d.]+) +([\d.]+) +([\d.]+)$", output, re.M).groups())
        assert 0 < p50 <= p99 <= most
    assert re.search(r"real-time factor \d\.\d+", output) and "dropped snapshots 0" in output
