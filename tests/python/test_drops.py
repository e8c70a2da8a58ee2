"""G1 dropped onto the ground with passive joints, from many poses: on the spheres of its feet, and with all its hulls."""

import json
import random
import subprocess

import pytest
from conftest import BINARY
from models import public_models
from simulation import columns, simulate, texts

G1 = public_models()["g1"]
MESHES = ["--package", f"example-robot-data={G1.parents[3]}"]


def axes():
    return json.loads(subprocess.check_output([str(BINARY), "inspect", str(G1), "--json"]))["axes"]


AXES = axes()


def pose(seed):
    """`--set` and `--base-pose`: the soles about 10 cm up; joints within ±0.3 rad of 0, the base within 0.1 rad of upright."""
    choose = random.Random(seed)
    x, y = choose.uniform(-0.05, 0.05), choose.uniform(-0.05, 0.05)
    flags = [f"--base-pose=0,0,0.9,{x},{y},0,{(1 - x * x - y * y) ** 0.5}"]
    for axis in AXES:
        low, high = max(axis["lower"], -0.3), min(axis["upper"], 0.3)
        flags.append(f"--set={axis['name']}={choose.uniform(low, high)}")
    return flags


def drop(tmp_path, seed, step, seconds, *more):
    out, contacts = tmp_path / "drop.csv", tmp_path / "contacts.csv"
    flags = ["--ground", "--base", "free", "--off", "drives", "--control-interval", step, "--steps", 1]
    summary = simulate(G1, *flags, "--duration", seconds, *pose(seed), *more, "--out", out, "--contacts", contacts)
    table = columns(out)
    energy = [k + p for k, p in zip(table["energy.kinetic"], table["energy.potential"], strict=True)]
    grown = sum(max(b - a, 0) for a, b in zip(energy, energy[1:], strict=False))
    late = texts(contacts)

    def deepest(after):
        return max((float(d) for t, d in zip(late["time"], late["depth"], strict=True) if float(t) > after), default=0)

    found = {
        # Some poses begin with hulls in each other (a knee in a hip, by up to 5 cm); these are pushed apart first.
        "worst": deepest(0.2),
        "grown": grown,
        "at rest": deepest(0.95 * seconds),
        "kinetic": table["energy.kinetic"][-1],
        "us": summary["us_per_step"],
    }
    print(seed, step, found)
    assert summary["finite"]
    return found


@pytest.mark.parametrize("seed", range(6))
def test_g1_falls_with_all_its_hulls(tmp_path, seed):
    """At 1 ms: never deeper than 3 mm, and lies no deeper than 0.1 mm; makes no more energy in all than 0.1 mJ (in free motion)."""
    found = drop(tmp_path, seed, 0.001, 1.5, *MESHES)
    assert found["worst"] < 3e-3
    if found["kinetic"] < 1e-2:
        assert found["at rest"] < 1e-4
    assert found["grown"] < 1e-4


@pytest.mark.parametrize("step", [0.01, 0.005, 0.00025])
def test_g1_falls_at_any_step(tmp_path, step):
    """On the spheres of its feet: nothing blows up; at 0.25 ms not deeper than 0.2 mm."""
    found = drop(tmp_path, 1, step, 0.6)
    assert found["worst"] < (2e-4 if step < 0.001 else 2e-2)
