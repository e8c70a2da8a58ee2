"""Accelerations against Pinocchio's, an independent implementation, on four humanoids.

Tolerance: 1e-10 of the largest acceleration of the state. Both programs solve the same system in f64, whose condition
number (largest to smallest inertia) is about 1e5 for these robots, so rounding is some 1e-11.
"""

import json
import os
import subprocess

import numpy as np
import pinocchio as pin
import pytest

from models import public_models

BIN = os.environ.get("REALNOID_BIN", "target/release/realnoid")
ROOT = os.path.join(os.path.dirname(__file__), "..", "..")
GRAVITY = np.array([0.4, -0.3, -9.80665])
STATES = 100


@pytest.fixture(params=["g1", "simple_humanoid", "jvrc1", "origin"])
def urdf(request, tmp_path):
    if request.param != "origin":
        return str(public_models()[request.param])
    # Pinocchio does not read our tags: give it the masses that they stand for.
    path = tmp_path / "origin.urdf"
    source = os.path.join(ROOT, "urdf", "origin.urdf")
    path.write_text(subprocess.check_output([BIN, "inspect", source, "--urdf-with-inertials"], text=True))
    return str(path)


def axes_of(path):
    return [a["name"] for a in json.loads(subprocess.check_output([BIN, "inspect", path, "--json"]))["axes"]]


def random_states(model, axes, base, rng):
    """Our states and Pinocchio's (q, v, tau) of the same."""
    ours, theirs = [], []
    for _ in range(STATES):
        position = rng.uniform(-1.2, 1.2, len(axes))
        velocity, effort = rng.uniform(-3, 3, len(axes)), rng.uniform(-20, 20, len(axes))
        q, v, tau = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        state = {"position": position.tolist(), "velocity": velocity.tolist(), "effort": effort.tolist()}
        if base == "free":
            quaternion = rng.normal(size=4)
            quaternion /= np.linalg.norm(quaternion)
            at, twist = rng.uniform(-1, 1, 3), rng.uniform(-2, 2, 6)
            q[:3], q[3:7], v[:3], v[3:6] = at, quaternion, twist[3:], twist[:3]
            state |= {"base_pose": [*at, *quaternion], "base_twist": twist.tolist()}
        for name, x, xd, t in zip(axes, position, velocity, effort):
            joint = model.joints[model.getJointId(name)]
            if joint.nq == 2:  # Pinocchio keeps a continuous joint as cosine and sine
                q[joint.idx_q : joint.idx_q + 2] = np.cos(x), np.sin(x)
            else:
                q[joint.idx_q] = x
            v[joint.idx_v], tau[joint.idx_v] = xd, t
        ours.append(json.dumps(state))
        theirs.append((q, v, tau))
    return ours, theirs


@pytest.mark.parametrize("base", ["fixed", "free"])
def test_accelerations_agree_with_pinocchio(urdf, base):
    free = (pin.JointModelFreeFlyer(),) if base == "free" else ()
    model = pin.buildModelFromUrdf(urdf, *free)
    model.gravity.linear = GRAVITY
    data = model.createData()
    axes = axes_of(urdf)
    assert len(axes) == model.nv - (6 if base == "free" else 0), "both programs see the same axes"
    ours, theirs = random_states(model, axes, base, np.random.default_rng(7))
    gravity = ",".join(map(repr, GRAVITY.tolist()))
    command = [BIN, "evaluate", urdf, "--base", base, "--gravity", gravity]
    lines = subprocess.run(command, input="\n".join(ours), text=True, capture_output=True, check=True).stdout.split("\n")
    worst = 0.0
    for line, (q, v, tau) in zip(lines[:STATES], theirs, strict=True):
        out = json.loads(line)
        expected = pin.aba(model, data, q, v, tau)
        actual = np.zeros(model.nv)
        for name, a in zip(axes, out["acceleration"], strict=True):
            actual[model.joints[model.getJointId(name)].idx_v] = a
        if base == "free":
            b = out["base_acceleration"]
            actual[:3], actual[3:6] = b[3:], b[:3]
        worst = max(worst, np.abs(actual - expected).max() / np.abs(expected).max())
    print(f"{os.path.basename(urdf)} {base}: {STATES} states, worst relative difference {worst:.1e}")
    assert worst <= 1e-10
