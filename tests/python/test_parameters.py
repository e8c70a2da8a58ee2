"""Parameters through rclpy's services, from the command line and from files."""

import itertools
import subprocess

import pytest
import yaml
from conftest import BINARY, HERE, nanoseconds, wait_until
from rcl_interfaces.msg import ParameterEvent
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

DEFAULTS = yaml.safe_load((HERE / "../../config/default.yaml").read_text())["/**"]["ros__parameters"]


def test_list_get_and_types_agree_with_the_default_file(bench):
    client = bench.probe.parameters()
    names = bench.probe.call(lambda: client.list_parameters([], 0)).result.names
    assert set(names) == set(DEFAULTS) | {"axes"}
    assert {name: bench.probe.get(client, name) for name in DEFAULTS} == DEFAULTS
    assert bench.probe.call(lambda: client.list_parameters(["tf_rate"], 0)).result.names == ["tf_rate"]
    for prefixes, depth, some in ((["effects"], 0, "effects.gravity"), (["effects"], 1, "effects.contact"), ([], 2, "effects.mimic")):
        listed = bench.probe.call(lambda: client.list_parameters(prefixes, depth)).result
        assert some in listed.names and listed.prefixes == ["effects"]
    assert not any("." in name for name in bench.probe.call(lambda: client.list_parameters([], 1)).result.names)
    assert list(bench.probe.call(lambda: client.get_parameter_types(["gravity", "nonsense"])).types) == [8, 0]


def test_describe_tells_text_unit_range_and_read_only(bench):
    client = bench.probe.parameters()
    call = lambda: client.describe_parameters(["steps_per_interval", "time_scale", "axes", "base", "integrator"])
    steps, scale, axes, base, integrator = bench.probe.call(call).descriptors
    assert steps.type == 2 and steps.description.startswith("Physics steps")
    assert (steps.integer_range[0].from_value, steps.integer_range[0].to_value) == (1, 1000)
    assert (scale.floating_point_range[0].from_value, scale.floating_point_range[0].to_value) == (0.0, 100.0)
    assert axes.read_only and base.read_only and not steps.read_only
    assert "implicit_midpoint | semi_implicit_euler | rk4" in integrator.additional_constraints


def test_set_takes_effect_and_is_announced(bench):
    events = bench.probe.listen(ParameterEvent, "/parameter_events")
    client = bench.probe.parameters()
    # What is announced before the subscription is matched reaches nobody: wait until something does.
    tries = itertools.count(20)
    wait_until(lambda: bench.probe.set(client, solver_iterations=next(tries)) and events, what="a first event")
    [result] = bench.probe.set(client, control_interval=0.002)
    assert result.successful
    assert bench.probe.get(client, "control_interval") == 0.002
    wait_until(lambda: steps_of(bench)[-20:] == [2_000_000] * 20, what="stamps 2 ms apart")
    changed = lambda: [p.name for e in events for p in e.changed_parameters if p.name != "solver_iterations"]
    wait_until(lambda: changed() == ["control_interval"], what="the event")


def steps_of(bench):
    stamps = [nanoseconds(s.header.stamp) for s in list(bench.states)[-30:]]
    return [b - a for a, b in zip(stamps, stamps[1:])]


REFUSED = [
    ("steps_per_interval", 0, "parameter 'steps_per_interval' = 0 is out of range: 1 … 1000"),
    ("solver_iterations", 10001, "1 … 10000"),
    ("time_scale", -1.0, "0.0 … 100.0"),
    ("time_scale", float("nan"), "NaN"),
    ("control_interval", 0.0, "1e-6 … 1.0 s"),
    ("gravity", [0.0, 0.0], "3 finite numbers"),
    ("integrator", "rk45", "implicit_midpoint | semi_implicit_euler | rk4"),
    ("time_scale", 1, "is of type double, 1 is of type integer"),
    ("base", "free", "at start only"),
    ("axes", ["a"], "read-only"),
    ("nonsense", 1, "there is no parameter 'nonsense'"),
]


def test_refusals_carry_name_value_and_range(bench):
    client = bench.probe.parameters()
    for name, value, reason in REFUSED:
        [result] = bench.probe.set(client, **{name: value})
        assert not result.successful
        assert name in result.reason and reason in result.reason, result.reason
    assert {name: bench.probe.get(client, name) for name in DEFAULTS} == DEFAULTS, "nothing has changed"


def test_an_atomic_set_changes_all_or_nothing(bench):
    client = bench.probe.parameters()
    good, bad = Parameter("tf_rate", value=10.0), Parameter("time_scale", value=-1.0)
    result = bench.probe.call(lambda: client.set_parameters_atomically([good, bad])).result
    assert not result.successful and bench.probe.get(client, "tf_rate") == DEFAULTS["tf_rate"]
    result = bench.probe.call(lambda: client.set_parameters_atomically([good])).result
    assert result.successful and bench.probe.get(client, "tf_rate") == 10.0


def test_parameter_file_sections_and_later_assignments(start, tmp_path):
    file = tmp_path / "bench.yaml"
    file.write_text(
        "/**:\n  ros__parameters: {tf_rate: 7.0, time_scale: 0.5}\n"
        "forward_dynamics:\n  ros__parameters: {tf_rate: 8}\n"
        "somebody_else:\n  ros__parameters: {speed: 1}\n"
    )
    bench = start("--params-file", file, "-p", "solver_iterations:=20")
    client = bench.probe.parameters()
    values = [bench.probe.get(client, n) for n in ("tf_rate", "time_scale", "solver_iterations")]
    assert values == [8.0, 0.5, 20]


@pytest.mark.parametrize("written", ["off", "'off'"])
def test_effects_are_switched_at_start(start, tmp_path, written):
    scene = tmp_path / "scene.yaml"
    scene.write_text("version: 1\nworld: {effects: {limits: true, gravity: false}}\n")
    bench = start("-p", f"scene:={scene}", "-p", f"effects.limits:={written}", "-p", "effects.friction:=on")
    client = bench.probe.parameters()
    values = {name: bench.probe.get(client, f"effects.{name}") for name in ("limits", "friction", "gravity")}
    assert values == {"limits": "off", "friction": "on", "gravity": "auto"}
    bench.probe.publisher(JointState, "joint_command").publish(JointState(name=["knee"], effort=[5.0]))
    wait_until(lambda: bench.axis("knee")[0] > 2.5, what="the knee beyond its stop")
    [result] = bench.probe.set(client, **{"effects.limits": "on"})
    assert not result.successful and "effects.limits" in result.reason and "at start only" in result.reason


def test_an_effect_that_is_switched_to_nonsense_is_refused():
    for argument, reason in (
        ("effects.limits:=maybe", "parameter 'effects.limits' = maybe is out of range: auto | on | off"),
        ("effects.magic:=on", "there is no parameter 'effects.magic'"),
    ):
        result = run("--ros-args", "-p", argument)
        assert result.returncode == 2 and reason in result.stderr, result.stderr


def run(*arguments):
    return subprocess.run([BINARY, "run", *map(str, arguments)], capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize(
    "text, message",
    [
        ("forward_dynamics:\n  ros__parameters:\n    speed: 1\n", ":3: there is no parameter 'speed'"),
        ("/**:\n  ros__parameters:\n    time_scale: 1.0\n    steps_per_interval: 0\n", ":4: parameter 'steps_per_interval' = 0"),
        ("/**:\n  ros__parameters:\n    gravity: down\n", ":3: parameter 'gravity' is of type double array, down is of type string"),
        ("/**: [\n", "bench.yaml"),
    ],
)
def test_a_bad_parameter_file_is_told_with_its_line(tmp_path, text, message):
    file = tmp_path / "bench.yaml"
    file.write_text(text)
    result = run("--ros-args", "--params-file", file)
    assert result.returncode == 2
    assert message in result.stderr, result.stderr


def test_all_parameters_are_described_at_once(bench):
    """A reply in many fragments: docs/decisions/0032."""
    client = bench.probe.parameters()
    names = bench.probe.call(lambda: client.list_parameters()).result.names
    descriptors = bench.probe.call(lambda: client.describe_parameters(names)).descriptors
    assert [d.name for d in descriptors] == list(names)
    assert sum(len(d.description) for d in descriptors) > 1500
