"""Hard cases through `simulate`: whirling limbs in free flight, commands that no drive can follow, every axis at once."""

import json
import random
import subprocess

import pytest
from conftest import BINARY
from models import public_models
from simulation import ORIGIN, columns, simulate


def axes_of(urdf):
    return json.loads(subprocess.check_output([str(BINARY), "inspect", str(urdf), "--json"]))["axes"]


def thrown(urdf, speed):
    """`--set` for every axis: at its initial place, ± speed."""
    choose = random.Random(5)
    return [f"--set={axis['name']}=0,{choose.choice([-speed, speed])}" for axis in axes_of(urdf)]


def test_a_passive_g1_in_free_flight_keeps_its_energy_for_a_minute(tmp_path):
    """3 rad/s on all joints, nothing that takes energy, 60 s at 1 ms; its light wrists reach 200 rad/s.

    What an integrator of second order that is symmetric in time leaves is no drift, but what one step errs: at 200 rad/s
    and 1 ms (0.2 rad)²/12 = 0.3 % of what such a limb carries. 1 % is allowed.
    """
    g1 = public_models()["g1"]
    out = tmp_path / "flight.csv"
    flags = ["--base", "free", "--gravity", "0,0,0", "--duration", 60, "--control-interval", 0.001, "--steps", 1, "--every", 0.1]
    passive = [f"--off={effect}" for effect in ("limits", "damping", "friction")]
    summary = simulate(g1, *flags, *passive, *thrown(g1, 3), "--out", out)
    table = columns(out)
    start = table["energy.kinetic"][0]
    assert max(abs(e - start) for e in table["energy.kinetic"]) <= 0.01 * start
    fastest = max(max(map(abs, column)) for name, column in table.items() if name.endswith("_joint.velocity"))
    assert fastest > 50, "or else it is no hard case"
    for part in ("px", "py", "pz"):
        assert abs(table[f"momentum.{part}"][-1] - table[f"momentum.{part}"][0]) <= 0.01 * 10
    assert summary["guarded_pieces"] == 0 and summary["unsettled_steps"] == 0
    assert summary["energy"]["unaccounted"] == pytest.approx(table["energy.kinetic"][-1] - start, abs=1e-9)


def test_torques_that_no_drive_has_are_cut_and_said():
    name = axes_of(ORIGIN)[3]["name"]
    summary = simulate(ORIGIN, "--duration", 0.5, "--effort", f"{name}=1e6")
    assert summary["finite"]
    [said] = [w for w in summary["warnings"] if name in w]
    assert "1000000 is beyond its maximum" in said
    assert summary["peaks"][name]["torque"] <= 200


@pytest.mark.parametrize("interval", [0.01, 0.001, 0.0001])
def test_all_axes_of_the_humanoid_against_their_stops(interval):
    """Every servo pushes beyond its range: they end at their stops, and stand."""
    servos = [f"--servo={axis['name']}={2 * axis['upper']}" for axis in axes_of(ORIGIN) if axis["upper"]]
    steps = ["--control-interval", interval, "--steps", 1]
    summary = simulate(ORIGIN, "--duration", 2, *steps, *servos)
    assert summary["finite"] and summary["guarded_pieces"] == 0
    assert len([w for w in summary["warnings"] if "outside its range" in w]) == len(servos)
