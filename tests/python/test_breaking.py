"""Soft joints and joints that come apart, as a user meets them: simulate, check, evaluate and the node."""

import json
import math
import subprocess

import pytest
from conftest import BINARY, wait_until
from cyclone import listen as cyclone_listen
from simulation import columns, run, simulate

G = 9.80665
MASS, TIP = 2.0, 0.5
INERTIA = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'

CRANE = f"""<robot name="crane">
  <link name="boom"/>
  <link name="hook"><inertial><origin xyz="0 0 -0.3"/><mass value="{MASS}"/>{INERTIA}</inertial></link>
  <link name="load"><inertial><mass value="{TIP}"/>{INERTIA}</inertial></link>
  <joint name="swing" type="continuous">
    <parent link="boom"/><child link="hook"/><origin xyz="0 0 3"/><axis xyz="0 1 0"/><realnoid>SWING</realnoid>
  </joint>
  <joint name="pin" type="fixed">
    <parent link="hook"/><child link="load"/><origin xyz="0 0 -0.6"/><realnoid>PIN</realnoid>
  </joint>
</robot>"""


@pytest.fixture
def crane(tmp_path):
    def write(swing="", pin=""):
        path = tmp_path / "crane.urdf"
        path.write_text(CRANE.replace("SWING", swing).replace("PIN", pin))
        return path

    return write


@pytest.mark.parametrize("integrator", ["semi_implicit_euler", "rk4"])
def test_a_pin_holds_its_load_or_lets_it_fall(crane, tmp_path, integrator):
    weight = TIP * G
    arguments = ["--duration", 1, "--steps", 1, "--integrator", integrator]
    holds = simulate(crane(pin=f'<constraint break_threshold="{weight / 0.999}"/>'), *arguments)
    assert (holds["broken_joints"], [w for w in holds["warnings"] if "apart" in w]) == ([], [])

    out = tmp_path / "fall.csv"
    told = simulate(crane(pin=f'<constraint break_threshold="{weight / 1.001}"/>'), *arguments, "--out", out)
    [broken] = told["broken_joints"]
    assert (broken["joint"], told["finite"]) == ("pin", True)
    assert math.isclose(broken["force"], weight, rel_tol=1e-9) and math.isclose(broken["time"], 1e-3, rel_tol=1e-9)
    assert any("'pin' came apart" in w for w in told["warnings"])
    # What falls has the momentum of its weight; the hook hangs on. A first-order method is at most one step late.
    table = columns(out)
    for t, pz in list(zip(table["time"], table["momentum.pz"], strict=True))[2:]:
        assert abs(pz + weight * t) < weight * 1.001e-3
    assert max(map(abs, table["swing.position"])) < 1e-12


def test_breaking_can_be_switched_off(crane):
    told = simulate(crane(pin='<constraint break_threshold="1"/>'), "--duration", 0.1, "--off", "breaking")
    assert told["broken_joints"] == []


def test_a_soft_hinge_sags_by_its_load_over_k(crane, tmp_path):
    erp, cfm, h = 0.3, 1e-5, 1e-3
    urdf = crane(swing=f'<constraint erp="{erp}" cfm="{cfm}"/>')
    energy = {}
    for off in ([], ["--off", "compliance"]):
        out = tmp_path / "sag.csv"
        simulate(urdf, "--duration", 1, "--steps", 1, "--integrator", "semi_implicit_euler", *off, "--out", out)
        energy[len(off)] = columns(out)["energy.potential"][-1]
    weight = (MASS + TIP) * G
    sag = (energy[2] - energy[0]) / weight
    assert math.isclose(sag, weight * cfm * h / erp, rel_tol=1e-6)


def test_check_names_joint_and_item(crane):
    found = subprocess.run([BINARY, "check", crane(swing='<constraint erp="0.3"/>')], capture_output=True, text=True)
    assert found.returncode == 0 and "erp has no effect" in found.stdout and "joint 'swing'" in found.stdout
    found = subprocess.run([BINARY, "check", crane(swing='<constraint cfm="0.3"/>')], capture_output=True, text=True)
    assert found.returncode == 0 and "drifts apart" in found.stdout


def test_inspect_and_evaluate_take_soft_joints(crane):
    tag = '<constraint erp="0.3" cfm="1e-3" break_threshold="500"/>'
    state = json.dumps({"position": [0.4], "velocity": [1.0], "effort": [2.0]}) + "\n"
    answers = []
    for urdf in (crane(), crane(swing=tag, pin=tag)):
        assert run(urdf, "--duration", 0.01).returncode == 0
        for form in ([], ["--json"], ["--full"]):
            shown = subprocess.run([BINARY, "inspect", urdf, *form], capture_output=True, text=True)
            assert shown.returncode == 0 and "swing" in shown.stdout, shown.stderr
        done = subprocess.run([BINARY, "evaluate", urdf], input=state, capture_output=True, text=True)
        answers.append(json.loads(done.stdout)["acceleration"][0])
    # Without a step there is no softness: it is the hard joint.
    assert math.isclose(*answers, rel_tol=1e-12)


def test_the_node_tells_of_a_break_and_moves_the_frame_to_the_world(crane, start):
    bench = start(urdf=crane(pin='<constraint break_threshold="1"/>'))
    frames = cyclone_listen("tf", bench.domain)
    wait_until(lambda: bench.count("simulation", "broken joints") == "1", what="diagnostics of the break")
    assert "came apart at" in bench.count("simulation", "broken: pin")
    parents = {}

    def fallen():
        for message in frames.take_all():
            parents.update((t.child_frame_id, (t.header.frame_id, t.transform.translation.z)) for t in message.transforms)
        parent, z = parents.get("load", ("", math.inf))
        return parent == "world" and z < 2.4

    wait_until(fallen, what="/tf of a load that falls in the world")
    assert parents["hook"][0] == "boom"
    wait_until(lambda: bench.logged("joint 'pin' came apart"), what="the log")
