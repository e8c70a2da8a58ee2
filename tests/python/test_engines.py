"""Engines are exchanged while the node runs, through real rclpy; `realnoid engines` and `inspect --engine`."""

import json
import math
import subprocess

import pytest
from conftest import ARM, BINARY, nanoseconds, wait_until

ROOT = BINARY.parents[2]
# A rod of 2 kg, its centre 0.3 m from a horizontal axis, I = 0.24 kg·m²; at 0 it is horizontal. See tests/conformance/rod.urdf.
ROD = ROOT / "tests/conformance/rod.urdf"
G = 9.80665
# Greatest acceleration, rad/s², and greatest speed of a swing from the horizontal, rad/s.
FASTEST_CHANGE = 2 * G * 0.3 / 0.24
FASTEST = math.sqrt(2 * FASTEST_CHANGE)
INTERVAL = 0.001
STEP = INTERVAL / 5


def list_engines():
    return json.loads(subprocess.check_output([BINARY, "engines", "--json"]))["engines"]


ENGINES = list_engines()
BUILT = [e["name"] for e in ENGINES if e["built"]]
JOINTED = [e["name"] for e in ENGINES if e["built"] and e["capabilities"]["joints"]]


def switch(bench, client, name):
    """The index of the first sample that was taken after the answer."""
    [result] = bench.probe.set(client, engine=name)
    assert result.successful, result.reason
    assert bench.probe.get(client, "engine") == name
    return len(bench.states)


def test_a_swinging_joint_goes_on_through_all_engines(start):
    bench = start("-p", "start:=free", urdf=ROD)
    client = bench.probe.parameters()
    order = [name for name in JOINTED if name != "rbx"] + ["rbx"]
    assert "rapier" in order
    for name in order:
        at = switch(bench, client, name)
        # Half a second of swinging in it.
        wait_until(lambda: len(bench.states) > at + 500, what=f"samples of {name}")
    states = list(bench.states)
    stamps = [nanoseconds(s.header.stamp) for s in states]
    assert {b - a for a, b in zip(stamps, stamps[1:])} == {round(INTERVAL * 1e9)}, "no sample is missing"
    position = [s.position[0] for s in states]
    velocity = [s.velocity[0] for s in states]
    moved = max(abs(b - a) for a, b in zip(position, position[1:]))
    changed = max(abs(b - a) for a, b in zip(velocity, velocity[1:]))
    # In an interval no more than the greatest speed and acceleration can; beside that engines err in the first order of a step.
    assert 0.5 * FASTEST * INTERVAL < moved < (FASTEST + FASTEST_CHANGE * STEP) * INTERVAL * 1.01, moved
    assert changed < FASTEST_CHANGE * (INTERVAL + STEP) * 1.01, changed
    # It still swings with the energy it had: per moment of inertia, 0 at the horizontal.
    energy = [0.5 * v * v + FASTEST_CHANGE * math.sin(q) for q, v in zip(position, velocity)]
    swings = stamps[-1] * 1e-9 * math.sqrt(FASTEST_CHANGE)
    assert max(map(abs, energy)) < FASTEST_CHANGE * math.sqrt(FASTEST_CHANGE) * STEP * max(swings, 1), max(map(abs, energy))
    assert min(position) < -3.0, "it swings to the other side"


def test_a_bad_name_is_refused_and_changes_nothing(bench):
    client = bench.probe.parameters()
    switch(bench, client, "rapier")
    [result] = bench.probe.set(client, engine="newton")
    assert not result.successful
    assert all(text in result.reason for text in ["newton", "rbx", "rapier", "bullet"]), result.reason
    assert bench.probe.get(client, "engine") == "rapier"
    at = len(bench.states)
    wait_until(lambda: len(bench.states) > at + 50, what="samples after the refusal")


@pytest.mark.parametrize("engine", ENGINES, ids=lambda e: e["name"])
def test_an_engine_that_is_not_built_says_how_to_have_it(engine, bench):
    client = bench.probe.parameters()
    [result] = bench.probe.set(client, engine=engine["name"])
    assert result.successful == engine["built"]
    assert result.reason == (engine["to_have_it"] or "")
    assert bench.probe.get(client, "engine") == (engine["name"] if engine["built"] else "rbx")
    if not engine["built"]:
        assert re_build(result.reason), result.reason


def re_build(reason):
    """It says how to build it, or that there is nothing to build yet."""
    return "cargo build --release --features" in reason or "not part of realnoid yet" in reason


# Two hinges without mass between them that do not stand square on each other: Bullet has no constraint for that.
ASKEW = """<robot name="askew"><link name="base"/><link name="between"/>
<link name="tip"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="first" type="continuous"><parent link="base"/><child link="between"/><axis xyz="0 0 1"/></joint>
<joint name="second" type="continuous"><parent link="between"/><child link="tip"/><axis xyz="0 1 1"/></joint></robot>
"""


@pytest.mark.skipif("bullet" not in BUILT, reason="only bullet refuses a robot")
def test_an_engine_that_cannot_take_the_robot_is_refused(start, tmp_path):
    urdf = tmp_path / "askew.urdf"
    urdf.write_text(ASKEW)
    bench = start(urdf=urdf)
    client = bench.probe.parameters()
    [result] = bench.probe.set(client, engine="bullet")
    assert not result.successful and "parameter 'engine' = bullet" in result.reason and "link 'tip'" in result.reason, result.reason
    assert bench.probe.get(client, "engine") == "rbx"
    # Later settings still count.
    [result] = bench.probe.set(client, control_interval=0.002)
    assert result.successful
    stamps = lambda: [nanoseconds(s.header.stamp) for s in list(bench.states)[-2:]]
    wait_until(lambda: stamps()[1] - stamps()[0] == 2_000_000, what="stamps 2 ms apart")


@pytest.fixture
def coupled(tmp_path):
    """The ankle follows the knee: rbx alone knows that."""
    path = tmp_path / "coupled.urdf"
    text = ARM.read_text()
    at = text.index("</joint>", text.index('<joint name="ankle"'))
    path.write_text(text[:at] + '<mimic joint="knee"/>' + text[at:])
    return path


def test_what_an_engine_does_not_honour_is_told_at_the_switch(start, coupled):
    bench = start(urdf=coupled)
    client = bench.probe.parameters()
    assert not bench.logged("does not honour")
    for engine in [e for e in ENGINES if e["built"] and e["capabilities"]["joints"] and not e["capabilities"]["couplings"]]:
        name = engine["name"]
        switch(bench, client, name)
        told = f"the engine {name} does not honour <mimic> of joint 'ankle'"
        wait_until(lambda: bench.logged(told), what=told)
        # Once for each switch, not for each setting.
        bench.probe.set(client, solver_iterations=20)
        switch(bench, client, "rbx")
        assert len(bench.logged(told)) == 1
    assert not bench.logged("the engine rbx does not honour")


def test_an_integrator_that_an_engine_does_not_use_is_told(start, tmp_path):
    bench = start(urdf=ARM)
    client = bench.probe.parameters()
    told = "the engine rapier does not honour integrator rk4 of the world: it has its own"
    bench.probe.set(client, integrator="rk4")
    assert not bench.logged("does not honour")
    switch(bench, client, "rapier")
    wait_until(lambda: bench.logged(told), what=told)
    run = [BINARY, "simulate", ARM, "--duration", "0.01", "--engine", "rapier"]
    assert told in subprocess.check_output([*run, "--integrator", "rk4"], text=True)
    assert "does not honour" not in subprocess.check_output(run, text=True)


def test_inspect_tells_what_an_engine_does_not_honour(coupled):
    text = subprocess.check_output([BINARY, "inspect", coupled, "--engine", "rapier"], text=True)
    assert "the engine rapier does not honour\n  <mimic> of joint 'ankle': it moves by itself" in text, text
    assert "the engine rbx honours all of it" in subprocess.check_output([BINARY, "inspect", coupled, "--engine", "rbx"], text=True)
    told = json.loads(subprocess.check_output([BINARY, "inspect", coupled, "--engine", "rapier", "--json"]))["engine"]
    assert told["name"] == "rapier"
    assert {"element": "joint 'ankle'", "item": "<mimic>", "instead": "it moves by itself"} in told["not_honoured"]
    # `check` tells the same, with its line.
    checked = subprocess.run([BINARY, "check", coupled, "--engine", "rapier"], capture_output=True, text=True)
    assert checked.returncode == 0 and "the engine rapier does not honour <mimic> of joint 'ankle'" in checked.stdout


def test_inspect_tells_the_shapes_of_rapier():
    command = [BINARY, "inspect", ROOT / "urdf/origin.urdf", "--ground", "--engine", "rapier"]
    text = subprocess.check_output(command, text=True)
    assert "shapes in rapier: " in text and "half-space -> HalfSpace (1)" in text, text
    told = json.loads(subprocess.check_output([*command, "--json"]))
    assert len(told["engine"]["shapes"]) == len(told["world"]["colliders"])


@pytest.mark.parametrize("name, told", [("newton", "does not exist; choose one of: rbx, rapier")] + [(e["name"], e["to_have_it"]) for e in ENGINES if not e["built"]])
def test_inspect_and_check_refuse_engines_that_are_not_there(name, told):
    inspected = subprocess.run([BINARY, "inspect", ROD, "--engine", name], capture_output=True, text=True)
    assert inspected.returncode == 2 and told in inspected.stderr and inspected.stdout == ""
    checked = subprocess.run([BINARY, "check", ROD, "--engine", name], capture_output=True, text=True)
    assert checked.returncode == 1 and told in checked.stderr
